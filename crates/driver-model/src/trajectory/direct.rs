//! The speed some seconds ahead, predicted at once and not step by step: one regression of `v(t + h) − v(t)` per horizon `h`.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use svr::{Kernel, Penalty, Response, Samples, Settings, Status};

use super::boosted_trees::BoostedTrees;
use super::predictors::{Predictor, predictors, rows};
use super::{Course, DirectKind};
use crate::Error;
use crate::statistics::mean;

/// What direct predictions are made of.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectSettings {
    /// Seconds ahead, ascending; 1 to 10.
    pub horizons_s: Vec<f64>,
    /// Training samples, spread evenly over the drives; 16,000.
    pub max_samples: usize,
    /// Distance of training samples; 1 s.
    pub sample_step_s: f64,
    /// Whether the slope ahead is a predictor. Off: where the slope comes from the elevation that was recorded on the same drive,
    /// its errors tell where the drive stood still or went slowly.
    pub slope_ahead: bool,
    /// Share of drives that prediction intervals hold; 0.9.
    pub coverage: f64,
}

impl Default for DirectSettings {
    fn default() -> Self {
        Self {
            horizons_s: (1..=10).map(f64::from).collect(),
            max_samples: 16_000,
            sample_step_s: 1.0,
            slope_ahead: false,
            coverage: 0.9,
        }
    }
}

/// History that an origin must have behind it.
const LEAST_PAST_S: f64 = 5.0;

/// Fewer samples teach nothing.
const LEAST_SAMPLES: usize = 50;

/// `λ` of ridge regression, `C = 1/λ`.
const RIDGE_BOX_CONSTRAINT: f64 = 0.1;

/// Box constraint of the least-squares support vector machine, and kernel scale beside the root of the sum of squared
/// predictor weights. Chosen on drives of `bmw-i3`; they serve other logs as well.
const LEAST_SQUARES_BOX_CONSTRAINT: f64 = 5.0;
const RBF_SCALE: f64 = 1.7;

/// Beside MATLAB's defaults: with those the regression learns medians, which lie too near to "no change", and its root mean square
/// error is 4 % larger.
const BOX_CONSTRAINT_FACTOR: f64 = 10.0;
const TUBE_FACTOR: f64 = 8.0;

/// A fitted direct prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawModel")]
pub struct DirectModel {
    kind: DirectKind,
    step_s: f64,
    samples: usize,
    predictors: Vec<Predictor>,
    horizons: Vec<Horizon>,
}

/// What is known of one horizon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Horizon {
    horizon_s: f64,
    /// Half width of the prediction interval; none for a baseline that is not fitted.
    interval_mps: Option<f64>,
    regression: Option<Regression>,
    trees: Option<BoostedTrees>,
    /// How the solver of a support vector regression ended.
    status: Option<Status>,
}

type Regression = svr::Model;

/// A regression, and how its solver ended where it is one that might not.
type Solved = (Regression, Option<Status>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawModel {
    kind: DirectKind,
    step_s: f64,
    samples: usize,
    predictors: Vec<Predictor>,
    horizons: Vec<Horizon>,
}

impl TryFrom<RawModel> for DirectModel {
    type Error = Error;

    fn try_from(raw: RawModel) -> Result<Self, Error> {
        let RawModel {
            kind,
            step_s,
            samples,
            predictors,
            horizons,
        } = raw;
        let model = Self {
            kind,
            step_s,
            samples,
            predictors,
            horizons,
        };
        model.check().map_err(|reason| Error::ModelFile {
            reason: reason.to_owned(),
        })?;
        Ok(model)
    }
}

/// The speed ahead as seen from one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedAhead {
    /// Predicted, one per horizon; never negative.
    pub speed_mps: Vec<f64>,
}

/// Predictions at one horizon beside what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonScore {
    /// Seconds ahead.
    pub horizon_s: f64,
    /// Half width of the prediction interval.
    pub interval_mps: Option<f64>,
    /// One per moment.
    pub speed_mps: Vec<f64>,
    /// One per moment; `None` where the drive is over by then.
    pub measured_mps: Vec<Option<f64>>,
    /// Root mean square error; `None` where nothing was measured.
    pub rmse_mps: Option<f64>,
    /// Share of measured speeds in the interval.
    pub inside_pct: Option<f64>,
}

impl DirectModel {
    /// Fits one regression per horizon to drives of the same sampling interval, and prediction intervals to the errors on
    /// every third drive, predicted from the others.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] where there is not enough to learn from, [`Error::Option`] for settings out of range,
    /// [`Error::Steps`] for drives of different sampling intervals, and what the regressions refuse.
    pub fn fit(
        kind: DirectKind,
        courses: &[&Course],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        settings.check()?;
        let mut model = Self::fit_points(kind, courses, settings)?;
        if kind.is_fitted() {
            let third = |held: bool| -> Vec<&Course> {
                let courses = courses.iter().enumerate();
                courses
                    .filter(|(i, _)| (i % 3 == 2) == held)
                    .map(|(_, course)| *course)
                    .collect()
            };
            if let Ok(calibration) = Self::fit_points(kind, &third(false), settings) {
                model.calibrate(&calibration, &third(true), settings.coverage)?;
            }
        }
        Ok(model)
    }

    fn fit_points(
        kind: DirectKind,
        courses: &[&Course],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let step_s = courses.first().map_or(1.0, |course| course.step_s);
        if let Some(other) = courses
            .iter()
            .find(|course| (course.step_s - step_s).abs() > 1e-9)
        {
            return Err(Error::Steps {
                log: other.name.clone(),
                found_s: other.step_s,
                expected_s: step_s,
            });
        }
        let limits = courses.iter().all(|course| course.limit_mps.is_some());
        let slope = settings.slope_ahead && courses.iter().all(|course| course.slope_rad.is_some());
        let weighted = predictors(step_s, limits, slope);
        let horizon = |&horizon_s| Horizon {
            horizon_s,
            interval_mps: None,
            regression: None,
            trees: None,
            status: None,
        };
        let mut model = Self {
            kind,
            step_s,
            samples: 0,
            predictors: weighted.iter().map(|(predictor, _)| *predictor).collect(),
            horizons: settings.horizons_s.iter().map(horizon).collect(),
        };
        if kind.is_fitted() {
            let weights = weighted.iter().map(|(_, weight)| *weight).collect();
            model.learn(courses, settings, weights)?;
        }
        Ok(model)
    }

    fn learn(
        &mut self,
        courses: &[&Course],
        settings: &DirectSettings,
        weights: Vec<f64>,
    ) -> Result<(), Error> {
        let training = Training::gather(courses, &self.predictors, settings)?;
        let d = self.predictors.len();
        let samples = Samples::new(&training.rows, d)?;
        let responses = training
            .changes
            .iter()
            .map(|changes| Response::new(changes));
        let responses = responses.collect::<Result<Vec<_>, _>>()?;
        self.samples = samples.len();
        let regressions = self.kind.regressions(&samples, &responses, weights)?;
        let trees = self.kind.has_trees().then(|| {
            let trees = training
                .changes
                .par_iter()
                .map(|changes| BoostedTrees::fit(&training.rows, d, changes));
            trees.collect::<Result<Vec<_>, Error>>()
        });
        let mut trees = trees.transpose()?.unwrap_or_default().into_iter();
        let mut regressions = regressions.into_iter();
        for horizon in &mut self.horizons {
            if let Some((regression, status)) = regressions.next() {
                (horizon.regression, horizon.status) = (Some(regression), status);
            }
            horizon.trees = trees.next();
        }
        Ok(())
    }

    /// Split conformal prediction (V. Vovk, A. Gammerman, G. Shafer, 2005), by whole drives: neighbours resemble each other.
    fn calibrate(
        &mut self,
        calibration: &Self,
        held: &[&Course],
        coverage: f64,
    ) -> Result<(), Error> {
        let mut errors = vec![Vec::new(); self.horizons.len()];
        for course in held {
            let origins = calibration.origins(course, 1.0);
            let predicted = calibration.predict(course, &origins)?;
            for (&origin, ahead) in origins.iter().zip(predicted) {
                for ((errors, horizon), speed) in
                    errors.iter_mut().zip(&self.horizons).zip(ahead.speed_mps)
                {
                    let measured = course.speed_mps[origin + course.samples_in(horizon.horizon_s)];
                    errors.push((speed - measured).abs());
                }
            }
        }
        for (horizon, errors) in self.horizons.iter_mut().zip(&mut errors) {
            let rank = (coverage * (errors.len() + 1) as f64).ceil() as usize;
            if errors.is_empty() || rank > errors.len() {
                continue;
            }
            let (_, quantile, _) = errors.select_nth_unstable_by(rank - 1, f64::total_cmp);
            horizon.interval_mps = Some(*quantile);
        }
        Ok(())
    }

    /// Which model.
    #[must_use]
    pub fn kind(&self) -> DirectKind {
        self.kind
    }

    /// Sampling interval of the drives that it was fitted to and that it predicts.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Number of predictors.
    #[must_use]
    pub fn predictors(&self) -> usize {
        self.predictors.len()
    }

    /// Samples learnt from.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Horizons whose solver stopped before the optimum.
    pub fn unfinished_s(&self) -> impl Iterator<Item = f64> {
        let unfinished = |horizon: &&Horizon| {
            horizon
                .status
                .is_some_and(|status| status != Status::Optimal)
        };
        self.horizons
            .iter()
            .filter(unfinished)
            .map(|horizon| horizon.horizon_s)
    }

    /// Every moment with enough past, `step_s` apart.
    #[must_use]
    pub fn moments(&self, course: &Course, step_s: f64) -> Vec<usize> {
        origins(course, 0.0, step_s)
    }

    /// Seconds ahead.
    pub fn horizons_s(&self) -> impl ExactSizeIterator<Item = f64> {
        self.horizons.iter().map(|horizon| horizon.horizon_s)
    }

    /// Half width of the prediction interval per horizon, where there is one.
    pub fn intervals_mps(&self) -> impl Iterator<Item = Option<f64>> {
        self.horizons.iter().map(|horizon| horizon.interval_mps)
    }

    /// Moments every `step_s` from which all horizons can be compared with the measured speed.
    #[must_use]
    pub fn origins(&self, course: &Course, step_s: f64) -> Vec<usize> {
        origins(course, self.horizons_s().fold(0.0, f64::max), step_s)
    }

    /// Predicts from every origin, the last sample known, at all horizons.
    ///
    /// # Errors
    /// [`Error::Steps`] for a drive of another sampling interval, [`Error::NoLimits`] for one without limits where the model
    /// knows them.
    pub fn predict(&self, course: &Course, origins: &[usize]) -> Result<Vec<SpeedAhead>, Error> {
        if (course.step_s - self.step_s).abs() > 1e-9 {
            return Err(Error::Steps {
                log: course.name.clone(),
                found_s: course.step_s,
                expected_s: self.step_s,
            });
        }
        let knows_limits = self
            .predictors
            .iter()
            .any(|p| matches!(p, Predictor::Limit { .. }));
        if knows_limits && course.limit_mps.is_none() {
            return Err(Error::NoLimits {
                log: course.name.clone(),
            });
        }
        let mut ahead: Vec<SpeedAhead> = origins
            .iter()
            .map(|_| SpeedAhead {
                speed_mps: Vec::new(),
            })
            .collect();
        if origins.is_empty() {
            return Ok(ahead);
        }
        let rows = rows(course, &self.predictors, origins);
        for horizon in &self.horizons {
            let changes = match self.kind.baseline_change(horizon.horizon_s) {
                Some(change) => origins
                    .iter()
                    .map(|&origin| change * accel_mps2(course, origin))
                    .collect(),
                None => horizon.changes(&rows, self.predictors.len())?,
            };
            for ((ahead, change), &origin) in ahead.iter_mut().zip(changes).zip(origins) {
                ahead
                    .speed_mps
                    .push((course.speed_mps[origin] + change).max(0.0));
            }
        }
        Ok(ahead)
    }

    /// Predicts as [`Self::predict`] and compares with the measured speed as far as the drive goes; one per horizon.
    ///
    /// # Errors
    /// As [`Self::predict`].
    pub fn score(&self, course: &Course, origins: &[usize]) -> Result<Vec<HorizonScore>, Error> {
        let ahead = self.predict(course, origins)?;
        let score = |(k, horizon): (usize, &Horizon)| {
            let speed_mps: Vec<f64> = ahead.iter().map(|ahead| ahead.speed_mps[k]).collect();
            let steps = course.samples_in(horizon.horizon_s);
            let measured = origins
                .iter()
                .map(|&origin| course.speed_mps.get(origin + steps).copied());
            let measured_mps: Vec<Option<f64>> = measured.collect();
            let errors = speed_mps
                .iter()
                .zip(&measured_mps)
                .filter_map(|(p, v)| v.map(|v| p - v));
            let inside = |interval_mps: f64| {
                mean(
                    errors
                        .clone()
                        .map(|e| if e.abs() <= interval_mps { 100.0 } else { 0.0 }),
                )
            };
            HorizonScore {
                horizon_s: horizon.horizon_s,
                interval_mps: horizon.interval_mps,
                rmse_mps: mean(errors.clone().map(|e| e * e)).map(f64::sqrt),
                inside_pct: horizon.interval_mps.and_then(inside),
                speed_mps,
                measured_mps,
            }
        };
        Ok(self.horizons.iter().enumerate().map(score).collect())
    }

    fn check(&self) -> Result<(), &'static str> {
        let d = self.predictors.len();
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.step_s) || !self.horizons.iter().all(|h| positive(h.horizon_s)) {
            return Err("a time is not positive");
        }
        let fits = |horizon: &Horizon| {
            let trees = horizon.trees.as_ref().map(BoostedTrees::predictors);
            let regression = horizon.regression.as_ref().map(Regression::predictors);
            regression.is_none_or(|n| n == d)
                && trees.is_none_or(|n| n == d)
                && trees.is_some() == self.kind.has_trees()
                && regression.is_some() == self.kind.has_regression()
        };
        if !self.horizons.iter().all(fits) {
            return Err("regressions do not fit the predictors");
        }
        if !self
            .predictors
            .iter()
            .all(|predictor| predictor.is_usable())
        {
            return Err("a predictor looks at an impossible time");
        }
        Ok(())
    }
}

impl Horizon {
    /// Mean of what there is: a regression, trees, or both.
    fn changes(&self, rows: &[f64], d: usize) -> Result<Vec<f64>, Error> {
        let regression = self
            .regression
            .as_ref()
            .map(|model| model.predict(&Samples::new(rows, d)?))
            .transpose()?;
        let trees = self.trees.as_ref().map(|trees| trees.predict(rows));
        Ok(match (regression, trees) {
            (Some(a), Some(b)) => a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect(),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => vec![0.0; rows.len() / d],
        })
    }
}

impl DirectKind {
    fn regressions(
        self,
        samples: &Samples<'_>,
        responses: &[Response<'_>],
        weights: Vec<f64>,
    ) -> Result<Vec<Solved>, Error> {
        let kernel = match self {
            Self::Ridge => {
                let settings = Settings::default();
                let models =
                    svr::fit_least_squares(samples, responses, &settings, RIDGE_BOX_CONSTRAINT)?;
                return Ok(models.into_iter().map(|model| (model, None)).collect());
            }
            Self::LeastSquares | Self::Blend => {
                let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
                let settings = Settings {
                    kernel: Kernel::Rbf,
                    kernel_scale: Some(RBF_SCALE * size),
                    predictor_weights: weights,
                    ..Settings::default()
                };
                let models = svr::fit_least_squares(
                    samples,
                    responses,
                    &settings,
                    LEAST_SQUARES_BOX_CONSTRAINT,
                )?;
                return Ok(models.into_iter().map(|model| (model, None)).collect());
            }
            Self::SvrLinear => Kernel::Linear,
            Self::SvrQuadratic => Kernel::Quadratic,
            Self::SvrCubic => Kernel::Cubic,
            Self::SvrRbf => Kernel::Rbf,
            _ => return Ok(Vec::new()),
        };
        let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        let settings = Settings {
            kernel,
            kernel_scale: Some(match kernel {
                Kernel::Linear => 1.0,
                Kernel::Rbf => RBF_SCALE * size,
                Kernel::Quadratic | Kernel::Cubic => size,
            }),
            predictor_weights: if kernel == Kernel::Linear {
                Vec::new()
            } else {
                weights
            },
            ..Settings::default()
        };
        // Kernel rows are shared by all horizons; each starts from the one before.
        let mut trainer = svr::Trainer::new(samples, &settings)?;
        let mut before = None;
        let mut models = Vec::with_capacity(responses.len());
        for response in responses {
            let default = Penalty::default().resolve(response.values())?;
            let penalty = Penalty {
                box_constraint: Some(BOX_CONSTRAINT_FACTOR * default.box_constraint),
                tube_epsilon: Some(TUBE_FACTOR * default.tube_epsilon),
            };
            let fit = trainer.fit(response, &penalty, before.as_ref())?;
            models.push((fit.model.clone(), Some(fit.status)));
            before = Some(fit);
        }
        Ok(models)
    }
}

/// Acceleration over the last second.
fn accel_mps2(course: &Course, origin: usize) -> f64 {
    let lag = course.samples_in(1.0).min(origin);
    if lag == 0 {
        return 0.0;
    }
    (course.speed_mps[origin] - course.speed_mps[origin - lag]) / (lag as f64 * course.step_s)
}

pub(super) fn origins(course: &Course, longest_s: f64, step_s: f64) -> Vec<usize> {
    let from = course.samples_in(LEAST_PAST_S);
    let to = course.len().saturating_sub(course.samples_in(longest_s));
    (from..to).step_by(course.samples_in(step_s)).collect()
}

/// What all horizons learn from.
struct Training {
    rows: Vec<f64>,
    /// Per horizon.
    changes: Vec<Vec<f64>>,
}

impl Training {
    fn gather(
        courses: &[&Course],
        predictors: &[Predictor],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let longest_s = settings.horizons_s.iter().copied().fold(0.0, f64::max);
        let origins: Vec<Vec<usize>> = courses
            .iter()
            .map(|course| origins(course, longest_s, settings.sample_step_s))
            .collect();
        let total: usize = origins.iter().map(Vec::len).sum();
        if total < LEAST_SAMPLES {
            return Err(Error::TooFewPhases {
                model: "trajectory",
                found: total,
                needed: LEAST_SAMPLES,
                unit: "moments with enough past and future",
            });
        }
        let most = settings.max_samples.max(LEAST_SAMPLES);
        let mut seen = 0;
        let mut training = Self {
            rows: Vec::new(),
            changes: vec![Vec::new(); settings.horizons_s.len()],
        };
        for (course, origins) in courses.iter().zip(origins) {
            let chosen = origins.into_iter().filter(|_| {
                seen += 1;
                total <= most || (seen - 1) * most / total != seen * most / total
            });
            let chosen: Vec<usize> = chosen.collect();
            training.rows.extend(rows(course, predictors, &chosen));
            for (changes, &horizon_s) in training.changes.iter_mut().zip(&settings.horizons_s) {
                let ahead = course.samples_in(horizon_s);
                changes.extend(
                    chosen
                        .iter()
                        .map(|&i| course.speed_mps[i + ahead] - course.speed_mps[i]),
                );
            }
        }
        Ok(training)
    }
}

impl DirectSettings {
    fn check(&self) -> Result<(), Error> {
        let longest = self.horizons_s.iter().copied().fold(0.0, f64::max);
        Error::unless_at_least(
            "the number of horizons",
            self.horizons_s.len() as f64,
            1.0,
            "at least 1",
        )?;
        for &horizon_s in &self.horizons_s {
            Error::unless_at_least("horizon_s", horizon_s, 0.1, "0.1 s to 60 s")?;
        }
        if longest > 60.0 {
            return Err(Error::Option {
                name: "horizon_s",
                value: longest,
                expected: "0.1 s to 60 s",
            });
        }
        if !(self.coverage > 0.0 && self.coverage < 1.0) {
            return Err(Error::Option {
                name: "coverage",
                value: self.coverage,
                expected: "between 0 and 1",
            });
        }
        Error::unless_at_least("sample_step_s", self.sample_step_s, 0.0, "at least 0 s")
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Speeds that swing by a sum of two sines: what comes next follows from the past.
    fn course(phase: f64) -> Course {
        let speed = |i: usize| {
            let t = 0.2 * i as f64 + phase;
            12.0 + 4.0 * (0.3 * t).sin() + 2.0 * (0.11 * t).cos()
        };
        let speed_mps: Vec<f64> = (0..1500).map(speed).collect();
        let distance_m = (0..1500).map(|i| 2.4 * f64::from(i)).collect();
        Course {
            name: format!("{phase}"),
            step_s: 0.2,
            limit_mps: None,
            slope_rad: None,
            speed_mps,
            distance_m,
        }
    }

    fn settings() -> DirectSettings {
        DirectSettings {
            horizons_s: vec![1.0, 3.0],
            ..DirectSettings::default()
        }
    }

    #[test]
    fn what_follows_from_the_past_is_predicted_and_files_keep_it() {
        let courses: Vec<Course> = (0..6).map(|k| course(40.0 * f64::from(k))).collect();
        let (train, test) = (courses[..5].iter().collect::<Vec<_>>(), &courses[5]);
        for kind in DirectKind::ALL.into_iter().filter(|kind| kind.is_fitted()) {
            let model = DirectModel::fit(kind, &train, &settings()).unwrap();
            let origins = model.origins(test, 1.0);
            let error =
                |model: &DirectModel| model.score(test, &origins).unwrap()[1].rmse_mps.unwrap();
            let stays = DirectModel::fit(DirectKind::Persistence, &train, &settings()).unwrap();
            assert!(
                error(&model) < 0.8 * error(&stays),
                "{kind}: {}",
                error(&model)
            );
            assert!(
                model.intervals_mps().all(|interval| interval.is_some()),
                "{kind}"
            );

            let text = serde_json::to_string(&model).unwrap();
            let read: DirectModel = serde_json::from_str(&text).unwrap();
            assert_eq!(
                read.predict(test, &origins).unwrap(),
                model.predict(test, &origins).unwrap(),
                "{kind}"
            );
            let broken = text.replacen("\"horizon_s\":1.0", "\"horizon_s\":-1.0", 1);
            assert!(
                serde_json::from_str::<DirectModel>(&broken).is_err(),
                "{kind}"
            );
        }
    }

    #[test]
    fn baselines_are_what_they_say_and_never_negative() {
        let mut course = course(0.0);
        course.speed_mps = (0..1500)
            .map(|i| (10.0 - 0.01 * f64::from(i)).max(0.0))
            .collect();
        let model = |kind| DirectModel::fit(kind, &[&course], &settings()).unwrap();
        let ahead = |kind| model(kind).predict(&course, &[500, 995]).unwrap();
        assert!((ahead(DirectKind::Persistence)[0].speed_mps[1] - 5.0).abs() < 1e-9);
        assert!((ahead(DirectKind::ConstantAcceleration)[0].speed_mps[1] - 4.85).abs() < 1e-9);
        assert!(ahead(DirectKind::ConstantAcceleration)[1].speed_mps[1].abs() < 1e-12);
        let decayed = 5.0 - 0.05 * 2.0 * (1.0 - (-1.5_f64).exp());
        assert!((ahead(DirectKind::DecayingAcceleration)[0].speed_mps[1] - decayed).abs() < 1e-9);
    }

    #[test]
    fn a_drive_of_another_step_or_without_limits_is_refused() {
        let mut with_limits = course(0.0);
        with_limits.limit_mps = Some(vec![14.0; 1500]);
        let model = DirectModel::fit(DirectKind::Ridge, &[&with_limits], &settings()).unwrap();
        let other = Course {
            step_s: 1.0,
            ..with_limits.clone()
        };
        assert!(matches!(
            model.predict(&other, &[10]),
            Err(Error::Steps { .. })
        ));
        assert!(matches!(
            model.predict(&course(0.0), &[100]),
            Err(Error::NoLimits { .. })
        ));
        let short = Course {
            speed_mps: vec![1.0; 30],
            distance_m: vec![0.0; 30],
            ..course(0.0)
        };
        let too_few = DirectModel::fit(DirectKind::Ridge, &[&short], &settings());
        assert!(matches!(too_few, Err(Error::TooFewPhases { .. })));
    }
}

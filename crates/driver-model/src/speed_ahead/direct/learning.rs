use rayon::prelude::*;
use svr::{Response, Samples};

use super::{DirectModel, DirectSettings, Horizon, origins};
use crate::speed_ahead::boosted_trees::BoostedTrees;
use crate::speed_ahead::predictors::{Predictor, predictors, rows};
use crate::{Error, ModelKind, Motion, Subject};

/// Fewer samples teach nothing.
const LEAST_SAMPLES: usize = 50;

impl DirectModel {
    /// Fits one regression per horizon to drives of the same sampling interval, and prediction intervals to the errors on
    /// every third drive, predicted from the others.
    ///
    /// # Errors
    /// [`Error::TooFewMoments`] where there is not enough to learn from, [`Error::Option`] for settings out of range,
    /// [`Error::Steps`] for drives of different sampling intervals, [`Error::Subject`] for a model of anything else, and what the
    /// regressions refuse.
    pub fn fit(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        if kind.subject() != Subject::SpeedAhead {
            return Err(Error::not_of(Subject::SpeedAhead, kind));
        }
        settings.check()?;
        let mut model = Self::fit_points(kind, motions, settings)?;
        if kind.is_fitted() {
            let third = |held: bool| -> Vec<&Motion> {
                let motions = motions.iter().enumerate();
                motions
                    .filter(|(i, _)| (i % 3 == 2) == held)
                    .map(|(_, motion)| *motion)
                    .collect()
            };
            match Self::fit_points(kind, &third(false), settings) {
                Ok(part) => model.calibrate(&part, &third(true), settings.coverage)?,
                // Too few drives for intervals.
                Err(Error::TooFewMoments { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(model)
    }

    fn fit_points(
        kind: ModelKind,
        motions: &[&Motion],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let step_s = motions.first().map_or(1.0, |motion| motion.step_s());
        if let Some(other) = motions
            .iter()
            .find(|motion| (motion.step_s() - step_s).abs() > 1e-9)
        {
            return Err(Error::Steps {
                log: other.name().to_owned(),
                found_s: other.step_s(),
                expected_s: step_s,
            });
        }
        let limits = motions.iter().all(|motion| motion.limit_mps().is_some());
        let slope =
            settings.slope_ahead && motions.iter().all(|motion| motion.slope_rad().is_some());
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
            model.learn(motions, settings, weights)?;
        }
        Ok(model)
    }

    fn learn(
        &mut self,
        motions: &[&Motion],
        settings: &DirectSettings,
        weights: Vec<f64>,
    ) -> Result<(), Error> {
        let training = Training::gather(motions, &self.predictors, settings)?;
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
        held: &[&Motion],
        coverage: f64,
    ) -> Result<(), Error> {
        let mut errors = vec![Vec::new(); self.horizons.len()];
        for motion in held {
            let origins = calibration.origins(motion, 1.0);
            let predicted = calibration.predict(motion, &origins)?;
            for (&origin, ahead) in origins.iter().zip(predicted) {
                for ((errors, horizon), speed) in
                    errors.iter_mut().zip(&self.horizons).zip(ahead.speed_mps)
                {
                    let measured =
                        motion.speed_mps()[origin + motion.samples_in(horizon.horizon_s)];
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
}

/// What all horizons learn from.
struct Training {
    rows: Vec<f64>,
    /// Per horizon.
    changes: Vec<Vec<f64>>,
}

impl Training {
    fn gather(
        motions: &[&Motion],
        predictors: &[Predictor],
        settings: &DirectSettings,
    ) -> Result<Self, Error> {
        let longest_s = settings.horizons_s.iter().copied().fold(0.0, f64::max);
        let origins: Vec<Vec<usize>> = motions
            .iter()
            .map(|motion| origins(motion, longest_s, settings.sample_step_s))
            .collect();
        let total: usize = origins.iter().map(Vec::len).sum();
        if total < LEAST_SAMPLES {
            return Err(Error::TooFewMoments {
                found: total,
                needed: LEAST_SAMPLES,
            });
        }
        let most = settings.max_samples.max(LEAST_SAMPLES);
        let mut seen = 0;
        let mut training = Self {
            rows: Vec::new(),
            changes: vec![Vec::new(); settings.horizons_s.len()],
        };
        for (motion, origins) in motions.iter().zip(origins) {
            let chosen = origins.into_iter().filter(|_| {
                seen += 1;
                total <= most || (seen - 1) * most / total != seen * most / total
            });
            let chosen: Vec<usize> = chosen.collect();
            training.rows.extend(rows(motion, predictors, &chosen));
            for (changes, &horizon_s) in training.changes.iter_mut().zip(&settings.horizons_s) {
                let ahead = motion.samples_in(horizon_s);
                changes.extend(
                    chosen
                        .iter()
                        .map(|&i| motion.speed_mps()[i + ahead] - motion.speed_mps()[i]),
                );
            }
        }
        Ok(training)
    }
}

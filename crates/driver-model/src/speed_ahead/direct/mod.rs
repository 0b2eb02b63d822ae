//! The speed some seconds ahead, predicted at once and not step by step: one regression of `v(t + h) − v(t)` per horizon `h`.

mod learning;
mod regression;
mod settings;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};
use svr::{Samples, Status};

use super::boosted_trees::BoostedTrees;
use super::predictors::{Predictor, rows};
use crate::statistics::mean;
use crate::{Error, ModelKind, Motion, Subject};
pub use settings::DirectSettings;

/// History that an origin must have behind it.
pub(super) const LEAST_PAST_S: f64 = 5.0;

/// A fitted direct prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawModel")]
pub struct DirectModel {
    kind: ModelKind,
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
    kind: ModelKind,
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
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Which model.
    #[must_use]
    pub fn kind(&self) -> ModelKind {
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
    pub fn moments(&self, motion: &Motion, step_s: f64) -> Vec<usize> {
        origins(motion, 0.0, step_s)
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
    pub fn origins(&self, motion: &Motion, step_s: f64) -> Vec<usize> {
        origins(motion, self.horizons_s().fold(0.0, f64::max), step_s)
    }

    /// Predicts from every origin, the last sample known, at all horizons.
    ///
    /// # Errors
    /// [`Error::Steps`] for a drive of another sampling interval, [`Error::NoLimits`] for one without limits where the model
    /// knows them.
    pub fn predict(&self, motion: &Motion, origins: &[usize]) -> Result<Vec<SpeedAhead>, Error> {
        if (motion.step_s() - self.step_s).abs() > 1e-9 {
            return Err(Error::Steps {
                log: motion.name().to_owned(),
                found_s: motion.step_s(),
                expected_s: self.step_s,
            });
        }
        let knows_limits = self
            .predictors
            .iter()
            .any(|p| matches!(p, Predictor::Limit { .. }));
        if knows_limits && motion.limit_mps().is_none() {
            return Err(Error::NoLimits {
                log: motion.name().to_owned(),
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
        let rows = rows(motion, &self.predictors, origins);
        for horizon in &self.horizons {
            let changes = match self.kind.baseline_change(horizon.horizon_s) {
                Some(change) => origins
                    .iter()
                    .map(|&origin| change * accel_mps2(motion, origin))
                    .collect(),
                None => horizon.changes(&rows, self.predictors.len())?,
            };
            for ((ahead, change), &origin) in ahead.iter_mut().zip(changes).zip(origins) {
                ahead
                    .speed_mps
                    .push((motion.speed_mps()[origin] + change).max(0.0));
            }
        }
        Ok(ahead)
    }

    /// Predicts as [`Self::predict`] and compares with the measured speed as far as the drive goes; one per horizon.
    ///
    /// # Errors
    /// As [`Self::predict`].
    pub fn score(&self, motion: &Motion, origins: &[usize]) -> Result<Vec<HorizonScore>, Error> {
        let ahead = self.predict(motion, origins)?;
        let score = |(k, horizon): (usize, &Horizon)| {
            let speed_mps: Vec<f64> = ahead.iter().map(|ahead| ahead.speed_mps[k]).collect();
            let steps = motion.samples_in(horizon.horizon_s);
            let measured = origins
                .iter()
                .map(|&origin| motion.speed_mps().get(origin + steps).copied());
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
        if self.kind.subject() != Subject::SpeedAhead {
            return Err("it is none of the speed ahead");
        }
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

/// Acceleration over the last second.
fn accel_mps2(motion: &Motion, origin: usize) -> f64 {
    let lag = motion.samples_in(1.0).min(origin);
    if lag == 0 {
        return 0.0;
    }
    (motion.speed_mps()[origin] - motion.speed_mps()[origin - lag]) / (lag as f64 * motion.step_s())
}

/// Moments of a drive every `step_s` that have enough past, and `longest_s` ahead.
#[must_use]
pub fn origins(motion: &Motion, longest_s: f64, step_s: f64) -> Vec<usize> {
    let from = motion.samples_in(LEAST_PAST_S);
    let to = motion.len().saturating_sub(motion.samples_in(longest_s));
    (from..to).step_by(motion.samples_in(step_s)).collect()
}

use serde::{Deserialize, Serialize};
use svr::{Samples, Status};

use super::{SpeedAhead, accel_mps2};
use crate::speed_ahead::boosted_trees::BoostedTrees;
use crate::speed_ahead::interval::Intervals;
use crate::speed_ahead::predictors::{Predictor, rows};
use crate::{DriverChannel, Error, ModelKind, Motion};

/// What one set of predictors has taught.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Knowledge {
    pub(super) channels: Vec<DriverChannel>,
    /// Drives and moments learnt from.
    pub(super) drives: usize,
    pub(super) samples: usize,
    pub(super) predictors: Vec<Predictor>,
    pub(super) horizons: Vec<Horizon>,
    /// `None` for a baseline that is not fitted, and where there were too few drives.
    pub(super) intervals: Option<Intervals>,
}

/// What is known of one horizon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Horizon {
    pub(super) horizon_s: f64,
    /// Of a blend.
    pub(super) ridge: Option<svr::Model>,
    pub(super) regression: Option<svr::Model>,
    pub(super) trees: Option<BoostedTrees>,
    /// How much each of these counts, in this order, as far as there are any.
    pub(super) shares: Vec<f64>,
    /// How the solver of a support vector regression ended.
    pub(super) status: Option<Status>,
}

impl Knowledge {
    pub(super) fn needs_limits(&self) -> bool {
        let limit = |predictor: &Predictor| matches!(predictor, Predictor::Limit { .. });
        self.predictors.iter().any(limit)
    }

    pub(super) fn serves(&self, motion: &Motion) -> bool {
        self.channels
            .iter()
            .all(|channel| channel.is_known_in(motion))
    }

    pub(super) fn predict(
        &self,
        kind: ModelKind,
        motion: &Motion,
        origins: &[usize],
    ) -> Result<Vec<SpeedAhead>, Error> {
        let nothing = SpeedAhead {
            speed_mps: Vec::with_capacity(self.horizons.len()),
            interval_mps: Vec::with_capacity(self.horizons.len()),
        };
        let mut ahead = vec![nothing; origins.len()];
        if origins.is_empty() {
            return Ok(ahead);
        }
        let rows = rows(motion, &self.predictors, origins);
        for (k, horizon) in self.horizons.iter().enumerate() {
            let here = || origins.iter().map(|&origin| motion.speed_mps()[origin]);
            let mut changes = match kind.baseline_change(horizon.horizon_s) {
                Some(change) => origins
                    .iter()
                    .map(|&origin| change * accel_mps2(motion, origin))
                    .collect(),
                None => horizon.changes(&rows, self.predictors.len())?,
            };
            for (change, here) in changes.iter_mut().zip(here()) {
                *change = change.max(-here);
            }
            let intervals = self.intervals.as_ref();
            let bounds = intervals.map(|of| of.bounds_mps(k, &rows, &changes));
            for (i, (ahead, here)) in ahead.iter_mut().zip(here()).enumerate() {
                let speed_mps = here + changes[i];
                let bounds = bounds.as_ref().map(|bounds| bounds[i]);
                let interval =
                    |(low, high): (f64, f64)| ((speed_mps + low).max(0.0), speed_mps + high);
                ahead.speed_mps.push(speed_mps);
                ahead.interval_mps.push(bounds.map(interval));
            }
        }
        Ok(ahead)
    }

    pub(super) fn check(&self, kind: ModelKind) -> Result<(), &'static str> {
        let d = self.predictors.len();
        if !self
            .horizons
            .iter()
            .all(|horizon| horizon.horizon_s.is_finite() && horizon.horizon_s > 0.0)
        {
            return Err("a time is not positive");
        }
        if !self.horizons.iter().all(|horizon| horizon.fits(kind, d)) {
            return Err("regressions do not fit the predictors");
        }
        if !self
            .predictors
            .iter()
            .all(|predictor| predictor.is_usable())
        {
            return Err("a predictor looks at an impossible time");
        }
        if !self
            .intervals
            .as_ref()
            .is_none_or(|intervals| intervals.is_sound(self.horizons.len(), d))
        {
            return Err("intervals do not fit the predictors");
        }
        Ok(())
    }
}

impl Horizon {
    /// Shares of a blend before anything was held back: the mean of regression and trees.
    pub(super) const EVEN_SHARES: [f64; 3] = [0.0, 0.5, 0.5];

    fn changes(&self, rows: &[f64], d: usize) -> Result<Vec<f64>, Error> {
        let mut changes = vec![0.0; rows.len() / d];
        for (part, share) in self.parts(rows, d)?.iter().zip(&self.shares) {
            for (change, part) in changes.iter_mut().zip(part) {
                *change += share * part;
            }
        }
        Ok(changes)
    }

    /// What ridge regression, the other regression, and trees say, as far as there are any.
    pub(super) fn parts(&self, rows: &[f64], d: usize) -> Result<Vec<Vec<f64>>, Error> {
        let samples = Samples::new(rows, d)?;
        let regressions = self.ridge.iter().chain(&self.regression);
        let mut parts = regressions
            .map(|model| model.predict(&samples))
            .collect::<Result<Vec<_>, _>>()?;
        parts.extend(self.trees.as_ref().map(|trees| trees.predict(rows)));
        Ok(parts)
    }

    fn fits(&self, kind: ModelKind, d: usize) -> bool {
        let mut regressions = self.ridge.iter().chain(&self.regression);
        let trees = self.trees.as_ref().map(BoostedTrees::predictors);
        let parts = [
            self.ridge.is_some(),
            self.regression.is_some(),
            trees.is_some(),
        ];
        let number = parts.iter().filter(|part| **part).count();
        regressions.all(|model| model.predictors() == d)
            && trees.is_none_or(|n| n == d)
            && parts
                == [
                    kind == ModelKind::Blend,
                    kind.has_regression(),
                    kind.has_trees(),
                ]
            && self.shares.len() == number
            && self.shares.iter().all(|share| (0.0..=1.0).contains(share))
    }
}

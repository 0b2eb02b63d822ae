//! The speed some seconds ahead, predicted at once and not step by step: one regression of `v(t + h) − v(t)` per horizon `h`.

mod held;
mod knowledge;
mod learning;
mod regression;
mod settings;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};
use svr::Status;

use crate::statistics::mean;
use crate::{DriverChannel, Error, ModelKind, Motion, Subject};
use knowledge::{Horizon, Knowledge};
pub use settings::DirectSettings;

/// History that an origin must have behind it.
pub(crate) const LEAST_PAST_S: f64 = 5.0;

/// A fitted direct prediction.
///
/// Where most of the drives know what the driver does, see [`DriverChannel`], there are two: one that is told, and one for drives
/// without these channels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawModel")]
pub struct DirectModel {
    kind: ModelKind,
    step_s: f64,
    told: Option<Box<Knowledge>>,
    untold: Box<Knowledge>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawModel {
    kind: ModelKind,
    step_s: f64,
    told: Option<Box<Knowledge>>,
    untold: Box<Knowledge>,
}

impl TryFrom<RawModel> for DirectModel {
    type Error = Error;

    fn try_from(raw: RawModel) -> Result<Self, Error> {
        let RawModel {
            kind,
            step_s,
            told,
            untold,
        } = raw;
        let model = Self {
            kind,
            step_s,
            told,
            untold,
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
    /// Lower and upper bound per horizon, none where the model has none.
    pub interval_mps: Vec<Option<(f64, f64)>>,
}

/// Predictions at one horizon beside what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HorizonScore {
    /// Seconds ahead.
    pub horizon_s: f64,
    /// Mean half width of the prediction interval.
    pub interval_mps: Option<f64>,
    /// One per moment.
    pub speed_mps: Vec<f64>,
    /// Lower end of the prediction interval, one per moment; empty for a model without.
    pub low_mps: Vec<f64>,
    /// Upper end.
    pub high_mps: Vec<f64>,
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
        self.best().predictors.len()
    }

    /// Samples learnt from.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.untold.samples
    }

    /// What it is told beside speed and limits; nothing is empty.
    #[must_use]
    pub fn channels(&self) -> &[DriverChannel] {
        &self.best().channels
    }

    /// Drives that taught it, with [`channels`](Self::channels) and in all.
    #[must_use]
    pub fn drives(&self) -> (usize, usize) {
        (self.best().drives, self.untold.drives)
    }

    /// Whether it predicts this drive without [`channels`](Self::channels), since the drive lacks one.
    #[must_use]
    pub fn falls_back(&self, motion: &Motion) -> bool {
        self.told.as_ref().is_some_and(|told| !told.serves(motion))
    }

    /// The same without the driver's channels.
    #[must_use]
    pub fn without_channels(self) -> Self {
        Self { told: None, ..self }
    }

    fn of_drive(&self, motion: &Motion) -> &Knowledge {
        let told = self.told.as_deref().filter(|told| told.serves(motion));
        told.unwrap_or(&self.untold)
    }

    fn best(&self) -> &Knowledge {
        self.told.as_deref().unwrap_or(&self.untold)
    }

    fn knowledge(&self) -> impl Iterator<Item = &Knowledge> {
        self.told
            .as_deref()
            .into_iter()
            .chain(std::iter::once(&*self.untold))
    }

    /// Horizons whose solver stopped before the optimum.
    pub fn unfinished_s(&self) -> impl Iterator<Item = f64> {
        let unfinished = |horizon: &&Horizon| {
            horizon
                .status
                .is_some_and(|status| status != Status::Optimal)
        };
        self.knowledge()
            .flat_map(|knowledge| &knowledge.horizons)
            .filter(unfinished)
            .map(|horizon| horizon.horizon_s)
    }

    /// How far back it looks: what was before does not matter.
    #[must_use]
    pub fn past_s(&self) -> f64 {
        let predictors = self.knowledge().flat_map(|of| &of.predictors);
        let past_s = predictors.map(|predictor| predictor.past_s());
        past_s.fold(LEAST_PAST_S, f64::max)
    }

    /// Whether it predicts nothing without speed limits, for drives that have all [`channels`](Self::channels) or not.
    #[must_use]
    pub fn needs_limits(&self) -> bool {
        self.knowledge().any(Knowledge::needs_limits)
    }

    /// Every moment with enough past, `step_s` apart.
    #[must_use]
    pub fn moments(&self, motion: &Motion, step_s: f64) -> Vec<usize> {
        origins(motion, 0.0, step_s)
    }

    /// Seconds ahead.
    pub fn horizons_s(&self) -> impl ExactSizeIterator<Item = f64> {
        self.untold.horizons.iter().map(|horizon| horizon.horizon_s)
    }

    /// Half width per horizon of the interval that has the same width at every moment, where there is one: of a drive, or of drives that
    /// have all channels. Intervals of moments are in [`SpeedAhead`].
    pub fn one_width_mps(&self, motion: Option<&Motion>) -> impl Iterator<Item = Option<f64>> {
        let best = motion.map_or_else(|| self.best(), |motion| self.of_drive(motion));
        let width = |k: usize| best.intervals.as_ref().map(|of| of.one_width_mps[k]);
        (0..best.horizons.len()).map(width)
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
        let knowledge = self.of_drive(motion);
        if knowledge.needs_limits() && motion.limit_mps().is_none() {
            return Err(Error::NoLimits {
                log: motion.name().to_owned(),
            });
        }
        knowledge.predict(self.kind, motion, origins)
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
            let bounds = ahead.iter().filter_map(|ahead| ahead.interval_mps[k]);
            let (low_mps, high_mps): (Vec<f64>, Vec<f64>) = bounds.unzip();
            let inside = low_mps.iter().zip(&high_mps).zip(&measured_mps);
            let inside = inside.filter_map(|((low, high), v)| v.map(|v| *low <= v && v <= *high));
            HorizonScore {
                horizon_s: horizon.horizon_s,
                interval_mps: mean(low_mps.iter().zip(&high_mps).map(|(a, b)| 0.5 * (b - a))),
                rmse_mps: mean(errors.map(|e| e * e)).map(f64::sqrt),
                inside_pct: mean(inside.map(|inside| if inside { 100.0 } else { 0.0 })),
                speed_mps,
                low_mps,
                high_mps,
                measured_mps,
            }
        };
        Ok(self.untold.horizons.iter().enumerate().map(score).collect())
    }

    fn check(&self) -> Result<(), &'static str> {
        if self.kind.subject() != Subject::SpeedAhead {
            return Err("it is none of the speed ahead");
        }
        if !(self.step_s.is_finite() && self.step_s > 0.0) {
            return Err("a time is not positive");
        }
        if !self.untold.channels.is_empty() {
            return Err("what is to do without channels asks for some");
        }
        let horizons = |knowledge: &Knowledge| -> Vec<f64> {
            let horizons = knowledge.horizons.iter();
            horizons.map(|horizon| horizon.horizon_s).collect()
        };
        if self
            .knowledge()
            .any(|knowledge| horizons(knowledge) != horizons(&self.untold))
        {
            return Err("it looks ahead differently with and without channels");
        }
        self.knowledge()
            .try_for_each(|knowledge| knowledge.check(self.kind))
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

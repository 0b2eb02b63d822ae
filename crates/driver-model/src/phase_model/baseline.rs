use serde::{Deserialize, Serialize};

use crate::{Error, PhaseCurve, TrainingSet};

/// The driver's mean acceleration or deceleration, whatever the speed. Knows `v0` and `T`, like the function fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// Mean over phases of `|v_end − v0|/T`, in m/s².
    pub accel_mps2: f64,
}

impl Constant {
    /// Averages over phases.
    ///
    /// # Errors
    /// [`Error::TooFewPhases`] without a phase.
    pub fn fit(training: &TrainingSet<'_>) -> Result<Self, Error> {
        super::need_phases("constant", &training.phases)?;
        let accel = |curve: &PhaseCurve| {
            let outline = curve.outline();
            outline.gain_mps().abs() / outline.duration_s()
        };
        Ok(Self {
            accel_mps2: training.mean(accel).unwrap_or(f64::NAN),
        })
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        super::parameter("constant", "accel_mps2", self.accel_mps2, true, "finite")
    }
}

/// A straight line from start to end speed, at the share `t/T` of the phase.
#[must_use]
pub fn straight(start_speed_mps: f64, end_speed_mps: f64, share: f64) -> f64 {
    start_speed_mps + (end_speed_mps - start_speed_mps) * share
}

/// `3s² − 2s³` from start to end speed, at the share `s = t/T` of the phase.
#[must_use]
pub fn smoothstep(start_speed_mps: f64, end_speed_mps: f64, share: f64) -> f64 {
    straight(
        start_speed_mps,
        end_speed_mps,
        share * share * (3.0 - 2.0 * share),
    )
}

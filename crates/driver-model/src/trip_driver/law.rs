use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::within;
use crate::Error;

/// Ranges that a fit is kept in.
pub(super) const ACCEL_MPS2: RangeInclusive<f64> = 0.1..=20.0;
pub(super) const BRAKING_SCALE_MPS2: RangeInclusive<f64> = 0.05..=20.0;
pub(super) const BRAKING_MPS2: RangeInclusive<f64> = 0.2..=20.0;

/// `a(v) = min(a_max, A √(1 − v/w))` below the wanted speed `w`, which is reached in finite time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AccelerationLaw {
    /// `A`.
    pub scale_mps2: f64,
    /// `a_max`.
    pub max_mps2: f64,
    /// Rises of the speed that `A` is the median of; without one it is 1.5 m/s².
    pub rises: usize,
}

/// Braking by `Δ` takes the constant deceleration `d = min(c max(Δ, 1)^γ, b_max)`, with `Δ` in m/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrakingLaw {
    /// `c`.
    pub scale_mps2: f64,
    /// `γ`, 0 to 1.
    pub exponent: f64,
    /// `b_max`.
    pub max_mps2: f64,
    /// Falls of the speed that it was fitted to; without one `c` is 0.4 m/s² and `γ` 0.5.
    pub falls: usize,
}

impl AccelerationLaw {
    /// Acceleration at a speed below the wanted one; 0 from there on.
    #[must_use]
    pub fn mps2(&self, speed_mps: f64, wanted_mps: f64) -> f64 {
        let missing = 1.0 - speed_mps / wanted_mps;
        if missing > 0.0 {
            self.max_mps2.min(self.scale_mps2 * missing.sqrt())
        } else {
            0.0
        }
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        within("acceleration.scale_mps2", self.scale_mps2, &ACCEL_MPS2)?;
        within("acceleration.max_mps2", self.max_mps2, &ACCEL_MPS2)
    }
}

impl BrakingLaw {
    /// Deceleration of braking by a difference of speed.
    #[must_use]
    pub fn mps2(&self, difference_mps: f64) -> f64 {
        let wanted_mps2 = self.scale_mps2 * difference_mps.max(1.0).powf(self.exponent);
        wanted_mps2.min(self.max_mps2)
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        within("braking.scale_mps2", self.scale_mps2, &BRAKING_SCALE_MPS2)?;
        within("braking.exponent", self.exponent, &(0.0..=1.0))?;
        within("braking.max_mps2", self.max_mps2, &BRAKING_MPS2)
    }
}

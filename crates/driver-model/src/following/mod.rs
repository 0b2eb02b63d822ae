//! Car following: how a driver keeps the distance to the vehicle ahead, calibrated to recorded drives.
//!
//! ```text
//! idm                 v̇ = a_max [1 − (v/v_d)⁴ − (s*/s)²],  s* = s0 + max(0, v T + v Δv/(2 √(a_max b)))
//! constant-time-gap   v̇ = (v_lead − v + λ (s − s0 − τ v))/τ        baseline
//! ```
//!
//! with speed `v`, gap `s` (bumper to bumper) and closing speed `Δv = v − v_lead`. [`following_stretches`] cuts the
//! stretches behind one leader out of a log, [`FollowingModel::fit`] simulates them as a whole and compares.
//!
//! # References
//!
//! - M. Treiber, A. Hennecke, D. Helbing: Congested traffic states in empirical observations and microscopic
//!   simulations, Physical Review E 62 (2000), 1805–1824.
//! - D. Swaroop, K. R. Rajagopal: A review of constant time headway policy for automatic vehicle following, IEEE
//!   Intelligent Transportation Systems Conference (2001), 65–69; R. Rajamani: Vehicle Dynamics and Control, Springer
//!   2012, chapter 6 (the baseline).
//! - A. Kesting, M. Treiber: Calibrating car-following models by using trajectory data, Transportation Research Record
//!   2088 (2008), 148–156 (simulating whole stretches, errors of the gap).
//! - V. Punzo, M. Montanino: Speed or spacing? Cumulative variables, and convolution of model errors and time in traffic
//!   flow models validation and calibration, Transportation Research Part B 91 (2016), 21–33.
//! - M. Treiber, V. Kanagaraj: Comparing numerical integration schemes for time-continuous car-following models, Physica
//!   A 419 (2015), 183–195 (the ballistic update).

mod constant_time_gap;
mod drivers;
mod fit;
mod idm;
mod objective;
mod polish;
mod simulation;
mod stretch;

pub use constant_time_gap::ConstantTimeGap;
pub use drivers::FollowingPopulation;
pub use fit::FollowingFit;
pub use idm::Idm;
pub use objective::FollowingObjective;
pub use simulation::{FollowingErrors, SimulatedFollowing};
pub use stretch::{FollowingSettings, FollowingStretch, following_stretches};

use ev_energy::calibration::Bounds;
use serde::{Deserialize, Serialize};

use crate::{Error, ModelKind, Subject};

/// No model brakes harder.
const FULL_BRAKING_MPS2: f64 = 8.0;

/// Gaps below this count as this.
const SMALLEST_GAP_M: f64 = 0.1;

/// A parameter of a model of car following, and between which bounds it is sought.
struct Parameter {
    name: &'static str,
    lower: f64,
    upper: f64,
}

impl Parameter {
    /// Where it is sought: by its logarithm.
    fn place(&self, value: f64) -> f64 {
        if self.lower > 0.0 { value.ln() } else { value }
    }

    fn value(&self, place: f64) -> f64 {
        let value = if self.lower > 0.0 { place.exp() } else { place };
        value.clamp(self.lower, self.upper)
    }

    fn bounds(&self) -> Bounds {
        Bounds {
            lower: self.place(self.lower),
            upper: self.place(self.upper),
        }
    }
}

const fn parameter(name: &'static str, lower: f64, upper: f64) -> Parameter {
    Parameter { name, lower, upper }
}

/// What a fit needs of a model.
struct Family {
    parameters: &'static [Parameter],
    /// Where the fit starts: an ordinary driver, a close one and a distant one.
    starts: [&'static [f64]; 3],
    /// The model of values in the order of the parameters; NaN where there are too few.
    model: fn(&[f64]) -> FollowingModel,
}

const IDM: Family = Family {
    parameters: &[
        parameter("max_accel_mps2", 0.3, 5.0),
        parameter("comfortable_decel_mps2", 0.3, 5.0),
        parameter("time_headway_s", 0.1, 5.0),
        parameter("standstill_gap_m", 0.5, 8.0),
        parameter("desired_speed_mps", 5.0, 70.0),
    ],
    starts: [
        &[1.3, 1.7, 1.4, 2.0, 35.0],
        &[2.5, 2.5, 0.7, 3.0, 25.0],
        &[0.8, 1.0, 2.2, 5.0, 45.0],
    ],
    model: |values| FollowingModel::Idm {
        idm: Idm {
            max_accel_mps2: value(values, 0),
            comfortable_decel_mps2: value(values, 1),
            time_headway_s: value(values, 2),
            standstill_gap_m: value(values, 3),
        },
        desired_speed_mps: value(values, 4),
    },
};

const CONSTANT_TIME_GAP: Family = Family {
    parameters: &[
        parameter("time_gap_s", 0.1, 5.0),
        parameter("standstill_gap_m", -20.0, 20.0),
        parameter("gap_gain_per_s", 0.0001, 5.0),
    ],
    starts: [&[1.4, 2.0, 0.2], &[0.7, 3.0, 0.5], &[2.2, 5.0, 0.1]],
    model: |values| {
        FollowingModel::ConstantTimeGap(ConstantTimeGap {
            time_gap_s: value(values, 0),
            standstill_gap_m: value(values, 1),
            gap_gain_per_s: value(values, 2),
        })
    },
};

fn value(values: &[f64], k: usize) -> f64 {
    values.get(k).copied().unwrap_or(f64::NAN)
}

impl Family {
    fn of(kind: ModelKind) -> Result<&'static Self, Error> {
        match kind {
            ModelKind::Idm => Ok(&IDM),
            ModelKind::ConstantTimeGap => Ok(&CONSTANT_TIME_GAP),
            _ => Err(Error::not_of(Subject::Following, kind)),
        }
    }

    /// Free parameters of values: without bounds, for methods that know none.
    fn free(&self, values: &[f64]) -> Vec<f64> {
        let named = self.parameters.iter().zip(values);
        named
            .map(|(p, value)| p.bounds().free(p.place(*value)))
            .collect()
    }

    /// Places of free parameters.
    fn places(&self, free: &[f64]) -> Vec<f64> {
        let named = self.parameters.iter().zip(free);
        named.map(|(p, free)| p.bounds().value(*free)).collect()
    }

    /// Values of free parameters.
    fn values(&self, free: &[f64]) -> Vec<f64> {
        let named = self.parameters.iter().zip(free);
        named
            .map(|(p, free)| p.value(p.bounds().value(*free)))
            .collect()
    }
}

/// A model of car following with its parameters; [`FollowingModel::check`] those that come from a file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FollowingModel {
    /// Intelligent driver model.
    Idm {
        /// Its parameters.
        idm: Idm,
        /// Speed on a free road. Stretches behind a leader tell little about it.
        desired_speed_mps: f64,
    },
    /// Constant-time-gap law.
    ConstantTimeGap(ConstantTimeGap),
}

impl FollowingModel {
    /// Which model this is.
    #[must_use]
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Idm { .. } => ModelKind::Idm,
            Self::ConstantTimeGap(_) => ModelKind::ConstantTimeGap,
        }
    }

    /// Acceleration in m/s² at a speed, a gap to the vehicle ahead, and its speed; at least −8 m/s².
    #[must_use]
    pub fn accel_mps2(&self, speed_mps: f64, gap_m: f64, lead_speed_mps: f64) -> f64 {
        match self {
            Self::Idm {
                idm,
                desired_speed_mps,
            } => idm.accel_mps2(speed_mps, *desired_speed_mps, gap_m, lead_speed_mps),
            Self::ConstantTimeGap(law) => law.accel_mps2(speed_mps, gap_m, lead_speed_mps),
        }
    }

    /// Checks parameters that come from outside.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that no fit can produce.
    pub fn check(&self) -> Result<(), Error> {
        let parameters = self.family().parameters;
        for (parameter, value) in parameters.iter().zip(self.values()) {
            if !(parameter.lower..=parameter.upper).contains(&value) {
                return Err(Error::Parameter {
                    model: self.kind().name(),
                    name: parameter.name,
                    value,
                    expected: format!("{} to {}", parameter.lower, parameter.upper),
                });
            }
        }
        Ok(())
    }

    /// The gap in m at which the driver neither accelerates nor brakes behind a leader at constant speed; `None` where the
    /// leader is faster than the driver wants to drive.
    #[must_use]
    pub fn equilibrium_gap_m(&self, speed_mps: f64) -> Option<f64> {
        match self {
            Self::Idm {
                idm,
                desired_speed_mps,
            } => {
                let wanted_m = idm.standstill_gap_m + speed_mps * idm.time_headway_s;
                let left = 1.0 - (speed_mps / desired_speed_mps).powi(4);
                (left > 0.0).then(|| wanted_m / left.sqrt())
            }
            Self::ConstantTimeGap(law) => Some(law.wanted_gap_m(speed_mps)),
        }
    }

    fn family(&self) -> &'static Family {
        match self {
            Self::Idm { .. } => &IDM,
            Self::ConstantTimeGap(_) => &CONSTANT_TIME_GAP,
        }
    }

    fn values(&self) -> Vec<f64> {
        match self {
            Self::Idm {
                idm,
                desired_speed_mps,
            } => vec![
                idm.max_accel_mps2,
                idm.comfortable_decel_mps2,
                idm.time_headway_s,
                idm.standstill_gap_m,
                *desired_speed_mps,
            ],
            Self::ConstantTimeGap(law) => {
                vec![law.time_gap_s, law.standstill_gap_m, law.gap_gain_per_s]
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn starts_lie_inside_the_bounds_and_come_back() {
        for kind in ModelKind::of(Subject::Following) {
            let family = Family::of(kind).unwrap();
            for start in family.starts {
                let model = (family.model)(start);
                assert!(model.check().is_ok());
                assert_eq!((model.kind(), model.values()), (kind, start.to_vec()));
                let text = serde_json::to_string(&model).unwrap();
                assert_eq!(
                    serde_json::from_str::<FollowingModel>(&text).unwrap(),
                    model
                );
            }
        }
    }

    #[test]
    fn files_with_impossible_or_unknown_keys_are_refused() {
        let json = r#"{"kind":"constant-time-gap","time_gap_s":1.0,"standstill_gap_m":2.0,"gap_gain_per_s":-1.0}"#;
        let model: FollowingModel = serde_json::from_str(json).unwrap();
        assert!(matches!(model.check(), Err(Error::Parameter { .. })));
        let misspelt = json.replace("standstill_gap_m", "standstill");
        assert!(serde_json::from_str::<FollowingModel>(&misspelt).is_err());
        let more = json.replace("{", r#"{"more":1,"#);
        assert!(serde_json::from_str::<FollowingModel>(&more).is_err());
    }
}

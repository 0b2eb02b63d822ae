//! One file per model of a single acceleration phase, with the baselines.
//!
//! Every model answers the same question: given what it may know of a phase, which speed is driven at
//! `t = 0, Δt, 2Δt, …`? [`crate::Phase`] holds what may be known, and each type here takes only its share of it.

mod baseline;
mod conditioned;
mod exponential;
mod inverse;
mod kernel_ridge;
mod pedal;
mod profile;
mod rise_time;
mod step_response;
mod transition_point;

pub use baseline::{Constant, smoothstep, straight};
pub use conditioned::{BandLevel, ConditionedProfile, Conditioning, PredictiveBand};
pub use exponential::Exponential;
pub use inverse::Inverse;
pub use kernel_ridge::GaussianBasis;
pub use pedal::PedalProfile;
pub use profile::Profile;
pub use rise_time::{GroupConstant, RiseTime};
pub use step_response::{StepCharacteristics, StepResponse};
pub use transition_point::{GroupResponse, TransitionPoint, identify};

pub use crate::speed_group::SpeedGroup;
use crate::{AccelPoint, Error};

fn need_points(model: &'static str, points: &[AccelPoint], needed: usize) -> Result<(), Error> {
    if points.len() < needed {
        return Err(Error::TooFewPhases {
            model,
            found: points.len(),
            needed,
            unit: "segments of its kind without a leader",
        });
    }
    Ok(())
}

fn need_phases<T>(model: &'static str, phases: &[T]) -> Result<(), Error> {
    if phases.is_empty() {
        return Err(Error::TooFewPhases {
            model,
            found: 0,
            needed: 1,
            unit: "phases of its kind without a leader",
        });
    }
    Ok(())
}

fn parameter(
    model: &'static str,
    name: &'static str,
    value: f64,
    usable: bool,
    expected: &'static str,
) -> Result<(), Error> {
    if usable && value.is_finite() {
        return Ok(());
    }
    Err(Error::Parameter {
        model,
        name,
        value,
        expected: expected.to_owned(),
    })
}

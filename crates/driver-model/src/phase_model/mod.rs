//! One file per model of a single acceleration phase, with the baselines.
//!
//! Every model answers the same question: given what it may know of a phase, which speed is driven at
//! `t = 0, Δt, 2Δt, …`? [`crate::PhaseOutline`] holds what may be known, and each type here takes only its share of it.

mod baseline;
mod exponential;
mod inverse;
mod profile;
mod rise_time;

pub use baseline::{Constant, smoothstep, straight};
pub use exponential::Exponential;
pub use inverse::Inverse;
pub use profile::Profile;
pub use rise_time::{GroupConstant, RiseTime, SpeedGroup};

use crate::Error;

fn need_segments(
    model: &'static str,
    segment_means: &[(f64, f64)],
    needed: usize,
) -> Result<(), Error> {
    if segment_means.len() < needed {
        return Err(Error::TooFewPhases {
            model,
            found: segment_means.len(),
            needed,
            unit: "acceleration segments without a leader",
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
            unit: "acceleration phases without a leader",
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

use driver_model::{DriverInput, Phase};
use serde::Serialize;

/// Which part of the driver decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Regime {
    /// Waiting at a stop line.
    Standstill,
    /// Speeding up on a free road.
    Acceleration,
    /// Holding limit plus bias on a free road.
    Cruise,
    /// Slowing down for a lower limit, a turn or a stop line.
    Braking,
    /// A vehicle ahead allows no more.
    Following,
}

/// A stretch of a simulated drive in one regime.
///
/// Neighbours share a sample: the last of one phase is the first of the next, so that every step between two samples
/// belongs to one phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TruePhase {
    /// The regime.
    pub regime: Regime,
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// Speed at the first sample.
    pub start_speed_mps: f64,
    /// Speed aimed at.
    pub target_speed_mps: f64,
    /// Whether an acceleration or braking phase ran to its end; where not, the next phase says what cut it short, such
    /// as following a vehicle that cut in. `true` in other regimes.
    pub complete: bool,
}

impl TruePhase {
    pub(crate) fn open(
        regime: Regime,
        start: usize,
        start_speed_mps: f64,
        target_speed_mps: f64,
    ) -> Self {
        Self {
            regime,
            start,
            end: start + 1,
            start_speed_mps,
            target_speed_mps,
            complete: false,
        }
    }

    /// What the true model knows of an acceleration phase. The end speed is the one aimed at: the rise-time model stops
    /// at 95.96 % of it, the others at the last sample that does not exceed it.
    #[must_use]
    pub fn outline(&self, step_s: f64) -> Phase {
        Phase {
            start_speed_mps: self.start_speed_mps,
            end_speed_mps: self.target_speed_mps,
            step_s,
            samples: self.end - self.start,
            onset: None,
            input: DriverInput::default(),
        }
    }
}

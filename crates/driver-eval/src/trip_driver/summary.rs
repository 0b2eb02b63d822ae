use driver_model::statistics::mean;
use serde::Serialize;

use super::{FreeRunScore, FreeRunTrip};
use crate::Error;

/// Errors over trips.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PercentErrors {
    /// Mean: the bias.
    pub mean_pct: f64,
    /// Mean of the magnitudes.
    pub mean_abs_pct: f64,
    /// Largest magnitude.
    pub max_abs_pct: f64,
}

/// Figures over trips, every trip with the same weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FreeRunSummary {
    /// Trips.
    pub trips: usize,
    /// Distance at equal time.
    pub distance: PercentErrors,
    /// Energy at equal time; `None` where no trip has one.
    pub energy: Option<PercentErrors>,
    /// Time at equal distance.
    pub time_at_distance: PercentErrors,
    /// Energy at equal distance; `None` where no trip has one.
    pub energy_at_distance: Option<PercentErrors>,
}

impl FreeRunSummary {
    pub(super) fn of(trips: &[FreeRunTrip]) -> Result<Self, Error> {
        let errors = |of: fn(&FreeRunScore) -> Option<f64>| {
            let errors_pct: Vec<f64> = trips.iter().filter_map(|t| of(&t.score)).collect();
            PercentErrors::of(&errors_pct)
        };
        let distance = errors(|s| Some(s.distance_error_pct));
        let time_at_distance = errors(|s| Some(s.time_at_distance_error_pct));
        let (Some(distance), Some(time_at_distance)) = (distance, time_at_distance) else {
            let error = driver_model::Error::TooFewPhases {
                model: "free run",
                found: 0,
                needed: 1,
                unit: "trips that are long enough",
            };
            return Err(error.into());
        };
        Ok(Self {
            trips: trips.len(),
            distance,
            energy: errors(|s| s.energy_error_pct),
            time_at_distance,
            energy_at_distance: errors(|s| s.energy_at_distance_error_pct),
        })
    }
}

impl PercentErrors {
    fn of(errors_pct: &[f64]) -> Option<Self> {
        let magnitudes = || errors_pct.iter().map(|error| error.abs());
        Some(Self {
            mean_pct: mean(errors_pct.iter().copied())?,
            mean_abs_pct: mean(magnitudes())?,
            max_abs_pct: magnitudes().fold(0.0, f64::max),
        })
    }
}

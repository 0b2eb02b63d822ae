//! Three phases as a model predicts them: town, country road and motorway.

use driver_model::phase_model::PredictiveBand;
use driver_model::{DriverModel, Phase, PhaseModel};
use serde::Serialize;

/// A phase that a model predicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Example {
    /// What the model is told.
    #[serde(flatten)]
    pub outline: Phase,
    /// Predicted speed.
    pub speed_mps: Vec<f64>,
    /// Half-width of the 90 % band, where the model has one.
    pub half_width_mps: Option<Vec<f64>>,
}

impl Example {
    /// Of a model of phases; none of another.
    #[must_use]
    pub fn of(model: &DriverModel) -> Vec<Self> {
        let (DriverModel::Acceleration(phases) | DriverModel::Braking(phases)) = model else {
            return Vec::new();
        };
        let examples = [(0.0, 50.0, 8.0), (30.0, 70.0, 9.0), (60.0, 110.0, 14.0)];
        let outline = |(low_kmh, high_kmh, duration_s): (f64, f64, f64)| {
            let (from, to) = match model {
                DriverModel::Braking(_) => (high_kmh, low_kmh),
                _ => (low_kmh, high_kmh),
            };
            Phase::from_to(from / 3.6, to / 3.6).lasting(duration_s)
        };
        let outlines = examples.into_iter().map(outline);
        outlines.map(|outline| Self::new(phases, outline)).collect()
    }

    fn new(model: &PhaseModel, outline: Phase) -> Self {
        let bands = model.bands(&outline);
        Self {
            speed_mps: model.predict(&outline),
            half_width_mps: PredictiveBand::of_90_pct(&bands).map(|b| b.half_width_mps.clone()),
            outline,
        }
    }
}

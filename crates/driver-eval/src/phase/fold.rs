//! What is found when one unit is held out.

use driver_model::{PhaseCurve, PhaseModel};

use super::prediction::PhasePrediction;

/// A held-out phase with every model's prediction of it.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedPhase {
    /// Index of the trip.
    pub trip: usize,
    /// Index of the unit that was held out.
    pub unit: usize,
    /// The measured phase.
    pub curve: PhaseCurve,
    /// Battery energy of the measured speed, inside the cells.
    pub energy_j: f64,
    /// One per model, in the order of [`Evaluation::models`](super::Evaluation::models).
    pub predictions: Vec<PhasePrediction>,
    /// Battery energy of the predicted speeds, in the same order.
    pub predicted_energy_j: Vec<f64>,
}

/// One unit held out, one model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    /// Index of the unit that was held out.
    pub unit: usize,
    /// The model as fitted on all others.
    pub model: PhaseModel,
    /// Held-out phases.
    pub phases: usize,
    /// Mean over them; `None` without a phase.
    pub rmse_mps: Option<f64>,
    /// Mean over them; `None` without a phase.
    pub in_band_pct: Option<f64>,
    /// Phases predicted with a parameter of another speed group.
    pub fallbacks: usize,
    /// Seconds of fitting.
    pub fit_seconds: f64,
    /// Seconds of predicting and comparing, energy not included.
    pub predict_seconds: f64,
}

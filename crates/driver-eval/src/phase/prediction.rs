use driver_model::phase_model::PredictiveBand;
use driver_model::{PhaseCurve, PhaseModel};
use serde::Serialize;

/// One model's prediction of one phase, and how far it is off the measured speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhasePrediction {
    /// Predicted speed at the samples of the phase.
    pub speed_mps: Vec<f64>,
    /// Root mean square error.
    pub rmse_mps: f64,
    /// `√SSE/n`.
    pub sqrt_sse_per_sample_mps: f64,
    /// Share of samples within half the band of the measured speed.
    pub in_band_pct: f64,
    /// Predicted minus measured speed at the last sample.
    pub final_speed_error_mps: f64,
    /// The model had no training phase of this speed group and used another's parameter, or did without what the log does not say.
    pub fallback: bool,
    /// Bands around the predicted speed by rising level, where the model has them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<PredictiveBand>,
}

impl PhasePrediction {
    /// Predicts from what the model may know of the phase, and judges against the measured speed with a band of the full
    /// width `band_mps`.
    #[must_use]
    pub fn new(model: &PhaseModel, curve: &PhaseCurve, band_mps: f64) -> Self {
        let outline = curve.outline();
        let speed_mps = model.predict(&outline);
        let errors = || speed_mps.iter().zip(curve.speed_mps()).map(|(p, m)| p - m);
        let n = curve.speed_mps().len() as f64;
        let sse: f64 = errors().map(|e| e * e).sum();
        let inside = errors().filter(|e| e.abs() <= 0.5 * band_mps).count();
        Self {
            rmse_mps: (sse / n).sqrt(),
            sqrt_sse_per_sample_mps: sse.sqrt() / n,
            in_band_pct: 100.0 * inside as f64 / n,
            final_speed_error_mps: errors().next_back().unwrap_or(0.0),
            fallback: model.falls_back(&outline),
            bands: model.bands(&outline),
            speed_mps,
        }
    }
}

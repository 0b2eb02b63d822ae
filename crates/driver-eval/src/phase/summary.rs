use std::collections::BTreeMap;

use driver_model::statistics::{mean, median};
use driver_model::{ModelKind, SpeedGroup};
use serde::Serialize;

use super::fold::{EvaluatedPhase, Fold};
use super::prediction::PhasePrediction;

/// Mean, median and mean absolute value of energy differences; positive where the prediction uses less.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergyError {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Mean of the magnitudes.
    pub mean_abs: f64,
}

/// How well phases are predicted. Means over phases, every phase with the same weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PhaseFigures {
    /// Held-out phases.
    pub phases: usize,
    /// Mean root mean square error, the main figure.
    pub rmse_mps: f64,
    /// Median of the same.
    pub rmse_median_mps: f64,
    /// Mean `√SSE/n`.
    pub sqrt_sse_per_sample_mps: f64,
    /// Mean share of samples inside the band.
    pub in_band_pct: f64,
    /// Its complement.
    pub out_of_band_pct: f64,
    /// Measured minus predicted battery energy.
    pub energy_error_j: EnergyError,
    /// Mean of predicted minus measured final speed.
    pub final_speed_error_mps: f64,
}

/// Figures of one model over all held-out phases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// What the model is told of a phase, in words.
    pub knows: &'static str,
    /// Over all phases.
    #[serde(flatten)]
    pub figures: PhaseFigures,
    /// Full width of the band.
    pub band_kmh: f64,
    /// Seconds of fitting, over all folds.
    pub fit_seconds: f64,
    /// Seconds of predicting, over all folds.
    pub predict_seconds: f64,
    /// Phases predicted with a parameter of another speed group.
    pub fallback_phases: usize,
    /// The same figures by speed group.
    pub groups: BTreeMap<String, PhaseFigures>,
}

pub(super) fn summarise(
    index: usize,
    kind: ModelKind,
    folds: &[Fold],
    phases: &[EvaluatedPhase],
    band_mps: f64,
) -> Summary {
    let all: Vec<&EvaluatedPhase> = phases.iter().collect();
    let seconds = |of: fn(&Fold) -> f64| {
        folds
            .iter()
            .filter(|f| f.model.kind() == kind)
            .map(of)
            .sum()
    };
    Summary {
        knows: kind.knows(),
        figures: PhaseFigures::of(index, &all),
        band_kmh: band_mps * 3.6,
        fit_seconds: seconds(|f| f.fit_seconds),
        predict_seconds: seconds(|f| f.predict_seconds),
        fallback_phases: phases
            .iter()
            .filter(|p| p.predictions[index].fallback)
            .count(),
        groups: by_group(index, phases),
    }
}

fn by_group(index: usize, phases: &[EvaluatedPhase]) -> BTreeMap<String, PhaseFigures> {
    let mut members = BTreeMap::<SpeedGroup, Vec<&EvaluatedPhase>>::new();
    for phase in phases {
        members
            .entry(phase.curve.outline().group())
            .or_default()
            .push(phase);
    }
    members
        .into_iter()
        .map(|(group, own)| (group.name(), PhaseFigures::of(index, &own)))
        .collect()
}

impl PhaseFigures {
    /// Of the model with this index; NaN without a phase.
    fn of(index: usize, phases: &[&EvaluatedPhase]) -> Self {
        let own = || phases.iter().map(|p| &p.predictions[index]);
        let average =
            |figure: fn(&PhasePrediction) -> f64| mean(own().map(figure)).unwrap_or(f64::NAN);
        let energy: Vec<f64> = phases
            .iter()
            .map(|p| p.energy_j - p.predicted_energy_j[index])
            .collect();
        let in_band_pct = average(|p| p.in_band_pct);
        Self {
            phases: phases.len(),
            rmse_mps: average(|p| p.rmse_mps),
            rmse_median_mps: median(own().map(|p| p.rmse_mps).collect()).unwrap_or(f64::NAN),
            sqrt_sse_per_sample_mps: average(|p| p.sqrt_sse_per_sample_mps),
            in_band_pct,
            out_of_band_pct: 100.0 - in_band_pct,
            energy_error_j: EnergyError {
                mean: mean(energy.iter().copied()).unwrap_or(f64::NAN),
                mean_abs: mean(energy.iter().map(|e| e.abs())).unwrap_or(f64::NAN),
                median: median(energy).unwrap_or(f64::NAN),
            },
            final_speed_error_mps: average(|p| p.final_speed_error_mps),
        }
    }
}

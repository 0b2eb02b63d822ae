//! Predictions of phases that the model has not seen, and how good they are.

mod bands;
mod data;
mod fold;
mod learning_curve;
mod paired;
mod prediction;
mod summary;

use std::time::Instant;

use driver_model::energy::driving_energy_j;
use driver_model::error::at_least;
use driver_model::statistics::mean;
use driver_model::{
    Error as ModelError, ModelKind, PhaseCurve, PhaseKind, PhaseModel, Subject, TrainingSet,
};
use ev_energy::Vehicle;

use crate::Error;
use crate::hold_out::Split;
pub use bands::BandCoverage;
pub use data::EvaluationData;
pub use fold::{EvaluatedPhase, Fold};
pub use learning_curve::{LearningPoint, TrainingSource, learning_curve};
pub use paired::{PairedComparison, Verdict};
pub use prediction::PhasePrediction;
use summary::summarise;
pub use summary::{EnergyError, PhaseFigures, Summary};

/// Weight of a phase of other drivers beside 1 for an own one: own phases count three times.
pub const DEFAULT_PRIOR_WEIGHT: f64 = 0.33;

/// What is evaluated, and how it is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// Models to evaluate; the baselines are always added.
    pub models: Vec<ModelKind>,
    /// Full width of the band around the measured speed; 3 km/h.
    pub band_mps: f64,
    /// Weight of a phase of other drivers beside 1 for an own one; [`DEFAULT_PRIOR_WEIGHT`].
    pub prior_weight: f64,
}

impl Default for EvaluationSettings {
    fn default() -> Self {
        Self {
            models: ModelKind::of(Subject::Phases).collect(),
            band_mps: 3.0 / 3.6,
            prior_weight: DEFAULT_PRIOR_WEIGHT,
        }
    }
}

impl EvaluationSettings {
    fn check(&self) -> Result<(), Error> {
        at_least("band_mps", self.band_mps, 0.0, "at least 0 m/s")?;
        Ok(at_least(
            "prior_weight",
            self.prior_weight,
            0.0,
            "at least 0",
        )?)
    }
}

/// The outcome of [`leave_one_out`].
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Acceleration or braking.
    pub kind: PhaseKind,
    /// Names of the trips, in input order.
    pub trips: Vec<String>,
    /// Names of the units.
    pub units: Vec<String>,
    /// The models and baselines, in the order of all predictions.
    pub models: Vec<ModelKind>,
    /// Models that could not be fitted without every unit, and why.
    pub left_out: Vec<(ModelKind, String)>,
    /// Figures per model, in the order of [`Evaluation::models`].
    pub summaries: Vec<Summary>,
    /// Every pair of models.
    pub paired: Vec<PairedComparison>,
    /// What the predictive bands hold, for the models that have them.
    pub bands: Vec<(ModelKind, Vec<BandCoverage>)>,
    /// Units in order, models within.
    pub folds: Vec<Fold>,
    /// Phases in input order.
    pub phases: Vec<EvaluatedPhase>,
}

impl Evaluation {
    /// Of one model; `None` where it is not among those evaluated.
    #[must_use]
    pub fn summary(&self, model: ModelKind) -> Option<&Summary> {
        let summaries = self.models.iter().zip(&self.summaries);
        summaries
            .filter(|(kind, _)| **kind == model)
            .map(|(_, summary)| summary)
            .next()
    }
}

/// Holds each unit out once, fits every model on the others, and predicts the held-out phases of one kind.
///
/// Folds run in parallel on the current rayon pool; the result does not depend on the number of threads.
/// `on_fold` is called after each fold, from any thread. A model that cannot learn from what is left without some unit is left
/// out, and said.
///
/// # Errors
/// [`Error::TooFewUnits`] below two units, [`Error::Model`] when no trip has a phase, or for a drive that the vehicle cannot have
/// driven.
pub fn leave_one_out(
    kind: PhaseKind,
    data: &EvaluationData<'_>,
    vehicle: &Vehicle,
    settings: &EvaluationSettings,
    on_fold: &(dyn Fn() + Sync),
) -> Result<Evaluation, Error> {
    data.check(kind)?;
    settings.check()?;
    let asked: Vec<ModelKind> = ModelKind::of(Subject::Phases)
        .filter(|model| model.is_baseline() || settings.models.contains(model))
        .collect();
    let units = data.hold_out.run(on_fold, |split| {
        hold_out(split, kind, data, &asked, vehicle, settings)
    })?;
    let (models, left_out) = usable(&asked, &units);

    let mut folds = Vec::new();
    let mut phases = Vec::new();
    for unit in units {
        let start = phases.len();
        phases.extend(unit.phases);
        for (fold, predicted) in unit.models.into_iter().flatten() {
            if !models.contains(&fold.model.kind()) {
                continue;
            }
            for (phase, (prediction, energy_j)) in phases[start..].iter_mut().zip(predicted) {
                phase.predictions.push(prediction);
                phase.predicted_energy_j.push(energy_j);
            }
            folds.push(fold);
        }
    }
    phases.sort_by_key(|phase: &EvaluatedPhase| phase.trip);
    let summary = |m: usize| summarise(m, models[m], &folds, &phases, settings.band_mps);
    Ok(Evaluation {
        kind,
        trips: data.trips.iter().map(|t| t.name.clone()).collect(),
        units: data.hold_out.units().to_vec(),
        summaries: (0..models.len()).map(summary).collect(),
        paired: paired::all_pairs(&models, &phases),
        bands: bands::coverage(&models, &phases),
        models,
        left_out,
        folds,
        phases,
    })
}

/// Every phase of a unit predicted by one model, with the energy of the prediction.
type Predicted = Vec<(PhasePrediction, f64)>;

/// What is learnt from holding out one unit.
struct HeldOut {
    phases: Vec<EvaluatedPhase>,
    /// In the order asked for; an error where a model could not be fitted.
    models: Vec<Result<(Fold, Predicted), ModelError>>,
}

fn hold_out(
    split: Split<'_>,
    kind: PhaseKind,
    data: &EvaluationData<'_>,
    models: &[ModelKind],
    vehicle: &Vehicle,
    settings: &EvaluationSettings,
) -> Result<HeldOut, Error> {
    let unit = split.fold();
    let others = split.rest().map(|trip| &data.trips[trip]);
    let training =
        TrainingSet::from_trips(kind, others).with_prior(kind, data.prior, settings.prior_weight);
    let own = split.held_out();
    let curves = own.flat_map(|trip| data.trips[trip].phases_of(kind).map(move |c| (trip, c)));
    let phases = curves
        .map(|(trip, curve)| {
            Ok(EvaluatedPhase {
                trip,
                unit,
                energy_j: energy_j(vehicle, curve, curve.speed_mps())
                    .map_err(|error| error.in_log(&data.trips[trip].name))?,
                curve: curve.clone(),
                predictions: Vec::with_capacity(models.len()),
                predicted_energy_j: Vec::with_capacity(models.len()),
            })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let models = models
        .iter()
        .map(
            |&model| match fold(unit, model, &training, &phases, vehicle, settings) {
                // The measured phases have an energy; what has none is a prediction that is no speed of a car.
                Err(Error::Model(
                    error @ (ModelError::TooFewPhases { .. }
                    | ModelError::Fit { .. }
                    | ModelError::Energy(_)),
                )) => Ok(Err(error)),
                outcome => outcome.map(Ok),
            },
        )
        .collect::<Result<_, Error>>()?;
    Ok(HeldOut { phases, models })
}

fn fold(
    unit: usize,
    kind: ModelKind,
    training: &TrainingSet<'_>,
    phases: &[EvaluatedPhase],
    vehicle: &Vehicle,
    settings: &EvaluationSettings,
) -> Result<(Fold, Predicted), Error> {
    let clock = Instant::now();
    let model = PhaseModel::fit(kind, training)?;
    let fit_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let predictions: Vec<_> = phases
        .iter()
        .map(|phase| PhasePrediction::new(&model, &phase.curve, settings.band_mps))
        .collect();
    let predict_seconds = clock.elapsed().as_secs_f64();
    let fold = Fold {
        unit,
        phases: phases.len(),
        rmse_mps: mean(predictions.iter().map(|p| p.rmse_mps)),
        in_band_pct: mean(predictions.iter().map(|p| p.in_band_pct)),
        fallbacks: predictions.iter().filter(|p| p.fallback).count(),
        fit_seconds,
        predict_seconds,
        model,
    };
    let with_energy = |(phase, prediction): (&EvaluatedPhase, PhasePrediction)| {
        let energy_j = energy_j(vehicle, &phase.curve, &prediction.speed_mps)?;
        Ok((prediction, energy_j))
    };
    let predicted = phases.iter().zip(predictions).map(with_energy);
    Ok((fold, predicted.collect::<Result<_, Error>>()?))
}

/// The models that could be fitted without every unit, and the others with the reason.
fn usable(asked: &[ModelKind], units: &[HeldOut]) -> (Vec<ModelKind>, Vec<(ModelKind, String)>) {
    let mut models = Vec::new();
    let mut left_out = Vec::new();
    for (m, &kind) in asked.iter().enumerate() {
        match units.iter().find_map(|unit| unit.models[m].as_ref().err()) {
            None => models.push(kind),
            Some(error) => left_out.push((kind, error.to_string())),
        }
    }
    (models, left_out)
}

/// Battery energy of driving `speed_mps` over the slope of the phase.
fn energy_j(vehicle: &Vehicle, curve: &PhaseCurve, speed_mps: &[f64]) -> Result<f64, ModelError> {
    let step_s = curve.outline().step_s;
    driving_energy_j(vehicle, step_s, speed_mps, curve.slope_rad())
}

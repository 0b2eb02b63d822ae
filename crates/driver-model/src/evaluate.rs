use std::collections::BTreeMap;
use std::time::Instant;

use ev_energy::Vehicle;
use rayon::prelude::*;
use serde::Serialize;

use crate::{
    DriverModel, Error, ModelKind, PhaseCurve, PhasePrediction, SpeedGroup, TrainingSet, Trip,
};

/// What is evaluated, and how it is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// Models to evaluate; the baselines are always added.
    pub models: Vec<ModelKind>,
    /// Full width of the band around the measured speed; 3 km/h.
    pub band_mps: f64,
}

impl Default for EvaluationSettings {
    fn default() -> Self {
        Self {
            models: ModelKind::ALL.to_vec(),
            band_mps: 3.0 / 3.6,
        }
    }
}

/// A held-out phase with every model's prediction of it.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedPhase {
    /// Index of the trip.
    pub trip: usize,
    /// The measured phase.
    pub curve: PhaseCurve,
    /// Battery energy of the measured speed, inside the cells.
    pub energy_j: f64,
    /// One per model, in the order of [`Evaluation::models`].
    pub predictions: Vec<PhasePrediction>,
    /// Battery energy of the predicted speeds, in the same order.
    pub predicted_energy_j: Vec<f64>,
}

/// One trip held out, one model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    /// Index of the trip that was held out.
    pub trip: usize,
    /// The model as fitted on all other trips.
    pub model: DriverModel,
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

/// Figures of one speed group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GroupSummary {
    /// Held-out phases in the group.
    pub phases: usize,
    /// Mean over them.
    pub rmse_mps: f64,
    /// Mean over them.
    pub in_band_pct: f64,
    /// Mean over them.
    pub sqrt_sse_per_sample_mps: f64,
    /// Mean of measured minus predicted battery energy.
    pub energy_error_mean_j: f64,
}

/// Figures of one model over all held-out phases. Means over phases, every phase with the same weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// What the model is told of a phase, in words.
    pub knows: &'static str,
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
    /// Full width of the band.
    pub band_kmh: f64,
    /// Measured minus predicted battery energy.
    pub energy_error_j: EnergyError,
    /// Mean of predicted minus measured final speed.
    pub final_speed_error_mps: f64,
    /// Seconds of fitting, over all folds.
    pub fit_seconds: f64,
    /// Seconds of predicting, over all folds.
    pub predict_seconds: f64,
    /// Phases predicted with a parameter of another speed group.
    pub fallback_phases: usize,
    /// The same figures by speed group.
    pub groups: BTreeMap<String, GroupSummary>,
}

/// The outcome of [`leave_one_trip_out`].
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Names of the trips, in input order.
    pub trips: Vec<String>,
    /// The models and baselines, in the order of all predictions.
    pub models: Vec<ModelKind>,
    /// Figures per model, in the same order.
    pub summaries: Vec<Summary>,
    /// Trips in input order, models within.
    pub folds: Vec<Fold>,
    /// Phases in input order.
    pub phases: Vec<EvaluatedPhase>,
}

/// Holds each trip out once, fits every model on the others, and predicts the held-out phases.
///
/// Folds run in parallel on the current rayon pool; the result does not depend on the number of threads.
/// `on_fold` is called after each fold, from any thread.
///
/// # Errors
/// [`Error::TooFewTrips`] below two trips, [`Error::TooFewPhases`] when no trip has a phase or a model has
/// nothing to learn from.
pub fn leave_one_trip_out(
    trips: &[Trip],
    vehicle: &Vehicle,
    settings: &EvaluationSettings,
    on_fold: &(dyn Fn() + Sync),
) -> Result<Evaluation, Error> {
    if trips.len() < 2 {
        return Err(Error::TooFewTrips { found: trips.len() });
    }
    Error::unless_at_least("band_mps", settings.band_mps, 0.0, "at least 0 m/s")?;
    if trips.iter().all(|t| t.phases.is_empty()) {
        return Err(Error::TooFewPhases {
            model: "any model",
            found: 0,
            needed: 1,
            unit: "acceleration phases without a leader",
        });
    }
    let models: Vec<ModelKind> = ModelKind::ALL
        .into_iter()
        .filter(|kind| kind.is_baseline() || settings.models.contains(kind))
        .collect();
    let folds = (0..trips.len())
        .into_par_iter()
        .map(|held_out| {
            let fold = run_fold(trips, held_out, &models, vehicle, settings);
            on_fold();
            fold
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (folds, phases): (Vec<_>, Vec<_>) = folds.into_iter().unzip();
    let folds: Vec<Fold> = folds.into_iter().flatten().collect();
    let phases: Vec<EvaluatedPhase> = phases.into_iter().flatten().collect();
    let summaries = (0..models.len())
        .map(|m| summarise(m, models[m], &folds, &phases, settings.band_mps))
        .collect();
    Ok(Evaluation {
        trips: trips.iter().map(|t| t.name.clone()).collect(),
        models,
        summaries,
        folds,
        phases,
    })
}

fn run_fold(
    trips: &[Trip],
    held_out: usize,
    models: &[ModelKind],
    vehicle: &Vehicle,
    settings: &EvaluationSettings,
) -> Result<(Vec<Fold>, Vec<EvaluatedPhase>), Error> {
    let training = TrainingSet::from_trips(
        trips
            .iter()
            .enumerate()
            .filter(|&(i, _)| i != held_out)
            .map(|(_, trip)| trip),
    );
    let curves = &trips[held_out].phases;
    let mut phases = curves
        .iter()
        .map(|curve| {
            Ok(EvaluatedPhase {
                trip: held_out,
                energy_j: energy_j(vehicle, curve, curve.speed_mps())?,
                curve: curve.clone(),
                predictions: Vec::with_capacity(models.len()),
                predicted_energy_j: Vec::with_capacity(models.len()),
            })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let mut folds = Vec::with_capacity(models.len());
    for &kind in models {
        let clock = Instant::now();
        let model = DriverModel::fit(kind, &training)?;
        let fit_seconds = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let predictions: Vec<_> = curves
            .iter()
            .map(|curve| PhasePrediction::new(&model, curve, settings.band_mps))
            .collect();
        let predict_seconds = clock.elapsed().as_secs_f64();
        for (phase, prediction) in phases.iter_mut().zip(predictions) {
            let energy = energy_j(vehicle, &phase.curve, &prediction.speed_mps)?;
            phase.predicted_energy_j.push(energy);
            phase.predictions.push(prediction);
        }
        let own = || phases.iter().filter_map(|p| p.predictions.last());
        folds.push(Fold {
            trip: held_out,
            phases: phases.len(),
            rmse_mps: mean(own().map(|p| p.rmse_mps)),
            in_band_pct: mean(own().map(|p| p.in_band_pct)),
            fallbacks: own().filter(|p| p.fallback).count(),
            fit_seconds,
            predict_seconds,
            model,
        });
    }
    Ok((folds, phases))
}

impl<'a> TrainingSet<'a> {
    /// Joins what the trips have to offer.
    #[must_use]
    pub fn from_trips(trips: impl Iterator<Item = &'a Trip>) -> Self {
        let mut training = Self::default();
        for trip in trips {
            training.phases.extend(&trip.phases);
            training.segment_means.extend(&trip.segment_means);
        }
        training
    }
}

/// Battery energy of driving `speed_mps` over the slope of the phase. A prediction that rolls backward counts as standing.
fn energy_j(vehicle: &Vehicle, curve: &PhaseCurve, speed_mps: &[f64]) -> Result<f64, Error> {
    let forward: Vec<f64> = speed_mps.iter().map(|v| v.max(0.0)).collect();
    let energy = vehicle.trip_energy(&ev_energy::Trip {
        step_s: curve.outline().step_s,
        speed_mps: &forward,
        slope_rad: curve.slope_rad(),
        ..ev_energy::Trip::default()
    })?;
    Ok(energy.battery_energy_j)
}

fn summarise(
    index: usize,
    kind: ModelKind,
    folds: &[Fold],
    phases: &[EvaluatedPhase],
    band_mps: f64,
) -> Summary {
    let own = || phases.iter().map(|p| &p.predictions[index]);
    let average = |figure: fn(&PhasePrediction) -> f64| mean(own().map(figure)).unwrap_or(f64::NAN);
    let energy: Vec<f64> = phases
        .iter()
        .map(|p| p.energy_j - p.predicted_energy_j[index])
        .collect();
    let seconds = |of: fn(&Fold) -> f64| {
        folds
            .iter()
            .filter(|f| f.model.kind() == kind)
            .map(of)
            .sum()
    };
    let in_band_pct = average(|p| p.in_band_pct);
    Summary {
        knows: if kind.knows_end_speed() {
            "v0, v_end, T"
        } else {
            "v0, T"
        },
        phases: phases.len(),
        rmse_mps: average(|p| p.rmse_mps),
        rmse_median_mps: median(own().map(|p| p.rmse_mps).collect()),
        sqrt_sse_per_sample_mps: average(|p| p.sqrt_sse_per_sample_mps),
        in_band_pct,
        out_of_band_pct: 100.0 - in_band_pct,
        band_kmh: band_mps * 3.6,
        energy_error_j: EnergyError {
            mean: mean(energy.iter().copied()).unwrap_or(f64::NAN),
            mean_abs: mean(energy.iter().map(|e| e.abs())).unwrap_or(f64::NAN),
            median: median(energy),
        },
        final_speed_error_mps: average(|p| p.final_speed_error_mps),
        fit_seconds: seconds(|f| f.fit_seconds),
        predict_seconds: seconds(|f| f.predict_seconds),
        fallback_phases: own().filter(|p| p.fallback).count(),
        groups: by_group(index, phases),
    }
}

fn by_group(index: usize, phases: &[EvaluatedPhase]) -> BTreeMap<String, GroupSummary> {
    let mut members = BTreeMap::<SpeedGroup, Vec<&EvaluatedPhase>>::new();
    for phase in phases {
        members
            .entry(phase.curve.outline().group())
            .or_default()
            .push(phase);
    }
    members
        .into_iter()
        .map(|(group, own)| {
            let n = own.len() as f64;
            let average = |figure: fn(&PhasePrediction) -> f64| {
                own.iter()
                    .map(|p| figure(&p.predictions[index]))
                    .sum::<f64>()
                    / n
            };
            let energy = own.iter().map(|p| p.energy_j - p.predicted_energy_j[index]);
            let summary = GroupSummary {
                phases: own.len(),
                rmse_mps: average(|p| p.rmse_mps),
                in_band_pct: average(|p| p.in_band_pct),
                sqrt_sse_per_sample_mps: average(|p| p.sqrt_sse_per_sample_mps),
                energy_error_mean_j: energy.sum::<f64>() / n,
            };
            (group.name(), summary)
        })
        .collect()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.fold((0.0, 0usize), |(sum, n), v| (sum + v, n + 1));
    (n > 0).then(|| sum / n as f64)
}

/// The mean of the two middle values where their number is even; NaN without values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => f64::NAN,
        _ => 0.5 * (values[(n - 1) / 2] + values[n / 2]),
    }
}

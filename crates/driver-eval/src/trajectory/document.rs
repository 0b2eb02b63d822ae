//! The document of a trajectory evaluation, and what the report gets beyond it.

use std::collections::BTreeMap;

use driver_model::LeftOut;
use driver_model::speed_ahead::FittedTrial;
use driver_model::trip_driver::TripDriver;
use serde::Serialize;
use serde_json::{Value, json};

use super::Trajectories;
use super::free_run::{FreeRuns, curve};
use crate::speed_ahead::TrajectoryData;
use crate::speed_ahead::{
    HorizonFigures, HorizonRow, HorizonVerdict, TrialResult, TrialTrip, TripFigures, TripSummary,
};
use crate::trip_driver::{FreeRunEvaluation, FreeRunSummary, FreeRunTrip};
use crate::units::{Units, UnitsEntry};
use crate::words::millimetres;
use crate::{Error, LimitsKnown};

/// What a document says of [`Trajectories`].
#[derive(Debug, Serialize)]
pub struct TrajectoryDocument<'a> {
    task: &'static str,
    drives: usize,
    units: &'a [String],
    held_out: UnitsEntry,
    origins: usize,
    band_kmh: f64,
    /// By seconds ahead, then by model.
    horizons: BTreeMap<String, BTreeMap<&'a str, HorizonFigures>>,
    models: BTreeMap<&'a str, Entry>,
    baselines: BTreeMap<&'a str, Entry>,
    verdicts: &'a [HorizonVerdict],
    trials: Vec<Trial<'a>>,
    free_run: Option<FreeRun<'a>>,
    left_out: BTreeMap<&'a str, &'a str>,
    /// Drives that cannot be used, with the reason.
    left_out_drives: &'a [LeftOut],
    /// Parts without figures, with the reason.
    not_evaluated: &'a BTreeMap<&'static str, String>,
    /// How the drives know their speed limits.
    limits: Option<LimitsKnown>,
    /// What models with `+channels` in their name are told of the driver.
    channels: Vec<&'static str>,
    /// The vehicle, where none was named.
    default_vehicle: Option<&'static str>,
}

/// Whole trips from the road, with what the road may know.
#[derive(Debug, Serialize)]
struct FreeRun<'a> {
    /// Stops; slowdowns as expected of the driver.
    expected: FreeRunFigures<'a>,
    /// Stops and slowdowns of the trip itself.
    known: FreeRunFigures<'a>,
    driver: &'a TripDriver,
    /// Share of the time over which the speed's reading was held and was joined to the next by a straight line.
    joined_pct: f64,
    left_out: BTreeMap<&'a str, &'a str>,
}

#[derive(Debug, Serialize)]
struct FreeRunFigures<'a> {
    #[serde(flatten)]
    summary: FreeRunSummary,
    by_trip: &'a [FreeRunTrip],
}

impl<'a> FreeRun<'a> {
    fn new(runs: &'a FreeRuns) -> Self {
        let figures = |evaluation: &'a FreeRunEvaluation| FreeRunFigures {
            summary: evaluation.summary,
            by_trip: &evaluation.trips,
        };
        let left_out = runs.expected.left_out.iter();
        Self {
            expected: figures(&runs.expected),
            known: figures(&runs.known),
            driver: &runs.expected.driver,
            joined_pct: runs.expected.joined_pct,
            left_out: left_out
                .map(|(log, reason)| (log.as_str(), reason.as_str()))
                .collect(),
        }
    }
}

/// One model, its figures by seconds ahead.
#[derive(Debug, Serialize)]
struct Entry {
    rmse_mps: BTreeMap<String, f64>,
    skill_pct: BTreeMap<String, f64>,
    fold_skill_pct: BTreeMap<String, Vec<f64>>,
    fit_seconds: f64,
    predict_seconds: f64,
    /// Regressions, over horizons and folds, whose solver stopped before the optimum.
    unfinished: usize,
}

#[derive(Debug, Serialize)]
struct Trial<'a> {
    trial: usize,
    #[serde(flatten)]
    summary: Option<TripSummary>,
    fits: Vec<Fit>,
    by_trip: Vec<TripEntry<'a>>,
}

#[derive(Debug, Serialize)]
struct Fit {
    samples: usize,
    predictors: usize,
    hold_out_rmse_mps: f64,
    status: svr::Status,
    box_constraint: f64,
    tube_epsilon: f64,
    support_vectors: usize,
    primal_objective: f64,
    duality_gap: f64,
    kkt_residual: f64,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct TripEntry<'a> {
    drive: &'a str,
    #[serde(flatten)]
    figures: &'a TripFigures,
}

impl<'a> TrajectoryDocument<'a> {
    /// `default_vehicle` is the vehicle where none was named.
    #[must_use]
    pub fn new(
        units: &Units,
        trajectories: &'a Trajectories,
        default_vehicle: Option<&'static str>,
    ) -> Self {
        let Trajectories {
            data,
            speed_ahead: evaluation,
            free_runs,
            ..
        } = trajectories;
        let folds = trajectories.folds;
        let keys: Vec<String> = evaluation.horizons_s.iter().map(f64::to_string).collect();
        let by_horizon = |(k, key): (usize, &String)| {
            let rows = evaluation
                .rows
                .iter()
                .map(|row| (row.model.as_str(), row.figures[k]));
            (key.clone(), rows.collect())
        };
        let entries = |baseline: bool| {
            let rows = evaluation
                .rows
                .iter()
                .filter(move |row| row.baseline == baseline);
            rows.map(|row| {
                (
                    row.model.as_str(),
                    Entry::new(row, &evaluation.rows[0], &keys, folds),
                )
            })
            .collect()
        };
        Self {
            task: "trajectory",
            drives: data.motions.len(),
            units: data.hold_out.units(),
            held_out: units.entry(),
            origins: evaluation.rows.first().map_or(0, |row| row.origins),
            band_kmh: trajectories.band_mps * 3.6,
            horizons: keys.iter().enumerate().map(by_horizon).collect(),
            models: entries(false),
            baselines: entries(true),
            verdicts: &evaluation.verdicts,
            trials: evaluation
                .trials
                .iter()
                .map(|trial| Trial::new(trial, data))
                .collect(),
            free_run: free_runs.as_ref().map(FreeRun::new),
            left_out_drives: &trajectories.left_out,
            not_evaluated: &trajectories.not_evaluated,
            limits: LimitsKnown::of(&data.motions),
            channels: evaluation
                .channels
                .iter()
                .map(|c| c.channel().name())
                .collect(),
            default_vehicle,
            left_out: evaluation
                .left_out
                .iter()
                .map(|(model, reason)| (model.as_str(), reason.as_str()))
                .collect(),
        }
    }
}

impl Entry {
    fn new(row: &HorizonRow, persistence: &HorizonRow, keys: &[String], folds: usize) -> Self {
        let of = |figure: fn(&HorizonFigures) -> f64| {
            keys.iter()
                .cloned()
                .zip(row.figures.iter().map(figure))
                .collect()
        };
        let fold_skill =
            |(k, key): (usize, &String)| (key.clone(), row.fold_skill_pct(persistence, k, folds));
        Self {
            rmse_mps: of(|figures| figures.rmse_mps),
            skill_pct: of(|figures| figures.skill_pct),
            fold_skill_pct: keys.iter().enumerate().map(fold_skill).collect(),
            fit_seconds: row.fit_seconds,
            predict_seconds: row.predict_seconds,
            unfinished: row.unfinished,
        }
    }
}

impl<'a> Trial<'a> {
    fn new(result: &'a TrialResult, data: &'a TrajectoryData) -> Self {
        let trip = |trip: &'a TrialTrip| TripEntry {
            drive: data.motions[trip.motion].name(),
            figures: &trip.figures,
        };
        Self {
            trial: result.trial.number(),
            summary: result.summary(),
            fits: result.fits.iter().map(Fit::new).collect(),
            by_trip: result.trips.iter().map(trip).collect(),
        }
    }
}

impl Fit {
    fn new(fitted: &FittedTrial) -> Self {
        let fit = &fitted.fit;
        Self {
            samples: fitted.samples,
            predictors: fit.model.predictors(),
            hold_out_rmse_mps: fitted.hold_out_rmse_mps,
            status: fit.status,
            box_constraint: fit.penalty.box_constraint,
            tube_epsilon: fit.penalty.tube_epsilon,
            support_vectors: fit.support_vectors,
            primal_objective: fit.primal_objective,
            duality_gap: fit.duality_gap(),
            kkt_residual: fit.kkt_residual,
            seconds: fit.seconds,
        }
    }
}

/// Adds what figures 4.4 to 4.11 draw: one drive that was learnt from, and the longest one as every trial predicts it.
///
/// # Errors
/// What driving the longest trip's road refuses.
pub fn with_curves(mut document: Value, trajectories: &Trajectories) -> Result<Value, Error> {
    let (data, evaluation) = (&trajectories.data, &trajectories.speed_ahead);
    let free_run = match &trajectories.free_runs {
        Some(runs) => curve(&trajectories.motions, runs)?,
        None => None,
    };
    let Some(shown) = (0..data.motions.len()).max_by_key(|&i| data.motions[i].len()) else {
        return Ok(document);
    };
    let motion = &data.motions[shown];
    let unit_of = data.hold_out.unit_of();
    // Another unit than the one shown, so that it was learnt from.
    let learnt = (0..data.motions.len())
        .find(|&i| unit_of[i] != unit_of[shown])
        .unwrap_or(shown);
    let predicted = evaluation.trials.iter().filter_map(|result| {
        let trip = result.trips.iter().find(|trip| trip.motion == shown)?;
        Some(json!({ "trial": result.trial.number(), "speed_mps": millimetres(trip.speed_mps.iter().copied()) }))
    });
    document["curves"] = json!({
        "shown": drive(motion),
        "learnt": drive(&data.motions[learnt]),
        "predicted": predicted.collect::<Vec<_>>(),
        "free_run": free_run,
    });
    Ok(document)
}

fn drive(motion: &driver_model::Motion) -> Value {
    json!({
        "name": motion.name(),
        "step_s": motion.step_s(),
        "speed_mps": millimetres(motion.speed_mps().iter().copied()),
        "limit_mps": motion.limit_mps().map(|limit| millimetres(limit.iter().copied())),
    })
}

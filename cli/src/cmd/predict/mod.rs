mod ahead;
mod trip;

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use driver_eval::behaviour::without;
use driver_eval::phase::PhasePrediction;
use driver_model::cruise::{CruiseModel, CruiseStretch};
use driver_model::following::{FollowingErrors, FollowingModel, FollowingStretch};
use driver_model::{DriverModel, LeftOut, Phase, PhaseCurve, PhaseKind, PhaseModel, Trip};
use serde::Serialize;

use super::left_out;
use super::motions::{mention_finer_grids, motions};
use super::phases::PhaseArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::render::table::{Table, number};
use crate::require::{Figures, RequireArgs};

/// Predict the phases, the speed ahead or whole trips of logs with a fitted model
///
/// Of a model of the speed ahead: the speed some seconds ahead of every second of the logs, with its interval. Of a trip driver: every
/// drive from its road (limits, slope, stops) alone.
///
/// Phases or stretches of whatever the model was fitted to. Acceleration and braking phases are found as in `fit`; the model is told of each what it may know (start speed and duration, and the end
/// speed where it takes one) and its prediction is compared with the measured speed.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit predict drive.csv --model driver.json
  drivekit predict drive.csv --model ahead.json --horizon 5     from `drivekit fit --model svr-rbf`
  drivekit predict logs/ --model driver.json --format json > predicted.json")]
pub(crate) struct PredictArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    /// Model file written by `drivekit fit`
    #[arg(long, value_name = "FILE.json")]
    model: PathBuf,
    /// Full width of the band around the measured speed, in km/h
    #[arg(long, default_value_t = 3.0, value_parser = numbers::width_kmh, value_name = "KM/H")]
    band: f64,
    /// Seconds ahead, comma separated [default: all of the model]
    #[arg(long, value_delimiter = ',', value_parser = numbers::horizon_s, value_name = "S")]
    horizon: Vec<f64>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &PredictArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&Figures::new(include_str!("../../figures/predict.txt")))?;
    let file = super::model::read(&args.model)?;
    let inputs = inputs::load(&args.logs, context)?;
    if !args.horizon.is_empty() && !matches!(file.model, DriverModel::SpeedAhead(_)) {
        bail!(
            "--horizon: `{}` is no model of the speed ahead",
            file.model.kind().name()
        );
    }
    let (mut trips, mut whole) = (Vec::new(), Vec::new());
    match file.model {
        DriverModel::SpeedAhead(_) | DriverModel::Trip(_) => {
            whole = motions(&inputs, args.phases.slope_bandwidth)?;
        }
        _ => trips = args.phases.trips(&inputs, context)?,
    }
    let left_out: Vec<LeftOut>;
    let (document, text) = match &file.model {
        DriverModel::Acceleration(model) | DriverModel::Braking(model) => {
            let kind = match file.model {
                DriverModel::Braking(_) => PhaseKind::Braking,
                _ => PhaseKind::Acceleration,
            };
            let has_some = |trip: &Trip| trip.phases_of(kind).next().is_some();
            left_out = without(&trips, has_some, "no phase that counts");
            let entry = |trip| Entry::of_phases(trip, kind, model, args.band / 3.6);
            let logs: Vec<_> = trips.iter().map(entry).collect();
            (serde_json::to_value(&logs)?, phase_table(&logs))
        }
        DriverModel::Cruise(model) => {
            let has_some = |trip: &Trip| !trip.cruise.is_empty();
            left_out = without(&trips, has_some, "no stretch of cruising that counts");
            let logs: Vec<_> = trips
                .iter()
                .map(|trip| Entry::of_cruise(trip, model))
                .collect();
            (serde_json::to_value(&logs)?, cruise_table(&logs))
        }
        DriverModel::Following(model) => {
            let has_some = |trip: &Trip| !trip.following.is_empty();
            left_out = without(&trips, has_some, "no stretch behind a vehicle that counts");
            let logs: Vec<_> = trips
                .iter()
                .map(|trip| Entry::of_following(trip, model))
                .collect();
            (serde_json::to_value(&logs)?, following_table(&logs))
        }
        DriverModel::SpeedAhead(model) => {
            mention_finer_grids(&inputs, context);
            let (logs, without) = ahead::predict(&whole, model, &args.horizon)?;
            left_out = without;
            (serde_json::to_value(&logs)?, ahead::table(&logs))
        }
        DriverModel::Trip(driver) => {
            let (logs, without) = trip::predict(&whole, driver)?;
            left_out = without;
            (serde_json::to_value(&logs)?, trip::table(&logs))
        }
    };
    left_out::mention(&left_out, context);
    let body = Body {
        logs: document,
        left_out_drives: left_out,
    };
    let mut document = Document::new("predict", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text)?,
    }
    Ok(inputs.outcome().and(outcome))
}

#[derive(Serialize)]
struct Body {
    logs: serde_json::Value,
    /// Drives that the model cannot predict, with the reason.
    left_out_drives: Vec<LeftOut>,
}

/// A log with what is predicted in it: phases, or stretches.
#[derive(Serialize)]
struct Entry<'a, T> {
    name: &'a str,
    phases: Vec<T>,
}

#[derive(Serialize)]
struct PhaseEntry {
    start_s: f64,
    end_s: f64,
    #[serde(flatten)]
    outline: Phase,
    #[serde(flatten)]
    prediction: PhasePrediction,
}

#[derive(Serialize)]
struct CruiseEntry {
    start_s: f64,
    end_s: f64,
    limit_mps: Option<f64>,
    start_speed_mps: f64,
    rmse_mps: f64,
    hold_rmse_mps: f64,
    in_90_pct_band_pct: f64,
}

#[derive(Serialize)]
struct FollowingEntry {
    start_s: f64,
    end_s: f64,
    #[serde(flatten)]
    errors: FollowingErrors,
    speed_mps: Vec<f64>,
    gap_m: Vec<f64>,
}

impl<'a> Entry<'a, PhaseEntry> {
    fn of_phases(trip: &'a Trip, kind: PhaseKind, model: &PhaseModel, band_mps: f64) -> Self {
        let entry = |curve: &PhaseCurve| {
            let outline = curve.outline();
            PhaseEntry {
                start_s: curve.start_s(),
                end_s: curve.start_s() + outline.duration_s(),
                prediction: PhasePrediction::new(model, curve, band_mps),
                outline,
            }
        };
        Self {
            name: &trip.name,
            phases: trip.phases_of(kind).map(entry).collect(),
        }
    }
}

impl<'a> Entry<'a, CruiseEntry> {
    fn of_cruise(trip: &'a Trip, model: &CruiseModel) -> Self {
        let entry = |stretch: &CruiseStretch| {
            let errors = model.errors(stretch);
            CruiseEntry {
                start_s: stretch.start_s(),
                end_s: stretch.start_s() + stretch.duration_s(),
                limit_mps: stretch.limit_mps(),
                start_speed_mps: stretch.speed_mps()[0],
                rmse_mps: errors.cruise_mps,
                hold_rmse_mps: errors.hold_mps,
                in_90_pct_band_pct: errors.inside_pct,
            }
        };
        Self {
            name: &trip.name,
            phases: trip.cruise.iter().map(entry).collect(),
        }
    }
}

impl<'a> Entry<'a, FollowingEntry> {
    fn of_following(trip: &'a Trip, model: &FollowingModel) -> Self {
        let entry = |stretch: &FollowingStretch| {
            let simulated = model.simulate(stretch);
            FollowingEntry {
                start_s: stretch.start_s(),
                end_s: stretch.start_s() + stretch.duration_s(),
                errors: model.errors(stretch),
                speed_mps: simulated.speed_mps,
                gap_m: simulated.gap_m,
            }
        };
        Self {
            name: &trip.name,
            phases: trip.following.iter().map(entry).collect(),
        }
    }
}

fn cruise_table(logs: &[Entry<'_, CruiseEntry>]) -> String {
    let headings = [
        "log",
        "from s",
        "to s",
        "limit km/h",
        "v0 km/h",
        "RMSE km/h",
        "hold km/h",
        "in 90 % band %",
    ];
    let mut table = Table::new(headings);
    for (log, stretch) in rows(logs) {
        table.row([
            log.to_owned(),
            number(stretch.start_s, 1),
            number(stretch.end_s, 1),
            number(stretch.limit_mps.map(|v| v * 3.6), 0),
            number(stretch.start_speed_mps * 3.6, 1),
            number(stretch.rmse_mps * 3.6, 2),
            number(stretch.hold_rmse_mps * 3.6, 2),
            number(stretch.in_90_pct_band_pct, 1),
        ]);
    }
    table.render()
}

fn following_table(logs: &[Entry<'_, FollowingEntry>]) -> String {
    let mut table = Table::new([
        "log",
        "from s",
        "to s",
        "gap RMSE m",
        "speed RMSE m/s",
        "collisions",
    ]);
    for (log, stretch) in rows(logs) {
        table.row([
            log.to_owned(),
            number(stretch.start_s, 1),
            number(stretch.end_s, 1),
            number(stretch.errors.gap_rmse_m, 2),
            number(stretch.errors.speed_rmse_mps, 3),
            stretch.errors.collisions.to_string(),
        ]);
    }
    table.render()
}

fn rows<'a, T>(logs: &'a [Entry<'a, T>]) -> impl Iterator<Item = (&'a str, &'a T)> {
    logs.iter()
        .flat_map(|log| log.phases.iter().map(|phase| (log.name, phase)))
}

fn phase_table(logs: &[Entry<'_, PhaseEntry>]) -> String {
    let mut table = Table::new([
        "log",
        "from s",
        "to s",
        "v0 km/h",
        "end km/h",
        "predicted",
        "RMSE km/h",
        "in band %",
    ]);
    for (log, phase) in rows(logs) {
        let predicted_end = phase.prediction.speed_mps.last().copied();
        table.row([
            log.to_owned(),
            number(phase.start_s, 1),
            number(phase.end_s, 1),
            number(phase.outline.start_speed_mps * 3.6, 1),
            number(phase.outline.end_speed_mps * 3.6, 1),
            number(predicted_end.map(|v| v * 3.6), 1),
            number(phase.prediction.rmse_mps * 3.6, 2),
            number(phase.prediction.in_band_pct, 1),
        ]);
    }
    table.render()
}

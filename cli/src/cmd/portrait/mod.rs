//! `drivekit portrait`: one page about a driver.

use std::path::PathBuf;

use clap::Args;
use driver_eval::portrait::sentences;
use driver_model::portrait::Portrait;
use report::terminal::{Table, number};
use serde::Serialize;

use super::motions::motions;
use super::phases::PhaseArgs;
use super::vehicle_arg::VehicleArg;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input, Inputs};
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// One page about a driver
///
/// How the driver accelerates and brakes at which speed, keeps to limits, follows, how smooth the driving is and what it
/// costs, in plain sentences and figures, beside other drivers where their logs are given.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit portrait logs/anna/ --vehicle bmw-i3-60ah --report anna.html
  drivekit portrait logs/anna/ --fleet logs/ben/ --fleet logs/carla/
  drivekit portrait logs/*.csv --format json > portrait.json")]
pub(crate) struct PortraitArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    /// Logs of other drivers to compare with; a file, folder or glob, may be repeated
    #[arg(long, value_name = "LOG")]
    #[serde(skip)]
    fleet: Vec<PathBuf>,
    #[command(flatten)]
    #[serde(flatten)]
    vehicle: VehicleArg,
    /// Write one self-contained page with pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &PortraitArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/portrait.txt"
    )))?;
    let vehicle = args.vehicle.read()?;
    args.vehicle.mention(context);
    let settings = args.phases.settings();
    let portrait_of = |inputs: &[Input]| {
        let motions = motions(inputs, args.phases.slope_bandwidth)?;
        anyhow::Ok(Portrait::of(&motions, &vehicle, &settings)?)
    };
    let inputs = inputs::load(&args.logs, context)?;
    let portrait = portrait_of(&inputs)?;
    let fleet_inputs = match args.fleet.is_empty() {
        true => Inputs::default(),
        false => {
            let logs = LogArgs {
                logs: args.fleet.clone(),
                reading: args.logs.reading.clone(),
            };
            inputs::load(&logs, context)?
        }
    };
    let fleet = (!fleet_inputs.is_empty())
        .then(|| portrait_of(&fleet_inputs))
        .transpose()?;
    let body = Body {
        default_vehicle: args.vehicle.by_default(),
        sentences: sentences(&portrait, fleet.as_ref(), &args.vehicle.words()),
        driver: portrait,
        fleet,
    };
    let mut document = Document::new("portrait", args, &inputs, body).beside(&fleet_inputs);
    let outcome = document.judged(&args.require)?;
    if let Some(path) = &args.report {
        let page = report::PORTRAIT.filled(&serde_json::to_value(&document)?);
        output::write_page(path, &page, context)?;
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&document.body))?,
    }
    Ok(inputs::outcome(&inputs)
        .and(inputs::outcome(&fleet_inputs))
        .and(outcome))
}

#[derive(Serialize)]
struct Body {
    driver: Portrait,
    /// Other drivers, all together.
    fleet: Option<Portrait>,
    sentences: Vec<String>,
    /// The vehicle, where none was named.
    default_vehicle: Option<&'static str>,
}

fn text(body: &Body) -> String {
    let mut text = String::new();
    for sentence in &body.sentences {
        text.push_str(sentence);
        text.push('\n');
    }
    text.push('\n');
    let mut table = Table::new(["figure", "driver", "fleet"]);
    for (name, figure) in FIGURES {
        let of = |portrait: Option<&Portrait>| number(portrait.and_then(figure), 2);
        table.row([
            name.to_owned(),
            of(Some(&body.driver)),
            of(body.fleet.as_ref()),
        ]);
    }
    text + &table.render()
}

type Figure = fn(&Portrait) -> Option<f64>;

const FIGURES: [(&str, Figure); 14] = [
    ("distance, km", |p| Some(p.distance_m / 1e3)),
    ("acceleration, median, m/s²", |p| {
        p.acceleration.accel_mps2.map(|d| d.median)
    }),
    ("acceleration, 90 % below", |p| {
        p.acceleration.accel_mps2.map(|d| d.p90)
    }),
    ("braking, median, m/s²", |p| {
        p.braking.accel_mps2.map(|d| d.median)
    }),
    ("braking, 90 % below", |p| {
        p.braking.accel_mps2.map(|d| d.p90)
    }),
    ("headway, median, s", |p| {
        p.headway.as_ref().map(|h| h.headway_s.median)
    }),
    ("headway under 1 s, % of the time", |p| {
        p.headway.as_ref().map(|h| h.under_1_s_pct)
    }),
    ("relative positive acceleration, m/s²", |p| {
        Some(p.dynamics.relative_positive_accel_mps2)
    }),
    ("v·a, 95 % below, m²/s³", |p| {
        Some(p.dynamics.speed_times_accel_p95_m2ps3)
    }),
    ("jerk, root mean square, m/s³", |p| {
        Some(p.dynamics.jerk_rms_mps3)
    }),
    ("stops per km", |p| Some(p.dynamics.stops_per_km)),
    ("steady, % of the time in motion", |p| {
        Some(p.dynamics.steady_pct)
    }),
    ("consumption, kWh/100 km", |p| {
        p.economy.consumption_kwh_per_100km
    }),
    ("the same, smoothed over 10 s", |p| {
        p.economy.smooth_consumption_kwh_per_100km
    }),
];

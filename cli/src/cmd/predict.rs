use std::path::PathBuf;

use clap::Args;
use driver_model::{ModelFile, PhaseCurve, PhaseOutline, PhasePrediction};
use serde::Serialize;

use super::phases::{PhaseArgs, width_kmh};
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::output;
use crate::render::json::{Document, Logs};
use crate::render::table::{Table, number};

/// Predict the phases of logs with a fitted model
///
/// Acceleration or braking phases, whichever the model was fitted to, are found as in `fit`; the model is told of each what it may know (start speed and duration, and the end
/// speed where it takes one) and its prediction is compared with the measured speed.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit predict drive.csv --model driver.json
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
    #[arg(long, default_value_t = 3.0, value_parser = width_kmh, value_name = "KM/H")]
    band: f64,
}

pub(crate) fn run(args: &PredictArgs, context: &Context) -> anyhow::Result<Outcome> {
    let file = super::model::read(&args.model)?;
    let inputs = inputs::load(&args.logs, context)?;
    let trips = args.phases.trips(&inputs, context)?;
    let logs: Vec<Entry> = trips
        .iter()
        .map(|trip| Entry {
            name: &trip.name,
            phases: trip
                .phases_of(file.phase)
                .map(|curve| PhaseEntry::new(curve, &file, args.band / 3.6))
                .collect(),
        })
        .collect();
    match context.format {
        Format::Json => {
            output::print_json(&Document::new("predict", args, &inputs, Logs { logs }))?;
        }
        Format::Text => output::print_text(&table(&logs))?,
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    phases: Vec<PhaseEntry>,
}

#[derive(Serialize)]
struct PhaseEntry {
    start_s: f64,
    end_s: f64,
    #[serde(flatten)]
    outline: PhaseOutline,
    #[serde(flatten)]
    prediction: PhasePrediction,
}

impl PhaseEntry {
    fn new(curve: &PhaseCurve, file: &ModelFile, band_mps: f64) -> Self {
        let outline = curve.outline();
        Self {
            start_s: curve.start_s(),
            end_s: curve.start_s() + outline.duration_s(),
            prediction: PhasePrediction::new(&file.model, curve, band_mps),
            outline,
        }
    }
}

fn table(logs: &[Entry]) -> String {
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
    for log in logs {
        for phase in &log.phases {
            let predicted_end = phase.prediction.speed_mps.last().copied();
            table.row([
                log.name.to_owned(),
                number(phase.start_s, 1),
                number(phase.end_s, 1),
                number(phase.outline.start_speed_mps * 3.6, 1),
                number(phase.outline.end_speed_mps * 3.6, 1),
                number(predicted_end.map(|v| v * 3.6), 1),
                number(phase.prediction.rmse_mps * 3.6, 2),
                number(phase.prediction.in_band_pct, 1),
            ]);
        }
    }
    table.render()
}

mod follow;
mod tables;

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use driver_eval::model_words::reading_words;
use driver_eval::{Error, PredictionSettings, Predictions, predict};
use driver_model::{DriverModel, LeftOut, ModelFile, PhaseExtent};
use serde::Serialize;

use super::left_out;
use super::motions::{mention_finer_grids, mention_limits, motions};
use super::phases::PhaseArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// Predict the phases, the speed ahead or whole trips of logs with a fitted model
///
/// Of a model of the speed ahead: the speed some seconds ahead of every second of the logs, with its interval. Of a trip driver: every
/// drive from its road (limits, slope, stops) alone.
///
/// Phases or stretches of whatever the model was fitted to. Acceleration and braking phases are found as in `fit`; the model is told of each what it may know (start speed and duration, and the end
/// speed where it takes one) and its prediction is compared with the measured speed.
///
/// With --follow, of a drive that is still going on: a line a second with the speed ahead, a line when a phase has begun that says how
/// it is likely to go, from the remembered phases that began like it, and a line when it has ended.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit predict drive.csv --model driver.json
  drivekit predict drive.csv --model ahead.json --horizon 5     from `drivekit fit --model svr-rbf`
  drivekit predict logs/ --model driver.json --format json > predicted.json
  logger | drivekit predict - --follow --model ahead.json --model acceleration.json --model braking.json")]
pub(crate) struct PredictArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    /// Model file written by `drivekit fit`; with --follow up to three, one of the speed ahead, one of acceleration and one of braking
    #[arg(long, required = true, value_name = "FILE.json")]
    model: Vec<PathBuf>,
    /// Full width of the band around the measured speed, in km/h
    #[arg(long, default_value_t = 3.0, value_parser = numbers::width_kmh, value_name = "KM/H")]
    band: f64,
    /// Seconds ahead, comma separated [default: all of the model]
    #[arg(long, value_delimiter = ',', value_parser = numbers::horizon_s, value_name = "S")]
    horizon: Vec<f64>,
    /// Predict canonical CSV from stdin while it is written. Samples must be --step apart; a gap over --max-gap starts a new piece
    #[arg(
        long,
        conflicts_with_all = ["band", "min_duration", "min_gain", "accel_deadband", "slope_bandwidth", "require"],
        help_heading = "Streams"
    )]
    #[serde(skip)]
    follow: bool,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &PredictArgs, context: &Context) -> anyhow::Result<Outcome> {
    if args.follow {
        return follow::run(args, context);
    }
    let [model] = &args.model[..] else {
        bail!(
            "several models predict a drive that is still going on, with --follow; logs are predicted by one --model"
        );
    };
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/predict.txt"
    )))?;
    let file = super::model::read(model)?;
    mention_reading(&file, args, context)?;
    let inputs = inputs::load(&args.logs, context)?;
    let is_ahead = matches!(file.model, DriverModel::SpeedAhead(_));
    if !args.horizon.is_empty() && !is_ahead {
        bail!(
            "--horizon: `{}` is no model of the speed ahead",
            file.model.kind()
        );
    }
    if is_ahead {
        mention_finer_grids(&inputs, context);
    }
    let motions = motions(&inputs, args.phases.slope_bandwidth)?;
    if is_ahead || matches!(file.model, DriverModel::Trip(_)) {
        mention_limits(&motions, context);
    }
    let progress = Progress::new(context, "predicting", inputs.len());
    let finished = || progress.step();
    let extent = file.training.extent;
    let predicted = predict(&file.model, &motions, &args.settings(extent), &finished);
    drop(progress);
    let (logs, left_out_drives) = predicted.map_err(with_flags)?;
    left_out::mention(&left_out_drives, context);
    if let Some(words) = logs.fallbacks_in_words() {
        output::note(context, &words);
    }
    if extent == PhaseExtent::Whole {
        output::note(context, "phases from begin to end, as those of the model");
    }
    let body = Body {
        extent,
        logs,
        left_out_drives,
    };
    let mut document = Document::new("predict", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&tables::of(&document.body.logs))?,
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

/// Says so where a model learnt from speeds that were smoothed otherwise.
fn mention_reading(file: &ModelFile, args: &PredictArgs, context: &Context) -> anyhow::Result<()> {
    if let Some(words) = reading_words(file, &serde_json::to_value(args)?) {
        output::note(context, &words);
    }
    Ok(())
}

impl PredictArgs {
    fn settings(&self, extent: PhaseExtent) -> PredictionSettings {
        PredictionSettings {
            phases: self.phases.settings().reaching(extent),
            band_mps: self.band / 3.6,
            horizons_s: self.horizon.clone(),
        }
    }
}

fn with_flags(error: Error) -> anyhow::Error {
    match error {
        Error::Horizon { asked_s, .. } => {
            anyhow::anyhow!("--horizon {asked_s}: {error}; fit it with --horizons {asked_s}")
        }
        error => error.into(),
    }
}

#[derive(Serialize)]
struct Body {
    /// How far phases reach.
    extent: PhaseExtent,
    logs: Predictions,
    /// Drives that the model cannot predict, with the reason.
    left_out_drives: Vec<LeftOut>,
}

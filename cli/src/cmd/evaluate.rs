use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use driver_model::{
    Evaluation, EvaluationSettings, Fold, ModelKind, Summary, Trip, leave_one_trip_out,
};
use serde::Serialize;
use serde_json::json;

use super::phases::{PhaseArgs, vehicle, width_kmh};
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::progress::Progress;
use crate::render::html;
use crate::render::json::Document;
use crate::render::table::{Table, number};
use crate::require::Requirement;

/// Leave-one-trip-out over models and baselines: the main job
///
/// Each drive is held out once; every model is fitted on the others and predicts the held-out acceleration phases
/// from what it may know of them. Without logs, the drives are twelve simulated ones that come with the program.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit evaluate
  drivekit evaluate logs/ --vehicle bmw-i3-60ah --report report.html
  drivekit evaluate logs/*.csv --models inverse,profile --format json > evaluation.json
  drivekit evaluate logs/ --require 'profile.in_band_pct>=60'      exit code 1 if missed")]
pub(crate) struct EvaluateArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    /// Models to evaluate, comma separated; the baselines are always added
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "inverse,exponential,exponential-amplitude,rise-time,profile",
        value_name = "MODEL"
    )]
    models: Vec<ModelKind>,
    /// Full width of the band around the measured speed, in km/h
    #[arg(long, default_value_t = 3.0, value_parser = width_kmh, value_name = "KM/H")]
    band: f64,
    /// Vehicle for the energy of curves: a built-in name or a TOML file
    #[arg(long, default_value = "b250e", value_name = "NAME|FILE")]
    vehicle: String,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    /// A threshold such as 'profile.in_band_pct>=60'; exit code 1 if missed
    #[arg(long, value_name = "EXPR")]
    #[serde(skip)]
    require: Vec<Requirement>,
}

pub(crate) fn run(args: &EvaluateArgs, context: &Context) -> anyhow::Result<Outcome> {
    let vehicle = vehicle(&args.vehicle)?;
    if let Some(path) = &args.report {
        output::check_file_place(path)?;
    }
    let inputs = if args.logs.logs.is_empty() {
        inputs::load_embedded(&args.logs.reading, context)?
    } else {
        inputs::load(&args.logs, context)?
    };
    let trips = args.phases.trips(&inputs, context)?;
    let progress = Progress::new(context, "evaluating", trips.len());
    let evaluation = leave_one_trip_out(&trips, &vehicle, &args.settings(), &|| progress.step())?;
    drop(progress);

    let document = Document::new("evaluate", args, &inputs, Body::new(&evaluation));
    let figures = serde_json::to_value(&document)?;
    if let Some(path) = &args.report {
        let page = html::EVALUATION.filled(&with_phases(figures.clone(), &evaluation));
        output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
        output::note(context, &format!("report written to {}", path.display()));
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(args, &inputs, &trips, &evaluation))?,
    }
    let mut outcome = Outcome::Done;
    for requirement in &args.require {
        if let Some(reason) = requirement.missed(&figures)? {
            output::note(context, &format!("missed: {reason}"));
            outcome = Outcome::Negative;
        }
    }
    Ok(outcome)
}

impl EvaluateArgs {
    fn settings(&self) -> EvaluationSettings {
        EvaluationSettings {
            models: self.models.clone(),
            band_mps: self.band / 3.6,
        }
    }
}

#[derive(Serialize)]
struct Body<'a> {
    models: BTreeMap<&'static str, &'a Summary>,
    folds: Vec<FoldEntry<'a>>,
    baselines: BTreeMap<&'static str, &'a Summary>,
}

#[derive(Serialize)]
struct FoldEntry<'a> {
    held_out: &'a str,
    model: &'static str,
    phases: usize,
    rmse_mps: Option<f64>,
    in_band_pct: Option<f64>,
    parameters: &'a driver_model::DriverModel,
    notes: Vec<String>,
}

impl<'a> Body<'a> {
    fn new(evaluation: &'a Evaluation) -> Self {
        let table = |baselines: bool| {
            evaluation
                .models
                .iter()
                .zip(&evaluation.summaries)
                .filter(|(kind, _)| kind.is_baseline() == baselines)
                .map(|(kind, summary)| (kind.name(), summary))
                .collect()
        };
        Self {
            models: table(false),
            folds: evaluation
                .folds
                .iter()
                .map(|fold| FoldEntry::new(fold, &evaluation.trips))
                .collect(),
            baselines: table(true),
        }
    }
}

impl<'a> FoldEntry<'a> {
    fn new(fold: &'a Fold, trips: &'a [String]) -> Self {
        let notes = match fold.fallbacks {
            0 => Vec::new(),
            n => vec![format!(
                "{n} phases in speed groups without training phases: nearest group used"
            )],
        };
        Self {
            held_out: &trips[fold.trip],
            model: fold.model.kind().name(),
            phases: fold.phases,
            rmse_mps: fold.rmse_mps,
            in_band_pct: fold.in_band_pct,
            parameters: &fold.model,
            notes,
        }
    }
}

/// The document with every curve, for the report. Speeds are rounded to mm/s.
fn with_phases(mut document: serde_json::Value, evaluation: &Evaluation) -> serde_json::Value {
    let rounded =
        |speed: &[f64]| -> Vec<f64> { speed.iter().map(|v| (v * 1e3).round() / 1e3).collect() };
    let phases: Vec<_> = evaluation
        .phases
        .iter()
        .map(|phase| {
            let predictions: serde_json::Map<_, _> = evaluation
                .models
                .iter()
                .zip(&phase.predictions)
                .zip(&phase.predicted_energy_j)
                .map(|((kind, p), energy_j)| {
                    let entry = json!({
                        "speed_mps": rounded(&p.speed_mps),
                        "energy_j": energy_j,
                        "rmse_mps": p.rmse_mps,
                        "in_band_pct": p.in_band_pct,
                        "sqrt_sse_per_sample_mps": p.sqrt_sse_per_sample_mps,
                    });
                    (kind.name().to_owned(), entry)
                })
                .collect();
            let outline = phase.curve.outline();
            json!({
                "trip": evaluation.trips[phase.trip],
                "start_s": phase.curve.start_s(),
                "step_s": outline.step_s,
                "group": outline.group().name(),
                "measured_mps": rounded(phase.curve.speed_mps()),
                "energy_j": phase.energy_j,
                "predictions": predictions,
            })
        })
        .collect();
    document["phases"] = phases.into();
    document
}

fn text(args: &EvaluateArgs, inputs: &[Input], trips: &[Trip], evaluation: &Evaluation) -> String {
    let influenced: usize = trips.iter().map(|t| t.lead_influenced_phases).sum();
    let mut text = format!(
        "{} drives, {} acceleration phases of at least {} s and {} km/h, leave one trip out",
        inputs.len(),
        evaluation.phases.len(),
        args.phases.min_duration,
        args.phases.min_gain,
    );
    if influenced > 0 {
        let _ = write!(
            text,
            " ({influenced} more under a leader's influence are left out)"
        );
    }
    text.push_str("\n\n");
    let band = format!("in ±{} km/h %", number(0.5 * args.band, 1));
    let mut table = Table::new([
        "model",
        "knows",
        "RMSE km/h",
        "median",
        &band,
        "√SSE/n km/h",
        "ΔE kJ mean",
        "median",
        "|ΔE| kJ",
        "end km/h",
        "fit s",
        "predict s",
    ]);
    for baselines in [false, true] {
        if baselines {
            table.heading("baselines");
        }
        for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
            if kind.is_baseline() == baselines {
                table.row(row(*kind, summary));
            }
        }
    }
    text.push_str(&table.render());
    let _ = writeln!(
        text,
        "\nΔE: measured minus predicted battery energy per phase ({}); end: predicted minus measured final speed.",
        args.vehicle
    );
    for (kind, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
        if summary.fallback_phases > 0 {
            let _ = writeln!(
                text,
                "{kind}: {} phases lie in speed groups without training phases; the nearest group's parameter was used.",
                summary.fallback_phases
            );
        }
    }
    text
}

fn row(kind: ModelKind, summary: &Summary) -> [String; 12] {
    let energy = &summary.energy_error_j;
    [
        kind.name().to_owned(),
        summary.knows.to_owned(),
        number(summary.rmse_mps * 3.6, 2),
        number(summary.rmse_median_mps * 3.6, 2),
        number(summary.in_band_pct, 1),
        number(summary.sqrt_sse_per_sample_mps * 3.6, 3),
        number(energy.mean / 1e3, 2),
        number(energy.median / 1e3, 2),
        number(energy.mean_abs / 1e3, 2),
        number(summary.final_speed_error_mps * 3.6, 2),
        number(summary.fit_seconds, 3),
        number(summary.predict_seconds, 3),
    ]
}

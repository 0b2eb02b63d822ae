use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use driver_model::{DriverModel, MODEL_SCHEMA, ModelFile, ModelKind, TrainingInput, TrainingSet};
use serde::Serialize;

use super::phases::PhaseArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::output;
use crate::render::json::Document;

/// Fit one model and write it to a file
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit fit logs/ --model profile -o driver.json
  drivekit fit logs/*.csv --model inverse -o inverse.json && drivekit predict new.csv --model inverse.json")]
pub(crate) struct FitArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    /// Model: inverse, exponential, exponential-amplitude, rise-time, profile, or a baseline
    #[arg(long, value_name = "KIND")]
    model: ModelKind,
    /// File for the model
    #[arg(short, long, value_name = "FILE.json")]
    #[serde(skip)]
    output: PathBuf,
}

pub(crate) fn run(args: &FitArgs, context: &Context) -> anyhow::Result<Outcome> {
    output::check_file_place(&args.output)?;
    let inputs = inputs::load(&args.logs, context)?;
    let trips = args.phases.trips(&inputs, context)?;
    let training = TrainingSet::from_trips(trips.iter());
    let file = ModelFile {
        schema: MODEL_SCHEMA.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        model: DriverModel::fit(args.model, &training)?,
        training_phases: training.phases.len(),
        training_segments: training.segment_means.len(),
        inputs: inputs
            .iter()
            .map(|input| TrainingInput {
                path: input.path.clone(),
                sha256: input.sha256.clone(),
            })
            .collect(),
        config: serde_json::to_value(args)?,
    };
    let json = file.to_json()?;
    output::write_file(&args.output, |out| Ok(out.write_all(json.as_bytes())?))?;
    match context.format {
        Format::Json => {
            let body = Body {
                model: &file.model,
                training_phases: file.training_phases,
                training_segments: file.training_segments,
                residual_sum_of_squares: file
                    .model
                    .residual_sum_of_squares(&training.segment_means),
            };
            output::print_json(&Document::new("fit", args, &inputs, body))?;
        }
        Format::Text => output::print_text(&text(args, &file, &training))?,
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct Body<'a> {
    model: &'a DriverModel,
    training_phases: usize,
    training_segments: usize,
    residual_sum_of_squares: Option<f64>,
}

fn text(args: &FitArgs, file: &ModelFile, training: &TrainingSet) -> String {
    let mut text = format!(
        "{} fitted to {} phases and {} segments of {} drives, written to {}\n{}\n",
        args.model,
        file.training_phases,
        file.training_segments,
        file.inputs.len(),
        args.output.display(),
        parameters(&file.model),
    );
    if let Some(sum) = file.model.residual_sum_of_squares(&training.segment_means) {
        let _ = writeln!(
            text,
            "residual sum of squares {sum:.2} (m/s²)² over the segments"
        );
    }
    text
}

fn parameters(model: &DriverModel) -> String {
    match model {
        DriverModel::Inverse(m) => format!("a = 1/({:.5} v + {:.5})", m.p1, m.p2),
        DriverModel::Exponential(m) | DriverModel::ExponentialAmplitude(m) => {
            format!("a = {:.4} exp(-{:.5} v) + {:.4}", m.p0, m.p1, m.p2)
        }
        DriverModel::RiseTime(m) => {
            let groups: Vec<String> = m
                .groups
                .iter()
                .map(|g| {
                    format!(
                        "{} km/h: T_c = {:.3} s ({} phases)",
                        g.group.name(),
                        g.time_constant_s,
                        g.phases
                    )
                })
                .collect();
            groups.join("\n")
        }
        DriverModel::Profile(m) => format!("mean shape over {} knots", m.shape.len()),
        DriverModel::Constant(m) => format!("a = {:.4} m/s²", m.accel_mps2),
        DriverModel::Straight | DriverModel::Smoothstep => "no parameters".to_owned(),
    }
}

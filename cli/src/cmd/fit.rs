use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};
use driver_model::{
    DriverModel, ModelFile, ModelKind, PhaseKind, PointsOf, TrainingInput, TrainingRecord,
    TrainingSet,
};
use serde::Serialize;

use super::model::words;
use super::phases::PhaseArgs;
use super::prior::PriorArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::render::json::Document;

/// Fit one model and write it to a file
///
/// The model learns from the acceleration phases of the logs, or from their braking phases. With logs of other drivers
/// it learns from those, too, each of their phases with the prior weight.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit fit logs/ --model profile-onset -o driver.json
  drivekit fit logs/*.csv --model inverse -o inverse.json && drivekit predict new.csv --model inverse.json
  drivekit fit anna/ --prior others/ --prior-weight 0.33 --model profile-conditioned -o anna.json
  drivekit fit logs/ --model rise-time --phase braking -o braking.json
  drivekit fit logs/ --model exponential --to samples -o all.json        the second row of Table 3.6")]
pub(crate) struct FitArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    #[command(flatten)]
    #[serde(flatten)]
    prior: PriorArgs,
    /// Model: inverse, exponential, exponential-amplitude, rise-time, rise-time-exact, transition-point, profile, profile-conditioned,
    /// profile-onset, or a baseline
    #[arg(long, value_name = "KIND")]
    model: ModelKind,
    /// Phases to learn from
    #[arg(long, value_enum, default_value_t = Phase::Acceleration, value_name = "KIND")]
    phase: Phase,
    /// What a function of speed (inverse, exponential, exponential-amplitude) is fitted to
    #[arg(long, value_enum, default_value_t = Points::Means, value_name = "POINTS")]
    to: Points,
    /// File for the model
    #[arg(short, long, value_name = "FILE.json")]
    #[serde(skip)]
    output: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Phase {
    Acceleration,
    Braking,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Points {
    /// Means of segments
    Means,
    /// All samples of segments
    Samples,
}

pub(crate) fn run(args: &FitArgs, context: &Context) -> anyhow::Result<Outcome> {
    output::check_file_place(&args.output)?;
    args.check()?;
    let inputs = inputs::load(&args.logs, context)?;
    let trips = args.phases.trips(&inputs, context)?;
    let prior_inputs = args.prior.inputs(&args.logs.reading, context)?;
    let prior = args.phases.trips(&prior_inputs, context)?;
    let kind = args.kind();
    let points_of = match args.to {
        Points::Means => PointsOf::Means,
        Points::Samples => PointsOf::Samples,
    };
    let weight = args.prior.weight();
    let training =
        TrainingSet::with_points(points_of, kind, &trips).with_prior(kind, &prior, weight);
    let record = TrainingRecord {
        phases: training.phases.len(),
        points: training.points.len(),
        inputs: hashes(&inputs),
        prior_inputs: hashes(&prior_inputs),
        prior_weight: weight,
    };
    let model = DriverModel::fit(args.model, &training)?;
    let file = ModelFile::new(kind, model, record, serde_json::to_value(args)?);
    let json = file.to_json()?;
    output::write_file(&args.output, |out| Ok(out.write_all(json.as_bytes())?))?;
    let residuals = file.model.residual_sum_of_squares(&training.points);
    match context.format {
        Format::Json => {
            let body = Body {
                model: &file.model,
                training_phases: file.training.phases,
                training_points: file.training.points,
                residual_sum_of_squares: residuals,
            };
            output::print_json(&Document::new("fit", args, &inputs, body))?;
        }
        Format::Text => output::print_text(&text(args, &file, residuals))?,
    }
    Ok(Outcome::Done)
}

impl FitArgs {
    fn kind(&self) -> PhaseKind {
        match self.phase {
            Phase::Acceleration => PhaseKind::Acceleration,
            Phase::Braking => PhaseKind::Braking,
        }
    }

    fn check(&self) -> anyhow::Result<()> {
        let is_function = matches!(
            self.model,
            ModelKind::Inverse | ModelKind::Exponential | ModelKind::ExponentialAmplitude
        );
        if self.to == Points::Samples && !is_function {
            bail!(
                "--to samples: `{}` is fitted to phases; only inverse, exponential and \
                 exponential-amplitude are functions of speed",
                self.model
            );
        }
        Ok(())
    }
}

fn hashes(inputs: &[Input]) -> Vec<TrainingInput> {
    let entry = |input: &Input| TrainingInput {
        path: input.path.clone(),
        sha256: input.sha256.clone(),
    };
    inputs.iter().map(entry).collect()
}

#[derive(Serialize)]
struct Body<'a> {
    model: &'a DriverModel,
    training_phases: usize,
    training_points: usize,
    residual_sum_of_squares: Option<f64>,
}

fn text(args: &FitArgs, file: &ModelFile, residuals: Option<f64>) -> String {
    let training = &file.training;
    let mut text = format!(
        "{} fitted to {} {} phases and {} points of {} drives",
        args.model,
        training.phases,
        file.phase.name(),
        training.points,
        training.inputs.len(),
    );
    if !training.prior_inputs.is_empty() {
        let _ = write!(
            text,
            " and {} of other drivers (weight {})",
            training.prior_inputs.len(),
            training.prior_weight
        );
    }
    let _ = writeln!(
        text,
        ", written to {}\n{}",
        args.output.display(),
        words(file)
    );
    if let Some(sum) = residuals {
        let _ = writeln!(
            text,
            "residual sum of squares {sum:.2} (m/s²)² over the points"
        );
    }
    text
}

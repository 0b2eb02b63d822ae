mod text;

use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};
use driver_eval::behaviour::contents_of;
use driver_model::speed_ahead::DirectSettings;
use driver_model::{
    DriverModel, Error, FitSettings, Fitted, LeftOut, Manoeuvre, ModelFile, ModelKind, PointsOf,
    Prior, Subject, TrainingInput, TrainingRecord, find_behaviour, fit_with,
};
use serde::Serialize;

use super::left_out;
use super::motions::{mention_finer_grids, motions};
use super::phases::PhaseArgs;
use super::prior::PriorArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::names;
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// Fit one model and write it to a file
///
/// The model learns from the acceleration phases of the logs, or from their braking phases. With logs of other drivers
/// it learns from those, too, each of their phases with the prior weight. Models of cruising and following learn from
/// stretches of their own kind.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit fit logs/ --model profile-onset -o driver.json
  drivekit fit logs/*.csv --model inverse -o inverse.json && drivekit predict new.csv --model inverse.json
  drivekit fit anna/ --prior others/ --prior-weight 0.33 --model profile-conditioned -o anna.json
  drivekit fit logs/ --model rise-time --phase braking -o braking.json
  drivekit fit logs/ --model idm -o following.json
  drivekit fit logs/ --model svr-rbf --horizons 1,2,5,10 -o ahead.json && drivekit predict new.csv --model ahead.json --horizon 5
  drivekit fit logs/ --model trip-driver -o trips.json
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
    /// Model of phases: inverse, exponential, exponential-amplitude, rise-time, rise-time-exact, transition-point, profile, profile-conditioned,
    /// profile-onset, or a baseline; of holding a speed: cruise; of following: idm, constant-time-gap; of the next seconds: svr-linear,
    /// svr-quadratic, svr-cubic, svr-rbf, least-squares, blend, ridge, boosted-trees; of whole trips: trip-driver
    #[arg(long, value_parser = names::fitted_model(), hide_possible_values = true, value_name = "KIND")]
    model: ModelKind,
    /// Phases to learn from
    #[arg(long, value_enum, default_value_t = Phase::Acceleration, value_name = "KIND")]
    phase: Phase,
    /// What a function of speed (inverse, exponential, exponential-amplitude) is fitted to
    #[arg(long, value_enum, default_value_t = Points::Means, value_name = "POINTS")]
    to: Points,
    /// Seconds ahead of a model of the next seconds, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_parser = numbers::horizon_s, value_name = "S")]
    horizons: Vec<f64>,
    /// Let a model of the next seconds know the slope ahead, if it does not come from the elevation of the same drive
    #[arg(long)]
    slope_ahead: bool,
    /// File for the model
    #[arg(short, long, value_name = "FILE.json")]
    #[serde(skip)]
    output: PathBuf,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
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
    args.check()?;
    args.require
        .check(&KnownFigures::new(include_str!("../../figures/fit.txt")))?;
    let inputs = inputs::load_once(&args.logs, context)?;
    let prior_inputs = args.prior.inputs(&args.logs.reading, &inputs, context)?;
    let fitted = args.fit(&inputs, &prior_inputs, context)?;
    left_out::mention(&fitted.left_out, context);
    let record = TrainingRecord {
        phases: fitted.phases,
        points: fitted.points,
        inputs: hashes(&inputs),
        prior_inputs: hashes(&prior_inputs),
        prior_weight: if args.prior.is_given() {
            args.prior.weight()
        } else {
            0.0
        },
    };
    let config = serde_json::to_value(args)?;
    let file = ModelFile::new(fitted.model, record, config);
    let json = file.to_json()?;
    output::write_file(&args.output, |out| Ok(out.write_all(json.as_bytes())?))?;
    let residuals = fitted.residual_sum_of_squares;
    let body = Body {
        model: &file.model,
        training_phases: file.training.phases,
        training_points: file.training.points,
        residual_sum_of_squares: residuals,
        left_out_drives: &fitted.left_out,
    };
    let mut document = Document::new("fit", args, &inputs, body).beside(&prior_inputs);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text::text(args, &file, residuals))?,
    }
    Ok(inputs::outcome(&inputs)
        .and(inputs::outcome(&prior_inputs))
        .and(outcome))
}

impl FitArgs {
    fn fit(&self, own: &[Input], prior: &[Input], context: &Context) -> anyhow::Result<Fitted> {
        let settings = self.settings();
        let motions = motions(own, self.phases.slope_bandwidth)?;
        let prior_motions = super::motions::motions(prior, self.phases.slope_bandwidth)?;
        if self.model.subject() == Subject::SpeedAhead {
            mention_finer_grids(own, context);
        }
        let progress = Progress::new(context, "fitting", own.len() + prior.len());
        let finished = || progress.step();
        let prior = self.prior.is_given().then_some(Prior {
            motions: &prior_motions,
            weight: self.prior.weight(),
        });
        fit_with(self.model, &motions, prior, &settings, &finished).map_err(|error| match error {
            Error::TooFewPhases { .. } | Error::TooFewStretches { .. } => {
                let trips = find_behaviour(&motions, &settings.phases, &|| {}).unwrap_or_default();
                anyhow::anyhow!("{error}{}", contents_of(&trips))
            }
            error => error.into(),
        })
    }

    fn settings(&self) -> FitSettings {
        FitSettings {
            phases: self.phases.settings(),
            manoeuvre: match self.phase {
                Phase::Acceleration => Manoeuvre::Acceleration,
                Phase::Braking => Manoeuvre::Braking,
            },
            points_of: match self.to {
                Points::Means => PointsOf::Means,
                Points::Samples => PointsOf::Samples,
            },
            speed_ahead: DirectSettings {
                slope_ahead: self.slope_ahead,
                ..DirectSettings::at(&self.horizons)
            },
        }
    }

    fn check(&self) -> anyhow::Result<()> {
        if self.to == Points::Samples && !self.model.is_function_of_speed() {
            bail!(
                "--to samples: `{}` is fitted to phases; only inverse, exponential and \
                 exponential-amplitude are functions of speed",
                self.model
            );
        }
        if self.prior.is_given() && self.model.subject() != Subject::Phases {
            bail!("--prior: only models of phases learn from other drivers as well");
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
    /// Drives that the model could learn nothing from, with the reason.
    left_out_drives: &'a [LeftOut],
}

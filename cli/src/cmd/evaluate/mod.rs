//! The main job: how well models predict drives that they have not seen.

mod hold_out;
mod text;
mod trajectory;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use driver_eval::behaviour::{
    BehaviourDocument, BehaviourEvaluation, BehaviourSettings, evaluate_behaviour, with_curves,
};
use driver_eval::phase::{EvaluationData, EvaluationSettings};
use driver_eval::units::Units;
use driver_model::{ModelKind, Subject};
use serde::Serialize;

use super::left_out;
use super::phases::PhaseArgs;
use super::prior::PriorArgs;
use super::vehicle_arg::VehicleArg;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Inputs};
use crate::names;
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};
use hold_out::HoldOutArgs;
use trajectory::TrajectoryArgs;

/// Leave-one-out over models and baselines: the main job
///
/// Each drive is held out once; every model is fitted on the others and predicts the held-out acceleration and braking
/// phases from what it may know of them, and cruising and following where the logs have them. Without logs, the drives
/// are twelve simulated ones that come with the program.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit evaluate
  drivekit evaluate logs/ --vehicle bmw-i3-60ah --report report.html
  drivekit evaluate logs/*.csv --models inverse,profile-onset --format json > evaluation.json
  drivekit evaluate drivers/ --hold-out driver           drivers/anna/*.csv, drivers/ben/*.csv, …
  drivekit evaluate anna/ --prior others/ --learning-curve
  drivekit evaluate logs/ --task trajectory --models blend,svr-rbf --horizons 1,2,5,10
  drivekit evaluate logs/ --require 'profile.in_band_pct>=60' --require 'braking.profile.rmse_mps<=0.5'
                                                         exit code 1 if missed")]
pub(crate) struct EvaluateArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    #[command(flatten)]
    #[serde(flatten)]
    prior: PriorArgs,
    /// What is predicted
    #[arg(long, value_enum, default_value_t = Task::Phases, value_name = "TASK")]
    task: Task,
    /// Models to evaluate, comma separated [default: all of the task]; the baselines are always added
    #[arg(long, value_delimiter = ',', value_parser = names::evaluated_model(), hide_possible_values = true, value_name = "MODEL")]
    models: Vec<ModelKind>,
    #[command(flatten)]
    #[serde(flatten)]
    trajectory: TrajectoryArgs,
    #[command(flatten)]
    #[serde(flatten)]
    hold_out: HoldOutArgs,
    /// Also the error over the number of own trips that a model has seen
    #[arg(long)]
    learning_curve: bool,
    /// Full width of the band around the measured speed, in km/h [default: 3 for phases, 5 for trips]
    #[arg(long, value_parser = numbers::width_kmh, value_name = "KM/H")]
    band: Option<f64>,
    #[command(flatten)]
    #[serde(flatten)]
    vehicle: VehicleArg,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

/// What is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Task {
    /// Acceleration and braking phases, cruising and following
    Phases,
    /// The speed of the next seconds and of whole trips, from limits and own past
    Trajectory,
}

pub(crate) fn run(args: &EvaluateArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&args.figures()?)?;
    let vehicle = args.vehicle.read()?;
    let inputs = if args.logs.logs.is_empty() {
        inputs::load_embedded(&args.logs.reading, context)?
    } else {
        args.vehicle.mention(context);
        inputs::load_once(&args.logs, context)?
    };
    let outcome = match args.task {
        Task::Trajectory => args.evaluate_trajectory(&inputs, &vehicle, context),
        Task::Phases => {
            let prior = args.prior.inputs(&args.logs.reading, &inputs, context)?;
            args.evaluate_phases(&inputs, &prior, &vehicle, context)
                .map(|outcome| outcome.and(inputs::outcome(&prior)))
        }
    };
    let outcome = outcome.map_err(|error| inputs::explained(&inputs, error))?;
    Ok(inputs::outcome(&inputs).and(outcome))
}

impl EvaluateArgs {
    /// Those of the models that are evaluated.
    fn figures(&self) -> anyhow::Result<KnownFigures> {
        Ok(match self.task {
            Task::Phases => {
                let baselines = ModelKind::of(Subject::Phases).filter(|kind| kind.is_baseline());
                let models = self.phase_models().into_iter().chain(baselines);
                let names = models.map(ModelKind::name);
                KnownFigures::of(
                    include_str!("../../figures/evaluate.txt"),
                    names.map(str::to_owned),
                )
            }
            Task::Trajectory => KnownFigures::of(
                include_str!("../../figures/evaluate-trajectory.txt"),
                self.direct_names()?,
            ),
        })
    }

    /// Evaluates and prints.
    fn evaluate_phases(
        &self,
        inputs: &Inputs,
        prior_inputs: &Inputs,
        vehicle: &ev_energy::Vehicle,
        context: &Context,
    ) -> anyhow::Result<Outcome> {
        let args = self;
        let units = args
            .hold_out
            .units(inputs, &args.logs.reading.layout()?, context)?;
        let trips = args.phases.trips(inputs, context)?;
        let prior = args.phases.trips(prior_inputs, context)?;
        let data = EvaluationData::by_unit(&trips, &units.of_drives).with_prior(&prior);
        let progress = Progress::new(context, "evaluating", 2 * trips.len());
        let finished = || progress.step();
        let mut findings = evaluate_behaviour(&data, vehicle, &args.settings(), &finished)?;
        drop(progress);
        if context.no_times {
            findings = findings.without_times();
        }
        mention_missing(&findings, context);

        let mut document = Document::new(
            "evaluate",
            args,
            inputs,
            BehaviourDocument::new(&units, &findings, args.vehicle.by_default()),
        )
        .beside(prior_inputs);
        let outcome = document.judged(&args.require)?;
        if let Some(path) = &args.report {
            let page = report::EVALUATION.filled(&with_curves(
                serde_json::to_value(&document)?,
                &findings,
                &trips,
            ));
            output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
            output::note(context, &format!("report written to {}", path.display()));
        }
        match context.format {
            Format::Json => output::print_json(&document)?,
            Format::Text => {
                output::print_text(&text::render(&args.heading(&units), &trips, &findings))?;
            }
        }
        Ok(outcome)
    }

    fn band_kmh(&self) -> f64 {
        self.band.unwrap_or(match self.task {
            Task::Phases => 3.0,
            Task::Trajectory => 5.0,
        })
    }

    fn settings(&self) -> BehaviourSettings {
        BehaviourSettings {
            phase: EvaluationSettings {
                models: self.phase_models(),
                band_mps: self.band_kmh() / 3.6,
                prior_weight: self.prior.weight(),
            },
            learning_curve: self.learning_curve,
        }
    }

    fn phase_models(&self) -> Vec<ModelKind> {
        let named = self.models.iter().copied();
        let named = named.filter(|kind| kind.subject() == Subject::Phases);
        if self.models.is_empty() {
            ModelKind::of(Subject::Phases).collect()
        } else {
            named.collect()
        }
    }

    fn heading(&self, units: &Units) -> text::Heading {
        text::Heading {
            unit: units.kind.name(),
            min_duration_s: self.phases.min_duration,
            min_gain_kmh: self.phases.min_gain,
            band_kmh: self.band_kmh(),
            vehicle: self.vehicle.words(),
        }
    }
}

/// Says what there is too little of.
fn mention_missing(findings: &BehaviourEvaluation, context: &Context) {
    for (part, reason) in &findings.missing {
        output::note(context, &format!("no figures of {part}: {reason}"));
    }
    left_out::mention(&findings.left_out, context);
    for evaluation in findings.phases() {
        for (model, reason) in &evaluation.left_out {
            let kind = evaluation.kind.name();
            output::note(
                context,
                &format!("`{model}` is left out for {kind}: {reason}"),
            );
        }
    }
}

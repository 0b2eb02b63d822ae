//! The main job: how well models predict drives that they have not seen.

mod document;
mod hold_out;
mod missing;
mod text;
mod trajectory;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use driver_eval::cruise::{CruiseEvaluation, evaluate_cruise};
use driver_eval::following::{FollowingEvaluation, evaluate_following};
use driver_eval::phase::{
    Evaluation, EvaluationData, EvaluationSettings, LearningPoint, learning_curve, leave_one_out,
};
use driver_model::following::FollowingStretch;
use driver_model::phase_model::TransitionPoint;
use driver_model::{
    Error, FunctionFit, LeftOut, ModelKind, PhaseKind, Subject, TrainingSet, Trip, function_fits,
};
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
use crate::require::{Figures, RequireArgs};
use hold_out::{HoldOutArgs, Units};
use missing::Missing;
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

/// Everything that was found out.
struct Findings {
    /// `None` where no drive has an acceleration phase that counts.
    acceleration: Option<Evaluation>,
    /// `None` where no drive has a braking phase that counts.
    braking: Option<Evaluation>,
    fits: [(PhaseKind, Vec<FunctionFit>); 2],
    learning: Vec<LearningPoint>,
    /// `None` where less than two units cruise.
    cruise: Option<CruiseEvaluation>,
    /// The transition-point model of all acceleration phases; `None` where none can be identified.
    systems: Option<TransitionPoint>,
    /// With the stretches; `None` where less than two units follow a vehicle.
    following: Option<(FollowingEvaluation, Vec<FollowingStretch>)>,
    /// What of it there is too little for.
    missing: Missing,
    /// Drives that have nothing to evaluate.
    left_out: Vec<LeftOut>,
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
                .map(|outcome| outcome.and(prior.outcome()))
        }
    };
    let outcome = outcome.map_err(|error| inputs.explained(error))?;
    Ok(inputs.outcome().and(outcome))
}

impl EvaluateArgs {
    /// Those of the models that are evaluated.
    fn figures(&self) -> anyhow::Result<Figures> {
        Ok(match self.task {
            Task::Phases => {
                let baselines = ModelKind::of(Subject::Phases).filter(|kind| kind.is_baseline());
                let models = self.phase_models().into_iter().chain(baselines);
                let names = models.map(ModelKind::name);
                Figures::of(
                    include_str!("../../figures/evaluate.txt"),
                    names.map(str::to_owned),
                )
            }
            Task::Trajectory => Figures::of(
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
        let units = args.hold_out.units(inputs, context)?;
        let trips = args.phases.trips(inputs, context)?;
        let prior = args.phases.trips(prior_inputs, context)?;
        let mut findings = args.evaluate(&units, &trips, &prior, vehicle, context)?;
        if context.no_times {
            findings.forget_times();
        }
        findings.missing.mention(context);
        left_out::mention(&findings.left_out, context);
        for evaluation in [&findings.acceleration, &findings.braking]
            .into_iter()
            .flatten()
        {
            for (model, reason) in &evaluation.left_out {
                let kind = evaluation.kind.name();
                output::note(
                    context,
                    &format!("`{model}` is left out for {kind}: {reason}"),
                );
            }
        }

        let mut document = Document::new(
            "evaluate",
            args,
            inputs,
            document::Body::new(args, &units, &findings),
        )
        .beside(prior_inputs);
        let outcome = document.judged(&args.require)?;
        if let Some(path) = &args.report {
            let page = report::EVALUATION.filled(&document::with_curves(
                serde_json::to_value(&document)?,
                &findings,
                &trips,
            ));
            output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
            output::note(context, &format!("report written to {}", path.display()));
        }
        match context.format {
            Format::Json => output::print_json(&document)?,
            Format::Text => output::print_text(&text::render(args, &trips, &findings))?,
        }
        Ok(outcome)
    }

    fn band_kmh(&self) -> f64 {
        self.band.unwrap_or(match self.task {
            Task::Phases => 3.0,
            Task::Trajectory => 5.0,
        })
    }

    fn settings(&self) -> EvaluationSettings {
        EvaluationSettings {
            models: self.phase_models(),
            band_mps: self.band_kmh() / 3.6,
            prior_weight: self.prior.weight(),
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

    fn evaluate(
        &self,
        units: &Units,
        trips: &[Trip],
        prior: &[Trip],
        vehicle: &ev_energy::Vehicle,
        context: &Context,
    ) -> anyhow::Result<Findings> {
        let settings = self.settings();
        let data = EvaluationData::by_unit(trips, &units.of_drives).with_prior(prior);
        let progress = Progress::new(context, "evaluating", 2 * trips.len());
        let evaluate = |kind| leave_one_out(kind, &data, vehicle, &settings, &|| progress.step());
        let mut missing = Missing::default();
        let acceleration =
            missing.unless_enough("acceleration", || evaluate(PhaseKind::Acceleration))?;
        let braking = missing.unless_enough("braking", || evaluate(PhaseKind::Braking))?;
        drop(progress);
        let (cruising, by_unit) = data.stretches(|trip| &trip.cruise);
        let cruise = missing.unless_enough("cruise", || evaluate_cruise(&cruising, &by_unit))?;
        let (behind, by_unit) = data.stretches(|trip| &trip.following);
        let following =
            missing.unless_enough("following", || evaluate_following(&behind, &by_unit))?;
        if missing.is_everything() {
            return Err(missing.into_error(trips));
        }
        Ok(Findings {
            learning: if self.learning_curve && acceleration.is_some() {
                learning_curve(PhaseKind::Acceleration, &data, &settings)?
            } else {
                Vec::new()
            },
            acceleration,
            braking,
            following: following.map(|evaluation| (evaluation, behind)),
            cruise,
            systems: systems(trips)?,
            fits: [PhaseKind::Acceleration, PhaseKind::Braking]
                .map(|kind| (kind, function_fits(kind, trips))),
            missing,
            left_out: missing::without_anything(trips),
        })
    }
}

impl Findings {
    /// Of fitting and predicting, which differ from run to run.
    fn forget_times(&mut self) {
        let kinds = [self.acceleration.as_mut(), self.braking.as_mut()];
        for summary in kinds
            .into_iter()
            .flatten()
            .flat_map(|kind| &mut kind.summaries)
        {
            (summary.fit_seconds, summary.predict_seconds) = (f64::NAN, f64::NAN);
        }
        let following = self.following.iter_mut();
        for fold in following.flat_map(|(following, _)| &mut following.folds) {
            (fold.fit_seconds.idm, fold.fit_seconds.constant_time_gap) = (f64::NAN, f64::NAN);
        }
    }
}

fn systems(trips: &[Trip]) -> anyhow::Result<Option<TransitionPoint>> {
    let training = TrainingSet::from_trips(PhaseKind::Acceleration, trips);
    match TransitionPoint::fit(&training) {
        Err(Error::TooFewPhases { .. } | Error::Fit { .. }) => Ok(None),
        model => Ok(Some(model?)),
    }
}

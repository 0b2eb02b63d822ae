//! The main job: how well models predict drives that they have not seen.

mod args;
mod hold_out;
mod text;
mod trajectory;
mod trajectory_args;

use driver_eval::behaviour::{
    BehaviourDocument, BehaviourEvaluation, BehaviourSettings, evaluate_behaviour, with_curves,
};
use driver_eval::phase::{EvaluationData, EvaluationSettings};
use driver_eval::units::Units;
use driver_model::{ModelKind, Subject};

use super::left_out;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::{self, Inputs};
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::KnownFigures;
pub(crate) use args::EvaluateArgs;
use args::Task;

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
        let progress = Progress::new(context, "evaluating", 4 * trips.len());
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
            output::write_page(path, &page, context)?;
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

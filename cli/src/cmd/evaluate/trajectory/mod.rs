//! `evaluate --task trajectory`: the speed of the next seconds, and of whole trips from limits.

mod text;

use anyhow::bail;
use driver_eval::speed_ahead::TrajectorySettings;
use driver_eval::trajectory::{Trajectories, TrajectoryDocument, TrajectoryTask, with_curves};
use driver_model::speed_ahead::{DirectSettings, Trial};
use driver_model::{ModelKind, Subject};
use ev_energy::Vehicle;

use super::args::EvaluateArgs;
use crate::cmd::left_out;
use crate::cmd::motions::{mention_finer_grids, mention_limits, motions};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::Inputs;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;

impl EvaluateArgs {
    /// Evaluates and prints.
    pub(super) fn evaluate_trajectory(
        &self,
        inputs: &Inputs,
        vehicle: &Vehicle,
        context: &Context,
    ) -> anyhow::Result<Outcome> {
        let settings = self.trajectory_settings()?;
        let units = self
            .hold_out
            .units(inputs, &self.logs.reading.layout()?, context)?;
        mention_finer_grids(inputs, context);
        let motions = motions(inputs, self.phases.slope_bandwidth)?;
        mention_limits(&motions, context);
        let asked = settings.folds;
        let task = TrajectoryTask::new(motions, &units.of_drives, settings)?;
        left_out::mention(task.left_out(), context);
        if task.folds() < asked {
            let folds = task.folds();
            let note = format!("{folds} folds in place of {asked}: there are no more units");
            output::note(context, &note);
        }
        let progress = Progress::new(context, "evaluating", task.steps());
        let mut trajectories = task.evaluate(vehicle, &|| progress.step())?;
        drop(progress);
        if context.no_times {
            trajectories = trajectories.without_times();
        }
        mention_missing(&trajectories, context);
        let body = TrajectoryDocument::new(&units, &trajectories, self.vehicle.by_default());
        let mut document = Document::new("evaluate", self, inputs, body);
        let outcome = document.judged(&self.require)?;
        if let Some(path) = &self.report {
            let shown = with_curves(serde_json::to_value(&document)?, &trajectories)?;
            let page = report::TRAJECTORY.filled(&shown);
            output::write_page(path, &page, context)?;
        }
        match context.format {
            Format::Json => output::print_json(&document)?,
            Format::Text => {
                output::print_text(&text::render(&self.heading(&units), &trajectories))?;
            }
        }
        Ok(outcome)
    }

    /// Of the models that are evaluated, baselines and trials.
    pub(super) fn direct_names(&self) -> anyhow::Result<Vec<String>> {
        let models = self.trajectory_settings()?.models.into_iter();
        let baselines = ModelKind::of(Subject::SpeedAhead).filter(|kind| kind.is_baseline());
        let kinds = models.chain(baselines).map(|kind| kind.name().to_owned());
        let trials = Trial::ALL.map(|trial| format!("trial-{}", trial.number()));
        Ok(kinds.chain(trials).collect())
    }

    fn trajectory_settings(&self) -> anyhow::Result<TrajectorySettings> {
        let mut settings = TrajectorySettings {
            direct: DirectSettings {
                slope_ahead: self.trajectory.slope_ahead,
                max_samples: self.trajectory.max_samples,
                ..DirectSettings::at(&self.trajectory.horizons)
            },
            folds: self.trajectory.folds,
            band_mps: self.band_kmh() / 3.6,
            ..TrajectorySettings::default()
        };
        if !self.trajectory.channels.is_empty() {
            settings
                .direct
                .channels
                .clone_from(&self.trajectory.channels);
        }
        settings.trials.max_samples = self.trajectory.max_samples;
        if !self.models.is_empty() {
            if let Some(kind) = self
                .models
                .iter()
                .find(|kind| kind.subject() == Subject::Phases)
            {
                bail!("`{kind}` is a model of phases; leave out --task trajectory");
            }
            settings.models = self.models.clone();
        }
        Ok(settings)
    }
}

/// Says what could not be fitted or evaluated.
fn mention_missing(trajectories: &Trajectories, context: &Context) {
    for (model, reason) in &trajectories.speed_ahead.left_out {
        output::note(context, &format!("`{model}` is left out: {reason}"));
    }
    for (part, reason) in &trajectories.not_evaluated {
        output::note(context, &format!("no figures of {part}: {reason}"));
    }
}

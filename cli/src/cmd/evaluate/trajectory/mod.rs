//! `evaluate --task trajectory`: the speed of the next seconds, and of whole trips from limits.

mod document;
mod free_run;
mod text;

use std::collections::BTreeMap;

use anyhow::bail;
use clap::Args;
use drive_log::{Channel, DriveLog};
use driver_eval::speed_ahead::{
    TrajectoryData, TrajectoryEvaluation, TrajectorySettings, evaluate_trajectory,
};
use driver_eval::trip_driver::FreeRunSettings;
use driver_model::speed_ahead::{DirectSettings, Trial};
use driver_model::{LeftOut, ModelKind, Subject};
use ev_energy::Vehicle;
use serde::Serialize;

use super::EvaluateArgs;
use crate::cmd::left_out;
use crate::cmd::motions::{mention_finer_grids, motions};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::{Input, Inputs};
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::words::plural;

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Trajectory")]
pub(super) struct TrajectoryArgs {
    /// Seconds ahead, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_parser = numbers::horizon_s, value_name = "S")]
    horizons: Vec<f64>,
    /// Number of folds: every so many units are held out together
    #[arg(long, default_value_t = TrajectorySettings::default().folds, value_parser = numbers::folds, value_name = "N")]
    folds: usize,
    /// Let models know the slope ahead. Not with elevation recorded on the same drive: its errors tell where the car stood
    #[arg(long)]
    slope_ahead: bool,
    /// Most training samples of a model
    #[arg(long, default_value_t = DirectSettings::default().max_samples, value_parser = numbers::samples, value_name = "N")]
    max_samples: usize,
}

impl EvaluateArgs {
    /// Evaluates and prints.
    pub(super) fn evaluate_trajectory(
        &self,
        inputs: &Inputs,
        vehicle: &Vehicle,
        context: &Context,
    ) -> anyhow::Result<Outcome> {
        let mut settings = self.trajectory_settings()?;
        let units = self.hold_out.units(inputs, context)?;
        mention_finer_grids(inputs, context);
        let motions = motions(inputs, self.phases.slope_bandwidth)?;
        let (data, left_out) =
            TrajectoryData::new(motions.clone(), &units.of_drives).usable(&settings.direct)?;
        left_out::mention(&left_out, context);
        settings.folds = folds(settings.folds, &data, &left_out, context)?;
        let progress = Progress::new(context, "evaluating", settings.steps(&data));
        let mut evaluation = evaluate_trajectory(&data, vehicle, &settings, &|| progress.step())?;
        drop(progress);
        if context.no_times {
            forget_times(&mut evaluation);
        }
        for (model, reason) in &evaluation.left_out {
            output::note(context, &format!("`{model}` is left out: {reason}"));
        }
        let mut not_evaluated = BTreeMap::new();
        if !data.has_limits() {
            not_evaluated.insert("trials", without_limits(inputs));
        }
        let free_run_settings = FreeRunSettings {
            folds: Some(settings.folds),
            ..FreeRunSettings::default()
        };
        let free_runs = free_run::evaluate(&motions, &units.of_drives, &free_run_settings, vehicle);
        if let Err(reason) = &free_runs {
            not_evaluated.insert("free_run", reason.to_string());
        }
        for (part, reason) in &not_evaluated {
            output::note(context, &format!("no figures of {part}: {reason}"));
        }
        let free_runs = free_runs.ok();
        let mut body =
            document::Body::new(&data, &units, &settings, &evaluation, free_runs.as_ref());
        body.default_vehicle = self.vehicle.by_default();
        body.left_out_drives = &left_out;
        body.not_evaluated = not_evaluated;
        let mut document = Document::new("evaluate", self, inputs, body);
        let outcome = document.judged(&self.require)?;
        if let Some(path) = &self.report {
            let curve = free_runs
                .as_ref()
                .map(|runs| free_run::curve(&motions, runs));
            let curve = curve.transpose()?.flatten();
            let shown = document::with_curves(
                serde_json::to_value(&document)?,
                &data,
                &evaluation,
                curve.as_ref(),
            );
            let page = report::TRAJECTORY.filled(&shown);
            output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
            output::note(context, &format!("report written to {}", path.display()));
        }
        match context.format {
            Format::Json => output::print_json(&document)?,
            Format::Text => {
                output::print_text(&text::render(
                    self,
                    settings.folds,
                    &data,
                    &evaluation,
                    free_runs.as_ref(),
                ))?;
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

/// As many folds as asked for, or as there are units; one unit cannot be held out.
fn folds(
    asked: usize,
    data: &TrajectoryData,
    left_out: &[LeftOut],
    context: &Context,
) -> anyhow::Result<usize> {
    let units = data.hold_out.units();
    if units.len() < 2 {
        let reasons = left_out
            .iter()
            .map(|left_out| format!("\n  left out, {}: {}", left_out.log, left_out.reason));
        bail!(
            "one drive, file or driver, `{}`, is all that can be used, and nothing is left when it is held out; add logs{}",
            units.join(", "),
            reasons.collect::<String>()
        );
    }
    if units.len() < asked {
        output::note(
            context,
            &format!(
                "{} folds in place of {asked}: there are no more units",
                units.len()
            ),
        );
    }
    Ok(asked.min(units.len()))
}

/// Why the models do not know limits and the trials are left out.
fn without_limits(inputs: &[Input]) -> String {
    let pieces = || inputs.iter().flat_map(|input| &input.drive.pieces);
    let known = |log: &&DriveLog| {
        let limit_mps = log.channel(Channel::SpeedLimit);
        limit_mps.is_some_and(|limit| limit.iter().any(|limit| limit.is_finite()))
    };
    match pieces().filter(known).count() {
        0 => "no speed limits".to_owned(),
        some => format!(
            "speed limits in {some} of {}, less than half of the time or of one drive, so that no model is told of them; \
             give those logs alone to use them",
            plural(pieces().count(), "drive")
        ),
    }
}

/// Of fitting and predicting, which differ from run to run.
fn forget_times(evaluation: &mut TrajectoryEvaluation) {
    for row in &mut evaluation.rows {
        (row.fit_seconds, row.predict_seconds) = (f64::NAN, f64::NAN);
    }
    let trials = evaluation.trials.iter_mut();
    for fitted in trials.flat_map(|trial| &mut trial.fits) {
        fitted.fit.seconds = f64::NAN;
    }
}

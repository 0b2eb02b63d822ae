//! `evaluate --task trajectory`: the speed of the next seconds, and of whole trips from limits.

mod document;
mod free_run;
mod text;

use anyhow::bail;
use clap::Args;
use driver_model::FreeRunSettings;
use driver_model::trajectory::{
    DirectKind, DirectSettings, TrajectoryData, TrajectorySettings, evaluate_trajectory,
};
use ev_energy::Vehicle;
use serde::Serialize;

use super::{EvaluateArgs, EvaluatedModel};
use crate::cmd::courses::courses;
use crate::flags::{Context, Format};
use crate::inputs::Input;
use crate::output;
use crate::progress::Progress;
use crate::render::html;
use crate::render::json::Document;

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Trajectory")]
pub(super) struct TrajectoryArgs {
    /// Seconds ahead, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_name = "S")]
    horizons: Vec<f64>,
    /// Number of folds: every so many units are held out together
    #[arg(long, default_value_t = TrajectorySettings::default().folds, value_name = "N")]
    folds: usize,
    /// Let models know the slope ahead. Not with elevation recorded on the same drive: its errors tell where the car stood
    #[arg(long)]
    slope_ahead: bool,
    /// Most training samples of a model
    #[arg(long, default_value_t = DirectSettings::default().max_samples, value_name = "N")]
    max_samples: usize,
}

impl EvaluateArgs {
    /// Evaluates, prints, and returns the document.
    pub(super) fn evaluate_trajectory(
        &self,
        inputs: &[Input],
        vehicle: &Vehicle,
        context: &Context,
    ) -> anyhow::Result<serde_json::Value> {
        let settings = self.trajectory_settings()?;
        let data = self.trajectory_data(inputs, context)?;
        let progress = Progress::new(context, "evaluating", settings.steps(&data));
        let evaluation = evaluate_trajectory(&data, vehicle, &settings, &|| progress.step())?;
        drop(progress);
        for (model, reason) in &evaluation.left_out {
            output::note(context, &format!("`{model}` is left out: {reason}"));
        }
        if evaluation.trials.is_empty() {
            output::note(
                context,
                "no speed limits in some drive: the trials of the thesis are left out",
            );
        }
        let units = self.units(inputs);
        let free_run_settings = FreeRunSettings {
            folds: Some(settings.folds),
            slope_bandwidth_m: self.phases.settings().slope_bandwidth_m,
            ..FreeRunSettings::default()
        };
        let free_runs = free_run::evaluate(inputs, &units, &free_run_settings, vehicle)?;
        let body = document::Body::new(&data, &settings, &evaluation, free_runs.as_ref());
        let document = Document::new("evaluate", self, inputs, body);
        let figures = serde_json::to_value(&document)?;
        if let Some(path) = &self.report {
            let bandwidth_m = free_run_settings.slope_bandwidth_m;
            let curve = free_runs
                .as_ref()
                .map(|runs| free_run::curve(inputs, runs, bandwidth_m));
            let curve = curve.transpose()?.flatten();
            let shown = document::with_curves(figures.clone(), &data, &evaluation, curve.as_ref());
            let page = html::TRAJECTORY.filled(&shown);
            output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
            output::note(context, &format!("report written to {}", path.display()));
        }
        match context.format {
            Format::Json => output::print_json(&document)?,
            Format::Text => {
                output::print_text(&text::render(self, &data, &evaluation, free_runs.as_ref()))?;
            }
        }
        Ok(figures)
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
            let named: anyhow::Result<Vec<DirectKind>> = self
                .models
                .iter()
                .map(|model| match model {
                    EvaluatedModel::Direct(kind) => Ok(*kind),
                    EvaluatedModel::Phase(kind) => {
                        bail!("`{kind}` is a model of phases; leave out --task trajectory")
                    }
                })
                .collect();
            settings.models = named?;
        }
        Ok(settings)
    }

    fn trajectory_data(
        &self,
        inputs: &[Input],
        context: &Context,
    ) -> anyhow::Result<TrajectoryData> {
        let courses = courses(inputs, self.phases.settings().slope_bandwidth_m, context)?;
        Ok(TrajectoryData::new(courses, &self.units(inputs)))
    }

    fn units(&self, inputs: &[Input]) -> Vec<String> {
        inputs
            .iter()
            .map(|input| self.hold_out.unit_of(input))
            .collect()
    }
}

mod args;
mod update;

use anyhow::{Context as _, bail};
use driver_eval::behaviour::contents_of;
use driver_eval::model_words::fitted_words;
use driver_model::speed_ahead::DirectSettings;
use driver_model::{
    DriverModel, Error, FitSettings, Fitted, LeftOut, Manoeuvre, ModelFile, ModelKind, PhaseMemory,
    PointsOf, Prior, Subject, TrainingInput, TrainingRecord, find_behaviour, fit_with,
};
use serde::Serialize;

use super::left_out;
use super::motions::{mention_finer_grids, mention_limits, motions};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::{self, Input};
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::KnownFigures;
pub(crate) use args::FitArgs;
use args::{Phase, Points};
use update::Before;

pub(crate) fn run(args: &FitArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.check()?;
    args.require
        .check(&KnownFigures::new(include_str!("../../figures/fit.txt")))?;
    let before = args.update.as_deref().map(Before::read).transpose()?;
    let args = &match &before {
        Some(before) => before.completed(args)?,
        None => args.clone(),
    };
    let inputs = inputs::load_once(&args.logs, context)?;
    let inputs = match &before {
        Some(before) => before.new_among(inputs, context)?,
        None => inputs,
    };
    let prior_inputs = args.prior.inputs(&args.logs.reading, &inputs, context)?;
    let fitted = match &before {
        Some(before) => args.update(before, &inputs, context)?,
        None => args.fit(&inputs, &prior_inputs, context)?,
    };
    left_out::mention(&fitted.left_out, context);
    let mut record = TrainingRecord {
        phases: fitted.phases,
        points: fitted.points,
        inputs: hashes(&inputs),
        prior_inputs: hashes(&prior_inputs),
        prior_weight: fitted
            .memory
            .as_ref()
            .map_or(0.0, PhaseMemory::prior_weight),
        extent: args.extent,
    };
    if let Some(before) = &before {
        record = before.file.training.extended(record);
    }
    let config = serde_json::to_value(args)?;
    let file = ModelFile::new(fitted.model, record, config).with_memory(fitted.memory);
    let json = file.to_json()?;
    output::write_file(&args.output, |out| Ok(out.write_all(json.as_bytes())?))?;
    let body = Body {
        model: &file.model,
        training_phases: file.training.phases,
        training_points: file.training.points,
        remembered_phases: before.as_ref().map(|before| before.file.training.phases),
        residual_sum_of_squares: fitted.residual_sum_of_squares,
        left_out_drives: &fitted.left_out,
    };
    let mut document = Document::new("fit", args, &inputs, body).beside(&prior_inputs);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => {
            let words = fitted_words(
                &file,
                before.as_ref().map(|before| &before.file.training),
                fitted.residual_sum_of_squares,
            );
            output::print_text(&format!("{words}written to {}\n", args.output.display()))?;
        }
    }
    Ok(inputs::outcome(&inputs)
        .and(inputs::outcome(&prior_inputs))
        .and(outcome))
}

impl FitArgs {
    /// What is fitted; a file that is updated has completed it.
    fn kind(&self) -> anyhow::Result<ModelKind> {
        self.model.context("--model is missing")
    }

    fn update(&self, before: &Before, new: &[Input], context: &Context) -> anyhow::Result<Fitted> {
        let motions = motions(new, self.phases.slope_bandwidth)?;
        let progress = Progress::new(context, "fitting", new.len());
        let memory = before.file.remembered()?.clone();
        let finished = || progress.step();
        Ok(driver_model::update(
            self.kind()?,
            memory,
            &motions,
            &finished,
        )?)
    }

    fn fit(&self, own: &[Input], prior: &[Input], context: &Context) -> anyhow::Result<Fitted> {
        let (kind, settings) = (self.kind()?, self.settings());
        let motions = motions(own, self.phases.slope_bandwidth)?;
        let prior_motions = super::motions::motions(prior, self.phases.slope_bandwidth)?;
        if kind.subject() == Subject::SpeedAhead {
            mention_finer_grids(own, context);
        }
        if matches!(kind.subject(), Subject::SpeedAhead | Subject::Trips) {
            mention_limits(&motions, context);
        }
        let progress = Progress::new(context, "fitting", own.len() + prior.len());
        let finished = || progress.step();
        let prior = self.prior.is_given().then_some(Prior {
            motions: &prior_motions,
            weight: self.prior.weight(),
        });
        fit_with(kind, &motions, prior, &settings, &finished).map_err(|error| match error {
            Error::TooFewPhases { .. } | Error::TooFewStretches { .. } => {
                let trips = find_behaviour(&motions, &settings.phases, &|| {}).unwrap_or_default();
                let told = format!("{error}{}", contents_of(&trips));
                anyhow::Error::from(error).context(told)
            }
            error => error.into(),
        })
    }

    fn settings(&self) -> FitSettings {
        FitSettings {
            phases: self.phases.settings().reaching(self.extent),
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
        let Some(kind) = self.model else {
            return Ok(());
        };
        if self.to == Points::Samples && !kind.is_function_of_speed() {
            bail!(
                "--to samples: `{kind}` is fitted to phases; only inverse, exponential and \
                 exponential-amplitude are functions of speed"
            );
        }
        if self.prior.is_given() && kind.subject() != Subject::Phases {
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
    /// Those of before an update, `training_phases` included.
    remembered_phases: Option<usize>,
    residual_sum_of_squares: Option<f64>,
    /// Drives that the model could learn nothing from, with the reason.
    left_out_drives: &'a [LeftOut],
}

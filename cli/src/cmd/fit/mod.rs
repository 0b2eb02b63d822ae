mod args;
mod text;

use anyhow::bail;
use driver_eval::behaviour::contents_of;
use driver_model::speed_ahead::DirectSettings;
use driver_model::{
    DriverModel, Error, FitSettings, Fitted, LeftOut, Manoeuvre, ModelFile, PointsOf, Prior,
    Subject, TrainingInput, TrainingRecord, find_behaviour, fit_with,
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
        extent: args.extent,
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
        if matches!(self.model.subject(), Subject::SpeedAhead | Subject::Trips) {
            mention_limits(&motions, context);
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

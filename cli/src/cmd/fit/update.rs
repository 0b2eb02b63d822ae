//! More drives for a model that was fitted before.

use std::path::Path;

use anyhow::{Context as _, anyhow, bail};
use clap::{Args as _, FromArgMatches as _};
use driver_model::ModelFile;

use super::args::FitArgs;
use crate::flags::Context;
use crate::inputs::{Inputs, notes};

/// Settings that are not those of before.
const OF_NEW_LOGS: [&str; 4] = ["layout", "limit_map", "on_error", "update"];

/// What there was before.
pub(super) struct Before {
    pub(super) file: ModelFile,
    name: String,
}

impl Before {
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        let file = crate::cmd::model::read(path)?;
        file.remembered()
            .with_context(|| format!("--update `{}`", path.display()))?;
        let name = path.display().to_string();
        Ok(Self { file, name })
    }

    /// The flags with the configuration of the file for all but the new logs; what was given otherwise is refused.
    pub(super) fn completed(&self, args: &FitArgs) -> anyhow::Result<FitArgs> {
        if args.prior.is_given() {
            bail!(
                "--prior: the model keeps the other drivers that it has; leave it out, also of a configuration file"
            );
        }
        let asked = serde_json::to_value(FitArgs {
            update: None,
            ..args.clone()
        })?;
        let flags = (self.file).flags_again(&asked, &OF_NEW_LOGS, &args.given)?;
        let flags = ["fit", "--output=-"]
            .into_iter()
            .map(str::to_owned)
            .chain(flags);
        let command = FitArgs::augment_args(clap::Command::new("fit"));
        let matches = command.try_get_matches_from(flags);
        let mut completed = matches
            .and_then(|matches| FitArgs::from_arg_matches(&matches))
            .map_err(|error| anyhow!("`{}`, its `config`: {error}", self.name))?;
        completed.logs.logs.clone_from(&args.logs.logs);
        Ok(FitArgs {
            update: args.update.clone(),
            output: args.output.clone(),
            require: args.require.clone(),
            ..completed
        })
    }

    /// The logs that the model has not learnt yet.
    pub(super) fn new_among(&self, inputs: Inputs, context: &Context) -> anyhow::Result<Inputs> {
        let training = &self.file.training;
        let before = inputs.beside().twice.len();
        let new = inputs.without_learnt(&self.name, |sha256| training.has_learnt(sha256));
        notes::twice(&new.beside().twice[before..], context);
        if new.is_empty() {
            bail!("the model has learnt from all of these already");
        }
        if let Some(input) = new
            .iter()
            .find(|input| training.has_as_prior(&input.sha256))
        {
            bail!(
                "{} is among the logs of other drivers that the model has learnt from; fit it anew",
                input.label()
            );
        }
        Ok(new)
    }
}

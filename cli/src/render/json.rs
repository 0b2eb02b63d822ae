//! The frame that every JSON document shares.

use serde::Serialize;

use crate::exit::Outcome;
use crate::inputs::{Input, InputEntry};
use crate::require::{Judged, RequireArgs};

/// `schema`, `version`, `config`, `inputs`, then whatever the subcommand has to say.
#[derive(Debug, Serialize)]
pub(crate) struct Document<'a, C, B> {
    schema: String,
    version: &'static str,
    config: &'a C,
    inputs: Vec<InputEntry<'a>>,
    #[serde(flatten)]
    pub(crate) body: B,
    /// Of `--require`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    requirements: Vec<Judged>,
}

impl<'a, C: Serialize, B: Serialize> Document<'a, C, B> {
    pub(crate) fn new(subcommand: &str, config: &'a C, inputs: &'a [Input], body: B) -> Self {
        Self {
            schema: format!("drivekit/{subcommand}/1"),
            version: env!("CARGO_PKG_VERSION"),
            config,
            inputs: inputs.iter().map(Input::entry).collect(),
            body,
            requirements: Vec::new(),
        }
    }

    /// Lists what became of the requirements, and how the run ends for them.
    pub(crate) fn judged(&mut self, require: &RequireArgs) -> anyhow::Result<Outcome> {
        let (requirements, outcome) = require.judge(&*self)?;
        self.requirements = requirements;
        Ok(outcome)
    }
}

/// A body with one entry per log, in input order.
#[derive(Debug, Serialize)]
pub(crate) struct Logs<T> {
    pub(crate) logs: Vec<T>,
}

//! The frame that every JSON document shares.

use serde::Serialize;

use crate::exit::Outcome;
use crate::inputs::files::{FileInput, FileInputs};
use crate::inputs::{Beside, Input, InputEntry, Inputs};
use crate::require::{Judged, RequireArgs};

/// `schema`, `version`, `config`, `inputs`, then whatever the subcommand has to say.
#[derive(Debug, Serialize)]
pub(crate) struct Document<'a, C, B> {
    schema: String,
    version: &'static str,
    config: &'a C,
    #[serde(flatten)]
    listing: Listing<'a>,
    #[serde(flatten)]
    pub(crate) body: B,
    /// Of `--require`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    requirements: Vec<Judged>,
}

impl<'a, C: Serialize, B: Serialize> Document<'a, C, B> {
    pub(crate) fn new(
        subcommand: &str,
        config: &'a C,
        inputs: impl Into<Listing<'a>>,
        body: B,
    ) -> Self {
        Self {
            schema: format!("drivekit/{subcommand}/1"),
            version: env!("CARGO_PKG_VERSION"),
            config,
            listing: inputs.into(),
            body,
            requirements: Vec::new(),
        }
    }

    /// With what was not read of the logs of others.
    pub(crate) fn beside(mut self, others: &Inputs) -> Self {
        self.listing.files = self.listing.files.map(|files| files.with(others.beside()));
        self
    }

    /// Lists what became of the requirements, and how the run ends for them.
    pub(crate) fn judged(&mut self, require: &RequireArgs) -> anyhow::Result<Outcome> {
        let (requirements, outcome) = require.judge(&*self)?;
        self.requirements = requirements;
        Ok(outcome)
    }
}

/// What was read, and in `files` what was not.
#[derive(Debug, Serialize)]
pub(crate) struct Listing<'a> {
    inputs: Vec<Entry<'a>>,
    /// `None` for subcommands that read no logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    files: Option<Beside>,
}

/// A log, or any other file.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Entry<'a> {
    Log(InputEntry<'a>),
    File(&'a FileInput),
}

impl<'a> From<&'a FileInputs> for Listing<'a> {
    fn from(inputs: &'a FileInputs) -> Self {
        Self {
            inputs: inputs.entries().iter().map(Entry::File).collect(),
            files: None,
        }
    }
}

impl<'a> From<&'a Inputs> for Listing<'a> {
    fn from(inputs: &'a Inputs) -> Self {
        Self {
            inputs: inputs.iter().map(Input::entry).map(Entry::Log).collect(),
            files: Some(inputs.beside().clone()),
        }
    }
}

impl From<&[Input; 0]> for Listing<'_> {
    fn from(_: &[Input; 0]) -> Self {
        Self {
            inputs: Vec::new(),
            files: None,
        }
    }
}

/// A body with one entry per log, in input order.
#[derive(Debug, Serialize)]
pub(crate) struct Logs<T> {
    pub(crate) logs: Vec<T>,
}

//! Flags for logs of other drivers, shared by `fit` and `evaluate`.

use std::path::PathBuf;

use clap::Args;
use driver_eval::phase::DEFAULT_PRIOR_WEIGHT;
use serde::Serialize;

use crate::flags::{Context, LogArgs, ReadingArgs};
use crate::inputs::{self, Input, Inputs};
use crate::numbers;

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Other drivers")]
pub(crate) struct PriorArgs {
    /// Logs of other drivers to learn from as well; a file, folder or glob, may be repeated
    #[arg(long, value_name = "LOG")]
    #[serde(skip)]
    prior: Vec<PathBuf>,
    /// Weight of a phase of other drivers beside 1 for an own one; 0 is the own data alone, 1 treats all alike
    #[arg(long, default_value_t = DEFAULT_PRIOR_WEIGHT, value_parser = numbers::weight, value_name = "W")]
    pub(super) prior_weight: f64,
}

impl PriorArgs {
    pub(crate) fn is_given(&self) -> bool {
        !self.prior.is_empty()
    }

    pub(crate) fn weight(&self) -> f64 {
        self.prior_weight
    }

    /// The logs of other drivers, none where none are named; a drive that is an own one too is left out.
    pub(crate) fn inputs(
        &self,
        reading: &ReadingArgs,
        own: &[Input],
        context: &Context,
    ) -> anyhow::Result<Inputs> {
        if self.prior.is_empty() {
            return Ok(Inputs::default());
        }
        let logs = LogArgs {
            logs: self.prior.clone(),
            reading: reading.clone(),
        };
        inputs::load_others(&logs, own, context)
    }
}

//! What the drives have too little of to be evaluated.

use std::collections::BTreeMap;

use driver_eval::Error;
use driver_model::{Error as ModelError, LeftOut, Trip};
use serde::Serialize;

use crate::cmd::left_out::{contents, contents_of};
use crate::flags::Context;
use crate::output;

/// Everything that an evaluation of phases may have figures of.
const PARTS: usize = 4;

/// Parts without figures, with the reason.
#[derive(Debug, Default, Serialize)]
#[serde(transparent)]
pub(super) struct Missing {
    parts: BTreeMap<&'static str, String>,
}

impl Missing {
    /// Evaluates one part; one that there is too little for is noted, and the others go on.
    pub(super) fn unless_enough<T>(
        &mut self,
        part: &'static str,
        evaluate: impl FnOnce() -> Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        match evaluate() {
            Err(Error::Model(
                error @ (ModelError::TooFewPhases { .. }
                | ModelError::TooFewStretches { .. }
                | ModelError::Fit { .. }),
            )) => {
                self.parts.insert(part, error.to_string());
                Ok(None)
            }
            evaluation => evaluation.map(Some),
        }
    }

    pub(super) fn is_everything(&self) -> bool {
        self.parts.len() == PARTS
    }

    pub(super) fn mention(&self, context: &Context) {
        for (part, reason) in &self.parts {
            output::note(context, &format!("no figures of {part}: {reason}"));
        }
    }

    /// The error of drives that have nothing to evaluate.
    pub(super) fn into_error(self, trips: &[Trip]) -> anyhow::Error {
        let parts = self
            .parts
            .iter()
            .map(|(part, reason)| format!("\n  {part}: {reason}"));
        let parts = parts.collect::<String>();
        anyhow::anyhow!("nothing to evaluate{parts}{}", contents_of(trips))
    }
}

/// Drives without a phase or stretch that counts.
pub(super) fn without_anything(trips: &[Trip]) -> Vec<LeftOut> {
    let empty = |trip: &&Trip| {
        trip.phases.is_empty() && trip.cruise.is_empty() && trip.following.is_empty()
    };
    let left_out = |trip: &Trip| LeftOut {
        log: trip.name.clone(),
        reason: contents(trip),
    };
    trips.iter().filter(empty).map(left_out).collect()
}

use std::collections::BTreeMap;

use driver_model::{DriveBehaviour, Error as ModelError};

use super::contents::contents_of;
use crate::Error;

/// Everything that an evaluation of phases may have figures of.
const PARTS: usize = 4;

/// Parts without figures, with the reason.
#[derive(Debug, Default)]
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

    /// The parts.
    pub(super) fn into_parts(self) -> BTreeMap<&'static str, String> {
        self.parts
    }

    /// The parts, or the error of drives that have nothing to evaluate.
    pub(super) fn unless_everything(
        self,
        trips: &[DriveBehaviour],
    ) -> Result<BTreeMap<&'static str, String>, Error> {
        if self.parts.len() < PARTS {
            return Ok(self.parts);
        }
        let parts = self.parts.iter();
        let parts = parts.map(|(part, reason)| format!("\n  {part}: {reason}"));
        Err(Error::Nothing {
            parts: parts.collect(),
            contents: contents_of(trips),
        })
    }
}

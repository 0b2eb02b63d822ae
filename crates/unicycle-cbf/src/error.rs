//! What can be wrong with settings and scenarios.

use crate::path::PathError;

/// A setting, path or scenario that cannot be used, with the offending value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that has to be positive and finite
    #[error("`{name}` is {value}; it must be positive and finite")]
    NotPositive {
        /// Name of the setting
        name: &'static str,
        /// What was given
        value: f64,
    },
    /// A number outside of its range
    #[error("`{name}` is {value}; it must be from {least} to {most}")]
    OutOfRange {
        /// Name of the setting
        name: &'static str,
        /// What was given
        value: f64,
        /// Least allowed value
        least: f64,
        /// Largest allowed value
        most: f64,
    },
    /// A number that is likely to be in another unit
    #[error("`{name}` is {value}; it must be {believed}: {help}")]
    Unit {
        /// Name of the setting
        name: &'static str,
        /// What was given
        value: f64,
        /// The range in which it is believed, in words
        believed: String,
        /// Which unit it is in, and which one it may be
        help: &'static str,
    },
    /// Settings that contradict each other
    #[error("{what}")]
    Contradiction {
        /// What contradicts what, and what to do
        what: String,
    },
    /// A scenario that no speed fits
    #[error("{what}")]
    DoesNotFit {
        /// What is needed and what there is, and what to do
        what: String,
    },
    /// A path that is none
    #[error("path: {0}")]
    Path(#[from] PathError),
    /// No built-in scenario has the name
    #[error("no scenario `{name}` for this testbed; there are {known}")]
    UnknownScenario {
        /// What was asked for
        name: String,
        /// All names
        known: String,
    },
    /// A robot that starts where it must not
    #[error("robot {robot} {what}")]
    Start {
        /// Index from the front, the first leader is 0
        robot: usize,
        /// What is wrong with its place, with the figures
        what: String,
    },
}

impl Error {
    pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }

    pub(crate) fn within(
        name: &'static str,
        value: f64,
        least: f64,
        most: f64,
    ) -> Result<(), Self> {
        if (least..=most).contains(&value) {
            Ok(())
        } else {
            Err(Self::OutOfRange {
                name,
                value,
                least,
                most,
            })
        }
    }
}

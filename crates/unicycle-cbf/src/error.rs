//! What can be wrong with settings and scenarios.

use std::fmt::{Display, Formatter};

use crate::path::PathError;

/// Beyond this numbers are written with an exponent.
const LONG: f64 = 1e9;

/// A number, however large, in a few digits.
pub(crate) struct Plain(pub(crate) f64);

/// From the first to the second, which may be any.
struct Between(f64, f64);

impl Display for Plain {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        if self.0.abs() < LONG {
            return write!(out, "{}", self.0);
        }
        write!(out, "{:e}", self.0)
    }
}

impl Display for Between {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        let Self(least, most) = *self;
        if most >= f64::MAX {
            return write!(out, "at least {}", Plain(least));
        }
        write!(out, "from {} to {}", Plain(least), Plain(most))
    }
}

/// A setting, path or scenario that cannot be used, with the offending value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that has to be positive and finite
    #[error("`{name}` is {}; it must be positive and finite", Plain(*value))]
    NotPositive {
        /// Name of the setting
        name: &'static str,
        /// What was given
        value: f64,
    },
    /// A number outside of its range
    #[error("`{name}` is {}; it must be {}", Plain(*value), Between(*least, *most))]
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
    #[error("`{name}` is {}; it must be {believed}: {help}", Plain(*value))]
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

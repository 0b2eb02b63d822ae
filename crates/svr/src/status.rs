use serde::{Deserialize, Serialize};

/// How a solver ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[must_use]
pub enum Status {
    /// Within the tolerance.
    Optimal,
    /// Stopped by the number of iterations; gap and residual say how far off.
    IterationLimit,
    /// Stopped by the clock.
    TimeLimit,
    /// No progress any more, at the limit of the arithmetic. Scale the predictors.
    Stalled,
}

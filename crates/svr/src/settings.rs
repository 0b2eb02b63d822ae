use serde::{Deserialize, Serialize};

use crate::quantile::hazen;
use crate::{Error, Kernel};

/// What to fit, and how. The default is a linear model of standardised predictors with MATLAB's penalties.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Linear, or what takes the place of the scalar product.
    pub kernel: Kernel,
    /// Divides predictors; none is [`Kernel::default_scale`].
    pub kernel_scale: Option<f64>,
    /// Of the predictors.
    pub predictor_scaling: Scaling,
    /// Multiply scaled predictors, so that a difference in one counts more to a kernel than in another. Empty, or one per
    /// predictor.
    pub predictor_weights: Vec<f64>,
    /// Of the response. Penalties apply to the scaled response.
    pub response_scaling: Scaling,
    /// When a kernel is approximated.
    pub landmarks: Landmarks,
    /// Kernel rows, landmarks and copies of the predictors stay under it; what the caller holds is not counted. 1.1 GB.
    pub memory_limit_bytes: usize,
    /// When a solver stops.
    pub stopping: Stopping,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            kernel: Kernel::Linear,
            kernel_scale: None,
            predictor_scaling: Scaling::Standardize,
            predictor_weights: Vec::new(),
            response_scaling: Scaling::None,
            landmarks: Landmarks::Auto,
            memory_limit_bytes: 1_100_000_000,
            stopping: Stopping::default(),
        }
    }
}

/// How predictors or responses are brought to a common scale before fitting.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scaling {
    /// As they are.
    None,
    /// Mean 0 and standard deviation 1 (divisor n − 1).
    #[default]
    Standardize,
    /// Least value −1, greatest 1.
    Range,
}

/// Whether a kernel is replaced by a linear model on as many features as there are landmarks (Nyström's method).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Landmarks {
    /// 512 landmarks beyond 100,000 samples, none up to that.
    #[default]
    Auto,
    /// Never.
    Never,
    /// As many as this, drawn from the samples with the seed.
    Count(usize),
}

/// When a solver stops. None of it is the width of the tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stopping {
    /// Linear: duality gap as a share of the objective, 10⁻⁸ when none is given. Kernel: by how much a pair of samples may
    /// violate optimality, in units of the (scaled) response, 10⁻³ when none is given.
    pub tolerance: Option<f64>,
    /// Linear: Newton steps. Kernel: pairs moved, and Newton steps between. 10 million.
    pub max_iterations: usize,
    /// Wall clock, checked between steps; none.
    pub time_limit_s: Option<f64>,
}

impl Default for Stopping {
    fn default() -> Self {
        Self {
            tolerance: None,
            max_iterations: 10_000_000,
            time_limit_s: None,
        }
    }
}

impl Stopping {
    pub(crate) fn tolerance(&self, kernel: Kernel) -> f64 {
        self.tolerance
            .unwrap_or(if kernel == Kernel::Linear { 1e-8 } else { 1e-3 })
    }
}

/// What errors cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Penalty {
    /// `C` of (4.17); none is `iqr(y)/1.349`, or 1 where that is 0.
    pub box_constraint: Option<f64>,
    /// Half width of the tube in which errors cost nothing; none is `iqr(y)/13.49`, or 0.1 where that is 0.
    pub tube_epsilon: Option<f64>,
}

/// Penalties as a fit used them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct UsedPenalty {
    /// `C` of (4.17).
    pub box_constraint: f64,
    /// Half width of the tube.
    pub tube_epsilon: f64,
}

impl Penalty {
    /// MATLAB's defaults where nothing is given, for a response on the scale on which it is fitted.
    ///
    /// # Errors
    /// [`Error::Setting`] for a box constraint that is not positive or a tube that is negative.
    pub fn resolve(&self, response: &[f64]) -> Result<UsedPenalty, Error> {
        let spread = hazen(response, 0.75) - hazen(response, 0.25);
        let or = |divisor: f64, fallback: f64| {
            if spread > 0.0 {
                spread / divisor
            } else {
                fallback
            }
        };
        let used = UsedPenalty {
            box_constraint: self.box_constraint.unwrap_or_else(|| or(1.349, 1.0)),
            tube_epsilon: self.tube_epsilon.unwrap_or_else(|| or(13.49, 0.1)),
        };
        let (c, epsilon) = (used.box_constraint, used.tube_epsilon);
        Error::unless(
            c.is_finite() && c > 0.0,
            "box_constraint",
            c,
            "positive and finite",
        )?;
        Error::unless(
            epsilon.is_finite() && epsilon >= 0.0,
            "tube_epsilon",
            epsilon,
            "finite and at least 0",
        )?;
        Ok(used)
    }
}

impl Settings {
    pub(crate) fn check(&self, predictors: usize) -> Result<(), Error> {
        let weights = &self.predictor_weights;
        if !weights.is_empty() && weights.len() != predictors {
            return Err(Error::Length {
                what: "predictor weights",
                found: weights.len(),
                expected: predictors,
            });
        }
        if let Some(&weight) = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
            return Err(Error::Setting {
                name: "a predictor weight",
                value: weight,
                must_be: "finite and at least 0",
            });
        }
        if let Some(scale) = self.kernel_scale {
            Error::unless(
                scale.is_finite() && scale > 0.0,
                "kernel_scale",
                scale,
                "positive and finite",
            )?;
        }
        let tolerance = self.stopping.tolerance(self.kernel);
        Error::unless(
            tolerance.is_finite() && tolerance > 0.0,
            "tolerance",
            tolerance,
            "positive and finite",
        )?;
        if let Some(limit) = self.stopping.time_limit_s {
            Error::unless(limit >= 0.0, "time_limit_s", limit, "at least 0 s")?;
        }
        if let Landmarks::Count(count) = self.landmarks {
            Error::unless(count >= 1, "landmarks", count as f64, "at least 1")?;
        }
        Ok(())
    }
}

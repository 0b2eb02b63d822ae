use serde::{Deserialize, Serialize};

use crate::vectorised::{exp_f32, exp_f64, vectorised};

/// What takes the place of the scalar product; `s` is the kernel scale, which divides predictors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// `x·z/s²`.
    Linear,
    /// `(1 + x·z/s²)²`.
    Quadratic,
    /// `(1 + x·z/s²)³`.
    Cubic,
    /// `exp(−‖x − z‖²/s²)`.
    Rbf,
}

impl Kernel {
    /// The scale when none is given, for `d` standardised predictors: 1 for the linear kernel, √d for the others. (MATLAB's
    /// `fitrsvm` takes 1 for polynomials, too; with a hundred predictors ours does not converge in 10 million steps.)
    #[must_use]
    pub fn default_scale(self, predictors: usize) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Quadratic | Self::Cubic | Self::Rbf => (predictors as f64).sqrt(),
        }
    }

    /// Turns products `x·z` of one scaled `x` with many scaled `z` into kernel values; `own` is `x·x`, `others` the `z·z`.
    pub(crate) fn apply_f64(self, products: &mut [f64], own: f64, others: &[f64]) {
        vectorised(
            #[inline(always)]
            || match self {
                Self::Linear => {}
                Self::Quadratic => products
                    .iter_mut()
                    .for_each(|p| *p = (1.0 + *p) * (1.0 + *p)),
                Self::Cubic => products
                    .iter_mut()
                    .for_each(|p| *p = (1.0 + *p) * (1.0 + *p) * (1.0 + *p)),
                Self::Rbf => {
                    for (p, other) in products.iter_mut().zip(others) {
                        *p = exp_f64((2.0 * *p - own - other).min(0.0));
                    }
                }
            },
        );
    }

    /// As [`Self::apply_f64`], in single precision.
    pub(crate) fn apply_f32(self, products: &mut [f32], own: f32, others: &[f32]) {
        vectorised(
            #[inline(always)]
            || match self {
                Self::Linear => {}
                Self::Quadratic => products
                    .iter_mut()
                    .for_each(|p| *p = (1.0 + *p) * (1.0 + *p)),
                Self::Cubic => products
                    .iter_mut()
                    .for_each(|p| *p = (1.0 + *p) * (1.0 + *p) * (1.0 + *p)),
                Self::Rbf => {
                    for (p, other) in products.iter_mut().zip(others) {
                        *p = exp_f32((2.0 * *p - own - other).min(0.0));
                    }
                }
            },
        );
    }

    /// `K(x, x)` of a scaled `x` with `x·x = square`.
    pub(crate) fn own_value(self, square: f64) -> f64 {
        match self {
            Self::Linear => square,
            Self::Quadratic => (1.0 + square).powi(2),
            Self::Cubic => (1.0 + square).powi(3),
            Self::Rbf => 1.0,
        }
    }
}

use serde::{Deserialize, Serialize};

use crate::expansion::add_expansion;
use crate::scaler::Scaler;
use crate::{Error, Kernel, Samples};

/// `f(x)`: `w·x' + b` for the linear kernel, `Σ β_j K(x', v_j) + b` for the others, with `x'` the scaled predictors; the
/// result is brought back to the scale of the response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawModel")]
pub struct Model {
    kernel: Kernel,
    kernel_scale: f64,
    predictors: Scaler,
    response: Scaler,
    /// One per predictor for the linear kernel, one per support vector for the others.
    coefficients: Vec<f64>,
    /// Scaled, row by row; none for the linear kernel.
    support_vectors: Vec<f64>,
    bias: f64,
}

/// A model as a file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawModel {
    kernel: Kernel,
    kernel_scale: f64,
    predictors: Scaler,
    response: Scaler,
    coefficients: Vec<f64>,
    support_vectors: Vec<f64>,
    bias: f64,
}

impl TryFrom<RawModel> for Model {
    type Error = Error;

    fn try_from(raw: RawModel) -> Result<Self, Error> {
        let RawModel {
            kernel,
            kernel_scale,
            predictors,
            response,
            coefficients,
            support_vectors,
            bias,
        } = raw;
        Self {
            kernel,
            kernel_scale,
            predictors,
            response,
            coefficients,
            support_vectors,
            bias,
        }
        .checked()
    }
}

impl Model {
    #[expect(clippy::too_many_arguments, reason = "the fields")]
    pub(crate) fn new(
        kernel: Kernel,
        kernel_scale: f64,
        predictors: Scaler,
        response: Scaler,
        coefficients: Vec<f64>,
        support_vectors: Vec<f64>,
        bias: f64,
    ) -> Self {
        Self {
            kernel,
            kernel_scale,
            predictors,
            response,
            coefficients,
            support_vectors,
            bias,
        }
    }

    fn checked(self) -> Result<Self, Error> {
        self.predictors.check()?;
        self.response.check()?;
        let d = self.predictors.columns();
        let sizes = match self.kernel {
            Kernel::Linear => self.coefficients.len() == d && self.support_vectors.is_empty(),
            _ => self.coefficients.len().checked_mul(d) == Some(self.support_vectors.len()),
        };
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !sizes {
            return Err(Error::Model("coefficients do not fit the predictors"));
        }
        if self.response.columns() != 1 {
            return Err(Error::Model("there is more than one response"));
        }
        if !(self.kernel_scale.is_finite() && self.kernel_scale > 0.0) {
            return Err(Error::Model("the kernel scale is not positive"));
        }
        if !(finite(&self.coefficients) && finite(&self.support_vectors) && self.bias.is_finite()) {
            return Err(Error::Model("a coefficient is not finite"));
        }
        Ok(self)
    }

    /// The kernel.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// What divides the scaled predictors.
    #[must_use]
    pub fn kernel_scale(&self) -> f64 {
        self.kernel_scale
    }

    /// Number of predictors.
    #[must_use]
    pub fn predictors(&self) -> usize {
        self.predictors.columns()
    }

    /// `b`, on the scale of the fitted response.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.bias
    }

    /// `w` for the linear kernel, `β` of the support vectors for the others.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// One value per sample, by blocks of matrix products.
    ///
    /// # Errors
    /// [`Error::Length`] where the samples have another number of predictors.
    pub fn predict(&self, samples: &Samples<'_>) -> Result<Vec<f64>, Error> {
        if samples.predictors() != self.predictors() {
            return Err(Error::Length {
                what: "predictors",
                found: samples.predictors(),
                expected: self.predictors(),
            });
        }
        let mut values = vec![self.bias; samples.len()];
        if self.kernel == Kernel::Linear {
            let columns: Vec<_> = self.predictors.columns_scaled(self.kernel_scale).collect();
            for (value, row) in values.iter_mut().zip(samples.rows()) {
                let terms = row.iter().zip(&columns).zip(&self.coefficients);
                *value += terms
                    .map(|((x, (offset, factor)), w)| (x - offset) * factor * w)
                    .sum::<f64>();
            }
        } else {
            let scaled = self.predictors.scale(samples, self.kernel_scale);
            add_expansion(
                self.kernel,
                self.predictors(),
                &scaled,
                &self.support_vectors,
                &self.coefficients,
                &mut values,
            );
        }
        self.response.restore(&mut values);
        Ok(values)
    }
}

use serde::{Deserialize, Serialize};

use crate::expansion::{add_expansion, dot};
use crate::quadratic_form::QuadraticForm;
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
        self.predictor().predict(samples)
    }

    /// The model made ready for many predictions, one after the other.
    #[must_use]
    pub fn predictor(&self) -> Predictor<'_> {
        let d = self.predictors();
        let written_out = self.kernel == Kernel::Quadratic && self.coefficients.len() > d;
        Predictor {
            model: self,
            columns: self.predictors.columns_scaled(self.kernel_scale).collect(),
            form: written_out
                .then(|| QuadraticForm::new(d, &self.support_vectors, &self.coefficients)),
        }
    }
}

/// A [`Model`] with what its predictions share computed once.
pub struct Predictor<'a> {
    model: &'a Model,
    columns: Vec<(f64, f64)>,
    form: Option<QuadraticForm>,
}

impl Predictor<'_> {
    /// As [`Model::predict`].
    ///
    /// # Errors
    /// [`Error::Length`] where the samples have another number of predictors.
    pub fn predict(&self, samples: &Samples<'_>) -> Result<Vec<f64>, Error> {
        let model = self.model;
        let d = self.columns.len();
        if samples.predictors() != d {
            return Err(Error::Length {
                what: "predictors",
                found: samples.predictors(),
                expected: d,
            });
        }
        let mut values = vec![model.bias; samples.len()];
        let mut scaled = Vec::with_capacity(samples.values().len());
        for row in samples.rows() {
            scaled.extend(
                row.iter()
                    .zip(&self.columns)
                    .map(|(x, (offset, factor))| (x - offset) * factor),
            );
        }
        match (&self.form, model.kernel) {
            (Some(form), _) => form.add(&scaled, &mut values),
            (None, Kernel::Linear) => {
                for (value, row) in values.iter_mut().zip(scaled.chunks_exact(d)) {
                    *value += dot(row, &model.coefficients);
                }
            }
            (None, kernel) => {
                add_expansion(
                    kernel,
                    d,
                    &scaled,
                    &model.support_vectors,
                    &model.coefficients,
                    &mut values,
                );
            }
        }
        model.response.restore(&mut values);
        Ok(values)
    }
}

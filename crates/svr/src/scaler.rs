use serde::{Deserialize, Serialize};

use crate::{Error, Kernel, Samples, Scaling, Settings};

/// `x' = (x − offset)·factor` per column. A column that is constant in training gets factor 0: it says nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaler {
    offset: Vec<f64>,
    factor: Vec<f64>,
}

/// Spread under this share of the largest magnitude is rounding.
const NO_SPREAD: f64 = 1e-12;

impl Scaler {
    /// Learns the scale of every column.
    #[must_use]
    pub fn learn(samples: &Samples<'_>, scaling: Scaling) -> Self {
        let d = samples.predictors();
        if scaling == Scaling::None {
            return Self {
                offset: vec![0.0; d],
                factor: vec![1.0; d],
            };
        }
        let (offset, spread) = match scaling {
            Scaling::Range => centre_and_half_range(samples),
            _ => mean_and_deviation(samples),
        };
        let mut magnitude = vec![0.0_f64; d];
        for row in samples.rows() {
            for (magnitude, x) in magnitude.iter_mut().zip(row) {
                *magnitude = magnitude.max(x.abs());
            }
        }
        let factor = spread.iter().zip(&magnitude);
        let factor = factor.map(|(&spread, &magnitude)| {
            if spread > NO_SPREAD * magnitude {
                1.0 / spread
            } else {
                0.0
            }
        });
        let factor = factor.collect();
        Self { offset, factor }
    }

    /// Of predictors, weighted as the settings say.
    pub(crate) fn of(samples: &Samples<'_>, settings: &Settings) -> Self {
        let mut scaler = Self::learn(samples, settings.predictor_scaling);
        if settings.kernel == Kernel::Rbf && settings.predictor_scaling == Scaling::None {
            // Distances stay what they are, and far from the origin single precision would not hold them.
            scaler.offset = mean_and_deviation(samples).0;
        }
        for (factor, weight) in scaler.factor.iter_mut().zip(&settings.predictor_weights) {
            *factor *= weight;
        }
        scaler
    }

    /// The only column as it is.
    pub(crate) fn identity() -> Self {
        Self {
            offset: vec![0.0],
            factor: vec![1.0],
        }
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.offset.len()
    }

    /// Scales rows; `extra` divides every column besides.
    pub(crate) fn scale(&self, samples: &Samples<'_>, extra: f64) -> Vec<f64> {
        let columns: Vec<(f64, f64)> = self.columns_scaled(extra).collect();
        let rows = samples.rows().flat_map(|row| row.iter().zip(&columns));
        rows.map(|(x, (offset, factor))| (x - offset) * factor)
            .collect()
    }

    pub(crate) fn columns_scaled(&self, extra: f64) -> impl Iterator<Item = (f64, f64)> {
        let columns = self.offset.iter().zip(&self.factor);
        columns.map(move |(&offset, &factor)| (offset, factor / extra))
    }

    /// Scales values of the only column.
    pub(crate) fn scale_values(&self, values: &[f64]) -> Vec<f64> {
        let (offset, factor) = (self.offset[0], self.factor[0]);
        values.iter().map(|y| (y - offset) * factor).collect()
    }

    /// Undoes [`Self::scale_values`]; a constant comes back as the constant.
    pub(crate) fn restore(&self, values: &mut [f64]) {
        let (offset, factor) = (self.offset[0], self.factor[0]);
        for y in values {
            *y = if factor > 0.0 {
                offset + *y / factor
            } else {
                offset
            };
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        let positive = self.factor.iter().all(|&factor| factor >= 0.0);
        if self.offset.is_empty() || self.offset.len() != self.factor.len() {
            return Err(Error::Model(
                "offsets and factors of the scale differ in number",
            ));
        }
        if !(finite(&self.offset) && finite(&self.factor) && positive) {
            return Err(Error::Model("a scale is not finite or negative"));
        }
        Ok(())
    }
}

fn mean_and_deviation(samples: &Samples<'_>) -> (Vec<f64>, Vec<f64>) {
    let (n, d) = (samples.len() as f64, samples.predictors());
    let mut mean = vec![0.0; d];
    for row in samples.rows() {
        for (mean, x) in mean.iter_mut().zip(row) {
            *mean += x / n;
        }
    }
    let mut square = vec![0.0; d];
    for row in samples.rows() {
        for ((square, mean), x) in square.iter_mut().zip(&mean).zip(row) {
            *square += (x - mean) * (x - mean);
        }
    }
    let freedom = (n - 1.0).max(1.0);
    let deviation = square.iter().map(|square| (square / freedom).sqrt());
    let deviation = deviation.collect();
    (mean, deviation)
}

fn centre_and_half_range(samples: &Samples<'_>) -> (Vec<f64>, Vec<f64>) {
    let mut range = vec![(f64::INFINITY, f64::NEG_INFINITY); samples.predictors()];
    for row in samples.rows() {
        for ((low, high), &x) in range.iter_mut().zip(row) {
            *low = low.min(x);
            *high = high.max(x);
        }
    }
    // Halves first, so that the sum of two large numbers does not overflow.
    let centre = |(low, high)| 0.5 * low + 0.5 * high;
    let half = |(low, high)| 0.5 * high - 0.5 * low;
    (
        range.iter().copied().map(centre).collect(),
        range.iter().copied().map(half).collect(),
    )
}

//! Ridge regression on Gaussian bumps around a few of the training points (subset of regressors, Smola and Schölkopf 2000).
//!
//! With features `x` standardised to mean 0 and deviation 1, `k_j(x) = exp(−|x − c_j|²/(2 d))` in `d` dimensions, and responses `y`
//! of several columns less their mean, the coefficients minimise `Σ_i w_i |y_i − Cᵀk(x_i)|² + λ tr(CᵀK C)`, `K_ij = k_j(c_i)`:
//! the mean of a Gaussian process whose covariance is replaced by its projection on the centres.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::{Deserialize, Serialize};

/// Most features that a basis takes.
pub(super) const MAX_FEATURES: usize = 12;

/// Features of a phase; NaN where unknown, which counts as the mean.
pub(super) type Features = [f64; MAX_FEATURES];

/// Centres: more gain less than 0.01 km/h on recorded phases.
const CENTRES: usize = 128;

/// `λ`, the variance of what the features do not tell over that of what they do. Errors hardly depend on it between 0.3 and 1.
const NOISE: f64 = 0.6;

/// Bumps over standardised features.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaussianBasis {
    /// Mean of each feature.
    pub mean: Vec<f64>,
    /// Standard deviation of each feature, above 0.
    pub deviation: Vec<f64>,
    /// Centres in standardised features.
    pub centres: Vec<Vec<f64>>,
}

impl GaussianBasis {
    /// Chooses centres among the first `dimensions` features of phases.
    pub(super) fn choose(features: &[Features], weights: &[f64], dimensions: usize) -> Self {
        let moments: Vec<(f64, f64)> = (0..dimensions)
            .map(|d| moments(&features.iter().map(|f| f[d]).collect::<Vec<_>>(), weights))
            .collect();
        let mut basis = Self {
            mean: moments.iter().map(|m| m.0).collect(),
            deviation: moments.iter().map(|m| m.1).collect(),
            centres: Vec::new(),
        };
        let points: Vec<Vec<f64>> = features
            .iter()
            .map(|f| basis.standardised(f)[..dimensions].to_vec())
            .collect();
        basis.centres = spread_out(&points);
        basis
    }

    /// The bumps at a point.
    pub(super) fn values(&self, features: &Features) -> Vec<f64> {
        let point = self.standardised(features);
        let bump = |centre: &Vec<f64>| bump(centre, &point);
        self.centres.iter().map(bump).collect()
    }

    fn standardised(&self, features: &Features) -> Features {
        let mut point = [0.0; MAX_FEATURES];
        for (d, (mean, deviation)) in self.mean.iter().zip(&self.deviation).enumerate() {
            let value = (features[d] - mean) / deviation;
            point[d] = if value.is_finite() { value } else { 0.0 };
        }
        point
    }

    /// `K`.
    fn covariance(&self) -> DMatrix<f64> {
        let m = self.centres.len();
        DMatrix::from_fn(m, m, |i, j| bump(&self.centres[i], &self.centres[j]))
    }
}

/// `exp(−|x − c|²/(2 d))`, `x` with as many dimensions as `c` or more.
fn bump(centre: &[f64], point: &[f64]) -> f64 {
    let squared: f64 = centre.iter().zip(point).map(|(c, x)| (x - c).powi(2)).sum();
    (-0.5 * squared / centre.len() as f64).exp()
}

/// Weighted mean and deviation of the finite values; deviation 1 where they do not differ.
fn moments(values: &[f64], weights: &[f64]) -> (f64, f64) {
    let known = || values.iter().zip(weights).filter(|(v, _)| v.is_finite());
    let total: f64 = known().map(|(_, w)| w).sum();
    if total <= 0.0 {
        return (0.0, 1.0);
    }
    let mean = known().map(|(v, w)| w * v).sum::<f64>() / total;
    let variance = known().map(|(v, w)| w * (v - mean).powi(2)).sum::<f64>() / total;
    let deviation = variance.sqrt();
    (mean, if deviation > 1e-12 { deviation } else { 1.0 })
}

/// At most [`CENTRES`] of the points, each the one that those before it explain least: pivots of a Cholesky decomposition.
fn spread_out(points: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut unexplained = vec![1.0_f64; points.len()];
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut centres: Vec<Vec<f64>> = Vec::new();
    while centres.len() < CENTRES.min(points.len()) {
        let Some((pivot, &left)) = unexplained
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)))
        else {
            break;
        };
        if left < 1e-6 {
            break;
        }
        let root = left.sqrt();
        let row: Vec<f64> = points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                let known: f64 = rows.iter().map(|r| r[i] * r[pivot]).sum();
                (bump(&points[pivot], point) - known) / root
            })
            .collect();
        for (u, r) in unexplained.iter_mut().zip(&row) {
            *u = (*u - r * r).max(0.0);
        }
        rows.push(row);
        centres.push(points[pivot].clone());
    }
    centres
}

/// The regression as a whole and with each block of points held out, for any response.
pub(super) struct Regression {
    /// Points by centres.
    values: DMatrix<f64>,
    weights: DVector<f64>,
    blocks: Vec<Vec<usize>>,
    whole: Cholesky<f64, Dyn>,
    without: Vec<Cholesky<f64, Dyn>>,
}

impl Regression {
    /// Prepares the normal equations; `block_of` numbers the block of each point. `None` where they cannot be solved.
    pub(super) fn new(
        basis: &GaussianBasis,
        features: &[Features],
        weights: &[f64],
        block_of: &[usize],
    ) -> Option<Self> {
        let m = basis.centres.len();
        let rows: Vec<f64> = features.iter().flat_map(|f| basis.values(f)).collect();
        let values = DMatrix::from_row_slice(features.len(), m, &rows);
        let weights = DVector::from_column_slice(weights);
        let mut blocks = vec![Vec::new(); block_of.iter().max()? + 1];
        for (i, &block) in block_of.iter().enumerate() {
            blocks[block].push(i);
        }
        let grams: Vec<DMatrix<f64>> = blocks
            .iter()
            .map(|block| weighted_gram(&values, &weights, block))
            .collect();
        let gram = grams.iter().fold(DMatrix::zeros(m, m), |sum, g| sum + g);
        let penalty = basis.covariance() * NOISE + DMatrix::identity(m, m) * 1e-8;
        let decomposed = |gram: DMatrix<f64>| Cholesky::new(gram + &penalty);
        let without = grams.iter().map(|g| decomposed(&gram - g));
        Some(Self {
            without: without.collect::<Option<Vec<_>>>()?,
            whole: decomposed(gram)?,
            values,
            weights,
            blocks,
        })
    }

    /// Coefficients, centres by columns of the response.
    pub(super) fn coefficients(&self, response: &DMatrix<f64>) -> DMatrix<f64> {
        let all: Vec<usize> = (0..response.nrows()).collect();
        self.whole.solve(&self.moment(response, &all))
    }

    /// Every point predicted without its block.
    pub(super) fn held_out(&self, response: &DMatrix<f64>) -> DMatrix<f64> {
        let moments: Vec<DMatrix<f64>> = self
            .blocks
            .iter()
            .map(|block| self.moment(response, block))
            .collect();
        let zero = DMatrix::zeros(self.values.ncols(), response.ncols());
        let total = moments.iter().fold(zero, |sum, moment| sum + moment);
        let mut predicted = DMatrix::zeros(response.nrows(), response.ncols());
        for ((block, moment), without) in self.blocks.iter().zip(&moments).zip(&self.without) {
            let rows = self.values.select_rows(block) * without.solve(&(&total - moment));
            for (row, &i) in block.iter().enumerate() {
                predicted.row_mut(i).copy_from(&rows.row(row));
            }
        }
        predicted
    }

    /// `Σ w_i k(x_i) y_iᵀ` over some points.
    fn moment(&self, response: &DMatrix<f64>, points: &[usize]) -> DMatrix<f64> {
        let mut weighted = response.select_rows(points);
        for (mut row, &i) in weighted.row_iter_mut().zip(points) {
            row *= self.weights[i];
        }
        self.values.select_rows(points).tr_mul(&weighted)
    }
}

fn weighted_gram(values: &DMatrix<f64>, weights: &DVector<f64>, block: &[usize]) -> DMatrix<f64> {
    let mut rows = values.select_rows(block);
    for (row, &i) in block.iter().enumerate() {
        let root = weights[i].sqrt();
        rows.row_mut(row)
            .iter_mut()
            .for_each(|value| *value *= root);
    }
    rows.tr_mul(&rows)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn features(n: usize) -> Vec<Features> {
        (0..n)
            .map(|i| {
                let x = i as f64 / n as f64;
                let mut features = [0.0; MAX_FEATURES];
                features[..4].copy_from_slice(&[(7.0 * x).sin(), (11.0 * x).cos(), x, f64::NAN]);
                features
            })
            .collect()
    }

    #[test]
    fn holding_out_is_fitting_without() {
        let features = features(60);
        let weights: Vec<f64> = (0..60).map(|i| 1.0 + 0.5 * f64::from(i % 3)).collect();
        let blocks: Vec<usize> = (0..60).map(|i| i / 20).collect();
        let response = DMatrix::from_fn(60, 2, |i, j| (features[i][0] * (j + 1) as f64).exp());
        let basis = GaussianBasis::choose(&features, &weights, 4);
        let all = Regression::new(&basis, &features, &weights, &blocks).unwrap();
        let held_out = all.held_out(&response);

        let kept: Vec<usize> = (20..60).collect();
        let pick =
            |values: &[Features]| -> Vec<Features> { kept.iter().map(|&i| values[i]).collect() };
        let kept_weights: Vec<f64> = kept.iter().map(|&i| weights[i]).collect();
        let without = Regression::new(&basis, &pick(&features), &kept_weights, &[0; 40]).unwrap();
        let coefficients = without.coefficients(&response.select_rows(&kept));
        for (i, point) in features.iter().take(20).enumerate() {
            let values = DMatrix::from_row_slice(1, basis.centres.len(), &basis.values(point));
            let again = values * &coefficients;
            assert!((again - held_out.row(i)).norm() < 1e-9);
        }
    }

    #[test]
    fn a_smooth_response_is_found_again() {
        let features = features(300);
        let weights = vec![1.0; 300];
        let basis = GaussianBasis::choose(&features, &weights, 3);
        let blocks: Vec<usize> = (0..300).map(|i| i % 10).collect();
        let regression = Regression::new(&basis, &features, &weights, &blocks).unwrap();
        let response = DMatrix::from_fn(300, 1, |i, _| features[i][0] * features[i][1]);
        let error = (regression.held_out(&response) - &response).norm() / response.norm();
        // The penalty shrinks what it finds.
        assert!(error < 0.15, "{error}");
    }
}

//! The quadratic kernel written out: `Σ β_j (1 + v_j·x)² = c + g·x + xᵀA x`, whatever the number of support vectors.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::expansion::dot;

pub(crate) struct QuadraticForm {
    constant: f64,
    linear: Vec<f64>,
    matrix: Mat<f64>,
}

/// Rows at a time.
const BLOCK: usize = 512;

impl QuadraticForm {
    pub(crate) fn new(predictors: usize, vectors: &[f64], coefficients: &[f64]) -> Self {
        let mut linear = vec![0.0; predictors];
        let mut weighted = Vec::with_capacity(vectors.len());
        for (vector, beta) in vectors.chunks_exact(predictors).zip(coefficients) {
            for (sum, x) in linear.iter_mut().zip(vector) {
                *sum += 2.0 * beta * x;
                weighted.push(beta * x);
            }
        }
        let mut matrix = Mat::zeros(predictors, predictors);
        let rows = coefficients.len();
        matmul(
            matrix.as_mut(),
            Accum::Replace,
            MatRef::from_row_major_slice(vectors, rows, predictors).transpose(),
            MatRef::from_row_major_slice(&weighted, rows, predictors),
            1.0,
            Par::Seq,
        );
        Self {
            constant: coefficients.iter().sum(),
            linear,
            matrix,
        }
    }

    /// Adds the form of scaled rows to `sums`.
    pub(crate) fn add(&self, rows: &[f64], sums: &mut [f64]) {
        let d = self.linear.len();
        let mut products = vec![0.0; BLOCK.min(sums.len()) * d];
        for (rows, sums) in rows.chunks(BLOCK * d).zip(sums.chunks_mut(BLOCK)) {
            let products = &mut products[..rows.len()];
            matmul(
                MatMut::from_row_major_slice_mut(products, sums.len(), d),
                Accum::Replace,
                MatRef::from_row_major_slice(rows, sums.len(), d),
                self.matrix.as_ref(),
                1.0,
                Par::Seq,
            );
            let rows = rows.chunks_exact(d).zip(products.chunks_exact(d));
            for (sum, (row, product)) in sums.iter_mut().zip(rows) {
                *sum += self.constant + dot(&self.linear, row) + dot(row, product);
            }
        }
    }
}

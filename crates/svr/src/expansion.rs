//! Sums of kernels in double precision by blocks of matrix products.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use crate::Kernel;

/// Values of a block of products: 1 MB.
const BLOCK_VALUES: usize = 1 << 17;

/// Adds `Σ_j β_j K(x_i, v_j)` to `sums[i]`, all rows scaled.
pub(crate) fn add_expansion(
    kernel: Kernel,
    predictors: usize,
    rows: &[f64],
    vectors: &[f64],
    coefficients: &[f64],
    sums: &mut [f64],
) {
    let count = coefficients.len();
    if count == 0 {
        return;
    }
    // Both directions blocked, so that products and vectors stay in the cache.
    let wide = count.min(1024);
    let high = (BLOCK_VALUES / wide).max(1);
    let mut products = vec![0.0; wide * high];
    for (rows, sums) in rows.chunks(high * predictors).zip(sums.chunks_mut(high)) {
        for (k, beta) in coefficients.chunks(wide).enumerate() {
            let from = k * wide;
            let vectors = &vectors[from * predictors..(from + beta.len()) * predictors];
            let products = &mut products[..beta.len() * sums.len()];
            kernel_block(kernel, predictors, vectors, rows, products);
            for (values, sum) in products.chunks_exact(beta.len()).zip(&mut *sums) {
                *sum += dot(values, beta);
            }
        }
    }
}

/// `K(v_j, x_i)` of scaled rows `x` and vectors `v`, at `i·vectors + j`.
pub(crate) fn kernel_block(
    kernel: Kernel,
    predictors: usize,
    vectors: &[f64],
    rows: &[f64],
    values: &mut [f64],
) {
    let (count, high) = (vectors.len() / predictors, rows.len() / predictors);
    let square = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>();
    let squares: Vec<f64> = vectors.chunks_exact(predictors).map(square).collect();
    matmul(
        MatMut::from_column_major_slice_mut(values, count, high),
        Accum::Replace,
        MatRef::from_row_major_slice(vectors, count, predictors),
        MatRef::from_row_major_slice(rows, high, predictors).transpose(),
        1.0,
        Par::Seq,
    );
    for (values, row) in values
        .chunks_exact_mut(count)
        .zip(rows.chunks_exact(predictors))
    {
        kernel.apply_f64(values, square(row), &squares);
    }
}

/// `a·b`, summed in lanes.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8
        .remainder()
        .iter()
        .zip(b8.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a8.zip(b8) {
        for lane in 0..8 {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    rest + lanes.iter().sum::<f64>()
}

//! Nyström's method: `K ≈ Φ Φᵀ` with `φ(x) = L⁻¹ k(x)`, where `k(x)` are the kernel values with `m` landmarks and
//! `L Lᵀ` those between landmarks; the regression is then linear in `m` features (C. Williams, M. Seeger, NIPS 2000).

use faer::linalg::solvers::{Llt, Solve};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{ColRef, Mat, MatMut, Par, Side};
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::expansion::kernel_block;
use crate::linear_rows::LinearRows;
use crate::{Error, Kernel};

/// Seed of the choice of landmarks.
const SEED: u64 = 1;

/// Rows at a time.
const BLOCK: usize = 1024;

/// Landmarks and the factor between them.
pub(crate) struct Nystrom {
    kernel: Kernel,
    predictors: usize,
    landmarks: Vec<f64>,
    factor: Llt<f64>,
}

impl Nystrom {
    /// Draws `count` landmarks from the scaled rows.
    pub(crate) fn new(
        kernel: Kernel,
        scaled: &[f64],
        predictors: usize,
        count: usize,
    ) -> Result<Self, Error> {
        let n = scaled.len() / predictors;
        let count = count.min(n);
        let mut order: Vec<usize> = (0..n).collect();
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let mut chosen = order.partial_shuffle(&mut random, count).0.to_vec();
        chosen.sort_unstable();
        let landmarks = chosen
            .iter()
            .flat_map(|i| &scaled[i * predictors..(i + 1) * predictors]);
        let landmarks: Vec<f64> = landmarks.copied().collect();
        let mut values = vec![0.0; count * count];
        kernel_block(kernel, predictors, &landmarks, &landmarks, &mut values);
        let between = Mat::from_fn(count, count, |i, j| values[i * count + j]);
        let scale = (0..count).fold(0.0_f64, |most, i| most.max(between[(i, i)]));
        // Equal landmarks make the matrix singular; a little on its diagonal changes features by about its square root.
        let factor = [1e-12, 1e-9, 1e-6].into_iter().find_map(|share| {
            let mut regular = between.clone();
            for i in 0..count {
                regular[(i, i)] += share * scale;
            }
            Llt::new(regular.as_ref(), Side::Lower).ok()
        });
        let factor = factor.ok_or(Error::NotPositiveDefinite)?;
        Ok(Self {
            kernel,
            predictors,
            landmarks,
            factor,
        })
    }

    pub(crate) fn count(&self) -> usize {
        self.landmarks.len() / self.predictors
    }

    pub(crate) fn landmarks(&self) -> &[f64] {
        &self.landmarks
    }

    /// `φ` of scaled rows.
    pub(crate) fn features(&self, scaled: &[f64]) -> LinearRows {
        let count = self.count();
        let mut rows = LinearRows::with_capacity(count, scaled.len() / self.predictors);
        let mut features = Vec::new();
        for block in scaled.chunks(BLOCK * self.predictors) {
            let columns = block.len() / self.predictors;
            features.resize(columns * count, 0.0);
            kernel_block(
                self.kernel,
                self.predictors,
                &self.landmarks,
                block,
                &mut features,
            );
            let right = MatMut::from_column_major_slice_mut(&mut features, count, columns);
            solve_lower_triangular_in_place(self.factor.L(), right, Par::Seq);
            rows.extend(&features);
        }
        rows
    }

    /// Bytes that as many landmarks need for the features of `samples` and for the factor between them.
    pub(crate) fn bytes(samples: usize, predictors: usize, count: usize) -> usize {
        8 * (samples * (count + 1) + BLOCK * count + 3 * count * count + count * predictors)
    }

    /// Coefficients of the landmarks that say the same as `weights` of the features: `L⁻ᵀ w`.
    pub(crate) fn coefficients(&self, weights: &[f64]) -> Vec<f64> {
        // L⁻ᵀ w = (L Lᵀ)⁻¹ (L w).
        let right = self.factor.L() * ColRef::from_slice(weights);
        let solved = self.factor.solve(&right);
        solved.iter().copied().collect()
    }
}

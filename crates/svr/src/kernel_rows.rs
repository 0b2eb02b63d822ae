//! Rows of the kernel matrix in single precision, computed when they are needed, kept as long as there is room.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use crate::vectorised::vectorised;
use crate::{Error, Kernel};

/// Rows computed by one matrix product.
const BATCH: usize = 64;

/// Samples of which those products stay in the second-level cache.
const TILE: usize = 1024;

/// Samples whose sums stay in the first-level cache.
const BLOCK: usize = 1024;

/// Up to here single precision computes kernel values without overflow.
const GREATEST: f64 = 1e37;

/// The rows `K(x_i, ·)` over all samples.
pub(crate) struct KernelRows {
    kernel: Kernel,
    predictors: usize,
    scaled: Vec<f32>,
    squares: Vec<f32>,
    diagonal: Vec<f64>,
    rows: Vec<Option<Box<[f32]>>>,
    last_used: Vec<u64>,
    clock: u64,
    capacity: usize,
    kept: usize,
    products: Vec<f32>,
}

impl KernelRows {
    /// Keeps at most `capacity` rows. [`Error::NotPositiveDefinite`] where single precision does not hold the kernel.
    pub(crate) fn new(
        kernel: Kernel,
        scaled: &[f64],
        predictors: usize,
        capacity: usize,
    ) -> Result<Self, Error> {
        let n = scaled.len() / predictors;
        let square = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>();
        let squares = scaled.chunks_exact(predictors).map(square);
        // No value is greater than the greatest of the diagonal, no sum of two squares than four times that.
        let mut held = squares
            .clone()
            .map(|square| square.max(kernel.own_value(square)));
        if !held.all(|most| most < GREATEST) {
            return Err(Error::NotPositiveDefinite);
        }
        Ok(Self {
            kernel,
            predictors,
            scaled: scaled.iter().map(|&x| x as f32).collect(),
            squares: squares.clone().map(|x| x as f32).collect(),
            diagonal: squares.map(|square| kernel.own_value(square)).collect(),
            rows: (0..n).map(|_| None).collect(),
            last_used: vec![0; n],
            clock: 0,
            capacity: capacity.min(n),
            kept: 0,
            products: vec![0.0; TILE * BATCH],
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    pub(crate) fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Makes the rows of `samples` available; no more of them than [`Self::capacity`].
    pub(crate) fn ensure(&mut self, samples: &[usize]) {
        self.clock += 1;
        for &i in samples {
            self.last_used[i] = self.clock;
        }
        let missing = samples.iter().copied().filter(|&i| self.rows[i].is_none());
        let missing: Vec<usize> = missing.collect();
        self.make_room(missing.len());
        for batch in missing.chunks(BATCH) {
            self.compute(batch);
        }
    }

    /// A row that [`Self::ensure`] has made available.
    pub(crate) fn row(&self, sample: usize) -> &[f32] {
        self.rows[sample].as_deref().unwrap_or(&[])
    }

    /// `sums += Σ factor · row` over rows that are available.
    pub(crate) fn add(&self, terms: &[(usize, f64)], sums: &mut [f64]) {
        for (block, sums) in sums.chunks_mut(BLOCK).enumerate() {
            let from = block * BLOCK;
            let to = from + sums.len();
            let part = |i: usize| &self.row(i)[from..to];
            let mut fours = terms.chunks_exact(4);
            for four in &mut fours {
                let rows = [
                    part(four[0].0),
                    part(four[1].0),
                    part(four[2].0),
                    part(four[3].0),
                ];
                let factors = [four[0].1, four[1].1, four[2].1, four[3].1];
                add_four(sums, rows, factors);
            }
            for &(i, factor) in fours.remainder() {
                let row = part(i);
                for (sum, k) in sums.iter_mut().zip(row) {
                    *sum += factor * f64::from(*k);
                }
            }
        }
    }

    fn make_room(&mut self, wanted: usize) {
        let excess = (self.kept + wanted).saturating_sub(self.capacity);
        if excess == 0 {
            return;
        }
        let old =
            (0..self.len()).filter(|&i| self.rows[i].is_some() && self.last_used[i] < self.clock);
        let mut old: Vec<usize> = old.collect();
        old.sort_unstable_by_key(|&i| self.last_used[i]);
        for i in old.into_iter().take(excess) {
            self.rows[i] = None;
            self.kept -= 1;
        }
    }

    fn compute(&mut self, samples: &[usize]) {
        let (n, d) = (self.len(), self.predictors);
        let chosen = samples
            .iter()
            .flat_map(|i| &self.scaled[i * d..(i + 1) * d]);
        let chosen: Vec<f32> = chosen.copied().collect();
        let mut rows: Vec<Vec<f32>> = samples.iter().map(|_| Vec::with_capacity(n)).collect();
        // Products of a tile stay in the cache until the kernel is applied to them.
        for (tile, squares) in self.scaled.chunks(TILE * d).zip(self.squares.chunks(TILE)) {
            let products = &mut self.products[..squares.len() * samples.len()];
            matmul(
                MatMut::from_column_major_slice_mut(products, squares.len(), samples.len()),
                Accum::Replace,
                MatRef::from_row_major_slice(tile, squares.len(), d),
                MatRef::from_row_major_slice(&chosen, samples.len(), d).transpose(),
                1.0,
                Par::Seq,
            );
            for ((products, row), &i) in products
                .chunks_exact_mut(squares.len())
                .zip(&mut rows)
                .zip(samples)
            {
                self.kernel.apply_f32(products, self.squares[i], squares);
                row.extend_from_slice(products);
            }
        }
        for (row, &i) in rows.into_iter().zip(samples) {
            self.rows[i] = Some(row.into_boxed_slice());
        }
        self.kept += samples.len();
    }
}

fn add_four(sums: &mut [f64], rows: [&[f32]; 4], factors: [f64; 4]) {
    let n = sums.len();
    let [a, b, c, d] = rows.map(|row| &row[..n]);
    vectorised(
        #[inline(always)]
        || {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += factors[0] * f64::from(a[i])
                    + factors[1] * f64::from(b[i])
                    + factors[2] * f64::from(c[i])
                    + factors[3] * f64::from(d[i]);
            }
        },
    );
}

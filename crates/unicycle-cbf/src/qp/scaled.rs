//! Rows in scaled variables.

use std::array::from_fn;

use super::{MAX_ROWS, Row, Status};

/// A row is violated from here on, relative to `|b̂_j| + |y|`.
pub(super) const FEASIBILITY: f64 = 1e-13;

/// Rows without a normal hold for right sides from minus this on, in their own units.
const ZERO_ROW: f64 = 1e-12;

/// Lengths of normals and distances of rows from the origin are at most this; below its inverse they
/// count as zero.
const LARGEST: f64 = 1e100;

/// The rows `â_j · y ≤ b̂_j`.
pub(super) struct Scaled<const N: usize> {
    pub(super) normals: [[f64; N]; MAX_ROWS],
    pub(super) offsets: [f64; MAX_ROWS],
    /// `b̂_j / b_j`
    pub(super) scales: [f64; MAX_ROWS],
    /// `b̂_j` with its tolerance; infinite for rows that must not enter
    pub(super) limits: [f64; MAX_ROWS],
    pub(super) count: usize,
    /// Bits of the rows that contradict active ones by no more than round-off
    passed: u32,
}

impl<const N: usize> Scaled<N> {
    pub(super) fn new(count: usize) -> Self {
        Self {
            normals: [[0.0; N]; MAX_ROWS],
            offsets: [0.0; MAX_ROWS],
            scales: [0.0; MAX_ROWS],
            limits: [f64::INFINITY; MAX_ROWS],
            count: count.min(MAX_ROWS),
            passed: 0,
        }
    }

    /// Takes over the rows; otherwise how the solve ends, and the row at fault.
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        inverse_root: &[f64; N],
        rows: &[Row<N>],
    ) -> Result<(), (Status, usize)> {
        if rows.len() > MAX_ROWS {
            return Err((Status::TooManyRows, MAX_ROWS));
        }
        for (j, row) in rows.iter().enumerate() {
            let normal: [f64; N] = from_fn(|i| row.a[i] * inverse_root[i]);
            let squared = dot(&normal, &normal);
            if squared < 1.0 / (LARGEST * LARGEST) && row.b.is_finite() {
                if row.b < -ZERO_ROW {
                    return Err((Status::Infeasible, j));
                }
                continue;
            }
            let scale = squared.sqrt().recip();
            let offset = scale * row.b;
            if !(squared <= LARGEST * LARGEST && offset.abs() <= LARGEST) {
                return Err((Status::NotFinite, j));
            }
            self.normals[j] = normal.map(|a| a * scale);
            self.scales[j] = scale;
            self.offsets[j] = if offset.abs() * LARGEST < 1.0 {
                0.0
            } else {
                offset
            };
            self.admit(j);
        }
        Ok(())
    }

    /// Lets a row enter.
    pub(super) fn admit(&mut self, row: usize) {
        self.limits[row] = self.offsets[row] + FEASIBILITY * self.offsets[row].abs();
    }

    /// Keeps a row from entering until the active set has changed.
    pub(super) fn pass(&mut self, row: usize) {
        self.limits[row] = f64::INFINITY;
        self.passed |= 1 << row;
    }

    /// Lets rows enter that were kept from it.
    pub(super) fn admit_passed(&mut self) {
        while self.passed != 0 {
            self.admit(self.passed.trailing_zeros() as usize);
            self.passed &= self.passed - 1;
        }
    }

    /// The row that `y` violates most, the first of equals.
    #[inline(always)]
    pub(super) fn most_violated(&self, y: &[f64; N]) -> Option<usize> {
        let mut worst = FEASIBILITY * norm(y);
        let mut found = None;
        for j in 0..self.count {
            let excess = dot(&self.normals[j], y) - self.limits[j];
            if excess > worst {
                worst = excess;
                found = Some(j);
            }
        }
        found
    }
}

#[inline(always)]
pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    // Two sums, for the pairs of numbers in a register.
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<2>(), b.as_chunks::<2>());
    let mut sums = [0.0; 2];
    for (a, b) in a.iter().zip(b) {
        sums = [sums[0] + a[0] * b[0], sums[1] + a[1] * b[1]];
    }
    for (a, b) in a_rest.iter().zip(b_rest) {
        sums[0] += a * b;
    }
    sums[0] + sums[1]
}

#[inline(always)]
pub(super) fn norm<const N: usize>(a: &[f64; N]) -> f64 {
    dot(a, a).sqrt()
}

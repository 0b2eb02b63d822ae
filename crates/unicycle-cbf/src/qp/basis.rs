//! Active rows and the optimum for them.

use std::array::from_fn;

use super::scaled::{Scaled, dot};

/// The active rows, their normals as `QR`, and `c` with `Rᵀ c = b̂`. Behind the active rows `q` and `r`
/// hold anything, `c` zero.
pub(super) struct Basis<const N: usize> {
    pub(super) rows: [usize; N],
    pub(super) count: usize,
    /// Columns of `Q`
    q: [[f64; N]; N],
    /// Columns of `R` above the diagonal
    r: [[f64; N]; N],
    /// Inverses of the diagonal of `R`
    inverse: [f64; N],
    pub(super) c: [f64; N],
}

/// A normal `p` split by the active ones: `p = Q along + across`.
pub(super) struct Split<const N: usize> {
    pub(super) along: [f64; N],
    across: [f64; N],
    pub(super) across_squared: f64,
}

impl<const N: usize> Basis<N> {
    pub(super) fn new() -> Self {
        Self {
            rows: [0; N],
            count: 0,
            q: [[0.0; N]; N],
            r: [[0.0; N]; N],
            inverse: [0.0; N],
            c: [0.0; N],
        }
    }

    /// `Qᵀ p`
    #[inline(always)]
    pub(super) fn projected(&self, p: &[f64; N]) -> [f64; N] {
        let mut along = [0.0; N];
        for (along, q) in along.iter_mut().zip(&self.q).take(self.count) {
            *along = dot(q, p);
        }
        along
    }

    /// `v − Q u`
    #[inline(always)]
    fn across(&self, mut v: [f64; N], u: &[f64; N]) -> [f64; N] {
        for (q, u) in self.q.iter().zip(u).take(self.count) {
            v = from_fn(|i| v[i] - u * q[i]);
        }
        v
    }

    /// `Q u`
    #[inline(always)]
    pub(super) fn combined(&self, u: [f64; N]) -> [f64; N] {
        self.across([0.0; N], &u.map(|u| -u))
    }

    /// The optimum for the active rows, `Q c`
    #[inline(always)]
    pub(super) fn point(&self) -> [f64; N] {
        self.combined(self.c)
    }

    /// Splits a normal by the active ones.
    #[inline(always)]
    pub(super) fn split(&self, p: &[f64; N]) -> Split<N> {
        let mut along = self.projected(p);
        let mut across = self.across(*p, &along);
        let mut across_squared = dot(&across, &across);
        // Once is enough where little cancels.
        if across_squared < 0.5 {
            let again = self.projected(&across);
            across = self.across(across, &again);
            along = from_fn(|k| along[k] + again[k]);
            across_squared = dot(&across, &across);
        }
        Split {
            along,
            across,
            across_squared,
        }
    }

    /// Makes a row active.
    #[inline(always)]
    pub(super) fn push(&mut self, row: usize, offset: f64, split: &Split<N>) {
        let k = self.count;
        let inverse = split.across_squared.sqrt().recip();
        self.rows[k] = row;
        self.q[k] = split.across.map(|across| across * inverse);
        self.r[k] = split.along;
        self.inverse[k] = inverse;
        self.c[k] = (offset - dot(&split.along, &self.c)) * inverse;
        self.count = k + 1;
    }

    /// Takes out the row at place `k` and builds the places behind it anew.
    pub(super) fn drop(&mut self, k: usize, scaled: &mut Scaled<N>) {
        let (rows, count) = (self.rows, self.count);
        scaled.admit(rows[k]);
        self.c = from_fn(|i| if i < k { self.c[i] } else { 0.0 });
        self.count = k;
        for &row in &rows[k + 1..count] {
            let split = self.split(&scaled.normals[row]);
            self.push(row, scaled.offsets[row], &split);
        }
    }

    /// `R⁻¹ v` for two vectors
    #[inline(always)]
    pub(super) fn back(&self, mut u: [f64; N], mut v: [f64; N]) -> ([f64; N], [f64; N]) {
        for k in (0..self.count).rev() {
            u[k] *= self.inverse[k];
            v[k] *= self.inverse[k];
            for i in 0..k {
                u[i] -= self.r[k][i] * u[k];
                v[i] -= self.r[k][i] * v[k];
            }
        }
        (u, v)
    }

    /// `R⁻ᵀ v`
    #[inline(always)]
    pub(super) fn forward(&self, mut v: [f64; N]) -> [f64; N] {
        for k in 0..self.count {
            for i in 0..k {
                v[k] -= self.r[k][i] * v[i];
            }
            v[k] *= self.inverse[k];
        }
        v
    }
}

//! A symmetric positive definite tridiagonal matrix.

/// Factorised in place as `L D Lᵀ` with a unit bidiagonal `L`.
#[derive(Debug, Default)]
pub(crate) struct Tridiagonal {
    pub(crate) diagonal: Vec<f64>,
    /// Below the diagonal; one less.
    pub(crate) off: Vec<f64>,
}

impl Tridiagonal {
    pub(crate) fn clear(&mut self, size: usize) {
        self.diagonal.clear();
        self.diagonal.resize(size, 0.0);
        self.off.clear();
        self.off.resize(size.saturating_sub(1), 0.0);
    }

    pub(crate) fn factorise(&mut self) {
        for k in 1..self.diagonal.len() {
            let ratio = self.off[k - 1] / self.diagonal[k - 1];
            // Rounding alone makes a pivot vanish.
            let least = 1e-14 * self.diagonal[k];
            self.diagonal[k] = (self.diagonal[k] - ratio * self.off[k - 1]).max(least);
            self.off[k - 1] = ratio;
        }
    }

    /// Solves with the factors, in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for k in 1..x.len() {
            x[k] -= self.off[k - 1] * x[k - 1];
        }
        for (x, d) in x.iter_mut().zip(&self.diagonal) {
            *x /= d;
        }
        for k in (1..x.len()).rev() {
            x[k - 1] -= self.off[k - 1] * x[k];
        }
    }
}

/// Solves `A x = b` in place for a small dense symmetric positive definite matrix, by rows; `false` where it is not definite.
pub(crate) fn solve_dense(a: &mut [f64], b: &mut [f64]) -> bool {
    let n = b.len();
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let rest = a[i * n + j] - dot;
            if i > j {
                a[i * n + j] = rest / a[j * n + j];
            } else if rest > 0.0 {
                a[i * n + i] = rest.sqrt();
            } else {
                return false;
            }
        }
    }
    for i in 0..n {
        let dot: f64 = (0..i).map(|k| a[i * n + k] * b[k]).sum();
        b[i] = (b[i] - dot) / a[i * n + i];
    }
    for i in (0..n).rev() {
        let dot: f64 = (i + 1..n).map(|k| a[k * n + i] * b[k]).sum();
        b[i] = (b[i] - dot) / a[i * n + i];
    }
    true
}

//! Numbers of samples and what is divided by them.

use crate::dynamic::lanes::{LANES, lanes};

/// Numbers of samples and small quotients of them, for any window.
pub(crate) struct Tables {
    /// `n`, `1 / n` and `1 / (n (n + 1))`; 0 where the divisor is 0.
    number: Vec<f64>,
    inverse: Vec<f64>,
    pair_inverse: Vec<f64>,
}

/// The same for the windows of a walk at one start: `n` samples before it is taken in, `n + 1` after.
pub(crate) struct Counts<'a> {
    pub(crate) before: &'a [f64; LANES],
    pub(crate) after: &'a [f64; LANES],
    /// `1 / (n + 1)` and `1 / (n (n + 1))`.
    pub(crate) inverse: &'a [f64; LANES],
    pub(crate) pair_inverse: &'a [f64; LANES],
}

impl Tables {
    pub(crate) fn new(len: usize) -> Self {
        let quotient = |n: f64| if n > 0.0 { 1.0 / n } else { 0.0 };
        let number: Vec<f64> = (0..=len + LANES).map(|n| n as f64).collect();
        Self {
            inverse: number.iter().map(|&n| quotient(n)).collect(),
            pair_inverse: number.iter().map(|&n| quotient(n * (n + 1.0))).collect(),
            number,
        }
    }

    /// Where the first window has `n` samples, the others one more each.
    #[inline(always)]
    pub(crate) fn counts(&self, n: usize) -> Counts<'_> {
        Counts {
            before: lanes(&self.number[n..]),
            after: lanes(&self.number[n + 1..]),
            inverse: lanes(&self.inverse[n + 1..]),
            pair_inverse: lanes(&self.pair_inverse[n..]),
        }
    }
}

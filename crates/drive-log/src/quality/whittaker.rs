//! The most likely speed under a noise, where its acceleration wanders as that of cars does.
//!
//! E. T. Whittaker, On a new method of graduation, Proceedings of the Edinburgh Mathematical Society 41, 1922, here on
//! irregular steps.

use std::ops::Range;

/// How fast the acceleration of a car wanders, m²/s⁵: by 0.57 m/s² within a second, 1.8 m/s³ from one sample to the next at 10 Hz.
const WANDER_M2PS5: f64 = 0.32;

/// The noise of a speed.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    /// m²/s².
    pub(super) variance: f64,
    /// Samples that follow each other faster than this have one noise, s.
    pub(super) independent_s: f64,
}

/// The smoothed speed, m/s, missing where it is missing. Nothing is smoothed over a cut.
pub(super) fn smooth(time_s: &[f64], speed_mps: &[f64], cuts: &[usize], noise: Noise) -> Vec<f64> {
    let mut smooth_mps = speed_mps.to_vec();
    for range in continuous(speed_mps, cuts).filter(|range| range.len() >= 3) {
        smooth_piece(&time_s[range.clone()], &mut smooth_mps[range], noise);
    }
    smooth_mps
}

/// Ranges without a missing value and without a cut.
fn continuous(speed_mps: &[f64], cuts: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let mut ranges = Vec::new();
    let mut start = 0;
    for i in 0..=speed_mps.len() {
        let missing = speed_mps.get(i).is_none_or(|v| !v.is_finite());
        if missing || cuts.contains(&i) {
            if i > start {
                ranges.push(start..i);
            }
            start = if missing { i + 1 } else { i };
        }
    }
    ranges.into_iter()
}

/// Minimises `Σ wᵢ (vᵢ − xᵢ)² + Σ (aᵢ − aᵢ₋₁)² / (wander · step)` over three or more samples.
fn smooth_piece(time_s: &[f64], speed_mps: &mut [f64], noise: Noise) {
    let n = speed_mps.len();
    let steps_s: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut matrix = Pentadiagonal::new(n);
    for i in 0..n {
        let own_s = 0.5 * (steps_s[i.max(1) - 1] + steps_s[i.min(n - 2)]);
        matrix.diagonal[i] = (own_s / noise.independent_s).min(1.0) / noise.variance;
    }
    for (x, weight) in speed_mps.iter_mut().zip(&matrix.diagonal) {
        *x *= weight;
    }
    for (i, pair) in steps_s.windows(2).enumerate() {
        let (before, after) = (1.0 / pair[0], 1.0 / pair[1]);
        let weight = 1.0 / (WANDER_M2PS5 * 0.5 * (pair[0] + pair[1]));
        matrix.add_square(i, [before, -before - after, after], weight);
    }
    matrix.solve(speed_mps);
}

/// A symmetric positive definite matrix with two diagonals beside the main one.
struct Pentadiagonal {
    diagonal: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
}

impl Pentadiagonal {
    fn new(n: usize) -> Pentadiagonal {
        Pentadiagonal {
            diagonal: vec![0.0; n],
            first: vec![0.0; n],
            second: vec![0.0; n],
        }
    }

    /// Adds `weight · (c₀ xᵢ + c₁ xᵢ₊₁ + c₂ xᵢ₊₂)²`.
    fn add_square(&mut self, i: usize, c: [f64; 3], weight: f64) {
        for (diagonal, c) in self.diagonal[i..i + 3].iter_mut().zip(c) {
            *diagonal += weight * c * c;
        }
        self.first[i] += weight * c[0] * c[1];
        self.first[i + 1] += weight * c[1] * c[2];
        self.second[i] += weight * c[0] * c[2];
    }

    /// Solves in place by `LDLᵀ`, which takes the place of the matrix.
    fn solve(mut self, x: &mut [f64]) {
        let n = x.len();
        let (d, e, f) = (&mut self.diagonal, &mut self.first, &mut self.second);
        for i in 0..n {
            if i >= 1 {
                d[i] -= e[i - 1] * e[i - 1] * d[i - 1];
                x[i] -= e[i - 1] * x[i - 1];
            }
            if i >= 2 {
                d[i] -= f[i - 2] * f[i - 2] * d[i - 2];
                x[i] -= f[i - 2] * x[i - 2];
            }
            if i >= 1 {
                e[i] -= f[i - 1] * d[i - 1] * e[i - 1];
            }
            e[i] /= d[i];
            f[i] /= d[i];
        }
        for i in (0..n).rev() {
            x[i] /= d[i];
            if i + 1 < n {
                x[i] -= e[i] * x[i + 1];
            }
            if i + 2 < n {
                x[i] -= f[i] * x[i + 2];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Pentadiagonal;

    #[test]
    fn the_solution_solves() {
        let n = 40;
        let wave = |k: usize| (k as f64 * 0.7).sin();
        let build = || {
            let mut matrix = Pentadiagonal::new(n);
            matrix.diagonal.fill(0.1);
            for i in 0..n - 2 {
                matrix.add_square(i, [1.0, -2.0 - wave(i), 1.0 + wave(i)], 3.0);
            }
            matrix
        };
        let matrix = build();
        let right: Vec<f64> = (0..n).map(wave).collect();
        let mut x = right.clone();
        build().solve(&mut x);
        for i in 0..n {
            let mut sum = matrix.diagonal[i] * x[i];
            for (k, off) in [(1, &matrix.first), (2, &matrix.second)] {
                sum += if i + k < n { off[i] * x[i + k] } else { 0.0 };
                sum += if i >= k { off[i - k] * x[i - k] } else { 0.0 };
            }
            assert!((sum - right[i]).abs() < 1e-10, "{i}: {sum} {}", right[i]);
        }
    }
}

//! A speed in steps so coarse that its differences are steps too.
//!
//! The smoother is the one of E. T. Whittaker, On a new method of graduation, Proceedings of the Edinburgh Mathematical
//! Society 41, 1922, here on irregular steps: the most likely speed whose acceleration wanders as that of cars does, where
//! rounding is a noise of variance `q²/12`.

use std::ops::Range;

use super::checked::Checked;
use super::lattice::Lattice;
use super::runs::constant_runs;
use crate::statistics::median_step_s;
use crate::{Action, Channel, FindingKind};

/// Steps whose differences are under this, m/s², are lost in the smoothing: whole km/h at 1 Hz.
const LEAST_STEP_MPS2: f64 = 0.3;

/// How fast the acceleration of a car wanders, m²/s⁵: by 0.57 m/s² within a second, 1.8 m/s³ from one sample to the next at 10 Hz.
const WANDER_M2PS5: f64 = 0.32;

/// Samples that follow each other faster than this are rounded alike, s.
const INDEPENDENT_S: f64 = 0.1;

/// A speed of 0 this far from any other is a standstill, s.
const STANDSTILL_S: f64 = 0.3;

/// How a speed was rounded, and how often it was renewed, s, where rows are faster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounding {
    pub(super) lattice: Lattice,
    pub(super) interval_s: f64,
}

impl Rounding {
    /// Looks at the values as they were recorded, before lines between them are drawn.
    pub(super) fn of(speed_mps: &[f64]) -> Option<Self> {
        Lattice::of(speed_mps).map(|lattice| Self {
            lattice,
            interval_s: 0.0,
        })
    }

    /// The same in another unit.
    pub(super) fn scale(&mut self, factor: f64) {
        self.lattice.step_mps *= factor;
        self.lattice.reach_mps *= factor;
    }
}

/// Smooths a rounded speed. It stays within half a step of every sample.
pub(super) fn smooth_speed(checked: &mut Checked) {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let Some(rounding) = checked.rounding else {
        return;
    };
    let step_mps = rounding.lattice.step_mps;
    if step_mps < LEAST_STEP_MPS2 * median_step_s(time_s).max(rounding.interval_s) {
        return;
    }
    let mut smooth_mps = speed_mps.to_vec();
    for range in continuous(speed_mps, &checked.cuts) {
        smoothed(&time_s[range.clone()], &mut smooth_mps[range], rounding);
    }
    stand_still(time_s, speed_mps, &mut smooth_mps);
    let detail = format!(
        "in steps of {:.3} km/h, taken as rounded to the nearest; smoothed within half a step",
        3.6 * step_mps
    );
    checked.report_all(
        FindingKind::Quantised,
        Channel::Speed,
        Action::Smoothed,
        detail,
    );
    checked.log.channels.insert(Channel::Speed, smooth_mps);
}

/// Ranges without a missing value and without a cut.
fn continuous(speed_mps: &[f64], cuts: &[usize]) -> Vec<Range<usize>> {
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
    ranges
}

/// Minimises `Σ wᵢ (vᵢ − xᵢ)² + Σ (aᵢ − aᵢ₋₁)² / (wander · step)`, and clips to what was rounded to `x`.
fn smoothed(time_s: &[f64], speed_mps: &mut [f64], rounding: Rounding) {
    let n = speed_mps.len();
    if n < 3 {
        return;
    }
    let steps_s: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let variance = rounding.lattice.step_mps.powi(2) / 12.0;
    let independent_s = INDEPENDENT_S.max(rounding.interval_s);
    let mut matrix = Pentadiagonal::new(n);
    for i in 0..n {
        let own_s = 0.5 * (steps_s[i.max(1) - 1] + steps_s[i.min(n - 2)]);
        matrix.diagonal[i] = (own_s / independent_s).min(1.0) / variance;
    }
    let mut right: Vec<f64> = matrix
        .diagonal
        .iter()
        .zip(&*speed_mps)
        .map(|(weight, v)| weight * v)
        .collect();
    for (i, pair) in steps_s.windows(2).enumerate() {
        let (before, after) = (1.0 / pair[0], 1.0 / pair[1]);
        let weight = 1.0 / (WANDER_M2PS5 * 0.5 * (pair[0] + pair[1]));
        matrix.add_square(i, [before, -before - after, after], weight);
    }
    matrix.solve(&mut right);
    let half = rounding.lattice.reach_mps;
    for (v, smooth) in speed_mps.iter_mut().zip(right) {
        *v = smooth.clamp(*v - half, *v + half);
    }
}

/// A rounded 0 is no motion backward, and none at all where it lasts.
fn stand_still(time_s: &[f64], speed_mps: &[f64], smooth_mps: &mut [f64]) {
    let stands = |i: usize| speed_mps[i] == 0.0;
    for run in constant_runs(speed_mps).filter(|run| stands(run.start)) {
        let (from_s, to_s) = (time_s[run.start], time_s[run.end - 1]);
        let (starts, ends) = (run.start == 0, run.end == speed_mps.len());
        for i in run {
            let settled = (starts || time_s[i] - from_s >= STANDSTILL_S)
                && (ends || to_s - time_s[i] >= STANDSTILL_S);
            smooth_mps[i] = if settled { 0.0 } else { smooth_mps[i].max(0.0) };
        }
    }
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

//! The benchmarks' input: the WLTC (class 3b) at 10 Hz, smoothed, differentiated and z-scored, end to end as often as asked.

#![allow(dead_code)]

use tseg::{Scale, Series};

const CYCLE: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../fixtures/cycles/wltc-3b.csv"
));
const STEPS_PER_SECOND: usize = 10;
const HANN_SAMPLES: usize = 5;
const DEAD_BAND_MPS2: f64 = 0.4;

/// Speed and acceleration (0 where below 0.4 m/s²), both z-scored, `len` samples each.
pub(crate) fn wltc(len: usize) -> (Vec<f64>, Vec<f64>) {
    let cycle = hann(&resampled(&speeds_mps()));
    let speed: Vec<f64> = cycle.iter().copied().cycle().take(len).collect();
    let accel = accelerations(&speed);
    (Scale::ZScore.scaled(&speed), Scale::ZScore.scaled(&accel))
}

/// The same with the weights 1.8 and 1.
pub(crate) fn series(len: usize) -> Series {
    let (speed, accel) = wltc(len);
    Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap()
}

fn speeds_mps() -> Vec<f64> {
    let speed = |row: &str| row.split(',').nth(1).unwrap().parse::<f64>().unwrap() / 3.6;
    CYCLE.lines().skip(1).map(speed).collect()
}

/// From 1 Hz to 10 Hz, linearly.
fn resampled(speeds: &[f64]) -> Vec<f64> {
    let at = |i: usize| {
        let (second, part) = (i / STEPS_PER_SECOND, i % STEPS_PER_SECOND);
        let next = speeds[(second + 1).min(speeds.len() - 1)];
        speeds[second] + (next - speeds[second]) * part as f64 / STEPS_PER_SECOND as f64
    };
    (0..(speeds.len() - 1) * STEPS_PER_SECOND + 1)
        .map(at)
        .collect()
}

fn hann(samples: &[f64]) -> Vec<f64> {
    let weight = |j: usize| {
        let angle = std::f64::consts::TAU * j as f64 / (HANN_SAMPLES + 1) as f64;
        0.5 * (1.0 - angle.cos())
    };
    let total: f64 = (1..=HANN_SAMPLES).map(weight).sum();
    let smooth = |i: usize| {
        let sample = |j: usize| {
            let shifted = (i + j).saturating_sub(HANN_SAMPLES / 2 + 1);
            samples[shifted.min(samples.len() - 1)]
        };
        (1..=HANN_SAMPLES)
            .map(|j| weight(j) * sample(j))
            .sum::<f64>()
            / total
    };
    (0..samples.len()).map(smooth).collect()
}

/// Forward differences, the last repeated.
fn accelerations(speeds: &[f64]) -> Vec<f64> {
    let accel = |i: usize| {
        let i = i.min(speeds.len().saturating_sub(2));
        let next = speeds[(i + 1).min(speeds.len() - 1)];
        let a = (next - speeds[i]) * STEPS_PER_SECOND as f64;
        if a.abs() < DEAD_BAND_MPS2 { 0.0 } else { a }
    };
    (0..speeds.len()).map(accel).collect()
}

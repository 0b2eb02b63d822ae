//! SWAB and bottom-up on a synthetic drive at 10 Hz, beside bottom-up without a queue of candidates.

#![allow(clippy::unwrap_used, missing_docs)]

use divan::Bencher;
use divan::counter::ItemsCount;
use tseg::{BottomUp, Cost, Refill, Series, Swab, merge_percentile};

const THRESHOLD: f64 = 0.2;
const WINDOW: usize = 100;
const STEP_S: f64 = 0.1;

fn main() {
    divan::main();
}

/// Speed in m/s and acceleration in m/s², dead-banded at 0.4 m/s²: stop and go with waves of several lengths.
fn drive(len: usize) -> (Vec<f64>, Vec<f64>) {
    let speed = |i: usize| {
        let t = i as f64 * STEP_S;
        let waves = 8.0 * (t / 29.0).sin()
            + 5.0 * (t / 7.3).sin()
            + 0.6 * (t / 1.7).sin()
            + 0.05 * (t * 2.9).sin();
        (7.0 + waves).max(0.0)
    };
    let accel = |i| {
        let a = (speed(i + 1) - speed(i)) / STEP_S;
        if a.abs() < 0.4 { 0.0 } else { a }
    };
    ((0..len).map(speed).collect(), (0..len).map(accel).collect())
}

fn series(len: usize) -> Series {
    let (speed, accel) = drive(len);
    Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap()
}

#[divan::bench(args = [3_000, 36_000])]
fn new_series(bencher: Bencher<'_, '_>, len: usize) {
    let (speed, accel) = drive(len);
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| Series::new(&[(&speed, 1.8), (&accel, 1.0)]).unwrap());
}

#[divan::bench(args = [3_000, 36_000])]
fn bottom_up(bencher: Bencher<'_, '_>, len: usize) {
    let series = series(len);
    let method = BottomUp::new(Cost::MeanDeviation, THRESHOLD).unwrap();
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| method.segment(&series));
}

#[divan::bench(args = [3_000])]
fn naive_bottom_up(bencher: Bencher<'_, '_>, len: usize) {
    let (speed, accel) = drive(len);
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| naive(&[(&speed, 1.8), (&accel, 1.0)]));
}

#[divan::bench(args = [Refill::Keogh, Refill::Literal, Refill::Fixed], consts = [3_000, 36_000])]
fn swab<const LEN: usize>(bencher: Bencher<'_, '_>, refill: Refill) {
    let series = series(LEN);
    let method = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW)
        .unwrap()
        .with_refill(refill);
    bencher
        .counter(ItemsCount::new(LEN))
        .bench(|| method.segment(&series));
}

#[divan::bench(args = [3_000, 36_000])]
fn percentile_merging(bencher: Bencher<'_, '_>, len: usize) {
    let (_, accel) = drive(len);
    let fine = Swab::new(Cost::MeanDeviation, THRESHOLD, WINDOW)
        .unwrap()
        .segment(&series(len));
    bencher
        .counter(ItemsCount::new(len))
        .bench(|| merge_percentile(&accel, &fine, 0.64).unwrap());
}

/// Bottom-up in `O(n²)`: all candidates of a step are looked through, changed ones computed anew.
fn naive(variables: &[(&[f64], f64)]) -> Vec<usize> {
    let cost = |start: usize, end: usize| {
        let n = (end - start) as f64;
        let deviation = |&(samples, weight): &(&[f64], f64)| {
            let x = &samples[start..end];
            let mean = x.iter().sum::<f64>() / n;
            weight * x.iter().map(|x| (x - mean).abs()).sum::<f64>() / n
        };
        variables.iter().map(deviation).sum::<f64>()
    };
    let mut boundaries: Vec<usize> = (0..=variables[0].0.len()).collect();
    let mut costs: Vec<f64> = boundaries.windows(3).map(|b| cost(b[0], b[2])).collect();
    while let Some((i, _)) = costs
        .iter()
        .enumerate()
        .filter(|(_, cost)| **cost <= THRESHOLD)
        .min_by(|a, b| a.1.total_cmp(b.1))
    {
        boundaries.remove(i + 1);
        costs.remove(i);
        if i > 0 {
            costs[i - 1] = cost(boundaries[i - 1], boundaries[i + 1]);
        }
        if i < costs.len() {
            costs[i] = cost(boundaries[i], boundaries[i + 2]);
        }
    }
    boundaries
}

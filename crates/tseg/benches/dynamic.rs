//! Dynamic programming under the z-scale cost on the WLTC at 10 Hz, speed and acceleration, with the memory it takes;
//! beside the thesis's algorithm with its table of costs. One thread unless the name says otherwise.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

mod wltc;

use std::ops::ControlFlow;
use std::process::Command;

use divan::Bencher;
use divan::counter::ItemsCount;
use rayon::ThreadPoolBuilder;
use tseg::{Certificate, Cost, Dynamic, PenaltyPath};

const SEGMENTS: usize = 80;
const MIN_LENGTH: usize = 5;

/// `--peak-memory SAMPLES SEGMENTS` runs once and prints the peak; without, such runs come before the benchmarks.
const PEAK_MEMORY: &str = "--peak-memory";

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match &arguments[1..] {
        [flag, len, segments] if flag == PEAK_MEMORY => {
            println!(
                "{}",
                peak_memory(len.parse().unwrap(), segments.parse().unwrap())
            );
        }
        [] | [_] if !arguments.contains(&"--test".to_owned()) => {
            for (len, segments) in [("3000", "80"), ("36000", "80"), ("36000", "1000")] {
                let run = Command::new(&arguments[0])
                    .args([PEAK_MEMORY, len, segments])
                    .output();
                let peak = String::from_utf8(run.unwrap().stdout).unwrap();
                println!(
                    "{len} samples, {segments} segments: peak memory of the process {}",
                    peak.trim()
                );
            }
            divan::main();
        }
        _ => divan::main(),
    }
}

/// Of this process, as Linux tells it.
fn peak_memory(len: usize, segments: usize) -> String {
    let series = wltc::series(len);
    let method = Dynamic::new(Cost::ZScale, segments).unwrap();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let _ = pool.install(|| method.segment(&series)).unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.unwrap_or("unknown").trim().to_owned()
}

fn optimum(bencher: Bencher<'_, '_>, len: usize, segments: usize, threads: usize) {
    let series = wltc::series(len);
    let method = Dynamic::new(Cost::ZScale, segments)
        .unwrap()
        .with_min_length(MIN_LENGTH);
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    bencher.counter(ItemsCount::new(len * len / 2)).bench(|| {
        let best = pool.install(|| method.segment(&series)).unwrap();
        assert_eq!(best.certificate, Certificate::Optimal);
        best
    });
}

/// Items are the segments `n² / 2`.
#[divan::bench(args = [1_500, 3_000, 6_000, 12_000], sample_count = 5, sample_size = 1)]
fn dynamic(bencher: Bencher<'_, '_>, len: usize) {
    optimum(bencher, len, SEGMENTS, 1);
}

#[divan::bench(args = [1, 2], sample_count = 1, sample_size = 1)]
fn dynamic_36_000_threads(bencher: Bencher<'_, '_>, threads: usize) {
    optimum(bencher, 36_000, SEGMENTS, threads);
}

#[divan::bench(args = [200, 500, 1_000], sample_count = 1, sample_size = 1)]
fn certified_36_000_segments(bencher: Bencher<'_, '_>, segments: usize) {
    optimum(bencher, 36_000, segments, 1);
}

#[divan::bench(args = [3_000, 12_000], sample_count = 3, sample_size = 1)]
fn penalty_path(bencher: Bencher<'_, '_>, len: usize) {
    let series = wltc::series(len);
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let path = || {
        PenaltyPath::new(Cost::ZScale, MIN_LENGTH, &series, &|_| {
            ControlFlow::Continue(())
        })
    };
    bencher.bench(|| pool.install(path).unwrap());
}

#[divan::bench(args = [750, 1_500], sample_count = 1, sample_size = 1)]
fn thesis_algorithm_2(bencher: Bencher<'_, '_>, len: usize) {
    let (speed, accel) = wltc::wltc(len);
    bencher
        .counter(ItemsCount::new(len * len / 2))
        .bench(|| table_of_costs(&[(&speed, 1.8), (&accel, 1.0)]));
}

/// Thesis Algorithm 2 as it stands: all costs first, each from its samples, then the recurrence.
fn table_of_costs(variables: &[(&[f64], f64)]) -> f64 {
    let n = variables[0].0.len();
    let cost = |start: usize, end: usize| {
        let count = (end - start) as f64;
        let term = |&(samples, weight): &(&[f64], f64)| {
            let x = &samples[start..end];
            let mean = x.iter().sum::<f64>() / count;
            let squares = x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            let absolute = x.iter().map(|x| (x - mean).abs()).sum::<f64>();
            if squares > 0.0 {
                weight * absolute / (squares / (count - 1.0)).sqrt()
            } else {
                0.0
            }
        };
        variables.iter().map(term).sum::<f64>()
    };
    let costs: Vec<Vec<f64>> = (0..n)
        .map(|l| (l + 1..=n).map(|r| cost(l, r)).collect())
        .collect();
    let mut best = vec![f64::INFINITY; n + 1];
    best[0] = 0.0;
    for _ in 0..SEGMENTS {
        let mut next = vec![f64::INFINITY; n + 1];
        for (l, row) in costs.iter().enumerate() {
            for (value, cost) in next[l + 1..].iter_mut().zip(row).skip(MIN_LENGTH - 1) {
                *value = value.min(best[l] + cost);
            }
        }
        best = next;
    }
    best[n]
}

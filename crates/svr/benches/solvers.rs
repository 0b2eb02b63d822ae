//! Fits and predictions of the task of the thesis (106 predictors of simulated drives), one core; before them, in processes
//! of their own, the peak memory and the support vectors of an rbf fit.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    missing_docs
)]

mod task;

use std::process::Command;

use divan::Bencher;
use divan::counter::ItemsCount;
use svr::{Fit, Kernel, Landmarks, Penalty, Response, Samples, Settings, Status};
use task::{PREDICTORS, Task};

const LENGTHS: [usize; 3] = [2_000, 8_000, 16_000];
const THESIS: usize = 16_000;
const NO_LIMIT: usize = 1_100_000_000;
const SMALL_LIMIT: usize = 300_000_000;

/// `--peak-memory SAMPLES LIMIT` fits once and prints the peak; without, such fits come before the benchmarks.
const PEAK_MEMORY: &str = "--peak-memory";

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match &arguments[1..] {
        [flag, samples, limit] if flag == PEAK_MEMORY => {
            println!(
                "{}",
                peak_memory(samples.parse().unwrap(), limit.parse().unwrap())
            );
        }
        [] | [_] if !arguments.contains(&"--test".to_owned()) => {
            for limit in [NO_LIMIT, SMALL_LIMIT] {
                let run = Command::new(&arguments[0])
                    .args([PEAK_MEMORY, &THESIS.to_string(), &limit.to_string()])
                    .output();
                let peak = String::from_utf8(run.unwrap().stdout).unwrap();
                println!(
                    "rbf, {THESIS} samples, limit {} MB: {}",
                    limit / 1_000_000,
                    peak.trim()
                );
            }
            divan::main();
        }
        _ => divan::main(),
    }
}

/// Of this process, as Linux tells it.
fn peak_memory(samples: usize, memory_limit_bytes: usize) -> String {
    let settings = Settings {
        memory_limit_bytes,
        ..of(Kernel::Rbf)
    };
    let fit = fit(&Task::load(samples), &settings);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    format!(
        "{} support vectors, peak memory of the process {}",
        fit.support_vectors,
        peak.unwrap_or("unknown").trim()
    )
}

fn of(kernel: Kernel) -> Settings {
    Settings {
        kernel,
        ..Settings::default()
    }
}

fn fit(task: &Task, settings: &Settings) -> Fit {
    let samples = Samples::new(&task.predictors, PREDICTORS).unwrap();
    let response = Response::new(&task.response).unwrap();
    let fit = svr::fit(&samples, &response, settings, &Penalty::default()).unwrap();
    assert_eq!(fit.status, Status::Optimal);
    fit
}

fn bench_fit(bencher: Bencher<'_, '_>, task: &Task, settings: &Settings) {
    bencher
        .counter(ItemsCount::new(task.response.len()))
        .bench(|| fit(task, settings));
}

/// To a duality gap of 10⁻⁸.
#[divan::bench(args = LENGTHS, sample_count = 5, sample_size = 1)]
fn linear(bencher: Bencher<'_, '_>, samples: usize) {
    bench_fit(bencher, &Task::load(samples), &of(Kernel::Linear));
}

/// To a violation of 10⁻³.
#[divan::bench(args = LENGTHS, sample_count = 3, sample_size = 1)]
fn rbf(bencher: Bencher<'_, '_>, samples: usize) {
    bench_fit(bencher, &Task::load(samples), &of(Kernel::Rbf));
}

/// To a violation of 10⁻³.
#[divan::bench(args = LENGTHS, sample_count = 3, sample_size = 1)]
fn quadratic(bencher: Bencher<'_, '_>, samples: usize) {
    bench_fit(bencher, &Task::load(samples), &of(Kernel::Quadratic));
}

/// Not all kernel rows have room.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn rbf_16000_in_300_mb(bencher: Bencher<'_, '_>) {
    let settings = Settings {
        memory_limit_bytes: SMALL_LIMIT,
        ..of(Kernel::Rbf)
    };
    bench_fit(bencher, &Task::load(THESIS), &settings);
}

/// All samples of the drives, about 70,000.
#[divan::bench(args = [Kernel::Rbf, Kernel::Quadratic], sample_count = 1, sample_size = 1)]
fn landmarks_512_of_all_samples(bencher: Bencher<'_, '_>, kernel: Kernel) {
    let settings = Settings {
        landmarks: Landmarks::Count(512),
        ..of(kernel)
    };
    bench_fit(bencher, &Task::load_up_to(usize::MAX), &settings);
}

/// 16,000 samples by a model of as many; the support vectors of rbf are above.
#[divan::bench(args = [Kernel::Linear, Kernel::Rbf, Kernel::Quadratic], sample_count = 3, sample_size = 1)]
fn predict_16000(bencher: Bencher<'_, '_>, kernel: Kernel) {
    let task = Task::load(THESIS);
    let fit = fit(&task, &of(kernel));
    let samples = Samples::new(&task.predictors, PREDICTORS).unwrap();
    bencher
        .counter(ItemsCount::new(THESIS))
        .bench(|| fit.model.predict(&samples).unwrap());
}

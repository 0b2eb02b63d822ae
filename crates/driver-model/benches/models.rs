//! The main job and its parts: phases of drives, fits beside a plain grid search over the same bounds, predictions, and
//! the whole evaluation.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::Bencher;
use divan::counter::ItemsCount;
use drive_log::Drive;
use driver_model::phase_model::{Exponential, Inverse, RiseTime};
use driver_model::synth::{SynthSettings, simulate};
use driver_model::{
    DriverModel, EvaluationSettings, PhaseOutline, PhaseSettings, Trip, leave_one_trip_out,
};
use ev_energy::Vehicle;

fn main() {
    divan::main();
}

const OUTLINE: PhaseOutline = PhaseOutline {
    start_speed_mps: 2.0,
    end_speed_mps: 14.0,
    step_s: 0.1,
    samples: 100,
};

fn segment_means(n: usize) -> Vec<(f64, f64)> {
    let truth = Inverse { p1: 0.04, p2: 0.5 };
    (0..n)
        .map(|i| {
            let v = 30.0 * i as f64 / n as f64;
            let scatter = 0.2 * (i as f64 * 2.399).sin();
            (v, 1.0 / (truth.p1 * v + truth.p2) + scatter)
        })
        .collect()
}

#[divan::bench]
fn fit_inverse(bencher: Bencher) {
    let means = segment_means(1000);
    bencher.bench(|| Inverse::fit(&means).unwrap());
}

#[divan::bench]
fn fit_exponential_with_amplitude(bencher: Bencher) {
    let means = segment_means(1000);
    bencher.bench(|| Exponential::fit_with_amplitude(&means).unwrap());
}

/// The rival: 100 × 100 points of a grid, which gives two digits of the parameters.
#[divan::bench]
fn fit_inverse_by_grid_search(bencher: Bencher) {
    let means = segment_means(1000);
    bencher.bench(|| {
        (0..10_000)
            .map(|k| Inverse {
                p1: f64::from(k % 100) * 0.01,
                p2: 0.05 + f64::from(k / 100) * 0.2,
            })
            .map(|m| m.residual_sum_of_squares(&means))
            .fold(f64::INFINITY, f64::min)
    });
}

#[divan::bench]
fn predict_inverse(bencher: Bencher) {
    let model = DriverModel::Inverse(Inverse { p1: 0.04, p2: 0.5 });
    bencher.bench(|| model.predict(&OUTLINE));
}

#[divan::bench]
fn predict_rise_time(bencher: Bencher) {
    let model = DriverModel::RiseTime(RiseTime::fit(&[OUTLINE]).unwrap());
    bencher.bench(|| model.predict(&OUTLINE));
}

fn simulated_drives() -> Vec<Drive> {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let drives = simulate(&SynthSettings::default(), &vehicle).unwrap();
    drives
        .into_iter()
        .map(|simulated| Drive::from(simulated.log))
        .collect()
}

/// Items are samples.
#[divan::bench]
fn find_phases_of_twelve_drives(bencher: Bencher) {
    let drives = simulated_drives();
    let samples: usize = drives.iter().map(|drive| drive.samples).sum();
    let settings = PhaseSettings::default();
    bencher.counter(ItemsCount::new(samples)).bench(|| {
        let trips = drives
            .iter()
            .map(|drive| Trip::from_drive(drive, &settings).unwrap());
        trips.collect::<Vec<_>>()
    });
}

/// Items are predicted phases, over all models.
#[divan::bench]
fn evaluate_twelve_drives(bencher: Bencher) {
    let settings = PhaseSettings::default();
    let trips: Vec<Trip> = simulated_drives()
        .iter()
        .map(|drive| Trip::from_drive(drive, &settings).unwrap())
        .collect();
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = EvaluationSettings::default();
    let evaluate = || leave_one_trip_out(&trips, &vehicle, &settings, &|| {}).unwrap();
    let evaluation = evaluate();
    let predictions = evaluation.phases.len() * evaluation.models.len();
    bencher
        .counter(ItemsCount::new(predictions))
        .bench(evaluate);
}

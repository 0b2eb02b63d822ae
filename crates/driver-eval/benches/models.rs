//! The main job and its parts: phases of drives, fits beside a plain grid search over the same bounds, predictions, and
//! the whole evaluation.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::Bencher;
use divan::counter::ItemsCount;
use drive_log::Drive;
use drive_sim::{SynthSettings, simulate};
use driver_eval::phase::{EvaluationData, EvaluationSettings, leave_one_out};
use driver_model::phase_model::{Exponential, Inverse};
use driver_model::{
    AccelPoint, DriveBehaviour, DriverInput, ModelKind, Motion, Onset, Phase, PhaseKind,
    PhaseModel, PhaseSettings, TrainingSet,
};
use ev_energy::Vehicle;

fn main() {
    divan::main();
}

const OUTLINE: Phase = Phase {
    start_speed_mps: 2.0,
    end_speed_mps: 14.0,
    step_s: 0.1,
    samples: 100,
    onset: Some(Onset {
        accel_mps2: 0.4,
        jerk_mps3: 1.0,
        previous_jerk_mps3: 0.2,
    }),
    input: DriverInput::NONE,
};

fn points(n: usize) -> Vec<AccelPoint> {
    let truth = Inverse { p1: 0.04, p2: 0.5 };
    (0..n)
        .map(|i| {
            let v = 30.0 * i as f64 / n as f64;
            let scatter = 0.2 * (i as f64 * 2.399).sin();
            AccelPoint::new(v, 1.0 / (truth.p1 * v + truth.p2) + scatter)
        })
        .collect()
}

/// Segment means of a driver, and all samples.
const POINTS: [usize; 2] = [1000, 100_000];

#[divan::bench(args = POINTS)]
fn fit_inverse(bencher: Bencher, n: usize) {
    let points = points(n);
    bencher.bench(|| Inverse::fit(&points).unwrap());
}

#[divan::bench(args = POINTS)]
fn fit_exponential(bencher: Bencher, n: usize) {
    let points = points(n);
    bencher.bench(|| Exponential::fit_printed(&points).unwrap());
}

#[divan::bench(args = POINTS)]
fn fit_exponential_with_amplitude(bencher: Bencher, n: usize) {
    let points = points(n);
    bencher.bench(|| Exponential::fit_with_amplitude(&points).unwrap());
}

/// The rival: 100 × 100 points of a grid, which gives two digits of the parameters.
#[divan::bench]
fn fit_inverse_by_grid_search(bencher: Bencher) {
    let points = points(1000);
    bencher.bench(|| {
        (0..10_000)
            .map(|k| Inverse {
                p1: f64::from(k % 100) * 0.01,
                p2: 0.05 + f64::from(k / 100) * 0.2,
            })
            .map(|m| m.residual_sum_of_squares(&points))
            .fold(f64::INFINITY, f64::min)
    });
}

#[divan::bench]
fn predict_inverse(bencher: Bencher) {
    let model = PhaseModel::Inverse(Inverse { p1: 0.04, p2: 0.5 });
    bencher.bench(|| model.predict(&OUTLINE));
}

const LEARNT: [ModelKind; 4] = [
    ModelKind::RiseTime,
    ModelKind::Profile,
    ModelKind::ProfileConditioned,
    ModelKind::ProfileOnset,
];

/// Drives with about 700 accelerations.
const DRIVES: usize = 50;

/// Of one phase, by a model fitted to those of [`fit_to_phases`].
#[divan::bench(args = LEARNT)]
fn predict(bencher: Bencher, kind: ModelKind) {
    let trips = simulated_trips(DRIVES);
    let training = TrainingSet::from_trips(PhaseKind::Acceleration, &trips);
    let model = PhaseModel::fit(kind, &training).unwrap();
    bencher.bench(|| model.predict(&OUTLINE));
}

/// Items are phases.
#[divan::bench(args = LEARNT, sample_count = 10)]
fn fit_to_phases(bencher: Bencher, kind: ModelKind) {
    let trips = simulated_trips(DRIVES);
    let training = TrainingSet::from_trips(PhaseKind::Acceleration, &trips);
    bencher
        .counter(ItemsCount::new(training.phases.len()))
        .bench(|| PhaseModel::fit(kind, &training).unwrap());
}

fn simulated_drives(drives: usize) -> Vec<Drive> {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = SynthSettings {
        drives,
        ..SynthSettings::default()
    };
    let drives = simulate(&settings, &vehicle).unwrap();
    drives
        .into_iter()
        .map(|simulated| Drive::from(simulated.log))
        .collect()
}

fn trip_of(drive: &Drive, settings: &PhaseSettings) -> DriveBehaviour {
    let motions = Motion::of_drive(drive, 100.0).unwrap();
    DriveBehaviour::of_drive(&motions, settings).unwrap()
}

fn simulated_trips(drives: usize) -> Vec<DriveBehaviour> {
    let settings = PhaseSettings::default();
    simulated_drives(drives)
        .iter()
        .map(|drive| trip_of(drive, &settings))
        .collect()
}

/// Items are samples.
#[divan::bench]
fn find_phases_of_twelve_drives(bencher: Bencher) {
    let drives = simulated_drives(12);
    let samples: usize = drives.iter().map(|drive| drive.samples).sum();
    let settings = PhaseSettings::default();
    bencher.counter(ItemsCount::new(samples)).bench(|| {
        let trips = drives.iter().map(|drive| trip_of(drive, &settings));
        trips.collect::<Vec<_>>()
    });
}

/// Items are predicted phases, over all models.
#[divan::bench]
fn evaluate_twelve_drives(bencher: Bencher) {
    let trips = simulated_trips(12);
    let data = EvaluationData::by_trip(&trips);
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let settings = EvaluationSettings::default();
    let evaluate = || {
        let kind = PhaseKind::Acceleration;
        leave_one_out(kind, &data, &vehicle, &settings, &|| {}).unwrap()
    };
    let evaluation = evaluate();
    let predictions = evaluation.phases.len() * evaluation.models.len();
    bencher
        .counter(ItemsCount::new(predictions))
        .bench(evaluate);
}

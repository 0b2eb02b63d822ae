//! Speed and slope in, battery energy out; and slope from elevation.

#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box, counter::ItemsCount};
use ev_energy::{
    DEFAULT_SLOPE_BANDWIDTH_M, Trip, Vehicle, library, slope_from_accelerometer,
    slope_from_elevation,
};

/// One hour at 10 Hz.
const SAMPLES: usize = 36_000;
const STEP_S: f64 = 0.1;

fn main() {
    divan::main();
}

/// Stop and go up to 36 m/s over rolling hills.
fn drive() -> (Vec<f64>, Vec<f64>) {
    let time_s = (0..SAMPLES).map(|i| i as f64 * STEP_S);
    let speed_mps = time_s
        .clone()
        .map(|t| (18.0 + 14.0 * (t / 40.0).sin() + 6.0 * (t / 7.0).sin()).max(0.0))
        .collect();
    let slope_rad = time_s.map(|t| 0.04 * (t / 60.0).sin()).collect();
    (speed_mps, slope_rad)
}

#[divan::bench(args = library::names())]
fn trip_with_slope(bencher: Bencher, name: &str) {
    let vehicle = Vehicle::builtin(name).unwrap();
    let (speed_mps, slope_rad) = drive();
    let trip = Trip {
        step_s: STEP_S,
        speed_mps: &speed_mps,
        slope_rad: Some(&slope_rad),
        ..Trip::default()
    };
    bencher
        .counter(ItemsCount::new(SAMPLES))
        .bench(|| vehicle.trip_energy(black_box(&trip)).unwrap());
}

#[divan::bench]
fn trip_on_the_level(bencher: Bencher) {
    let vehicle = Vehicle::builtin("b250e").unwrap();
    let (speed_mps, _) = drive();
    let trip = Trip {
        step_s: STEP_S,
        speed_mps: &speed_mps,
        slope_rad: None,
        ..Trip::default()
    };
    bencher
        .counter(ItemsCount::new(SAMPLES))
        .bench(|| vehicle.trip_energy(black_box(&trip)).unwrap());
}

/// The voltage follows the state of charge, step by step.
#[divan::bench]
fn trip_with_charge(bencher: Bencher) {
    let vehicle = Vehicle::builtin("bmw-i3-60ah").unwrap();
    let (speed_mps, slope_rad) = drive();
    let trip = Trip {
        step_s: STEP_S,
        speed_mps: &speed_mps,
        slope_rad: Some(&slope_rad),
        soc_start_pct: Some(80.0),
        ..Trip::default()
    };
    bencher
        .counter(ItemsCount::new(SAMPLES))
        .bench(|| vehicle.trip_energy(black_box(&trip)).unwrap());
}

#[divan::bench]
fn slope_with_accelerometer(bencher: Bencher) {
    let (speed_mps, slope_rad) = drive();
    let elevation_m: Vec<f64> = (0..SAMPLES).map(|i| (i as f64 * 1e-3).sin()).collect();
    bencher.counter(ItemsCount::new(SAMPLES)).bench(|| {
        slope_from_accelerometer(
            STEP_S,
            black_box(&speed_mps),
            &slope_rad,
            Some(&elevation_m),
            DEFAULT_SLOPE_BANDWIDTH_M,
        )
        .unwrap()
    });
}

#[divan::bench]
fn slope(bencher: Bencher) {
    let (speed_mps, _) = drive();
    let mut travelled_m = 0.0;
    let distance_m: Vec<f64> = speed_mps
        .iter()
        .map(|v| {
            travelled_m += v * STEP_S;
            travelled_m
        })
        .collect();
    let elevation_m: Vec<f64> = distance_m
        .iter()
        .map(|s| 30.0 * (s / 900.0).sin())
        .collect();
    bencher.counter(ItemsCount::new(SAMPLES)).bench(|| {
        slope_from_elevation(
            black_box(&distance_m),
            &elevation_m,
            DEFAULT_SLOPE_BANDWIDTH_M,
        )
        .unwrap()
    });
}

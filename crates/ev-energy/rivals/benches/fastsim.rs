//! The urban cycle (UDDS) with the Renault Zoe of both: energy from speed, step by step.
//!
//! `fastsim-core` limits, controls and follows more (speed achieved, state of charge, power over temperature); the ratio says what
//! a simulator of that kind costs, not that it is slow at what it does.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

use divan::{Bencher, black_box, counter::ItemsCount};
use ev_energy::{Cycle, JOULES_PER_KWH, Trip, Vehicle};
use fastsim_core::prelude as fastsim;
use fastsim_core::traits::{HistoryMethods as _, Init as _, SerdeAPI as _};

fn main() {
    let (ours_j, distance_m) = {
        let energy = Vehicle::builtin("renault-zoe-ze50")
            .unwrap()
            .trip_energy(&trip(&Cycle::Udds.speed_mps()))
            .unwrap();
        (energy.battery_energy_j, energy.distance_m)
    };
    let per_100km = |energy_j: f64| energy_j / JOULES_PER_KWH / (distance_m / 1e5);
    println!(
        "energy from the cells, kWh/100 km: ev-energy {:.2}",
        per_100km(ours_j)
    );
    let theirs = walked();
    let battery = &theirs.veh.bev().unwrap().res.state;
    let theirs_j = battery
        .energy_out_chemical
        .get_fresh(String::new)
        .unwrap()
        .value;
    println!(
        "                                    fastsim-core {:.2}",
        per_100km(theirs_j)
    );
    divan::main();
}

fn trip(speed_mps: &[f64]) -> Trip<'_> {
    Trip {
        step_s: 1.0,
        speed_mps,
        ..Trip::default()
    }
}

fn simulation() -> fastsim::SimDrive {
    let mut vehicle =
        fastsim::Vehicle::from_resource("2022_Renault_Zoe_ZE50_R135.yaml", false).unwrap();
    vehicle.set_save_interval(None).unwrap();
    vehicle.init().unwrap();
    let cycle = fastsim::Cycle::from_resource("udds.csv", false).unwrap();
    fastsim::SimDrive::new(vehicle, cycle, None)
}

fn walked() -> fastsim::SimDrive {
    let mut simulation = simulation();
    simulation.run().unwrap();
    simulation
}

#[divan::bench]
fn ev_energy(bencher: Bencher) {
    let vehicle = Vehicle::builtin("renault-zoe-ze50").unwrap();
    let speed_mps = Cycle::Udds.speed_mps();
    bencher
        .counter(ItemsCount::new(speed_mps.len()))
        .bench(|| vehicle.trip_energy(black_box(&trip(&speed_mps))).unwrap());
}

#[divan::bench]
fn fastsim_core(bencher: Bencher) {
    bencher
        .counter(ItemsCount::new(Cycle::Udds.speed_mps().len()))
        .with_inputs(simulation)
        .bench_values(|mut simulation| {
            simulation.run().unwrap();
            simulation
        });
}

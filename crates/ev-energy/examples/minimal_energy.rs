//! What a minute of driving takes: from rest to 10 m/s in 10 s, then on at that speed.
//!
//! `cargo run -p ev-energy --example minimal_energy`

#![allow(clippy::print_stdout)]

use std::error::Error;

use ev_energy::{Trip, Vehicle};

fn main() -> Result<(), Box<dyn Error>> {
    let vehicle = Vehicle::builtin("b250e")?;
    let speed_mps: Vec<f64> = (0..=60).map(|t| f64::from(t).min(10.0)).collect();
    let trip = Trip {
        step_s: 1.0,
        speed_mps: &speed_mps,
        ..Trip::default()
    };
    let energy = vehicle.trip_energy(&trip)?;
    println!(
        "{:.0} m with {:.1} kJ from the cells, of which {:.1} kJ are in the motion still",
        energy.distance_m,
        energy.battery_energy_j / 1e3,
        energy.budget.inertia_j / 1e3
    );
    Ok(())
}

//! Where the energy of a standard cycle goes, term by term.
//!
//! `cargo run -p ev-energy --example cycle_energy`

#![allow(clippy::print_stdout)]

use std::error::Error;

use ev_energy::{JOULES_PER_KWH, Trip, Vehicle};

/// Time in s and speed in km/h.
const CYCLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../fixtures/cycles/wltc-3b.csv"
);

fn main() -> Result<(), Box<dyn Error>> {
    let speed_mps: Vec<f64> = std::fs::read_to_string(CYCLE)?
        .lines()
        .filter_map(|line| line.split(',').nth(1)?.parse::<f64>().ok())
        .map(|speed_kmh| speed_kmh / 3.6)
        .collect();
    let trip = Trip {
        step_s: 1.0,
        speed_mps: &speed_mps,
        ..Trip::default()
    };
    let energy = Vehicle::builtin("vw-id3")?.trip_energy(&trip)?;
    let budget = &energy.budget;
    for (name, energy_j) in [
        ("air drag", budget.aero_j),
        ("rolling", budget.rolling_j),
        ("gear", budget.gear_loss_j),
        ("motor and inverter", budget.motor_loss_j),
        ("battery", budget.battery_loss_j),
        ("auxiliaries", budget.auxiliary_j),
        ("friction brakes", budget.friction_brake_j),
        ("from the cells", energy.battery_energy_j),
        ("back into the battery", budget.regenerated_j),
    ] {
        println!("{name:<22}{:8.3} kWh", energy_j / JOULES_PER_KWH);
    }
    Ok(())
}

//! The same cycle with every built-in vehicle, and with one that is made heavier.
//!
//! `cargo run -p ev-energy --example other_vehicle`

#![allow(clippy::print_stdout)]

use std::error::Error;

use ev_energy::{Cycle, Trip, Vehicle, library};

fn main() -> Result<(), Box<dyn Error>> {
    let mut vehicles = library::names()
        .map(Vehicle::builtin)
        .collect::<Result<Vec<_>, _>>()?;

    let mut spec = Vehicle::builtin("vw-id3")?.spec().clone();
    spec.name = "vw-id3 with 300 kg more".to_owned();
    spec.mass_kg += 300.0;
    vehicles.push(Vehicle::new(spec)?);

    let speed_mps = Cycle::Udds.speed_mps();
    let trip = Trip {
        step_s: 1.0,
        speed_mps: &speed_mps,
        ..Trip::default()
    };
    for vehicle in &vehicles {
        let energy = vehicle.trip_energy(&trip)?;
        println!(
            "{:<26}{:5.1} kWh per 100 km at the terminals",
            vehicle.spec().name,
            energy.consumption_kwh_per_100km().unwrap_or(f64::NAN)
        );
    }
    Ok(())
}

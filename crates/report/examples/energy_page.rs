//! The page of one trip: the flow of its energy, its power over time, and its row in the table.
//!
//! `cargo run -p report --example energy_page > energy.html`, then open the file in a browser.

#![allow(clippy::print_stdout)]

use std::error::Error;

use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let time_s: Vec<f64> = (0..120).map(f64::from).collect();
    let speed_mps: Vec<f64> = time_s.iter().map(|t| 7.0 - 7.0 * (t / 9.0).cos()).collect();
    let accel_mps2 = time_s.iter().map(|t| 7.0 / 9.0 * (t / 9.0).sin());
    let moving = speed_mps.iter().zip(accel_mps2);
    let modelled_w: Vec<f64> = moving
        .map(|(v, a)| 500.0 + v * (220.0 + 1300.0 * a))
        .collect();
    let trip = json!({
        "name": "to the station",
        "vehicle": "b250e",
        "trips": 1,
        "distance_m": 795.0,
        "duration_s": 119.0,
        "battery_energy_j": 5.6e5,
        "terminal_energy_j": 5.5e5,
        "consumption_kwh_per_100km": 19.2,
        "budget": {
            "battery_loss_j": 1e4, "auxiliary_j": 6e4, "motor_loss_j": 1.2e5, "gear_loss_j": 3e4,
            "aero_j": 1.1e5, "rolling_j": 1.3e5, "grade_j": 4e4, "inertia_j": 2e4,
            "friction_brake_j": 4e4, "regenerated_j": 9e4,
        },
        "wheel": { "propelled_j": 4.9e5, "braked_j": 1.9e5 },
        "curve": { "time_s": time_s, "speed_mps": speed_mps, "modelled_w": modelled_w, "measured_w": [] },
    });
    let document = json!({
        "schema": "drivekit/energy/1",
        "version": "0.1.0",
        "config": {},
        "inputs": [],
        "logs": [&trip],
        "totals": [&trip],
    });
    println!("{}", report::ENERGY.filled(&document));
    Ok(())
}

//! Two drives of an ordinary driver, and what really happened in the first of them.
//!
//! `cargo run -p drive-sim --example minimal_drive`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_sim::{SynthSettings, simulate};
use ev_energy::Vehicle;

fn main() -> Result<(), Box<dyn Error>> {
    let settings = SynthSettings {
        seed: 7,
        drives: 2,
        duration_s: 120.0,
        ..SynthSettings::default()
    };
    let drives = simulate(&settings, &Vehicle::builtin("b250e")?)?;
    for drive in &drives {
        println!("{}: {} samples", drive.log.name(), drive.log.len());
    }
    for phase in drives.iter().take(1).flat_map(|drive| &drive.phases) {
        println!(
            "from {:5.1} s at {:4.1} m/s: {:?}",
            phase.start as f64 * settings.step_s,
            phase.start_speed_mps,
            phase.regime
        );
    }
    Ok(())
}

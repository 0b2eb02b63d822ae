//! A simulated drive as a car would record it, as CSV on stdout.
//!
//! `cargo run -p drive-sim --example as_csv > drive-01.csv`

use std::error::Error;
use std::io::{BufWriter, stdout};

use drive_log::write_csv;
use drive_sim::{SynthSettings, simulate};
use ev_energy::Vehicle;

fn main() -> Result<(), Box<dyn Error>> {
    let settings = SynthSettings {
        drives: 1,
        duration_s: 60.0,
        leaders: false,
        ..SynthSettings::default()
    };
    for drive in simulate(&settings, &Vehicle::builtin("b250e")?)? {
        write_csv(&drive.log, BufWriter::new(stdout().lock()))?;
    }
    Ok(())
}

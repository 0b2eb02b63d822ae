//! A log of three samples, read, checked and put on a grid of 0.1 s.
//!
//! `cargo run -p drive-log --example minimal_log`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_log::{LayoutChoice, Preparation, prepare, read_bytes};

fn main() -> Result<(), Box<dyn Error>> {
    let csv = "time_s;speed_kmh;elevation_m\n0;36;100\n0,5;39,6;\n1;36;102\n";
    let file = read_bytes("trip.csv".as_ref(), csv.as_bytes(), &LayoutChoice::Auto)?;
    println!("layout {}", file.layout);

    for log in file.logs {
        let drive = prepare(log, &Preparation::default())?;
        for finding in &drive.findings {
            println!(
                "{} in {}: {}",
                finding.kind, finding.channel, finding.detail
            );
        }
        for trip in &drive.pieces {
            println!(
                "{}, {} samples of {} s",
                trip.name(),
                trip.len(),
                trip.step_s()
            );
            println!("speed in m/s: {:.2?}", trip.speed_mps());
        }
    }
    Ok(())
}

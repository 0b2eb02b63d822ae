//! What is wrong with a recording, where, and what was done about it.
//!
//! `cargo run -p drive-log --example findings`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_log::{LayoutChoice, Preparation, prepare, read_bytes};

fn main() -> Result<(), Box<dyn Error>> {
    // Two minutes at 1 Hz with a speed that no car has, an elevation that stays away, and a row that comes twice.
    let mut csv = String::from("time_s,speed_kmh,elevation_m\n");
    for second in 0..120 {
        let time_s = f64::from(second);
        let speed_kmh = match second {
            40 => 400.0,
            _ => 50.0 + 10.0 * (0.2 * time_s).sin(),
        };
        let elevation_m = match second {
            60..70 => String::new(),
            _ => format!("{:.1}", 100.0 + 0.1 * time_s),
        };
        let row = format!("{time_s},{speed_kmh:.1},{elevation_m}\n");
        csv.push_str(&row);
        if second == 80 {
            csv.push_str(&row);
        }
    }

    for log in read_bytes("faulty.csv".as_ref(), csv.as_bytes(), &LayoutChoice::Auto)?.logs {
        let drive = prepare(log, &Preparation::default())?;
        println!("{} samples, {:.0} m", drive.samples, drive.distance_m());
        for finding in &drive.findings {
            println!(
                "{:5.1} to {:5.1} s  {}: {} - {} ({})",
                finding.from_s,
                finding.to_s,
                finding.channel,
                finding.kind,
                finding.detail,
                finding.action
            );
        }
    }
    Ok(())
}

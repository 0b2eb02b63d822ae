//! How a driver follows: learnt from four drives, and asked behind the vehicles of a fifth.
//!
//! `cargo run -p driver-model --example following`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_log::{LayoutChoice, Preparation, prepare, read_file};
use driver_model::following::{FollowingModel, FollowingSettings, following_stretches};
use driver_model::statistics::mean;
use driver_model::{DriverModel, ModelKind, Motion, fit};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

const DRIVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

fn main() -> Result<(), Box<dyn Error>> {
    let mut motions = Vec::new();
    for number in 1..=5 {
        let path = format!("{DRIVES}/drive-{number:02}.csv");
        for log in read_file(path.as_ref(), &LayoutChoice::Auto)?.logs {
            let drive = prepare(log, &Preparation::default())?;
            motions.extend(Motion::of_drive(&drive, DEFAULT_SLOPE_BANDWIDTH_M)?);
        }
    }
    let asked = motions.pop().ok_or("no drive")?;
    let model = fit(ModelKind::Idm, &motions, None)?;
    if let DriverModel::Following(FollowingModel::Idm { idm, .. }) = &model {
        println!("time headway {:.2} s", idm.time_headway_s);
        println!("gap at standstill {:.2} m", idm.standstill_gap_m);
    }

    for stretch in following_stretches(&asked, &FollowingSettings::default()) {
        let speed_mps = model.predict(&stretch)?;
        let pairs = speed_mps.iter().zip(stretch.speed_mps());
        let off_mps = mean(pairs.map(|(found, measured)| (found - measured).abs()));
        println!(
            "{:.0} s behind a vehicle: off by {:.2} m/s",
            stretch.duration_s(),
            off_mps.unwrap_or(f64::NAN)
        );
    }
    Ok(())
}

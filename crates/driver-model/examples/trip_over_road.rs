//! A whole trip from its road alone: limits and a stop are told, the habits are learnt from four drives.
//!
//! `cargo run -p driver-model --example trip_over_road`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_log::{LayoutChoice, Preparation, prepare, read_file};
use driver_model::road::{LimitFrom, Road, RoadMap, RoadStop};
use driver_model::{ModelKind, Motion, Situation, fit};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

const DRIVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

fn main() -> Result<(), Box<dyn Error>> {
    let mut motions = Vec::new();
    for number in 1..=4 {
        let path = format!("{DRIVES}/drive-{number:02}.csv");
        for log in read_file(path.as_ref(), &LayoutChoice::Auto)?.logs {
            let drive = prepare(log, &Preparation::default())?;
            motions.extend(Motion::of_drive(&drive, DEFAULT_SLOPE_BANDWIDTH_M)?);
        }
    }
    let model = fit(ModelKind::TripDriver, &motions, None)?;

    let limit = |position_m, limit_kmh: f64| LimitFrom {
        position_m,
        limit_mps: limit_kmh / 3.6,
    };
    let stop = |position_m, dwell_s| RoadStop {
        position_m,
        dwell_s,
    };
    let road = Road::new(RoadMap {
        length_m: 2500.0,
        limits: vec![limit(0.0, 50.0), limit(900.0, 100.0)],
        stops: vec![stop(800.0, 20.0), stop(2500.0, 0.0)],
        ..RoadMap::default()
    })?;
    let speed_mps = model.predict(Situation::Road {
        road: &road,
        step_s: 1.0,
    })?;
    for (time_s, speed_mps) in speed_mps.iter().enumerate().step_by(10) {
        println!("after {time_s:3} s {:5.1} km/h", speed_mps * 3.6);
    }
    Ok(())
}

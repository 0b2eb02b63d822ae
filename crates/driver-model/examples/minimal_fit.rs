//! From speed over time to a model of the driver, and from two speeds and a duration to a prediction.
//!
//! `cargo run -p driver-model --example minimal_fit`

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;

use driver_model::{ModelKind, Motion, Phase, fit};

fn main() -> Result<(), Box<dyn Error>> {
    // Twelve times from rest to some speed and back, ten samples a second.
    let mut speed_mps = Vec::new();
    for rise in 0..12 {
        let (highest_mps, samples) = (8.0 + f64::from(rise), 160 + 10 * rise);
        let share = |k: i32| f64::from(k) / f64::from(samples);
        speed_mps.extend((0..samples).map(|k| highest_mps * (1.0 - (TAU * share(k)).cos()) / 2.0));
    }
    let time_s: Vec<f64> = (0..speed_mps.len()).map(|k| 0.1 * k as f64).collect();

    let m = Motion::from_samples("anna", &time_s, &speed_mps)?;
    let model = fit(ModelKind::ProfileOnset, &[m], None)?;
    let v = model.predict(&Phase::from_to(0.0, 13.9).lasting(8.0))?;

    for (k, v) in v.iter().enumerate().step_by(10) {
        println!("after {:.0} s {v:5.2} m/s", 0.1 * k as f64);
    }
    Ok(())
}

//! A driver who accelerates by `1/(p1 v + p2)`, and the parameters that a fit to his drives finds.
//!
//! `cargo run -p drive-sim --example recover_truth`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_sim::{SimulatedDriver, SynthSettings, simulate};
use driver_model::{DriverModel, ModelKind, Motion, PhaseModel, fit};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};

fn main() -> Result<(), Box<dyn Error>> {
    // Every phase alike, nobody in the way, sensors exact.
    let kind = ModelKind::Inverse;
    let driver = SimulatedDriver::with(kind).ok_or("no driver accelerates like this")?;
    let settings = SynthSettings {
        drives: 4,
        driver,
        variation: 0.0,
        sensor_noise: false,
        leaders: false,
        ..SynthSettings::default()
    };
    let motions = simulate(&settings, &Vehicle::builtin("b250e")?)?
        .iter()
        .map(|drive| Motion::of_log(&drive.log, DEFAULT_SLOPE_BANDWIDTH_M))
        .collect::<Result<Vec<_>, _>>()?;

    let truth = &settings.driver.acceleration;
    if let (PhaseModel::Inverse(truth), DriverModel::Acceleration(PhaseModel::Inverse(found))) =
        (truth, fit(kind, &motions, None)?)
    {
        println!("p1 = {:.4} s³/m² found, {:.4} true", found.p1, truth.p1);
        println!("p2 = {:.4} s²/m found, {:.4} true", found.p2, truth.p2);
    }
    Ok(())
}

//! Everything that the driver of six recorded drives does, held out: acceleration, braking, cruising, following.
//!
//! `cargo run -p driver-eval --example main_job`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_log::{LayoutChoice, Preparation, prepare, read_file};
use driver_eval::behaviour::{BehaviourSettings, evaluate_behaviour};
use driver_eval::phase::EvaluationData;
use driver_model::{DriveBehaviour, Motion, PhaseSettings};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};

const DRIVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

fn main() -> Result<(), Box<dyn Error>> {
    let mut trips = Vec::new();
    for number in 1..=6 {
        let path = format!("{DRIVES}/drive-{number:02}.csv");
        for log in read_file(path.as_ref(), &LayoutChoice::Auto)?.logs {
            let drive = prepare(log, &Preparation::default())?;
            let motions = Motion::of_drive(&drive, DEFAULT_SLOPE_BANDWIDTH_M)?;
            trips.push(DriveBehaviour::of_drive(
                &motions,
                &PhaseSettings::default(),
            )?);
        }
    }
    let data = EvaluationData::by_trip(&trips);
    let vehicle = Vehicle::builtin("b250e")?;
    let found = evaluate_behaviour(&data, &vehicle, &BehaviourSettings::default(), &|| {})?;

    for evaluation in found.phases() {
        let (kind, phases) = (evaluation.kind.name(), evaluation.phases.len());
        println!("{kind}, {phases} phases");
        for (model, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
            let rmse_kmh = summary.figures.rmse_mps * 3.6;
            println!("  {:22} {rmse_kmh:5.2} km/h", model.name());
        }
    }
    if let Some(cruise) = &found.cruise {
        println!("cruise, {:.2} km/h", cruise.cruise.rmse_mps * 3.6);
    }
    if let Some((following, _)) = &found.following {
        println!("following, gap {:.2} m", following.held_out.idm.gap_rmse_m);
    }
    Ok(())
}

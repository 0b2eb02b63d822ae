//! Three simulated drives, each held out once: every model of acceleration phases beside the baselines.
//!
//! `cargo run -p driver-eval --example minimal_evaluation`

#![allow(clippy::print_stdout)]

use std::error::Error;

use drive_sim::{SynthSettings, simulate};
use driver_eval::phase::{EvaluationData, EvaluationSettings, leave_one_out};
use driver_model::{DriveBehaviour, Motion, PhaseKind, PhaseSettings};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};

fn main() -> Result<(), Box<dyn Error>> {
    let vehicle = Vehicle::builtin("b250e")?;
    let settings = SynthSettings {
        drives: 3,
        duration_s: 200.0,
        ..SynthSettings::default()
    };
    let mut trips = Vec::new();
    for simulated in simulate(&settings, &vehicle)? {
        let motion = Motion::of_log(&simulated.log, DEFAULT_SLOPE_BANDWIDTH_M)?;
        trips.push(DriveBehaviour::of_drive(
            &[motion],
            &PhaseSettings::default(),
        )?);
    }

    let data = EvaluationData::by_trip(&trips);
    let settings = EvaluationSettings::default();
    let evaluation = leave_one_out(PhaseKind::Acceleration, &data, &vehicle, &settings, &|| {})?;
    for (model, summary) in evaluation.models.iter().zip(&evaluation.summaries) {
        let figures = &summary.figures;
        println!(
            "{:22} {:5.2} km/h  {:5.1} % in band",
            model.name(),
            figures.rmse_mps * 3.6,
            figures.in_band_pct
        );
    }
    for (model, reason) in &evaluation.left_out {
        println!("{:22} {reason}", model.name());
    }
    Ok(())
}

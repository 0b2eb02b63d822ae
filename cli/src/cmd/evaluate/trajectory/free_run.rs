//! Whole trips from the road and the driver alone.

use drive_log::DriveLog;
use driver_eval::Error;
use driver_eval::trip_driver::{FreeRunEvaluation, FreeRunSettings, evaluate_free_run};
use driver_model::energy::slope_rad;
use driver_model::road::{Road, RoadKnowledge};
use driver_model::trip_driver::FreeRun;
use ev_energy::Vehicle;
use serde_json::{Value, json};

use crate::inputs::Input;

/// The evaluation with what the road may know, the less first.
pub(super) struct FreeRuns {
    /// Stops, and slowdowns as the driver is expected to make.
    pub(super) expected: FreeRunEvaluation,
    /// Stops and slowdowns as they were on the trip: what a map could know at most.
    pub(super) known: FreeRunEvaluation,
}

/// The reason in place of figures where too few drives know their limits or are long enough: it is no reason to lose the rest.
pub(super) fn evaluate(
    inputs: &[Input],
    units: &[String],
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<FreeRuns, Error> {
    let of_drives = inputs.iter().zip(units);
    let (logs, units): (Vec<&DriveLog>, Vec<String>) = of_drives
        .flat_map(|(input, unit)| {
            input
                .drive
                .pieces
                .iter()
                .map(move |log| (log, unit.clone()))
        })
        .unzip();
    let with = |knowledge| {
        let settings = FreeRunSettings {
            knowledge,
            ..*settings
        };
        evaluate_free_run(&logs, &units, &settings, vehicle, &|| {})
    };
    Ok(FreeRuns {
        expected: with(RoadKnowledge::Stops)?,
        known: with(RoadKnowledge::StopsAndSlowdowns)?,
    })
}

/// The longest trip that was compared, measured and as the driver of its fold drives it, second by second.
pub(super) fn curve(
    inputs: &[Input],
    runs: &FreeRuns,
    slope_bandwidth_m: f64,
) -> anyhow::Result<Option<Value>> {
    let trips = runs.expected.trips.iter();
    let Some(trip) = trips.max_by(|a, b| a.score.duration_s.total_cmp(&b.score.duration_s)) else {
        return Ok(None);
    };
    let mut logs = inputs.iter().flat_map(|input| &input.drive.pieces);
    let log = logs.find(|log| log.name() == trip.log);
    let fold = runs
        .expected
        .folds
        .iter()
        .find(|fold| fold.held_out.contains(&trip.group));
    let Some((log, fold)) = log.zip(fold) else {
        return Ok(None);
    };
    let road = Road::of_log(
        log,
        slope_rad(log, slope_bandwidth_m)?.as_deref(),
        RoadKnowledge::Stops,
    )?;
    let run = fold.driver.drive(&road, 1.0, Some(trip.score.duration_s))?;
    Ok(Some(json!({
        "name": log.name(),
        "measured": measured(log, trip.score.duration_s),
        "predicted": predicted(&run),
    })))
}

fn measured(log: &DriveLog, duration_s: f64) -> Value {
    let stride = ((1.0 / log.step_s()).round() as usize).max(1);
    let last = (duration_s / log.step_s()) as usize;
    let every = |values: &[f64]| {
        super::document::rounded(values.iter().take(last + 1).step_by(stride).copied())
    };
    json!({ "speed_mps": every(log.speed_mps()), "distance_m": every(&log.distance_m()) })
}

fn predicted(run: &FreeRun) -> Value {
    let of = |values: &[f64]| super::document::rounded(values.iter().copied());
    json!({ "speed_mps": of(&run.speed_mps), "distance_m": of(&run.position_m) })
}

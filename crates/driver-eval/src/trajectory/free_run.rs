//! Whole trips from the road and the driver alone.

use driver_model::Motion;
use driver_model::road::{Road, RoadKnowledge};
use driver_model::trip_driver::FreeRun;
use ev_energy::Vehicle;
use serde_json::{Value, json};

use crate::Error;
use crate::trip_driver::{FreeRunEvaluation, FreeRunSettings, evaluate_free_run};
use crate::words::millimetres;

/// The evaluation with what the road may know, the less first.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRuns {
    /// Stops, and slowdowns as the driver is expected to make.
    pub expected: FreeRunEvaluation,
    /// Stops and slowdowns as they were on the trip: what a map could know at most.
    pub known: FreeRunEvaluation,
}

/// The reason in place of figures where too few drives know their limits or are long enough: it is no reason to lose the rest.
pub(super) fn evaluate(
    motions: &[Motion],
    units: &[String],
    settings: &FreeRunSettings,
    vehicle: &Vehicle,
) -> Result<FreeRuns, Error> {
    let with = |knowledge| {
        let settings = FreeRunSettings {
            knowledge,
            ..*settings
        };
        evaluate_free_run(motions, units, &settings, vehicle, &|| {})
    };
    Ok(FreeRuns {
        expected: with(RoadKnowledge::Stops)?,
        known: with(RoadKnowledge::StopsAndSlowdowns)?,
    })
}

/// The longest trip that was compared, measured and as the driver of its fold drives it, second by second.
pub(super) fn curve(motions: &[Motion], runs: &FreeRuns) -> Result<Option<Value>, Error> {
    let trips = runs.expected.trips.iter();
    let Some(trip) = trips.max_by(|a, b| a.score.duration_s.total_cmp(&b.score.duration_s)) else {
        return Ok(None);
    };
    let motion = motions.iter().find(|motion| motion.name() == trip.log);
    let fold = runs
        .expected
        .folds
        .iter()
        .find(|fold| fold.held_out.contains(&trip.group));
    let Some((motion, fold)) = motion.zip(fold) else {
        return Ok(None);
    };
    let road = Road::of_motion(motion, RoadKnowledge::Stops)?;
    let run = fold.driver.drive(&road, 1.0, Some(trip.score.duration_s))?;
    Ok(Some(json!({
        "name": motion.name(),
        "measured": measured(motion, trip.score.duration_s),
        "predicted": predicted(&run),
    })))
}

fn measured(motion: &Motion, duration_s: f64) -> Value {
    let stride = motion.samples_in(1.0);
    let last = (duration_s / motion.step_s()) as usize;
    let every = |values: &[f64]| millimetres(values.iter().take(last + 1).step_by(stride).copied());
    json!({ "speed_mps": every(motion.speed_mps()), "distance_m": every(motion.distance_m()) })
}

fn predicted(run: &FreeRun) -> Value {
    let of = |values: &[f64]| millimetres(values.iter().copied());
    json!({ "speed_mps": of(&run.speed_mps), "distance_m": of(&run.position_m) })
}

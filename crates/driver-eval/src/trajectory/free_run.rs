//! Whole trips from the road and the driver alone.

use std::fmt::Write as _;

use driver_model::Motion;
use driver_model::road::{Road, RoadKnowledge};
use driver_model::trip_driver::FreeRun;
use ev_energy::Vehicle;
use serde_json::{Value, json};

use crate::Error;
use crate::trip_driver::{FreeRunEvaluation, FreeRunSettings, evaluate_free_run};
use crate::words::millimetres;

/// Less of the time is not worth a word.
const JOINED_PCT: f64 = 1.0;

/// The evaluation with what the road may know, the less first.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRuns {
    /// Stops, and slowdowns as the driver is expected to make.
    pub expected: FreeRunEvaluation,
    /// Stops and slowdowns as they were on the trip: what a map could know at most.
    pub known: FreeRunEvaluation,
}

impl FreeRuns {
    /// How their figures are to be read, a line each.
    #[must_use]
    pub fn in_words(&self) -> String {
        let mut words = String::from(
            "Where neither limit nor stop explains a slowdown (turns, traffic), the first row puts slowdowns in as often as the driver makes them:\n\
             right on average, not on a single trip. What an evenly driven plan costs less than the other trips did, the driver's unrest makes up for.\n",
        );
        if self.expected.joined_pct > JOINED_PCT {
            let _ = writeln!(
                words,
                "In {:.0} % of the time the speed's reading was held until the next came; both are joined by straight lines, in what is learnt and in what is compared.",
                self.expected.joined_pct,
            );
        }
        words
    }
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

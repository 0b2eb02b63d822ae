//! Whole drives from road and driver alone.

use driver_model::road::{Road, RoadKnowledge};
use driver_model::trip_driver::{FreeRun, TripDriver};
use driver_model::{Error, LeftOut, Motion};
use serde::Serialize;

use crate::render::table::{Table, number};

#[derive(Serialize)]
pub(super) struct Entry<'a> {
    name: &'a str,
    step_s: f64,
    duration_s: f64,
    measured_duration_s: f64,
    distance_m: f64,
    speed_mps: Vec<f64>,
}

/// Drives whose road is not known are left out, as long as there are others.
pub(super) fn predict<'a>(
    motions: &'a [Motion],
    driver: &TripDriver,
) -> Result<(Vec<Entry<'a>>, Vec<LeftOut>), Error> {
    let (mut entries, mut left_out) = (Vec::new(), Vec::new());
    for motion in motions {
        match entry(motion, driver) {
            Ok(entry) => entries.push(entry),
            Err(reason) => left_out.push(LeftOut {
                log: motion.name().to_owned(),
                reason: reason.to_string(),
            }),
        }
    }
    if entries.is_empty() {
        let task = "whole trips from the road";
        return Err(Error::NothingUsable { task, left_out });
    }
    Ok((entries, left_out))
}

fn entry<'a>(motion: &'a Motion, driver: &TripDriver) -> Result<Entry<'a>, Error> {
    let road = Road::of_motion(motion, RoadKnowledge::Stops)?;
    let FreeRun {
        step_s,
        speed_mps,
        end_s,
        ..
    } = driver.drive(&road, motion.step_s(), None)?;
    Ok(Entry {
        name: motion.name(),
        step_s,
        duration_s: end_s,
        measured_duration_s: motion.duration_s(),
        distance_m: road.length_m(),
        speed_mps,
    })
}

pub(super) fn table(entries: &[Entry<'_>]) -> String {
    let mut table = Table::new(["log", "distance km", "measured s", "predicted s"]);
    for entry in entries {
        table.row([
            entry.name.to_owned(),
            number(entry.distance_m * 1e-3, 2),
            number(entry.measured_duration_s, 0),
            number(entry.duration_s, 0),
        ]);
    }
    table.render()
}

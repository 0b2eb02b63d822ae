//! Whole drives from road and driver alone.

use driver_model::{FreeRun, Road, RoadKnowledge, TripDriver, slope_rad};
use serde::Serialize;

use crate::inputs::Input;
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

pub(super) fn predict<'a>(
    inputs: &'a [Input],
    driver: &TripDriver,
    slope_bandwidth_m: f64,
) -> anyhow::Result<Vec<Entry<'a>>> {
    let logs = inputs.iter().flat_map(|input| &input.drive.pieces);
    logs.map(|log| {
        let slope = slope_rad(log, slope_bandwidth_m)?;
        let road = Road::of_log(log, slope.as_deref(), RoadKnowledge::Stops)?;
        let FreeRun {
            step_s,
            speed_mps,
            end_s,
            ..
        } = driver.drive(&road, log.step_s(), None)?;
        Ok(Entry {
            name: log.name(),
            step_s,
            duration_s: end_s,
            measured_duration_s: (log.len() - 1) as f64 * log.step_s(),
            distance_m: road.length_m(),
            speed_mps,
        })
    })
    .collect()
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

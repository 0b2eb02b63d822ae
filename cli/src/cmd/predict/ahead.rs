//! The speed of the next seconds, moment by moment.

use anyhow::bail;
use driver_model::trajectory::{Course, DirectModel, HorizonScore};
use serde::Serialize;

use crate::render::table::{Table, number};

/// Distance of two moments.
const STEP_S: f64 = 1.0;

#[derive(Serialize)]
pub(super) struct Entry<'a> {
    name: &'a str,
    /// Moments predicted from, on the clock of the drive's start.
    moments_s: Vec<f64>,
    horizons: Vec<HorizonScore>,
}

/// `horizons_s` picks some of the model's; empty is all.
pub(super) fn predict<'a>(
    courses: &'a [Course],
    model: &DirectModel,
    horizons_s: &[f64],
) -> anyhow::Result<Vec<Entry<'a>>> {
    let known: Vec<f64> = model.horizons_s().collect();
    if let Some(missing) = horizons_s
        .iter()
        .find(|h| !known.iter().any(|k| (k - **h).abs() < 1e-9))
    {
        let known: Vec<String> = known.iter().map(f64::to_string).collect();
        bail!(
            "--horizon {missing}: the model was fitted for {} s; fit it with --horizons {missing}",
            known.join(", ")
        );
    }
    let wanted = |horizon_s: f64| {
        horizons_s.is_empty() || horizons_s.iter().any(|h| (h - horizon_s).abs() < 1e-9)
    };
    courses
        .iter()
        .map(|course| {
            let origins = model.moments(course, STEP_S);
            let scored = model.score(course, &origins)?;
            let horizons = scored.into_iter().filter(|score| wanted(score.horizon_s));
            Ok(Entry {
                name: &course.name,
                moments_s: origins
                    .iter()
                    .map(|&origin| origin as f64 * course.step_s)
                    .collect(),
                horizons: horizons.collect(),
            })
        })
        .collect()
}

pub(super) fn table(entries: &[Entry<'_>]) -> String {
    let mut table = Table::new([
        "log",
        "moments",
        "ahead s",
        "RMSE m/s",
        "interval ± m/s",
        "inside %",
        "last prediction km/h",
    ]);
    for entry in entries {
        for horizon in &entry.horizons {
            table.row([
                entry.name.to_owned(),
                entry.moments_s.len().to_string(),
                horizon.horizon_s.to_string(),
                number(horizon.rmse_mps, 3),
                number(horizon.interval_mps, 2),
                number(horizon.inside_pct, 1),
                number(horizon.speed_mps.last().map(|v| v * 3.6), 1),
            ]);
        }
    }
    table.render()
}

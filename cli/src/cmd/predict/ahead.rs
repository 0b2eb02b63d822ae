//! The speed of the next seconds, moment by moment.

use anyhow::bail;
use driver_model::speed_ahead::{DirectModel, HorizonScore};
use driver_model::{Error, LeftOut, Motion};
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
///
/// Drives that the model cannot predict are left out, as long as there are others.
pub(super) fn predict<'a>(
    motions: &'a [Motion],
    model: &DirectModel,
    horizons_s: &[f64],
) -> anyhow::Result<(Vec<Entry<'a>>, Vec<LeftOut>)> {
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
    let (mut entries, mut left_out) = (Vec::new(), Vec::new());
    for motion in motions {
        match entry(motion, model, &wanted) {
            Ok(entry) => entries.push(entry),
            Err(reason) => left_out.push(LeftOut {
                log: motion.name().to_owned(),
                reason,
            }),
        }
    }
    if entries.is_empty() {
        let task = "the speed ahead";
        return Err(Error::NothingUsable { task, left_out }.into());
    }
    Ok((entries, left_out))
}

/// The reason where the model cannot predict a drive.
fn entry<'a>(
    motion: &'a Motion,
    model: &DirectModel,
    wanted: &dyn Fn(f64) -> bool,
) -> Result<Entry<'a>, String> {
    let origins = model.moments(motion, STEP_S);
    if origins.is_empty() {
        return Err("too short for the past that a prediction needs".to_owned());
    }
    let scored = model
        .score(motion, &origins)
        .map_err(|error| error.to_string())?;
    let horizons = scored.into_iter().filter(|score| wanted(score.horizon_s));
    let moments_s = origins
        .iter()
        .map(|&origin| origin as f64 * motion.step_s());
    Ok(Entry {
        name: motion.name(),
        moments_s: moments_s.collect(),
        horizons: horizons.collect(),
    })
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

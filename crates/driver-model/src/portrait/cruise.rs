use std::collections::BTreeMap;

use serde::Serialize;

use super::Distribution;
use crate::DriveBehaviour;

/// Speed against one limit while cruising without a leader.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitKeeping {
    /// The limit, rounded to 1 km/h.
    pub limit_mps: f64,
    /// Time of cruising under it.
    pub duration_s: f64,
    /// Speed less limit.
    pub excess_mps: Distribution,
}

/// By rising limit, from the stretches of cruising.
pub(super) fn limit_keeping(trips: &[DriveBehaviour]) -> Vec<LimitKeeping> {
    let mut by_limit = BTreeMap::<i64, (f64, Vec<f64>)>::new();
    for stretch in trips.iter().flat_map(|trip| &trip.cruise) {
        if let Some(limit_mps) = stretch.limit_mps() {
            let entry = by_limit
                .entry((3.6 * limit_mps).round() as i64)
                .or_default();
            entry.0 += stretch.duration_s();
            entry
                .1
                .extend(stretch.speed_mps().iter().map(|v| v - limit_mps));
        }
    }
    let entries = by_limit
        .into_iter()
        .filter_map(|(kmh, (duration_s, excess))| {
            Some(LimitKeeping {
                limit_mps: kmh as f64 / 3.6,
                duration_s,
                excess_mps: Distribution::of(excess)?,
            })
        });
    entries.collect()
}

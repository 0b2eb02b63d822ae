use std::collections::BTreeMap;

use drive_log::{Channel, DriveLog};
use serde::Serialize;

use super::Distribution;
use crate::{Error, PhaseKind, PhaseSettings};

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

/// Limits with less cruising than this are left out.
const LEAST_S: f64 = 10.0;

/// By rising limit.
pub(super) fn limit_keeping(
    logs: &[&DriveLog],
    settings: &PhaseSettings,
) -> Result<Vec<LimitKeeping>, Error> {
    let mut by_limit = BTreeMap::<i64, (f64, Vec<f64>)>::new();
    for log in logs {
        let Some(limit_mps) = log.channel(Channel::SpeedLimit) else {
            continue;
        };
        for phase in settings.heuristic.segment(log)?.phases {
            if phase.kind != PhaseKind::Cruise || phase.lead_influenced {
                continue;
            }
            let range = phase.start..phase.end;
            let speed_mps = &log.speed_mps()[range.clone()];
            for (&limit, &speed) in limit_mps[range].iter().zip(speed_mps) {
                if limit.is_finite() && limit < 100.0 {
                    let entry = by_limit.entry((3.6 * limit).round() as i64).or_default();
                    entry.0 += log.step_s();
                    entry.1.push(speed - limit);
                }
            }
        }
    }
    let entries = by_limit
        .into_iter()
        .filter_map(|(kmh, (duration_s, excess))| {
            (duration_s >= LEAST_S).then_some(LimitKeeping {
                limit_mps: kmh as f64 / 3.6,
                duration_s,
                excess_mps: Distribution::of(excess)?,
            })
        });
    Ok(entries.collect())
}

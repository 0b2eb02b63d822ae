//! Rises and falls of the speed in a recording.

use super::habit::WantedSpeed;
use super::recording::{RecordedTrip, interpolated};
use super::zigzag::Extremum;
use crate::road::STANDSTILL_MPS;
use crate::road::limit::is_same_limit;

/// A rise ends at this share of the wanted speed; a fall begins at the other or, if there is none, at a high from the third.
pub(super) const RISEN: f64 = 0.93;
const CRUISING: f64 = 0.95;
const NEAR_CRUISING: f64 = 0.85;

/// The limit may change in the first moments of a rise, s.
const LIMIT_MAY_CHANGE_S: f64 = 1.5;

/// Smaller rises say nothing, m/s.
const LEAST_RISE_MPS: f64 = 1.5;

/// From a low to nearly the wanted speed, under one limit.
pub(super) struct Rise {
    pub(super) duration_s: f64,
    pub(super) distance_m: f64,
    pub(super) from_mps: f64,
    pub(super) to_mps: f64,
    pub(super) wanted_mps: f64,
}

/// From nearly the wanted speed to a low.
pub(super) struct Fall {
    pub(super) duration_s: f64,
    pub(super) distance_m: f64,
    pub(super) from_mps: f64,
    pub(super) to_mps: f64,
}

/// All that can be told apart from a change of the limit or of mind.
pub(super) fn manoeuvres(
    recordings: &[&RecordedTrip],
    wanted: &WantedSpeed,
) -> (Vec<Rise>, Vec<Fall>) {
    let (mut rises, mut falls) = (Vec::new(), Vec::new());
    for recording in recordings {
        let wanted_mps: Vec<f64> = recording.limit_mps.iter().map(|&l| wanted.mps(l)).collect();
        for pair in recording.extrema.windows(2) {
            match (pair[0], pair[1]) {
                (Extremum::Low(low), Extremum::High(high)) => {
                    rises.extend(rise(recording, &wanted_mps, low, high));
                }
                (Extremum::High(high), Extremum::Low(low)) => {
                    falls.extend(fall(recording, &wanted_mps, high, low));
                }
                _ => {}
            }
        }
    }
    (rises, falls)
}

fn rise(recording: &RecordedTrip, wanted_mps: &[f64], low: usize, high: usize) -> Option<Rise> {
    let (v, step_s) = (&recording.speed_mps, recording.step_s);
    // Not in the first samples: they may lie before a limit that has just been raised.
    let risen = (low + 3..=high).find(|&k| v[k] >= RISEN * wanted_mps[k])?;
    let late = (LIMIT_MAY_CHANGE_S / step_s).round() as usize;
    let limits = &recording.limit_mps[(low + late).min(risen)..=risen];
    let wanted = wanted_mps[risen];
    if !limits.iter().all(|l| is_same_limit(*l, limits[0])) || wanted - v[low] < LEAST_RISE_MPS {
        return None;
    }
    let start_s = match v[low] < STANDSTILL_MPS && v[low + 2] > v[low + 1] {
        true => {
            // Extrapolated to standstill, which at 1 Hz is not at a sample.
            let since = v[low + 1] / (v[low + 2] - v[low + 1]);
            (low as f64 + (1.0 - since).clamp(0.0, 1.0)) * step_s
        }
        false => low as f64 * step_s,
    };
    let end_s = recording.crossing_s(risen - 1, RISEN * wanted);
    Some(Rise {
        duration_s: end_s - start_s,
        distance_m: interpolated(&recording.distance_m, end_s / step_s) - recording.distance_m[low],
        from_mps: v[low],
        to_mps: interpolated(v, end_s / step_s),
        wanted_mps: wanted,
    })
}

fn fall(recording: &RecordedTrip, wanted_mps: &[f64], high: usize, low: usize) -> Option<Fall> {
    let (v, step_s) = (&recording.speed_mps, recording.step_s);
    let cruising = (high..=low).rfind(|&k| v[k] >= CRUISING * wanted_mps[k]);
    let (start, start_s) = match cruising {
        Some(k) if k < low => (k, recording.crossing_s(k, CRUISING * wanted_mps[k])),
        Some(k) => (k, k as f64 * step_s),
        None if v[high] >= NEAR_CRUISING * wanted_mps[high] => (high, high as f64 * step_s),
        None => return None,
    };
    // The same threshold as that of a stop, so that no time is lost or counted twice.
    let end_s = match (start..=low).find(|&k| v[k] < STANDSTILL_MPS) {
        Some(k) if k > start => recording.crossing_s(k - 1, STANDSTILL_MPS),
        Some(k) => k as f64 * step_s,
        None => low as f64 * step_s,
    };
    let at = |values: &[f64], t_s: f64| interpolated(values, t_s / step_s);
    Some(Fall {
        duration_s: end_s - start_s,
        distance_m: at(&recording.distance_m, end_s) - at(&recording.distance_m, start_s),
        from_mps: at(v, start_s),
        to_mps: at(v, end_s),
    })
}

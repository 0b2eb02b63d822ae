use driver_model::trip_driver::{Extremum, zigzag};
use speed_plan::{Columns, Error, Road};

use super::PotentialSettings;
use super::recorded::Legs;

/// No car is faster, m/s.
const FASTEST_MPS: f64 = 150.0;

/// Elevation is climbed in pieces of at least this length, m.
const PIECE_M: f64 = 1.0;

/// Changes of the limit that are nearer to a node are at it, m.
const SAME_PLACE_M: f64 = 0.25;

/// The road of a recorded motion as the planner takes it.
pub(super) fn columns(legs: &Legs, settings: &PotentialSettings) -> Result<Columns, Error> {
    let mut columns = road(legs, settings).columns()?;
    let last = columns.position_m.len() - 1;
    for node in 1..last {
        let at_m = columns.position_m[node];
        let max_mps = &mut columns.max_mps[node];
        if *max_mps <= 0.0 {
            continue;
        }
        let near_mps = fastest_within(legs, at_m, settings.window_m);
        let allowed_mps = limit_at(legs, at_m).max(legs.speed_at(at_m));
        *max_mps = max_mps.min(near_mps).min(allowed_mps);
        columns.min_mps[node] = columns.min_mps[node].min(*max_mps);
    }
    Ok(columns)
}

/// Stops, slow points and elevation; nodes where the limit changes, which is not among them yet.
fn road(legs: &Legs, settings: &PotentialSettings) -> Road {
    let length_m = legs.length_m();
    let end = legs.arrival();
    let fastest_mps = legs.speed_mps.iter().copied().fold(1.0, f64::max);
    let begins_m = |k: usize| legs.distance_m[k];
    let mut stops: Vec<(f64, f64)> = legs
        .stands
        .iter()
        .map(|stand| {
            let samples = stand.end() - stand.start();
            (
                begins_m(*stand.start()),
                samples as f64 * legs.motion.step_s,
            )
        })
        .collect();
    if legs.ends_standing() {
        stops.pop();
    }
    let slow_points = zigzag(&legs.speed_mps, settings.prominence_mps)
        .into_iter()
        .filter_map(|extremum| match extremum {
            Extremum::Low(k) if k < end && !legs.stands.iter().any(|stand| stand.contains(&k)) => {
                Some((begins_m(k), legs.speed_mps[k]))
            }
            _ => None,
        })
        .collect();
    let end_speed = |standing: bool, k: usize| {
        let recorded = legs.speed_mps.get(k).copied().unwrap_or(0.0);
        if standing { 0.0 } else { recorded }
    };
    Road {
        length_m,
        start_mps: end_speed(legs.starts_standing(), 0),
        end_mps: end_speed(legs.ends_standing(), end),
        slowest_mps: settings.slowest_mps,
        limits: limit_changes(legs)
            .into_iter()
            .map(|at_m| (at_m, fastest_mps))
            .collect(),
        stops,
        slow_points,
        elevation: climbed(legs),
        ..Road::default()
    }
}

/// Where limits begin, the first at the start.
fn limit_changes(legs: &Legs) -> Vec<f64> {
    let limit_mps = legs.motion.limit_mps.unwrap_or_default();
    let mut places_m = vec![0.0];
    for (k, pair) in limit_mps.windows(2).enumerate() {
        let at_m = legs.distance_m[k + 1];
        let is_new = places_m.last().is_none_or(|last| at_m > *last);
        if (pair[1] - pair[0]).abs() > 1e-3 && is_new && at_m < legs.length_m() {
            places_m.push(at_m);
        }
    }
    places_m
}

/// The lowest limit where a node is and on both sides of it.
fn limit_at(legs: &Legs, at_m: f64) -> f64 {
    let Some(limit_mps) = legs.motion.limit_mps else {
        return FASTEST_MPS;
    };
    let [from, _] = legs.around(at_m - SAME_PLACE_M);
    let [_, to] = legs.around(at_m + SAME_PLACE_M);
    let touching = limit_mps.get(from..=to).unwrap_or_default();
    touching.iter().copied().fold(FASTEST_MPS, f64::min)
}

fn fastest_within(legs: &Legs, at_m: f64, window_m: f64) -> f64 {
    let [from, _] = legs.around(at_m - window_m);
    let [_, to] = legs.around(at_m + window_m);
    legs.speed_mps[from..=to]
        .iter()
        .copied()
        .fold(0.0, f64::max)
}

/// Elevation over the distance out of the slope of every sample.
fn climbed(legs: &Legs) -> Vec<(f64, f64)> {
    let Some(slope_rad) = legs.motion.slope_rad else {
        return Vec::new();
    };
    let (mut elevation_m, mut points) = (0.0, vec![(0.0, 0.0)]);
    let mut added_m = 0.0;
    for (k, ends) in slope_rad.windows(2).enumerate() {
        let (from_m, to_m) = (legs.distance_m[k], legs.distance_m[k + 1]);
        elevation_m += (0.5 * (ends[0] + ends[1])).tan() * (to_m - from_m);
        if to_m >= added_m + PIECE_M {
            points.push((to_m, elevation_m));
            added_m = to_m;
        }
    }
    points
}

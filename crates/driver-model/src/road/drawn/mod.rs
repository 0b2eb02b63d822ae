//! Roads drawn out of what there is: recorded drives, tracks, maps.

mod drives;
mod gpx;
mod lines;
mod profile;
mod shared;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests;
mod track;

use serde::Serialize;

use super::map::STOP_SPACING_M;
use super::{RoadFile, STANDSTILL_MPS};

/// Positions and elevations of drawn roads are rounded to 0.1 m and 0.01 m, speeds to 0.1 km/h, dwells to 0.1 s.
const POSITIONS_PER_M: f64 = 10.0;
const ELEVATIONS_PER_M: f64 = 100.0;
const SPEEDS_PER_KMH: f64 = 10.0;
const DWELLS_PER_S: f64 = 10.0;

/// A road with what was found while it was drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnRoad {
    /// The road, checked.
    pub road: RoadFile,
    /// What was assumed, left out or filled, in sentences.
    pub findings: Vec<String>,
}

/// Ends of a road, where a car that stands is not at a stop.
struct Ends {
    length_m: f64,
    start_speed_mps: f64,
    end_speed_mps: f64,
}

impl Ends {
    fn stands_at(&self, position_m: f64) -> bool {
        (self.start_speed_mps < STANDSTILL_MPS && position_m < STOP_SPACING_M)
            || (self.end_speed_mps < STANDSTILL_MPS && position_m > self.length_m - STOP_SPACING_M)
    }
}

fn rounded_m(position_m: f64) -> f64 {
    (position_m * POSITIONS_PER_M).round() / POSITIONS_PER_M
}

fn rounded_mps(speed_mps: f64) -> f64 {
    (speed_mps * 3.6 * SPEEDS_PER_KMH).round() / SPEEDS_PER_KMH / 3.6
}

impl RoadFile {
    fn of_length(length_m: f64) -> Self {
        Self {
            length_m,
            ..Self::default()
        }
    }

    /// Rounded, so that a file can be read. What comes to lie at one place is joined: the later limit, the slower point, all of the dwells.
    fn rounded(mut self) -> Self {
        self.length_m = rounded_m(self.length_m);
        self.start_speed_mps = rounded_mps(self.start_speed_mps);
        self.end_speed_mps = rounded_mps(self.end_speed_mps);
        for limit in &mut self.limits {
            limit.position_m = rounded_m(limit.position_m);
            limit.limit_mps = rounded_mps(limit.limit_mps);
        }
        for stop in &mut self.stops {
            stop.position_m = rounded_m(stop.position_m);
            stop.dwell_s = (stop.dwell_s * DWELLS_PER_S).round() / DWELLS_PER_S;
        }
        for slow in self.slow_points.iter_mut().flatten() {
            slow.position_m = rounded_m(slow.position_m);
            slow.speed_mps = rounded_mps(slow.speed_mps).max(STANDSTILL_MPS);
        }
        for at in &mut self.elevation {
            at.position_m = rounded_m(at.position_m);
            at.elevation_m = (at.elevation_m * ELEVATIONS_PER_M).round() / ELEVATIONS_PER_M;
        }
        self.joined()
    }

    fn joined(mut self) -> Self {
        self.limits.dedup_by(|next, kept| {
            let is_same = next.position_m <= kept.position_m;
            let limit_mps = if is_same {
                next.limit_mps
            } else {
                kept.limit_mps
            };
            kept.limit_mps = limit_mps;
            is_same
        });
        self.stops.dedup_by(|next, kept| {
            let is_same = next.position_m <= kept.position_m;
            kept.dwell_s += if is_same { next.dwell_s } else { 0.0 };
            is_same
        });
        if let Some(points) = &mut self.slow_points {
            points.dedup_by(|next, kept| {
                let is_same = next.position_m <= kept.position_m;
                let other_mps = if is_same {
                    next.speed_mps
                } else {
                    f64::INFINITY
                };
                kept.speed_mps = kept.speed_mps.min(other_mps);
                is_same
            });
        }
        self
    }
}

/// Places in words, the first of them.
fn places(positions_m: &[f64]) -> String {
    const NAMED: usize = 5;
    let named: Vec<String> = positions_m
        .iter()
        .take(NAMED)
        .map(|m| format!("{m:.0}"))
        .collect();
    match positions_m.len().saturating_sub(NAMED) {
        0 => format!("at {} m", named.join(", ")),
        more => format!("at {} m and {more} more", named.join(", ")),
    }
}

fn counted(number: usize, what: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {what}{ending}")
}

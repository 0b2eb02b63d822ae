//! Lines of a map and what stands on them, for those who make roads of them.

use super::{EARTH_RADIUS_M, PLACES_AROUND, PLACES_PER_DEG};

/// Lines of a map with their limits, and the points of OpenStreetMap that make drivers stop.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MapLines {
    /// The lines, at least one.
    pub ways: Vec<Way>,
    /// The points.
    pub points: Vec<MapPoint>,
    /// Limits whose value is no number with a unit, or none that a road has.
    pub not_understood: usize,
}

/// A line of a map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Way {
    /// Degrees east and north, at least two.
    pub positions_deg: Vec<[f64; 2]>,
    /// Elevation at each of them, NaN where it is missing; empty where no position has one.
    pub elevation_m: Vec<f64>,
    /// Along the line and against it; `None` where the map does not say.
    pub limits_mps: [Option<f64>; 2],
    /// Whether it may be driven along and against the line.
    pub open: [bool; 2],
}

/// A point of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// Degrees east and north.
    pub position_deg: [f64; 2],
    /// What stands there.
    pub kind: PointKind,
    /// Whether it is for those who drive along and against the line that it is on.
    pub valid: [bool; 2],
}

/// What stands at a point of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// Traffic signals.
    TrafficSignals,
    /// A stop sign.
    Stop,
    /// A give-way sign.
    GiveWay,
}

/// A position as OpenStreetMap keeps it: to the seventh digit, so that ends that meet are equal, also across ±180°.
#[must_use]
pub fn place(position_deg: [f64; 2]) -> [i64; 2] {
    let [east, north] = position_deg.map(|deg| (deg * PLACES_PER_DEG).round() as i64);
    [east.rem_euclid(PLACES_AROUND), north]
}

/// Distance of two positions, degrees east and north, over the sphere (haversine formula), m.
#[must_use]
pub fn great_circle_m(from_deg: [f64; 2], to_deg: [f64; 2]) -> f64 {
    let [east, north] = [0, 1].map(|axis| (to_deg[axis] - from_deg[axis]).to_radians());
    let parallels = from_deg[1].to_radians().cos() * to_deg[1].to_radians().cos();
    let chord = (0.5 * north).sin().powi(2) + parallels * (0.5 * east).sin().powi(2);
    2.0 * EARTH_RADIUS_M * chord.clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_of_latitude_is_a_nautical_mile_and_a_half_circle_ends_at_the_other_pole() {
        let minute = great_circle_m([11.0, 48.0], [11.0, 48.0 + 1.0 / 60.0]);
        assert!((minute - 1853.2).abs() < 0.1, "{minute}");
        let half = great_circle_m([0.0, -90.0], [120.0, 90.0]);
        assert!((half - std::f64::consts::PI * EARTH_RADIUS_M).abs() < 1e-3);
        assert!(great_circle_m([180.0, 10.0], [-180.0, 10.0]) < 1e-6);
    }
}

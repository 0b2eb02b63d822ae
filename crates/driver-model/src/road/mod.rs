//! Roads: limits, slope, stops and slow points over distance.

mod drawn;
mod file;
pub(crate) mod limit;
pub(crate) mod map;

use crate::Error;
pub use drawn::DrawnRoad;
pub use file::{Curve, ElevationAt, Green, LeaderAt, RoadFile, Signal};
pub(crate) use map::STANDSTILL_MPS;
use map::Stretch;
pub use map::{LimitFrom, RoadMap, RoadStop, SlopeAt, SlowPoint};

/// Distance of two nodes of a road.
pub const NODE_SPACING_M: f64 = 1.0;

/// Elevations beyond are none.
const HIGHEST_M: f64 = 1e5;

/// Longer roads are refused: 1000 km.
const MOST_NODES: f64 = 1e6;

/// What is known of a road besides limits and slope.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RoadKnowledge {
    /// Stops; slowdowns are those that the driver is expected to make.
    #[default]
    Stops,
    /// Stops and slow points with their speeds, as a map that knows turns. From a log that was driven behind others it includes
    /// the slowdowns behind them, which no map knows.
    StopsAndSlowdowns,
}

/// A road ahead, node by node.
#[derive(Debug, Clone, PartialEq)]
pub struct Road {
    spacing_m: f64,
    length_m: f64,
    start_speed_mps: f64,
    limit_mps: Vec<f64>,
    slope_rad: Option<Vec<f64>>,
    cap_mps: Vec<f64>,
    dwell_s: Vec<f64>,
    stretches: Vec<Stretch>,
    slow_points_known: bool,
}

impl Road {
    /// A road from a map.
    ///
    /// # Errors
    /// [`Error::Option`] for what is out of range or order, and for a road beyond 1000 km.
    pub fn new(map: RoadMap) -> Result<Self, Error> {
        Self::with_spacing(map, NODE_SPACING_M)
    }

    pub(crate) fn with_spacing(map: RoadMap, spacing_m: f64) -> Result<Self, Error> {
        let map = map.checked()?;
        let nodes = (map.length_m / spacing_m).floor() + 2.0;
        if nodes > MOST_NODES {
            return Err(Error::Option {
                name: "length_m",
                value: map.length_m,
                expected: "at most 1000 km in one road; split the trip",
            });
        }
        let nodes = nodes as usize;
        let positions_m = (0..nodes).map(|node| node as f64 * spacing_m);
        let mut road = Self {
            spacing_m,
            length_m: map.length_m,
            start_speed_mps: map.start_speed_mps,
            limit_mps: positions_m.clone().map(|s| map.limit_mps(s)).collect(),
            slope_rad: (!map.slope.is_empty())
                .then(|| positions_m.map(|s| slope_at(&map.slope, s)).collect()),
            cap_mps: vec![f64::INFINITY; nodes],
            dwell_s: vec![0.0; nodes],
            stretches: map.stretches(),
            slow_points_known: map.slow_points.is_some(),
        };
        for stop in &map.stops {
            let node = road.node(stop.position_m);
            road.cap_mps[node] = 0.0;
            road.dwell_s[node] += stop.dwell_s;
        }
        let slow_points = map.slow_points.unwrap_or_default();
        let mut cap_mps = std::mem::take(&mut road.cap_mps);
        road.cap_at(&slow_points, &mut cap_mps);
        road.cap_mps = cap_mps;
        Ok(road)
    }

    /// Number of nodes, at least two.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.limit_mps.len()
    }

    /// Length of the trip; the last node is up to two spacings beyond.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Speed at the first node, if nothing there forbids it.
    #[must_use]
    pub fn start_speed_mps(&self) -> f64 {
        self.start_speed_mps
    }

    /// Limit at every node.
    #[must_use]
    pub fn limit_mps(&self) -> &[f64] {
        &self.limit_mps
    }

    /// Slope at every node; `None` on a level road.
    #[must_use]
    pub fn slope_rad(&self) -> Option<&[f64]> {
        self.slope_rad.as_deref()
    }

    /// Highest speed at every node but for limits: 0 at stops, infinite where there is none.
    #[must_use]
    pub fn cap_mps(&self) -> &[f64] {
        &self.cap_mps
    }

    /// Time that the car stands at every node.
    #[must_use]
    pub fn dwell_s(&self) -> &[f64] {
        &self.dwell_s
    }

    pub(crate) fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// Stretches to spread expected slowdowns over; `None` where slow points are known.
    pub(crate) fn stretches(&self) -> Option<&[Stretch]> {
        (!self.slow_points_known).then_some(&self.stretches)
    }

    pub(crate) fn cap_at(&self, slow_points: &[SlowPoint], cap_mps: &mut [f64]) {
        for point in slow_points {
            let cap_mps = &mut cap_mps[self.node(point.position_m)];
            *cap_mps = cap_mps.min(point.speed_mps);
        }
    }

    fn node(&self, position_m: f64) -> usize {
        let nearest = (position_m / self.spacing_m).round() as usize;
        nearest.min(self.nodes() - 1)
    }
}

/// Linear between the known positions, constant beyond them.
fn slope_at(slope: &[SlopeAt], position_m: f64) -> f64 {
    let next = slope.partition_point(|known| known.position_m <= position_m);
    let (Some(left), Some(right)) = (slope.get(next.wrapping_sub(1)), slope.get(next)) else {
        return slope[next.saturating_sub(1)].slope_rad;
    };
    let share = (position_m - left.position_m) / (right.position_m - left.position_m);
    left.slope_rad + share * (right.slope_rad - left.slope_rad)
}

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::limit::{LIMIT_MPS, rounded_limit};
use crate::Error;

/// Slower than this a car stands, m/s.
pub(crate) const STANDSTILL_MPS: f64 = 0.3;

/// Stops nearer to each other than this are one, m.
pub(crate) const STOP_SPACING_M: f64 = 5.0;

/// A limit change this near to a stop has no stretch of its own, m.
const STOP_REACH_M: f64 = 15.0;

/// Positions up to here are the start, and shorter stretches are none, m.
const SHORTEST_M: f64 = 5.0;

/// What is known of a road ahead; positions from the start of the trip.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RoadMap {
    /// Length.
    pub length_m: f64,
    /// Speed at the start.
    pub start_speed_mps: f64,
    /// Limits from where they begin, in order; the first begins at 0.
    pub limits: Vec<LimitFrom>,
    /// Stops in order. Those less than 5 m from the one before add to it.
    pub stops: Vec<RoadStop>,
    /// Slow points such as turns; `None` where they are unknown, and the driver's expected ones count.
    pub slow_points: Option<Vec<SlowPoint>>,
    /// Slope in order, linear in between; none is a level road.
    pub slope: Vec<SlopeAt>,
}

/// A speed limit from a position on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitFrom {
    /// Where it begins.
    pub position_m: f64,
    /// The limit.
    pub limit_mps: f64,
}

/// A stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadStop {
    /// Where.
    pub position_m: f64,
    /// How long the car stands.
    pub dwell_s: f64,
}

/// A place that is passed at no more than some speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlowPoint {
    /// Where.
    pub position_m: f64,
    /// That speed, at least 0.3 m/s.
    pub speed_mps: f64,
}

/// Slope at a position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlopeAt {
    /// Where.
    pub position_m: f64,
    /// Positive uphill.
    pub slope_rad: f64,
}

/// What a stretch between known events ends in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StretchEnd {
    Stop,
    LimitChange,
    Road,
}

/// A stretch between known events: stops and changes of the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) start_m: f64,
    pub(crate) end_m: f64,
    /// In its middle.
    pub(crate) limit_mps: f64,
    pub(crate) end: StretchEnd,
}

impl Stretch {
    pub(crate) fn length_m(&self) -> f64 {
        self.end_m - self.start_m
    }
}

impl RoadMap {
    /// The limit at a position.
    pub(crate) fn limit_mps(&self, position_m: f64) -> f64 {
        // Cumulated distances are not exact.
        let next = self
            .limits
            .partition_point(|limit| limit.position_m <= position_m + 1e-9);
        self.limits[next.saturating_sub(1)].limit_mps
    }

    pub(crate) fn stretches(&self) -> Vec<Stretch> {
        let near_a_stop = |position_m: f64| {
            let next = self
                .stops
                .partition_point(|stop| stop.position_m < position_m - STOP_REACH_M);
            let stop = self.stops.get(next);
            stop.is_some_and(|stop| stop.position_m <= position_m + STOP_REACH_M)
        };
        let changes = self.limits.iter().skip(1).map(|change| change.position_m);
        let changes = changes.filter(|&position_m| !near_a_stop(position_m));
        let mut ends: Vec<(f64, StretchEnd)> = changes
            .map(|position_m| (position_m, StretchEnd::LimitChange))
            .chain(self.stops.iter().map(|s| (s.position_m, StretchEnd::Stop)))
            .filter(|(position_m, _)| *position_m > SHORTEST_M)
            .collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.push((self.length_m, StretchEnd::Road));
        let mut start_m = 0.0;
        let mut stretches = Vec::new();
        for (end_m, end) in ends {
            if end_m - start_m >= SHORTEST_M {
                stretches.push(Stretch {
                    start_m,
                    end_m,
                    limit_mps: self.limit_mps(0.5 * (start_m + end_m)),
                    end,
                });
            }
            start_m = end_m;
        }
        stretches
    }

    /// Refuses what is out of order or range; limits rounded, near stops joined.
    pub(crate) fn checked(mut self) -> Result<Self, Error> {
        in_range("length_m", self.length_m, 0.0, f64::MAX, "a length from 0")?;
        let speed_mps = self.start_speed_mps;
        in_range("start_speed_mps", speed_mps, 0.0, 1e3, "0 to 1000 m/s")?;
        in_order("limit position_m", self.limits.iter().map(|l| l.position_m))?;
        let first_m = self.limits.first().map_or(f64::NAN, |l| l.position_m);
        let expected = "a first limit that begins at 0";
        in_range("limit position_m", first_m, f64::MIN, 0.0, expected)?;
        for limit in &mut self.limits {
            let (lowest, highest) = (*LIMIT_MPS.start(), *LIMIT_MPS.end());
            let expected = "a limit from 0.5 m/s to 400 km/h";
            in_range("limit_mps", limit.limit_mps, lowest, highest, expected)?;
            limit.limit_mps = rounded_limit(limit.limit_mps);
        }
        in_order("stop position_m", self.stops.iter().map(|s| s.position_m))?;
        for stop in &self.stops {
            self.on_the_road("stop position_m", stop.position_m)?;
            in_range("dwell_s", stop.dwell_s, 0.0, 1e9, "0 to 1e9 s")?;
        }
        for slow in self.slow_points.iter().flatten() {
            self.on_the_road("slow point position_m", slow.position_m)?;
            let (lowest, expected) = (STANDSTILL_MPS, "at least 0.3 m/s");
            in_range(
                "slow point speed_mps",
                slow.speed_mps,
                lowest,
                1e3,
                expected,
            )?;
        }
        in_order("slope position_m", self.slope.iter().map(|s| s.position_m))?;
        for slope in &self.slope {
            let expected = "an angle within ±π/2";
            in_range(
                "slope_rad",
                slope.slope_rad,
                -FRAC_PI_2,
                FRAC_PI_2,
                expected,
            )?;
        }
        self.join_stops();
        Ok(self)
    }

    fn join_stops(&mut self) {
        let mut joined: Vec<RoadStop> = Vec::with_capacity(self.stops.len());
        for &stop in &self.stops {
            match joined.last_mut() {
                Some(last) if stop.position_m - last.position_m < STOP_SPACING_M => {
                    last.dwell_s += stop.dwell_s;
                }
                _ => joined.push(stop),
            }
        }
        // Who starts at rest a few metres before the line waits there.
        if let Some(first) = joined.first_mut()
            && first.position_m < STOP_SPACING_M
            && self.start_speed_mps < STANDSTILL_MPS
        {
            first.position_m = 0.0;
        }
        self.stops = joined;
    }

    fn on_the_road(&self, name: &'static str, position_m: f64) -> Result<(), Error> {
        let expected = "a position on the road";
        in_range(name, position_m, 0.0, self.length_m, expected)
    }
}

fn in_range(
    name: &'static str,
    value: f64,
    lowest: f64,
    highest: f64,
    expected: &'static str,
) -> Result<(), Error> {
    if (lowest..=highest).contains(&value) {
        return Ok(());
    }
    Err(Error::Option {
        name,
        value,
        expected,
    })
}

fn in_order(name: &'static str, positions_m: impl Iterator<Item = f64>) -> Result<(), Error> {
    let mut last_m = f64::NEG_INFINITY;
    for position_m in positions_m {
        let expected = "finite positions in ascending order";
        in_range(name, position_m, last_m, f64::MAX, expected)?;
        last_m = position_m;
    }
    Ok(())
}

use crate::error::Error;
use crate::problem::{Columns, NO_LEADER_S, Signal};

/// Length of a step next to a standstill, m, and next to a place that is passed at a speed, s; from step to step it grows by
/// [`GROWTH`] up to [`LONGEST_STEP_M`].
const FIRST_STEP_M: f64 = 1.0;
const FIRST_STEP_S: f64 = 0.7;
const GROWTH: f64 = 1.5;
const LONGEST_STEP_M: f64 = 40.0;

/// Places that are nearer than this are one node, m.
const SAME_PLACE_M: f64 = 0.25;

/// Deceleration from a start above the limit, m/s².
const BRAKING_MPS2: f64 = 2.0;

/// Steepest slope of a step, rad.
const STEEPEST_RAD: f64 = 0.5;

/// Latest time that a leader holds anybody up, s.
const LATEST_S: f64 = 1e9;

/// Lateral acceleration in curves, m/s².
const LATERAL_MPS2: f64 = 2.0;

/// A road as people know it: what lies where. Positions are in m from the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Road {
    /// Length, m.
    pub length_m: f64,
    /// Speed at the start, m/s.
    pub start_mps: f64,
    /// Speed at the end, m/s.
    pub end_mps: f64,
    /// Slowest speed where the car does not stand, m/s.
    pub slowest_mps: f64,
    /// Limit in m/s from a position on, in order; the first holds from the start.
    pub limits: Vec<(f64, f64)>,
    /// Stops with the time that the car stands there, s.
    pub stops: Vec<(f64, f64)>,
    /// Places that are passed no faster than a speed, m/s.
    pub slow_points: Vec<(f64, f64)>,
    /// Curves: begin, end and radius, m.
    pub curves: Vec<[f64; 3]>,
    /// Elevation in m over the position, in order, linear between; empty on a level road.
    pub elevation: Vec<(f64, f64)>,
    /// Signals with their green windows, s after the start.
    pub signals: Vec<(f64, Vec<[f64; 2]>)>,
    /// The car ahead; `None` without one.
    pub leader: Option<Leader>,
}

/// The car ahead, as it is predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Leader {
    /// Its position in m over the time in s, in order; after the last nothing is known of it.
    pub positions: Vec<(f64, f64)>,
    /// Gap at standstill, m.
    pub standstill_gap_m: f64,
    /// Time headway, s.
    pub headway_s: f64,
}

/// A level road from standstill to standstill at 50 km/h; to be completed.
impl Default for Road {
    fn default() -> Self {
        Self {
            length_m: 1000.0,
            start_mps: 0.0,
            end_mps: 0.0,
            slowest_mps: 0.5,
            limits: vec![(0.0, 50.0 / 3.6)],
            stops: Vec::new(),
            slow_points: Vec::new(),
            curves: Vec::new(),
            elevation: Vec::new(),
            signals: Vec::new(),
            leader: None,
        }
    }
}

/// A place that has to be a node.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    position_m: f64,
    /// How fast it is passed: the slower, the shorter are the steps beside it. 0 where the car may stand.
    speed_mps: f64,
}

impl Road {
    /// The columns of a problem: start, end, stops, signals, slow points, curves and changes of the limit are nodes; steps are short where the
    /// car stands and at most 40 m long.
    ///
    /// # Errors
    /// [`Error::Value`], [`Error::Place`] and [`Error::Setting`] for what lies beyond the road, is out of order or out of range.
    pub fn columns(&self) -> Result<Columns, Error> {
        self.check()?;
        let position_m = positions(&self.places());
        let nodes = position_m.len();
        let node = |at: f64| nearest(&position_m, at);
        let mut max_mps = self.highest_mps(&position_m);
        let mut min_mps: Vec<f64> = max_mps
            .iter()
            .map(|max| self.slowest_mps.min(*max))
            .collect();
        let mut dwell_s = vec![0.0; nodes];
        for &(at, stand_s) in &self.stops {
            dwell_s[node(at)] += stand_s;
        }
        if self.start_mps > 0.0 && dwell_s[0] > 0.0 {
            return Err(Error::Place {
                position_m: 0.0,
                problem: "the car stands at the start and is to start at a speed; give a start speed of 0, or no stop there".to_owned(),
            });
        }
        // Faster than allowed at the start, the car brakes down to it.
        for (max, at) in max_mps.iter_mut().zip(&position_m) {
            let square = self.start_mps * self.start_mps - 2.0 * BRAKING_MPS2 * at;
            let braked = square.max(0.0).sqrt();
            if braked <= *max || *max <= 0.0 {
                break;
            }
            *max = braked;
        }
        if self.end_mps > max_mps[nodes - 1] {
            return Err(Error::Setting {
                name: "end_mps",
                value: self.end_mps,
                expected: "at most what is allowed at the end of the road",
            });
        }
        for (node, speed) in [(0, self.start_mps), (nodes - 1, self.end_mps)] {
            (min_mps[node], max_mps[node]) = (speed, speed);
        }
        Ok(Columns {
            slope_rad: self.slopes_rad(&position_m)?,
            signals: self.signals_at(&position_m)?,
            earliest_s: self.leader.as_ref().map_or_else(Vec::new, |leader| {
                position_m.iter().map(|at| leader.earliest_s(*at)).collect()
            }),
            position_m,
            min_mps,
            max_mps,
            dwell_s,
        })
    }

    /// The highest speeds that limits, slow points, curves and stops allow at the start and at the end, m/s.
    ///
    /// # Errors
    /// As [`columns`](Self::columns).
    pub fn end_limits_mps(&self) -> Result<[f64; 2], Error> {
        self.check()?;
        let max_mps = self.highest_mps(&positions(&self.places()));
        Ok([max_mps[0], max_mps[max_mps.len() - 1]])
    }

    /// The highest speed that is allowed at every node, m/s.
    fn highest_mps(&self, position_m: &[f64]) -> Vec<f64> {
        let node = |at: f64| nearest(position_m, at);
        let nodes = 0..position_m.len();
        let mut max_mps: Vec<f64> = nodes.map(|k| self.limit_at(position_m, k)).collect();
        let lower = |max_mps: &mut f64, speed: f64| *max_mps = max_mps.min(speed);
        for &(at, speed) in &self.slow_points {
            lower(&mut max_mps[node(at)], speed);
        }
        for &[from, to, radius_m] in &self.curves {
            let speed = (LATERAL_MPS2 * radius_m).sqrt();
            let inside = node(from)..=node(to);
            max_mps[inside].iter_mut().for_each(|max| lower(max, speed));
        }
        for &(at, _) in &self.stops {
            max_mps[node(at)] = 0.0;
        }
        max_mps
    }

    fn slopes_rad(&self, position_m: &[f64]) -> Result<Vec<f64>, Error> {
        let slope = |ends: &[f64]| {
            let slope_rad = self.slope_rad(ends[0], ends[1]);
            if slope_rad.abs() <= STEEPEST_RAD {
                return Ok(slope_rad);
            }
            Err(Error::Place {
                position_m: ends[0],
                problem: format!(
                    "up to {:.1} m the slope is {:.1} %, steeper than the {:.0} % that can be planned; correct elevation or slope, or smooth them",
                    ends[1],
                    100.0 * slope_rad.tan(),
                    100.0 * STEEPEST_RAD.tan()
                ),
            })
        };
        position_m.windows(2).map(slope).collect()
    }

    fn signals_at(&self, position_m: &[f64]) -> Result<Vec<Signal>, Error> {
        let mut places: Vec<(usize, f64, &Vec<[f64; 2]>)> = self
            .signals
            .iter()
            .map(|(at, green_s)| (nearest(position_m, *at), *at, green_s))
            .collect();
        places.sort_by_key(|place| place.0);
        let fail = |position_m, problem| {
            Err(Error::Place {
                position_m,
                problem,
            })
        };
        if let Some(&(0, at, _)) = places.first() {
            return fail(
                at,
                "a signal at the start, which the car has passed; leave it out".to_owned(),
            );
        }
        if let Some(pair) = places.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return fail(
                pair[1].1,
                format!(
                    "a signal nearer than {SAME_PLACE_M} m to the one at {:.2} m; give one with the windows in which both are green",
                    pair[0].1
                ),
            );
        }
        let signals = places.into_iter().map(|(node, _, green_s)| Signal {
            node,
            green_s: green_s.clone(),
        });
        Ok(signals.collect())
    }

    fn check(&self) -> Result<(), Error> {
        let setting = |name, value: f64, min: f64, max: f64, expected| {
            if (min..=max).contains(&value) {
                Ok(())
            } else {
                Err(Error::Setting {
                    name,
                    value,
                    expected,
                })
            }
        };
        setting(
            "length_m",
            self.length_m,
            1.0,
            1e6,
            "a road is 1 m to 1000 km long",
        )?;
        setting("start_mps", self.start_mps, 0.0, 150.0, "0 to 150 m/s")?;
        setting("end_mps", self.end_mps, 0.0, 150.0, "0 to 150 m/s")?;
        setting(
            "slowest_mps",
            self.slowest_mps,
            0.1,
            100.0,
            "0.1 to 100 m/s",
        )?;
        let on_road = |channel, index, value: f64| {
            if (0.0..=self.length_m).contains(&value) {
                Ok(())
            } else {
                Err(Error::Value {
                    channel,
                    index,
                    value,
                    problem: "not on the road",
                })
            }
        };
        let pairs = [
            (
                "limits",
                &self.limits,
                0.1,
                150.0,
                "a limit of 0.1 to 150 m/s",
            ),
            ("stops", &self.stops, 0.0, 1e6, "a stand of 0 to 10⁶ s"),
            (
                "slow_points",
                &self.slow_points,
                0.1,
                150.0,
                "a speed of 0.1 to 150 m/s",
            ),
            (
                "elevation",
                &self.elevation,
                -1e6,
                1e6,
                "an elevation within ±1000 km",
            ),
        ];
        for (channel, values, min, max, problem) in pairs {
            for (index, &(at, value)) in values.iter().enumerate() {
                if channel != "elevation" {
                    on_road(channel, index, at)?;
                }
                if !(min..=max).contains(&value) {
                    return Err(Error::Value {
                        channel,
                        index,
                        value,
                        problem,
                    });
                }
            }
        }
        if self.limits.first().is_none_or(|limit| limit.0 > 0.0) {
            return Err(Error::Setting {
                name: "limits",
                value: self.limits.first().map_or(f64::NAN, |limit| limit.0),
                expected: "the first limit holds from position 0",
            });
        }
        for (channel, values) in [("limits", &self.limits), ("elevation", &self.elevation)] {
            let unordered = values.windows(2).position(|pair| pair[0].0 >= pair[1].0);
            if let Some(index) = unordered {
                return Err(Error::Value {
                    channel,
                    index: index + 1,
                    value: values[index + 1].0,
                    problem: "not beyond the position before",
                });
            }
        }
        for (index, &[from, to, radius_m]) in self.curves.iter().enumerate() {
            on_road("curves", index, from)?;
            on_road("curves", index, to)?;
            if from > to {
                return Err(Error::Value {
                    channel: "curves",
                    index,
                    value: from,
                    problem: "a curve begins before it ends",
                });
            }
            if !(radius_m >= 1.0 && radius_m.is_finite()) {
                return Err(Error::Place {
                    position_m: from,
                    problem: format!(
                        "a curve with a radius of {radius_m} m; give 1 m or more, or a slow point"
                    ),
                });
            }
        }
        for (index, (at, _)) in self.signals.iter().enumerate() {
            on_road("signals", index, *at)?;
        }
        self.leader.as_ref().map_or(Ok(()), Leader::check)
    }

    fn places(&self) -> Vec<Place> {
        let place = |position_m, speed_mps| Place {
            position_m,
            speed_mps,
        };
        let mut places = vec![
            place(0.0, self.start_mps),
            place(self.length_m, self.end_mps),
        ];
        let limits = self.limits.windows(2);
        places.extend(limits.map(|pair| place(pair[1].0, pair[0].1.min(pair[1].1))));
        places.extend(self.slow_points.iter().map(|point| place(point.0, point.1)));
        for &[from, to, radius_m] in &self.curves {
            let speed_mps = (LATERAL_MPS2 * radius_m).sqrt();
            places.extend([place(from, speed_mps), place(to, speed_mps)]);
        }
        places.extend(self.stops.iter().map(|stop| place(stop.0, 0.0)));
        places.extend(self.signals.iter().map(|signal| place(signal.0, 0.0)));
        places.sort_by(|a, b| a.position_m.total_cmp(&b.position_m));
        // Of places that are one, the first and the last of the road stay where they are.
        let mut merged: Vec<Place> = Vec::with_capacity(places.len());
        for place in places {
            match merged.last_mut() {
                Some(last) if place.position_m - last.position_m < SAME_PLACE_M => {
                    last.speed_mps = last.speed_mps.min(place.speed_mps);
                    let is_start = last.position_m <= 0.0;
                    if place.position_m >= self.length_m && !is_start {
                        last.position_m = self.length_m;
                    }
                }
                _ => merged.push(place),
            }
        }
        merged
    }

    /// The lower limit of both sides of a node.
    fn limit_at(&self, position_m: &[f64], node: usize) -> f64 {
        let at = position_m[node];
        let begun = self
            .limits
            .partition_point(|limit| limit.0 <= at + SAME_PLACE_M);
        let before = self
            .limits
            .partition_point(|limit| limit.0 < at - SAME_PLACE_M);
        let touching = before.saturating_sub(1)..begun.max(1);
        self.limits[touching]
            .iter()
            .map(|limit| limit.1)
            .fold(f64::INFINITY, f64::min)
    }

    fn slope_rad(&self, from_m: f64, to_m: f64) -> f64 {
        let rise_m = self.elevation_m(to_m) - self.elevation_m(from_m);
        (rise_m / (to_m - from_m)).atan()
    }

    fn elevation_m(&self, at: f64) -> f64 {
        interpolated(&self.elevation, at)
    }
}

impl Leader {
    fn check(&self) -> Result<(), Error> {
        for (index, pair) in self.positions.windows(2).enumerate() {
            let fail = |value, problem| {
                Err(Error::Value {
                    channel: "leader",
                    index: index + 1,
                    value,
                    problem,
                })
            };
            if !(pair[1].0 > pair[0].0 && pair[1].0 < 1e9) {
                return fail(pair[1].0, "a time that is not after the one before");
            }
            if !(pair[1].1 >= pair[0].1 && pair[1].1 < 1e9) {
                return fail(
                    pair[1].1,
                    "a position behind the one before: the leader drives backwards",
                );
            }
        }
        Ok(())
    }

    /// When the car can pass a position at the earliest, s. Beyond the last position of the leader that is his last time: until then he is known
    /// to be before it.
    fn earliest_s(&self, at: f64) -> f64 {
        let target_m = at + self.standstill_gap_m;
        let positions = &self.positions;
        // Beyond the last time that the leader is not further than that.
        let after = positions.partition_point(|(_, position_m)| *position_m <= target_m);
        match (
            after.checked_sub(1).map(|k| positions[k]),
            positions.get(after),
        ) {
            (Some((t0, s0)), Some(&(t1, s1))) => {
                t0 + (target_m - s0) / (s1 - s0) * (t1 - t0) + self.headway_s
            }
            (Some((last_s, _)), None) => (last_s + self.headway_s).min(LATEST_S),
            // He begins ahead of it.
            (None, _) => NO_LEADER_S,
        }
    }
}

/// Linear between points, constant before and after; 0 without any.
fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
    let after = points.partition_point(|point| point.0 <= at);
    match (after.checked_sub(1).map(|k| points[k]), points.get(after)) {
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (at - x0) / (x1 - x0) * (y1 - y0),
        (Some((_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => 0.0,
    }
}

fn nearest(position_m: &[f64], at: f64) -> usize {
    let after = position_m.partition_point(|position| *position < at);
    let before = after.saturating_sub(1);
    let after = after.min(position_m.len() - 1);
    if at - position_m[before] <= position_m[after] - at {
        before
    } else {
        after
    }
}

/// Nodes between places: short steps beside a standstill, even ones in between.
fn positions(places: &[Place]) -> Vec<f64> {
    let mut nodes = vec![0.0];
    for pair in places.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length_m = to.position_m - from.position_m;
        let both = from.speed_mps <= 0.0 && to.speed_mps <= 0.0;
        let (begin, end) = (
            graded(0.5 * length_m, from.speed_mps),
            graded(0.5 * length_m, to.speed_mps),
        );
        let begin_m: f64 = begin.iter().sum();
        let end_m: f64 = end.iter().sum();
        let middle_m = length_m - begin_m - end_m;
        // Between two stands the car has to move.
        let least = if both && begin.is_empty() { 2.0 } else { 1.0 };
        let count = if middle_m > 1e-6 {
            (middle_m / LONGEST_STEP_M).ceil().max(least)
        } else {
            0.0
        };
        let mut at = from.position_m;
        let even = std::iter::repeat_n(middle_m / count.max(1.0), count as usize);
        for step_m in begin
            .iter()
            .copied()
            .chain(even)
            .chain(end.iter().rev().copied())
        {
            at += step_m;
            nodes.push(at);
        }
        if let Some(last) = nodes.last_mut() {
            *last = to.position_m;
        }
    }
    nodes
}

/// Growing steps within a length, from a place that is passed at a speed.
fn graded(room_m: f64, speed_mps: f64) -> Vec<f64> {
    let mut steps = Vec::new();
    let mut step_m = FIRST_STEP_M.max(FIRST_STEP_S * speed_mps);
    let mut left_m = room_m;
    while step_m < LONGEST_STEP_M && step_m <= left_m {
        steps.push(step_m);
        left_m -= step_m;
        step_m *= GROWTH;
    }
    steps
}

use super::zigzag::{Extremum, PROMINENCE_MPS, zigzag};
use crate::road::limit::{LIMIT_MPS, is_same_limit, rounded_limit};
use crate::road::map::STOP_SPACING_M;
use crate::road::{
    LimitFrom, Road, RoadKnowledge, RoadMap, RoadStop, STANDSTILL_MPS, SlopeAt, SlowPoint,
};
use crate::{Error, Motion};

/// Below this a speed is 0, m/s.
const NOISE_MPS: f64 = 0.1;

/// No car is faster, m/s.
const FASTEST_MPS: f64 = 1e3;

/// Shorter stops do not count, but for the one at the start, s.
const SHORTEST_STOP_S: f64 = 1.0;

/// A low that is this much below every limit around it is a slow point, m/s.
const BELOW_LIMIT_MPS: f64 = 2.0;

/// Readings that differ by less are one that is held, for at most so long, in a log that holds this share of them. The next one tells by a step
/// that rounding cannot explain.
const SAME_MPS: f64 = 1e-6;
const LEAST_STEP_MPS: f64 = 0.1;
const LONGEST_HOLD_S: f64 = 10.0;
const LEAST_HELD: f64 = 0.1;

/// A recorded trip that knows its speed limits, as trip drivers learn from it.
#[derive(Debug, Clone)]
pub struct RecordedTrip {
    pub(super) step_s: f64,
    joined_s: f64,
    /// Noise around standstill is 0, readings that are held are joined.
    pub(super) speed_mps: Vec<f64>,
    /// Rounded, gaps filled.
    pub(super) limit_mps: Vec<f64>,
    pub(super) distance_m: Vec<f64>,
    /// At the same samples.
    slope_rad: Option<Vec<f64>>,
    /// Extrema of the speed.
    pub(super) extrema: Vec<Extremum>,
    /// Stops and slow points as they were, without slope.
    pub(super) map: RoadMap,
}

impl RecordedTrip {
    /// Takes a drive.
    ///
    /// # Errors
    /// [`Error::NoLimits`] without limits, see [`Motion::limit_mps`]; [`Error::Option`] for a speed that no car has.
    pub fn of(motion: &Motion) -> Result<Self, Error> {
        let limit_mps = motion.limit_mps().ok_or_else(|| Error::NoLimits {
            log: motion.name().to_owned(),
        })?;
        Self::under(motion, limit_mps)
    }

    /// The same of a drive that may know no limits, as if there were none.
    pub(crate) fn of_any(motion: &Motion) -> Result<Self, Error> {
        match motion.limit_mps() {
            Some(limit_mps) => Self::under(motion, limit_mps),
            None => Self::under(motion, &vec![*LIMIT_MPS.end(); motion.len()]),
        }
    }

    fn under(motion: &Motion, limit_mps: &[f64]) -> Result<Self, Error> {
        let log = motion.log();
        let limit_mps = limit_mps
            .iter()
            .map(|&limit| rounded_limit(limit))
            .collect();
        let too_fast = log.speed_mps().iter().find(|v| **v > FASTEST_MPS);
        if let Some(&value) = too_fast {
            return Err(Error::Option {
                name: "speed_mps",
                value,
                expected: "at most 1000 m/s",
            });
        }
        let moving = |&v: &f64| if v < NOISE_MPS { 0.0 } else { v };
        let speed_mps: Vec<f64> = log.speed_mps().iter().map(moving).collect();
        let (speed_mps, joined) = joined(speed_mps, (LONGEST_HOLD_S / log.step_s()) as usize);
        let mut recording = Self {
            joined_s: joined as f64 * log.step_s(),
            step_s: log.step_s(),
            distance_m: distance_m(&speed_mps, log.step_s()),
            extrema: zigzag(&speed_mps, PROMINENCE_MPS),
            speed_mps,
            limit_mps,
            slope_rad: motion.slope_rad().map(<[f64]>::to_vec),
            map: RoadMap::default(),
        };
        let map = RoadMap {
            length_m: recording.length_m(),
            start_speed_mps: recording.speed_mps[0],
            limits: recording.limits(),
            stops: recording.stops(),
            slow_points: Some(recording.slow_points()),
            slope: Vec::new(),
        };
        recording.map = map.checked()?;
        Ok(recording)
    }

    /// Samples in a time, at least one.
    pub(super) fn samples_in(&self, time_s: f64) -> usize {
        (time_s / self.step_s).round().max(1.0) as usize
    }

    /// Sampling interval.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Stops and slow points as they were, without slope.
    pub(crate) fn map(&self) -> &RoadMap {
        &self.map
    }

    /// Measured speed; noise around standstill is 0.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        &self.speed_mps
    }

    /// Time over which a held reading was joined to the next.
    #[must_use]
    pub fn joined_s(&self) -> f64 {
        self.joined_s
    }

    /// Distance from the start.
    #[must_use]
    pub fn distance_m(&self) -> &[f64] {
        &self.distance_m
    }

    /// Speed and slope every `step_s`.
    pub(super) fn on_grid(&self, step_s: f64) -> (Vec<f64>, Option<Vec<f64>>) {
        let samples = (self.duration_s() / step_s) as usize;
        let sampled = |values: &Vec<f64>| {
            let at = |k: usize| interpolated(values, k as f64 * step_s / self.step_s);
            (0..=samples).map(at).collect()
        };
        (
            sampled(&self.speed_mps),
            self.slope_rad.as_ref().map(sampled),
        )
    }

    /// From first to last sample.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        (self.speed_mps.len() - 1) as f64 * self.step_s
    }

    pub(super) fn length_m(&self) -> f64 {
        self.distance_m[self.distance_m.len() - 1]
    }

    /// Time at which the speed is `level_mps` between sample `k` and the next, at one of them where it is not.
    pub(super) fn crossing_s(&self, k: usize, level_mps: f64) -> f64 {
        let (from, to) = (self.speed_mps[k], self.speed_mps[k + 1]);
        let share = (level_mps - from) / (to - from);
        let share = if share.is_finite() {
            share.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (k as f64 + share) * self.step_s
    }

    fn limits(&self) -> Vec<LimitFrom> {
        let changes = (1..self.limit_mps.len())
            .filter(|&k| !is_same_limit(self.limit_mps[k], self.limit_mps[k - 1]));
        std::iter::once(0)
            .chain(changes)
            .map(|k| LimitFrom {
                position_m: self.distance_m[k],
                limit_mps: self.limit_mps[k],
            })
            .collect()
    }

    /// The times at which the speed crosses that of standstill are interpolated: at 1 Hz a second per stop is at stake.
    fn stops(&self) -> Vec<RoadStop> {
        let stands = |k: usize| self.speed_mps[k] < STANDSTILL_MPS;
        let last = self.speed_mps.len() - 1;
        let mut stops: Vec<RoadStop> = Vec::new();
        let mut k = 0;
        while k <= last {
            if !stands(k) {
                k += 1;
                continue;
            }
            let first = k;
            while k < last && stands(k + 1) {
                k += 1;
            }
            let until_s = match k == last {
                true => self.duration_s(),
                false => self.crossing_s(k, STANDSTILL_MPS),
            };
            let from_s = match first {
                0 => 0.0,
                _ => self.crossing_s(first - 1, STANDSTILL_MPS),
            };
            let stop = RoadStop {
                position_m: self.distance_m[first],
                dwell_s: until_s - from_s,
            };
            match stops.last_mut() {
                Some(last) if stop.position_m - last.position_m < STOP_SPACING_M => {
                    last.dwell_s += stop.dwell_s;
                }
                _ => stops.push(stop),
            }
            k += 1;
        }
        let at_start = stands(0);
        let mut number = 0;
        stops.retain(|stop| {
            number += 1;
            stop.dwell_s >= SHORTEST_STOP_S || (at_start && number == 1)
        });
        stops
    }

    /// Lows that neither a stop nor a limit within a second explains.
    fn slow_points(&self) -> Vec<SlowPoint> {
        let reach = self.samples_in(1.0);
        let last = self.limit_mps.len() - 1;
        let slow = |&extremum: &Extremum| {
            let Extremum::Low(k) = extremum else {
                return None;
            };
            let around = &self.limit_mps[k.saturating_sub(reach)..=(k + reach).min(last)];
            let lowest_mps = around.iter().copied().fold(f64::INFINITY, f64::min);
            let speed_mps = self.speed_mps[k];
            let is_one = speed_mps >= STANDSTILL_MPS && speed_mps < lowest_mps - BELOW_LIMIT_MPS;
            is_one.then_some(SlowPoint {
                position_m: self.distance_m[k],
                speed_mps,
            })
        };
        self.extrema.iter().filter_map(slow).collect()
    }
}

impl Road {
    /// The road of a recorded drive, with its slope, its stops and, if they are to be known, its slow points.
    ///
    /// # Errors
    /// [`Error::NoLimits`] without limits, otherwise as [`Road::new`].
    pub fn of_motion(motion: &Motion, knowledge: RoadKnowledge) -> Result<Self, Error> {
        Self::of_trip(&RecordedTrip::of(motion)?, knowledge)
    }

    /// The same of a trip.
    ///
    /// # Errors
    /// As [`Road::new`].
    pub fn of_trip(trip: &RecordedTrip, knowledge: RoadKnowledge) -> Result<Self, Error> {
        let mut map = trip.map.clone();
        if knowledge == RoadKnowledge::Stops {
            map.slow_points = None;
        }
        let slope_rad = trip.slope_rad.as_deref().unwrap_or_default();
        let slope = trip.distance_m.iter().zip(slope_rad);
        map.slope = slope
            .map(|(&position_m, &slope_rad)| SlopeAt {
                position_m,
                slope_rad,
            })
            .collect();
        Self::new(map)
    }
}

/// Joins the readings of a speed that is held until the next one comes by straight lines: steps would be accelerations that
/// no car had. Standstill, and what is held for more than `longest` samples, stays; so do all where few are held, as rounded ones
/// happen to be. With how many samples were changed.
fn joined(speed_mps: Vec<f64>, longest: usize) -> (Vec<f64>, usize) {
    let (mut start, mut changed, mut lines) = (0, 0, speed_mps.clone());
    for next in 1..speed_mps.len() {
        let (from, to) = (speed_mps[start], speed_mps[next]);
        if (to - from).abs() <= SAME_MPS {
            continue;
        }
        let held = next - start;
        if from > 0.0 && held <= longest && (to - from).abs() >= LEAST_STEP_MPS {
            changed += held - 1;
            for k in 1..held {
                lines[start + k] = from + (to - from) * k as f64 / held as f64;
            }
        }
        start = next;
    }
    let moving = speed_mps.iter().filter(|speed| **speed > 0.0).count();
    if changed as f64 > LEAST_HELD * moving as f64 {
        (lines, changed)
    } else {
        (speed_mps, 0)
    }
}

fn distance_m(speed_mps: &[f64], step_s: f64) -> Vec<f64> {
    let mut distance_m = vec![0.0; speed_mps.len()];
    for k in 1..speed_mps.len() {
        distance_m[k] = distance_m[k - 1] + 0.5 * (speed_mps[k - 1] + speed_mps[k]) * step_s;
    }
    distance_m
}

/// Linear between samples; `index` may lie between two, beyond the ends it is the nearest.
/// The value at a fractional index, linear in between, that of the ends beyond them; `values` must not be empty.
#[must_use]
pub fn interpolated(values: &[f64], index: f64) -> f64 {
    let last = values.len() - 1;
    let index = index.clamp(0.0, last as f64);
    let left = (index as usize).min(last.saturating_sub(1));
    let right = (left + 1).min(last);
    values[left] + (values[right] - values[left]) * (index - left as f64)
}

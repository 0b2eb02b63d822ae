use std::ops::RangeInclusive;

use driver_model::Motion;

/// Slower than this the car stands, m/s.
const STANDSTILL_MPS: f64 = 0.3;

/// Between stands that are nearer than this the car creeps, m.
const CREEPING_M: f64 = 2.0;

/// Faster than the limit by less is the noise of a speedometer, m/s.
const SPEEDOMETER_MPS: f64 = 0.3;

/// A recorded motion: uniform samples, all channels as long as the speed, none of them empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedMotion<'a> {
    /// Time between two samples, s.
    pub step_s: f64,
    /// Speed, m/s; backward counts as standing.
    pub speed_mps: &'a [f64],
    /// Slope angle, rad; `None` on a level road.
    pub slope_rad: Option<&'a [f64]>,
    /// Speed limit, m/s; `None` where it is not known.
    pub limit_mps: Option<&'a [f64]>,
}

impl<'a> From<&'a Motion> for RecordedMotion<'a> {
    fn from(motion: &'a Motion) -> Self {
        Self {
            step_s: motion.step_s(),
            speed_mps: motion.speed_mps(),
            slope_rad: motion.slope_rad(),
            limit_mps: motion.limit_mps(),
        }
    }
}

impl RecordedMotion<'_> {
    pub(super) fn forward_mps(&self) -> Vec<f64> {
        // What is not a number stays so, to be refused.
        let forward = |&v: &f64| if v < 0.0 { 0.0 } else { v };
        self.speed_mps.iter().map(forward).collect()
    }
}

/// A recorded motion over the distance, with where it stands.
pub(super) struct Legs<'a> {
    pub(super) motion: RecordedMotion<'a>,
    pub(super) speed_mps: Vec<f64>,
    pub(super) distance_m: Vec<f64>,
    /// Samples of every stand, in order.
    pub(super) stands: Vec<RangeInclusive<usize>>,
}

impl<'a> Legs<'a> {
    pub(super) fn of(motion: &RecordedMotion<'a>) -> Self {
        let speed_mps = motion.forward_mps();
        let mut distance_m = vec![0.0; speed_mps.len()];
        for (k, pair) in speed_mps.windows(2).enumerate() {
            distance_m[k + 1] = distance_m[k] + 0.5 * (pair[0] + pair[1]) * motion.step_s;
        }
        Self {
            motion: *motion,
            stands: stands(&speed_mps, &distance_m),
            speed_mps,
            distance_m,
        }
    }

    pub(super) fn last(&self) -> usize {
        self.speed_mps.len().saturating_sub(1)
    }

    pub(super) fn starts_standing(&self) -> bool {
        self.stands.first().is_some_and(|stand| *stand.start() == 0)
    }

    pub(super) fn ends_standing(&self) -> bool {
        let last = self.last();
        self.stands.last().is_some_and(|stand| *stand.end() == last)
    }

    /// The sample of the arrival: where the last stand begins that lasts to the end, or the last one.
    pub(super) fn arrival(&self) -> usize {
        match self.stands.last() {
            Some(stand) if self.ends_standing() => *stand.start(),
            _ => self.last(),
        }
    }

    pub(super) fn arrival_s(&self) -> f64 {
        self.arrival() as f64 * self.motion.step_s
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.last() as f64 * self.motion.step_s
    }

    pub(super) fn end_dwell_s(&self) -> f64 {
        self.duration_s() - self.arrival_s()
    }

    pub(super) fn length_m(&self) -> f64 {
        self.distance_m.get(self.arrival()).copied().unwrap_or(0.0)
    }

    pub(super) fn end_slope_rad(&self) -> f64 {
        let slope_rad = self.motion.slope_rad.unwrap_or_default();
        slope_rad.get(self.arrival()).copied().unwrap_or(0.0)
    }

    /// Accelerations of the steps in motion.
    pub(super) fn accels_mps2(&self) -> Vec<f64> {
        let moving = |pair: &&[f64]| pair[0].max(pair[1]) >= STANDSTILL_MPS;
        let steps = self.speed_mps.windows(2).filter(moving);
        steps
            .map(|pair| (pair[1] - pair[0]) / self.motion.step_s)
            .collect()
    }

    pub(super) fn faster_than_limit_s(&self) -> f64 {
        let limit_mps = self.motion.limit_mps.unwrap_or_default();
        let samples = self.speed_mps.iter().zip(limit_mps);
        let faster = samples.filter(|(v, limit)| **v > **limit + SPEEDOMETER_MPS);
        faster.count() as f64 * self.motion.step_s
    }

    /// The sample at or before a place, and the one after it.
    pub(super) fn around(&self, at_m: f64) -> [usize; 2] {
        let after = self.distance_m.partition_point(|m| *m < at_m);
        [after.saturating_sub(1), after.min(self.last())]
    }

    pub(super) fn speed_at(&self, at_m: f64) -> f64 {
        let [from, to] = self.around(at_m);
        let apart_m = self.distance_m[to] - self.distance_m[from];
        let share = if apart_m > 0.0 {
            ((at_m - self.distance_m[from]) / apart_m).clamp(0.0, 1.0)
        } else {
            1.0
        };
        self.speed_mps[from] + share * (self.speed_mps[to] - self.speed_mps[from])
    }
}

/// Stands that are a creep apart are one, from the first to the last sample.
fn stands(speed_mps: &[f64], distance_m: &[f64]) -> Vec<RangeInclusive<usize>> {
    let mut stands: Vec<RangeInclusive<usize>> = Vec::new();
    for (k, _) in speed_mps
        .iter()
        .enumerate()
        .filter(|(_, v)| **v < STANDSTILL_MPS)
    {
        match stands.last_mut() {
            Some(last)
                if *last.end() + 1 == k || distance_m[k] - distance_m[*last.end()] < CREEPING_M =>
            {
                *last = *last.start()..=k;
            }
            _ => stands.push(k..=k),
        }
    }
    stands
}

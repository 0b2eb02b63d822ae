//! Poses that cannot be true do not reach the controllers.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Pose, StampedPose};

use super::counts::Dropped;

/// The place that robots can be in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arena {
    /// From and to, in m
    pub x_m: [f64; 2],
    /// From and to, in m
    pub y_m: [f64; 2],
}

/// What robots can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Where they can be
    pub arena: Arena,
    /// How fast they are at most, in m/s
    pub speed_mps: f64,
    /// How fast they turn at most, in rad/s
    pub turn_rate_rad_s: f64,
    /// How near two of them can be to each other, in m
    pub spacing_m: f64,
}

/// By how much a newer pose is newer, in s; stamps of the same pose differ by rounding.
const NEWER_S: f64 = 1e-6;
/// How wrong a pose may be, in m and rad.
const TOLERANCE_M: f64 = 0.05;
const TOLERANCE_RAD: f64 = 0.5;
/// A robot out of sight was told to stop and has stopped within this time, in s: it is not farther away than it can move in it.
const STOPPED_AFTER_S: f64 = 2.5;

/// Remembers where each robot was last.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    bounds: Bounds,
    last: Vec<Option<StampedPose>>,
    /// Poses in a row that agree with each other
    agreeing: Vec<u32>,
    started: bool,
}

impl Gate {
    pub(super) fn new(bounds: Bounds, robots: usize) -> Self {
        Self {
            bounds,
            last: vec![None; robots],
            agreeing: vec![0; robots],
            started: false,
        }
    }

    pub(super) fn agreeing(&self, robot: usize) -> u32 {
        self.agreeing[robot]
    }

    /// Until now a robot was taken to be where its newest pose says, so that one wrong pose at the beginning does not count for ever.
    pub(super) fn start(&mut self) {
        self.started = true;
    }

    /// Takes a finite pose, or says what is wrong with it.
    pub(super) fn pass(&mut self, robot: usize, seen: StampedPose) -> Result<(), Dropped> {
        if !self.bounds.arena.contains(&seen.pose) {
            return Err(Dropped::Outside);
        }
        if let Some(last) = &self.last[robot] {
            match self.bounds.follows(last, &seen) {
                Err(Dropped::Jump) if !self.started => self.agreeing[robot] = 0,
                follows => follows?,
            }
        }
        let mut others = self.last.iter().enumerate();
        if others.any(|(other, last)| other != robot && self.bounds.overlap(last.as_ref(), &seen)) {
            return Err(Dropped::Overlapping);
        }
        self.last[robot] = Some(seen);
        self.agreeing[robot] = self.agreeing[robot].saturating_add(1);
        Ok(())
    }
}

impl Arena {
    fn contains(&self, pose: &Pose) -> bool {
        let within = |[from, to]: [f64; 2], value: f64| (from..=to).contains(&value);
        within(self.x_m, pose.x_m) && within(self.y_m, pose.y_m)
    }
}

impl Bounds {
    fn follows(&self, last: &StampedPose, seen: &StampedPose) -> Result<(), Dropped> {
        let passed_s = seen.stamp_s - last.stamp_s;
        if passed_s <= NEWER_S {
            return Err(Dropped::Old);
        }
        let moving_s = passed_s.min(STOPPED_AFTER_S);
        let turn_rad = (seen.pose.heading_rad - last.pose.heading_rad) % std::f64::consts::TAU;
        let turn_rad = turn_rad.abs().min(std::f64::consts::TAU - turn_rad.abs());
        let near = distance_m(&last.pose, &seen.pose) <= TOLERANCE_M + self.speed_mps * moving_s;
        let turned = turn_rad <= TOLERANCE_RAD + self.turn_rate_rad_s * moving_s;
        if near && turned {
            Ok(())
        } else {
            Err(Dropped::Jump)
        }
    }

    fn overlap(&self, other: Option<&StampedPose>, seen: &StampedPose) -> bool {
        other.is_some_and(|other| distance_m(&other.pose, &seen.pose) < self.spacing_m)
    }
}

fn distance_m(a: &Pose, b: &Pose) -> f64 {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

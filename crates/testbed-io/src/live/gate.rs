//! Poses that cannot be true do not reach the controllers.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Pose, Speeds, StampedPose};

use super::commanded::Commanded;
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
    /// Distance between their wheels, in m
    pub wheel_base_m: f64,
    /// How far each wheel may be off what it is told, as a share
    pub wheel_error: f64,
    /// How near two of them can be to each other, in m
    pub spacing_m: f64,
}

/// By how much a newer pose is newer, in s; more than the drift of clocks makes of a stamp that repeats itself.
const NEWER_S: f64 = 5e-4;
/// How wrong a pose may be, in m and rad.
pub(super) const TOLERANCE_M: f64 = 0.05;
const TOLERANCE_RAD: f64 = 0.5;
/// A robot out of sight was told to stop and has stopped within this time, in s: it is not farther away than it can move in it.
pub(super) const STOPPED_AFTER_S: f64 = 2.5;
/// Poses are compared with one that is older than this besides, in s, so that the tolerance does not add up from pose to pose.
const APART_S: f64 = 0.5;
/// What a robot was told before a pose may take effect after it: so late may commands and poses be together, in s.
pub(super) const UNDER_WAY_S: f64 = 0.3;
/// A robot that was not seen for longer may not have heard that it shall stop, in s, and have turned on by this at most, in rad.
const IN_SIGHT_S: f64 = 0.3;
const UNHEARD_RAD: f64 = 1.5;
/// Remembers where each robot was.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    bounds: Bounds,
    tracks: Vec<Track>,
    /// Nothing where the commands do not go to these robots
    told: Vec<Commanded>,
    started: bool,
}

/// Where a robot was.
#[derive(Debug, Clone, Copy, Default)]
struct Track {
    last: Option<StampedPose>,
    /// Two poses that are at least half a second apart, the older first
    earlier: [Option<StampedPose>; 2],
    /// Poses in a row that agree with each other
    agreeing: u32,
    /// Whether poses since the last say that it is where it cannot be
    strayed: bool,
}

impl Gate {
    pub(super) fn new(bounds: Bounds, robots: usize) -> Self {
        Self {
            bounds,
            tracks: vec![Track::default(); robots],
            told: vec![Commanded::new(bounds.wheel_base_m); robots],
            started: false,
        }
    }

    /// Poses in a row that agree with each other.
    pub(super) fn agreeing(&self, robot: usize) -> u32 {
        self.tracks[robot].agreeing
    }

    /// What a robot does from `time_s` on: poses that this does not lead to are not believed.
    pub(super) fn told(&mut self, robot: usize, time_s: f64, speeds: Speeds) {
        self.told[robot].sent(time_s, speeds);
    }

    /// Until now a robot was taken to be where its newest pose says, so that one wrong pose at the beginning does not count for ever.
    pub(super) fn start(&mut self) {
        self.started = true;
    }

    /// How far a pose is from where commands led the robot since its last, in m and rad.
    pub(super) fn off(&self, robot: usize, seen: &StampedPose) -> Option<[f64; 2]> {
        let last = self.tracks[robot].last?;
        let led = self.told[robot].carried(&last, seen.stamp_s);
        let off_rad = wrapped(seen.pose.heading_rad - led.heading_rad);
        Some([distance_m(&led, &seen.pose), off_rad])
    }

    /// Takes a finite pose, or says what is wrong with it.
    pub(super) fn pass(&mut self, robot: usize, seen: StampedPose) -> Result<(), Dropped> {
        let passed = self.look_at(robot, seen);
        let cannot_be = matches!(
            passed,
            Err(Dropped::Jump | Dropped::Overlapping | Dropped::Outside)
        );
        self.tracks[robot].strayed |= self.started && cannot_be;
        passed
    }

    fn look_at(&mut self, robot: usize, seen: StampedPose) -> Result<(), Dropped> {
        if !self.bounds.arena.contains(&seen.pose) {
            return Err(Dropped::Outside);
        }
        let mut track = self.tracks[robot];
        match track.follows(&seen, &self.bounds, &self.told[robot]) {
            Err(Dropped::Jump) if !self.started => {
                track = Track {
                    last: track.last,
                    ..Track::default()
                };
            }
            follows => follows?,
        }
        let mut others = self.tracks.iter().enumerate();
        if others.any(|(other, track)| other != robot && self.bounds.overlap(track, &seen)) {
            return Err(Dropped::Overlapping);
        }
        track.add(seen);
        self.tracks[robot] = track;
        Ok(())
    }
}

impl Track {
    fn follows(
        &self,
        seen: &StampedPose,
        bounds: &Bounds,
        told: &Commanded,
    ) -> Result<(), Dropped> {
        let newer = |last: StampedPose| seen.stamp_s - last.stamp_s >= NEWER_S;
        if !self.last.is_none_or(newer) {
            return Err(Dropped::Old);
        }
        let within = |before: Option<StampedPose>, most_s: f64| {
            before.is_none_or(|before| bounds.reach(&before, seen, most_s, told, self.strayed))
        };
        let is_led = |last: StampedPose| {
            let is_in_sight = !self.strayed && seen.stamp_s - last.stamp_s <= IN_SIGHT_S;
            is_in_sight || bounds.is_led(&last, seen, told, self.strayed)
        };
        // In sight since the earlier pose, it may have moved all the time.
        if within(self.last, STOPPED_AFTER_S)
            && within(self.earlier[0], f64::INFINITY)
            && self.last.is_none_or(is_led)
        {
            Ok(())
        } else {
            Err(Dropped::Jump)
        }
    }

    fn add(&mut self, seen: StampedPose) {
        let [older, newer] = self.earlier;
        if newer.is_none_or(|newer| seen.stamp_s - newer.stamp_s >= APART_S) {
            self.earlier = [newer.or(older), Some(seen)];
        }
        self.last = Some(seen);
        self.strayed = false;
        self.agreeing = self.agreeing.saturating_add(1);
    }
}

impl Arena {
    fn contains(&self, pose: &Pose) -> bool {
        let within = |[from, to]: [f64; 2], value: f64| (from..=to).contains(&value);
        within(self.x_m, pose.x_m) && within(self.y_m, pose.y_m)
    }
}

impl Bounds {
    /// Whether a robot can have come from one pose to the other if it moved for at most some time. Its heading is as it was told: it can
    /// turn too fast for anything else to mean much.
    fn reach(
        &self,
        before: &StampedPose,
        seen: &StampedPose,
        most_s: f64,
        told: &Commanded,
        contradicted: bool,
    ) -> bool {
        let moving_s = (seen.stamp_s - before.stamp_s).min(most_s);
        let most_m = self.speed_mps * moving_s;
        let most_rad = if told.is_empty() {
            self.turn_rate_rad_s * moving_s
        } else {
            self.told_rad(before.stamp_s, seen.stamp_s, told, contradicted)
        };
        distance_m(&before.pose, &seen.pose) <= TOLERANCE_M + most_m
            && turned_rad(&before.pose, &seen.pose) <= TOLERANCE_RAD + most_rad
    }

    /// The turn to which commands can have led.
    fn told_rad(&self, from_s: f64, to_s: f64, told: &Commanded, contradicted: bool) -> f64 {
        let way = told.between(from_s - UNDER_WAY_S, to_s);
        let [left_m, right_m] = way.wheels_m;
        let wheels_rad = self.wheel_error * (left_m + right_m) / self.wheel_base_m;
        let unheard_rad = if to_s - from_s > IN_SIGHT_S && !contradicted {
            let last = told.between(from_s - UNDER_WAY_S, from_s);
            let rate_rad_s = last.turned_rad / UNDER_WAY_S;
            (rate_rad_s * (to_s - from_s).min(STOPPED_AFTER_S)).min(UNHEARD_RAD)
        } else {
            0.0
        };
        way.turned_rad + wheels_rad + unheard_rad
    }

    fn overlap(&self, other: &Track, seen: &StampedPose) -> bool {
        other
            .last
            .is_some_and(|other| distance_m(&other.pose, &seen.pose) < self.spacing_m)
    }
}

pub(super) fn distance_m(a: &Pose, b: &Pose) -> f64 {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

/// Between two headings, the shorter way round.
pub(super) fn turned_rad(a: &Pose, b: &Pose) -> f64 {
    wrapped(b.heading_rad - a.heading_rad).abs()
}

/// An angle between −π and π.
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle_rad - turn * (angle_rad / turn).round()
}

#[cfg(test)]
impl Bounds {
    /// Of an ordinary robot on a long floor.
    pub(super) const ORDINARY: Self = Self {
        arena: Arena {
            x_m: [-2.0, 30.0],
            y_m: [-2.0, 2.0],
        },
        speed_mps: 0.3,
        turn_rate_rad_s: 3.0,
        wheel_base_m: 0.1,
        wheel_error: 0.1,
        spacing_m: 0.1,
    };
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds::ORDINARY;

    fn seen(stamp_s: f64, x_m: f64) -> StampedPose {
        let pose = Pose {
            x_m,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        StampedPose { stamp_s, pose }
    }

    fn started() -> Gate {
        let mut gate = Gate::new(BOUNDS, 2);
        gate.pass(0, seen(0.0, 0.0)).unwrap();
        gate.pass(1, seen(0.0, 1.0)).unwrap();
        gate.start();
        gate
    }

    #[test]
    fn poses_that_cannot_be_are_named() {
        let mut gate = started();
        assert_eq!(gate.pass(0, seen(0.1, 40.0)), Err(Dropped::Outside));
        assert_eq!(gate.pass(0, seen(0.1, 0.5)), Err(Dropped::Jump));
        assert_eq!(gate.pass(0, seen(0.0, 0.0)), Err(Dropped::Old));
        assert_eq!(gate.pass(0, seen(5.0, 0.95)), Err(Dropped::Jump));
        gate.pass(0, seen(5.0, 0.75)).unwrap();
        assert_eq!(gate.pass(0, seen(6.0, 0.95)), Err(Dropped::Overlapping));
        gate.pass(0, seen(6.0, 0.85)).unwrap();
    }

    #[test]
    fn small_steps_do_not_add_up_to_a_large_one() {
        let mut gate = started();
        let passed = (1..500).filter(|step| {
            let step = f64::from(*step);
            // 2.5 m/s, away from the other robot
            gate.pass(0, seen(0.02 * step, -0.05 * step)).is_ok()
        });
        let passed = passed.count();
        assert!(passed < 30, "{passed}");
    }

    #[test]
    fn before_the_start_the_newest_pose_counts() {
        let mut gate = Gate::new(BOUNDS, 1);
        gate.pass(0, seen(0.0, 20.0)).unwrap();
        gate.pass(0, seen(0.1, 0.0)).unwrap();
        assert_eq!(gate.agreeing(0), 1);
        gate.pass(0, seen(0.2, 0.0)).unwrap();
        assert_eq!(gate.agreeing(0), 2);
    }

    #[test]
    fn a_turn_through_pi_is_no_jump() {
        let mut gate = started();
        for (step, heading_rad) in [
            (1.0, 3.1),
            (2.0, -3.1),
            (3.0, 3.1),
            (4.0, 3.1 - 10.0 * std::f64::consts::TAU),
        ] {
            let mut pose = seen(step, 0.0);
            pose.pose.heading_rad = heading_rad;
            gate.pass(0, pose).unwrap();
        }
    }

    #[test]
    fn a_heading_that_turned_by_pi_is_not_believed_however_long_it_lasts() {
        let mut gate = started();
        let mut believed = 0;
        for step in 1..500 {
            let time_s = 0.02 * f64::from(step);
            let speeds = if time_s < 0.3 {
                Speeds {
                    speed_mps: 0.2,
                    turn_rate_rad_s: 0.5,
                }
            } else {
                Speeds::ZERO
            };
            gate.told(0, time_s, speeds);
            let mut pose = seen(time_s, 0.2 * time_s.min(0.3));
            pose.pose.heading_rad = std::f64::consts::PI;
            believed += u32::from(gate.pass(0, pose).is_ok());
        }
        assert_eq!(believed, 0);
        // Where its commands led it, it is found again.
        gate.pass(0, seen(10.0, 0.06)).unwrap();
    }

    #[test]
    fn a_robot_in_sight_is_believed_to_go_where_it_was_not_told() {
        let mut gate = started();
        gate.told(0, 0.0, Speeds::ZERO);
        for step in 1..100 {
            let time_s = 0.02 * f64::from(step);
            gate.pass(0, seen(time_s, 0.2 * time_s)).unwrap();
        }
    }
}

//! Where the robot is now: the newest pose carried forward through the commands sent since it was seen.

use crate::pose::{Pose, Speeds};

const CAPACITY: usize = 64;

/// A pose with the time at which it was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedPose {
    /// On the clock of the controller, in s
    pub stamp_s: f64,
    /// Where the axle was
    pub pose: Pose,
}

impl StampedPose {
    /// The constant speeds that lead from this pose to a later one, along the chord between them.
    #[must_use]
    pub fn speeds_to(&self, later: &Self) -> Speeds {
        let duration_s = later.stamp_s - self.stamp_s;
        let turn_rad = wrapped(later.pose.heading_rad - self.pose.heading_rad);
        let (sin, cos) = (self.pose.heading_rad + 0.5 * turn_rad).sin_cos();
        let (dx, dy) = (
            later.pose.x_m - self.pose.x_m,
            later.pose.y_m - self.pose.y_m,
        );
        Speeds {
            speed_mps: (dx * cos + dy * sin) / duration_s,
            turn_rate_rad_s: turn_rad / duration_s,
        }
    }
}

/// An observer with fixed gains on poses that come late, in any order, or not at all.
#[derive(Debug, Clone)]
pub struct Predictor {
    commands: [(f64, Speeds); CAPACITY],
    sent: usize,
    estimate: Option<StampedPose>,
}

impl Default for Predictor {
    fn default() -> Self {
        Self {
            commands: [(f64::NEG_INFINITY, Speeds::ZERO); CAPACITY],
            sent: 0,
            estimate: None,
        }
    }
}

impl Predictor {
    /// Commands that are remembered: at 50 Hz those of 1.28 s. A pose that is older than all of them is not carried forward rightly.
    pub const REMEMBERED: usize = CAPACITY;

    /// Remembers what the robot does from `time_s` on; times must not decrease.
    pub fn sent(&mut self, time_s: f64, speeds: Speeds) {
        self.commands[self.sent % CAPACITY] = (time_s, speeds);
        self.sent += 1;
    }

    /// Takes a pose in. One that is not newer than the last is ignored; the first, and one that comes more than
    /// `restart_after_s` after the last, is taken as it is.
    pub fn observe(&mut self, seen: StampedPose, gains: [f64; 2], restart_after_s: f64) {
        let corrected = match self.estimate {
            Some(last) if seen.stamp_s <= last.stamp_s => return,
            Some(last) if seen.stamp_s - last.stamp_s <= restart_after_s => {
                self.corrected(last, seen, gains)
            }
            _ => seen.pose,
        };
        self.estimate = Some(StampedPose {
            stamp_s: seen.stamp_s,
            pose: corrected,
        });
    }

    fn corrected(&self, last: StampedPose, seen: StampedPose, gains: [f64; 2]) -> Pose {
        let [position, heading] = gains;
        let expected = self.advanced(last, seen.stamp_s);
        let turn = wrapped(seen.pose.heading_rad - expected.heading_rad);
        Pose {
            x_m: expected.x_m + position * (seen.pose.x_m - expected.x_m),
            y_m: expected.y_m + position * (seen.pose.y_m - expected.y_m),
            heading_rad: expected.heading_rad + heading * turn,
        }
    }

    /// The corrected pose at the newest stamp.
    #[must_use]
    pub fn last_seen(&self) -> Option<StampedPose> {
        self.estimate
    }

    /// The pose at `now_s`.
    #[must_use]
    pub fn at(&self, now_s: f64) -> Option<Pose> {
        self.estimate.map(|last| self.advanced(last, now_s))
    }

    /// Through the commands between the stamp and `until_s`; before the oldest remembered one the robot is taken to stand.
    fn advanced(&self, from: StampedPose, until_s: f64) -> Pose {
        let oldest = self.sent.saturating_sub(CAPACITY);
        let mut next = self.sent;
        while next > oldest && self.commands[(next - 1) % CAPACITY].0 > from.stamp_s {
            next -= 1;
        }
        let (mut pose, mut time_s) = (from.pose, from.stamp_s);
        let mut speeds = if next > oldest {
            self.commands[(next - 1) % CAPACITY].1
        } else {
            Speeds::ZERO
        };
        while next < self.sent {
            let (start_s, following) = self.commands[next % CAPACITY];
            if start_s >= until_s {
                break;
            }
            pose = pose.advanced(speeds, start_s - time_s);
            (time_s, speeds) = (start_s, following);
            next += 1;
        }
        if until_s > time_s {
            pose = pose.advanced(speeds, until_s - time_s);
        }
        pose
    }
}

/// An angle between −π and π.
#[must_use]
pub(crate) fn wrapped(angle_rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle_rad - turn * (angle_rad / turn).round()
}

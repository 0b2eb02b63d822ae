//! Trackers that hold the last pose.

use unicycle_cbf::{Pose, StampedPose};

/// Poses that stay the same to the last bit while a robot is told to go so far, in m, and with its commands so long under way, in s, may be
/// held by the tracker: measured ones scatter.
const TOLD_M: f64 = 0.04;
const UNDER_WAY_S: f64 = 0.3;

/// What is known of the poses of one robot.
#[derive(Debug, Default)]
pub(super) struct Held {
    /// Since when they are the same
    since: Option<StampedPose>,
    were_held: bool,
}

impl Held {
    /// Takes in the next pose; `told_m` gives the way that the robot was told to go between two times, in m.
    pub(super) fn add(&mut self, seen: StampedPose, told_m: impl Fn(f64, f64) -> f64) {
        match self.since {
            Some(since) if is_same(&since.pose, &seen.pose) => {
                self.were_held |= told_m(since.stamp_s, seen.stamp_s - UNDER_WAY_S) > TOLD_M;
            }
            _ => self.since = Some(seen),
        }
    }

    /// Whether they stayed the same while the robot was told to move.
    pub(super) fn were_held(&self) -> bool {
        self.were_held
    }
}

fn is_same(a: &Pose, b: &Pose) -> bool {
    let bits = |pose: &Pose| [pose.x_m, pose.y_m, pose.heading_rad].map(f64::to_bits);
    bits(a) == bits(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_held_if_they_stay_while_a_robot_is_told_to_go() {
        for (speed_mps, step_m, held) in [(0.1, 0.0, true), (0.0, 0.0, false), (0.1, 1e-4, false)] {
            let mut poses = Held::default();
            for i in 0..20 {
                let stamp_s = 0.1 * f64::from(i);
                let pose = Pose {
                    x_m: step_m * f64::from(i),
                    y_m: 1.0,
                    heading_rad: 0.5,
                };
                poses.add(StampedPose { stamp_s, pose }, |from_s, to_s| {
                    speed_mps * (to_s - from_s).max(0.0)
                });
            }
            assert_eq!(poses.were_held(), held, "{speed_mps} m/s, {step_m} m");
        }
    }
}

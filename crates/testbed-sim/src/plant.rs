//! Simulated robots: where they really are, and how they follow commands.

use unicycle_cbf::{Body, Pose, Speeds, State, WheelSpeeds};

use crate::disturbances::{Disturbances, Random};

/// One robot as it really is.
#[derive(Debug, Clone)]
pub(crate) struct Plant {
    body: Body,
    pose: Pose,
    wheels: WheelSpeeds,
    gains: WheelSpeeds,
    time_constant_s: f64,
    resolution_mps: f64,
}

impl Plant {
    /// A robot that moves at `speeds`, with errors of its own.
    pub(crate) fn new(
        body: Body,
        pose: Pose,
        speeds: Speeds,
        disturbances: &Disturbances,
        random: &mut Random,
    ) -> Self {
        let mut gain = || 1.0 + disturbances.wheel_error * random.signed();
        let gains = WheelSpeeds {
            left_mps: gain(),
            right_mps: gain(),
        };
        let mass = 1.0 + disturbances.mass_error * random.signed();
        let wheels = body.wheel_speeds(speeds);
        Self {
            body,
            pose,
            wheels: WheelSpeeds {
                left_mps: gains.left_mps * wheels.left_mps,
                right_mps: gains.right_mps * wheels.right_mps,
            },
            gains,
            time_constant_s: disturbances.motor_time_constant_s * mass,
            resolution_mps: disturbances.wheel_resolution_mps,
        }
    }

    pub(crate) fn pose(&self) -> Pose {
        self.pose
    }

    /// The true state of the point of interest.
    pub(crate) fn state(&self) -> State {
        let speeds = self.body.speeds_of(self.wheels);
        self.pose.state(self.body.offset_m, speeds)
    }

    /// The wheel speeds that a command leads to in the end.
    fn target(&self, command: WheelSpeeds) -> WheelSpeeds {
        let rounded = |speed: f64| {
            if self.resolution_mps > 0.0 {
                (speed / self.resolution_mps).round() * self.resolution_mps
            } else {
                speed
            }
        };
        WheelSpeeds {
            left_mps: self.gains.left_mps * rounded(command.left_mps),
            right_mps: self.gains.right_mps * rounded(command.right_mps),
        }
    }

    /// Takes a command; without a time constant the wheels follow at once.
    pub(crate) fn command(&mut self, command: WheelSpeeds) -> WheelSpeeds {
        let target = self.target(command);
        if self.time_constant_s <= 0.0 {
            self.wheels = target;
        }
        target
    }

    /// Moves on towards the wheel speeds of a command: the wheels approach them exponentially, and the pose moves by an arc of
    /// their mean.
    pub(crate) fn advance(&mut self, target: WheelSpeeds, duration_s: f64) {
        let decay = if self.time_constant_s > 0.0 {
            (-duration_s / self.time_constant_s).exp()
        } else {
            0.0
        };
        let lagging_s = self.time_constant_s * (1.0 - decay);
        let mean = |now: f64, target: f64| target + (now - target) * lagging_s / duration_s;
        let after = |now: f64, target: f64| target + (now - target) * decay;
        let (left, right) = (self.wheels.left_mps, self.wheels.right_mps);
        let mean = WheelSpeeds {
            left_mps: mean(left, target.left_mps),
            right_mps: mean(right, target.right_mps),
        };
        self.pose = self.pose.advanced(self.body.speeds_of(mean), duration_s);
        self.wheels = WheelSpeeds {
            left_mps: after(left, target.left_mps),
            right_mps: after(right, target.right_mps),
        };
    }
}

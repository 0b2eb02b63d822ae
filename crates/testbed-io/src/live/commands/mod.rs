//! From the loop to the robots.

mod dead_man;
mod json;
mod khepera;
mod nowhere;
mod robotarium;
mod robotarium_udp;
mod udp;

use std::time::Duration;

use serde::Serialize;
use unicycle_cbf::{Speeds, WheelSpeeds};

pub(super) use dead_man::DeadMan;
pub(super) use json::{JsonUdpCommands, JsonWriter};
pub(super) use khepera::Khepera;
pub use khepera::{KheperaReply, KheperaSpec};
pub(super) use nowhere::Nowhere;
pub(super) use robotarium::RobotariumCommands;
pub(super) use robotarium_udp::RobotariumUdp;
pub use robotarium_udp::RobotariumUdpSpec;

/// What a robot is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::live) struct Command {
    /// Index of the robot, from the front
    pub(in crate::live) robot: usize,
    /// Speed and turn rate
    pub(in crate::live) speeds: Speeds,
    /// The same as wheel speeds
    pub(in crate::live) wheels: WheelSpeeds,
}

impl Command {
    /// Stand still.
    #[must_use]
    pub(in crate::live) fn zero(robot: usize) -> Self {
        Self {
            robot,
            speeds: Speeds::ZERO,
            wheels: WheelSpeeds::default(),
        }
    }
}

/// Commands sent and answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct CommandCounts {
    /// To single robots
    pub sent: u64,
    /// Answers of robots, where the protocol has them
    pub acknowledged: u64,
    /// That could not be sent
    pub failed: u64,
    /// Packets from addresses that are no robot's
    pub stranger: u64,
    /// Answers that are none
    pub malformed: u64,
}

/// A peer that does not answer.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::live) struct Silence {
    /// Which
    pub(in crate::live) peer: String,
    /// For how long, in s
    pub(in crate::live) for_s: f64,
}

/// A way to tell robots what to do.
pub(in crate::live) trait CommandSink: Send {
    /// Sends commands without waiting; what cannot be sent is counted, and is not sent later.
    fn send(&mut self, commands: &[Command]);

    /// Tells every robot to stand, until that is certain or `patience` has passed; where nothing can be certain, often. Gives the
    /// robots of which it is not certain where it could be.
    fn stop(&mut self, patience: Duration) -> Vec<usize>;

    /// The peer that has been silent for the longest time, where the protocol has answers.
    fn silence(&self) -> Option<Silence>;

    /// Counts so far.
    fn counts(&self) -> CommandCounts;
}

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
pub use json::{JsonUdpCommands, JsonWriter};
pub use khepera::{Khepera, KheperaReply, KheperaSpec};
pub use nowhere::Nowhere;
pub use robotarium::RobotariumCommands;
pub use robotarium_udp::{RobotariumUdp, RobotariumUdpSpec};

/// What a robot is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Index of the robot, from the front
    pub robot: usize,
    /// Speed and turn rate
    pub speeds: Speeds,
    /// The same as wheel speeds
    pub wheels: WheelSpeeds,
}

impl Command {
    /// Stand still.
    #[must_use]
    pub fn zero(robot: usize) -> Self {
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
pub struct Silence {
    /// Which
    pub peer: String,
    /// For how long, in s
    pub for_s: f64,
}

/// A way to tell robots what to do.
pub trait CommandSink: Send {
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

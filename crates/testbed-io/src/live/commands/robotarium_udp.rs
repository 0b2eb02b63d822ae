//! Robotarium robots as they were in 2018: JSON over UDP, no answer that means anything.

use std::net::SocketAddr;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use unicycle_cbf::Speeds;

use super::udp::UdpRobots;
use super::{Command, CommandCounts, CommandSink, Silence};
use crate::Error;

/// Which robots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotariumUdpSpec {
    /// Address and port of each robot, from the front; robots listen on port 4998
    pub addresses: Vec<SocketAddr>,
    /// Port of this computer that robots answer to
    #[serde(default = "default_reply_port")]
    pub reply_port: u16,
}

fn default_reply_port() -> u16 {
    4999
}

/// The robots.
#[derive(Debug)]
pub(in crate::live) struct RobotariumUdp {
    robots: UdpRobots,
}

impl RobotariumUdp {
    /// # Errors
    ///
    /// A port that cannot be opened.
    pub(in crate::live) fn open(spec: &RobotariumUdpSpec) -> Result<Self, Error> {
        let robots = UdpRobots::bind(&spec.addresses, spec.reply_port)?;
        Ok(Self { robots })
    }
}

#[derive(Serialize)]
struct Velocity {
    #[serde(rename = "msgType")]
    kind: u8,
    v: f64,
    w: f64,
}

/// Velocity messages are of type 3 and end with a NUL.
fn message(speeds: Speeds) -> Vec<u8> {
    let velocity = Velocity {
        kind: 3,
        v: speeds.speed_mps,
        w: speeds.turn_rate_rad_s,
    };
    let mut message = serde_json::to_vec(&velocity).unwrap_or_default();
    message.push(0);
    message
}

impl CommandSink for RobotariumUdp {
    fn send(&mut self, commands: &[Command]) {
        self.robots.take_answers(|_| true);
        for command in commands {
            self.robots.send(command.robot, &message(command.speeds));
        }
    }

    fn stop(&mut self, _patience: Duration) -> Vec<usize> {
        // Nothing says that zeros arrived.
        let zero = message(Speeds::ZERO);
        self.robots.repeat(&zero)
    }

    fn silence(&self) -> Option<Silence> {
        None
    }

    fn counts(&self) -> CommandCounts {
        self.robots.counts()
    }
}

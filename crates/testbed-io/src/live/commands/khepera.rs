//! Khepera III: text over UDP, wheel speeds in counts, an answer to every request.
//!
//! The robot stops its motors by itself after 2 s without a request.

use std::net::SocketAddr;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use unicycle_cbf::WheelSpeeds;

use super::udp::UdpRobots;
use super::{Command, CommandCounts, CommandSink, Silence};
use crate::Error;

/// Speeds beyond this number of counts are clipped.
const MOST_COUNTS: f64 = 48_000.0;
/// Answers to zeros after which a robot certainly stands.
const CERTAIN: u64 = 3;

/// Which robots, and the unit of their speeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KheperaSpec {
    /// Address and port of each robot, from the front; the robot's default port is 4555
    pub addresses: Vec<SocketAddr>,
    /// Speed of a wheel at one count, in m/s; it depends on the firmware: 6.2953e-6, 1/144010 or 1/218720
    #[serde(default = "default_unit")]
    pub count_mps: f64,
}

fn default_unit() -> f64 {
    6.2953e-6
}

/// The robots.
#[derive(Debug)]
pub(in crate::live) struct Khepera {
    robots: UdpRobots,
    count_mps: f64,
}

/// What a robot answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KheperaReply {
    /// To the first request
    Init,
    /// To wheel speeds, as documented (`RES,CTRL`) and as some firmware sends it (`CTRL,RES`)
    Control,
}

impl KheperaReply {
    /// Reads an answer; others than these are none.
    #[must_use]
    pub fn parse(packet: &[u8]) -> Option<Self> {
        let text = str::from_utf8(packet).ok()?;
        match text.trim_end_matches(['\0', '\r', '\n', ' ']) {
            "$K3DRV,RES,INIT" => Some(Self::Init),
            "$K3DRV,RES,CTRL" | "$K3DRV,CTRL,RES" => Some(Self::Control),
            _ => None,
        }
    }
}

impl Khepera {
    /// Waits until every robot has answered.
    ///
    /// # Errors
    ///
    /// A speed unit that is not positive, or a robot that does not answer within 2 s.
    pub(in crate::live) fn open(spec: &KheperaSpec) -> Result<Self, Error> {
        if !(spec.count_mps.is_finite() && spec.count_mps > 0.0) {
            return Err(Error::Link {
                peer: "khepera".to_owned(),
                problem: format!("`count_mps` is {}", spec.count_mps),
                help: "give the speed of a wheel at one count, in m/s".to_owned(),
            });
        }
        let mut robots = UdpRobots::bind(&spec.addresses, 0)?;
        let is_init = |packet: &[u8]| KheperaReply::parse(packet) == Some(KheperaReply::Init);
        let missing = robots.insist(b"$K3DRV,REQ,INIT", is_init, 1, Duration::from_secs(2));
        if let Some(robot) = missing.first() {
            // The others may still do what somebody told them before.
            let zero = request(WheelSpeeds::default(), spec.count_mps);
            robots.insist(zero.as_bytes(), is_control, 0, Duration::ZERO);
            return Err(Error::Link {
                peer: format!("Khepera at {}", spec.addresses[*robot]),
                problem: "no answer to the first request".to_owned(),
                help: "is it switched on, is its UDP driver running, is the address right?"
                    .to_owned(),
            });
        }
        Ok(Self {
            robots,
            count_mps: spec.count_mps,
        })
    }
}

/// The right wheel comes first.
fn request(wheels: WheelSpeeds, count_mps: f64) -> String {
    let counts = |speed_mps: f64| {
        let counts = speed_mps / count_mps;
        counts.round().clamp(-MOST_COUNTS, MOST_COUNTS) as i64
    };
    let (right, left) = (counts(wheels.right_mps), counts(wheels.left_mps));
    format!("$K3DRV,REQ,CTRL,{right},{left}")
}

fn is_control(packet: &[u8]) -> bool {
    KheperaReply::parse(packet) == Some(KheperaReply::Control)
}

impl CommandSink for Khepera {
    fn send(&mut self, commands: &[Command]) {
        self.robots.take_answers(is_control);
        for command in commands {
            let request = request(command.wheels, self.count_mps);
            self.robots.send(command.robot, request.as_bytes());
        }
    }

    fn stop(&mut self, patience: Duration) -> Vec<usize> {
        let request = request(WheelSpeeds::default(), self.count_mps);
        let robots = &mut self.robots;
        robots.insist(request.as_bytes(), is_control, CERTAIN, patience)
    }

    fn silence(&self) -> Option<Silence> {
        self.robots.silence()
    }

    fn counts(&self) -> CommandCounts {
        self.robots.counts()
    }
}

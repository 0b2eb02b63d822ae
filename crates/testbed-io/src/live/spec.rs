//! What a link's file says: who the robots are, where poses come from and where commands go.

use std::collections::HashSet;
use std::net::SocketAddr;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::commands::{KheperaSpec, RobotariumUdpSpec};
use super::gate::Arena;
use super::natnet::NatNetSpec;
use super::poses::{JsonUdpSpec, Pace, ProgramSpec, RecordingSpec};
use super::robotarium::RobotariumSpec;
use crate::Error;

/// Older poses cannot be driven with, in s.
const LONGEST_LATENCY_S: f64 = 1.0;

/// A testbed as a file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkSpec {
    /// How the tracker calls the robots, from the front
    pub robots: Vec<u32>,
    /// The session ends when no pose or no answer has come for this long, in s
    #[serde(default = "default_lost_after_s")]
    pub lost_after_s: f64,
    /// Where robots can be; poses elsewhere are dropped. Without it, 0.5 m around the lane
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arena: Option<Arena>,
    /// Where poses come from
    pub poses: PosesSpec,
    /// Where commands go
    pub commands: CommandsSpec,
}

fn default_lost_after_s() -> f64 {
    5.0
}

/// A tracker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PosesSpec {
    /// OptiTrack
    Natnet(NatNetSpec),
    /// The Robotarium's tracker, over MQTT
    Robotarium(RobotariumSpec),
    /// JSON lines in datagrams
    JsonUdp(JsonUdpSpec),
    /// JSON lines of a program
    Program(ProgramSpec),
    /// A run log
    Recording(RecordingSpec),
}

/// Robots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum CommandsSpec {
    /// Khepera III, over UDP
    Khepera(KheperaSpec),
    /// The Robotarium's robots, over the broker of the poses
    Robotarium,
    /// The Robotarium's robots of 2018, over UDP
    RobotariumUdp(RobotariumUdpSpec),
    /// JSON lines in datagrams
    JsonUdp(JsonCommandsSpec),
    /// JSON lines to the program that gives the poses
    Program,
    /// Nobody
    None,
}

/// Who gets the commands of all robots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JsonCommandsSpec {
    /// Address and port
    pub address: SocketAddr,
}

impl LinkSpec {
    /// # Errors
    ///
    /// Another number of robots than the scenario has, repeated ids, a time that is not one, or commands that the poses' kind does
    /// not go with.
    pub(super) fn check(&self, robots: usize) -> Result<(), Error> {
        let wrong = |problem: String, help: &str| Error::Link {
            peer: "settings of the link".to_owned(),
            problem,
            help: help.to_owned(),
        };
        if self.robots.len() != robots {
            return Err(wrong(
                format!(
                    "`robots` names {} and the scenario has {robots}",
                    self.robots.len()
                ),
                "name the ids of all robots, from the front",
            ));
        }
        let mut ids = self.robots.clone();
        ids.sort_unstable();
        if let Some([id, _]) = ids.array_windows().find(|[a, b]| a == b) {
            return Err(wrong(
                format!("robot {id} is named twice"),
                "each robot has an id of its own",
            ));
        }
        if !(0.5..=3600.0).contains(&self.lost_after_s) {
            return Err(wrong(
                format!("`lost_after_s` is {}", self.lost_after_s),
                "give 0.5 to 3600 s",
            ));
        }
        if !(0.0..=LONGEST_LATENCY_S).contains(&self.latency_s()) {
            return Err(wrong(
                format!("`latency_s` is {}", self.latency_s()),
                "give 0 to 1 s",
            ));
        }
        let addresses = match &self.commands {
            CommandsSpec::Khepera(spec) => Some(&spec.addresses),
            CommandsSpec::RobotariumUdp(spec) => Some(&spec.addresses),
            _ => None,
        };
        if let Some(addresses) = addresses {
            let different: HashSet<&SocketAddr> = addresses.iter().collect();
            let ipv4 = addresses.iter().filter(|address| address.is_ipv4()).count();
            if different.len() != robots || addresses.len() != robots {
                return Err(wrong(
                    format!("{} addresses for {robots} robots", different.len()),
                    "name the address of each robot once, from the front",
                ));
            }
            if ipv4 != 0 && ipv4 != robots {
                return Err(wrong(
                    "addresses of IPv4 and of IPv6".to_owned(),
                    "give all robots addresses of one kind",
                ));
            }
        }
        match (&self.commands, &self.poses) {
            (CommandsSpec::Robotarium, PosesSpec::Robotarium(_))
            | (CommandsSpec::Program, PosesSpec::Program(_)) => Ok(()),
            (CommandsSpec::Robotarium | CommandsSpec::Program, _) => Err(wrong(
                "commands go to the broker or program that gives the poses, and these come from elsewhere".to_owned(),
                "give `poses` and `commands` the same kind",
            )),
            _ => Ok(()),
        }
    }

    /// Stated latency of poses, in s.
    pub(super) fn latency_s(&self) -> f64 {
        match &self.poses {
            PosesSpec::Natnet(spec) => spec.latency_s,
            PosesSpec::Robotarium(spec) => spec.latency_s,
            PosesSpec::JsonUdp(spec) => spec.latency_s,
            PosesSpec::Program(spec) => spec.latency_s,
            PosesSpec::Recording(_) => 0.0,
        }
    }

    /// The run log whose poses come once more.
    #[must_use]
    pub fn recording(&self) -> Option<&Path> {
        match &self.poses {
            PosesSpec::Recording(spec) => Some(&spec.file),
            _ => None,
        }
    }

    /// Whether commands go to standard output.
    #[must_use]
    pub fn writes_to_stdout(&self) -> bool {
        matches!(&self.poses, PosesSpec::Program(spec) if spec.command.is_empty())
            && self.commands == CommandsSpec::Program
    }

    /// Whether the robots that are seen hear the commands.
    pub(crate) fn is_told(&self) -> bool {
        self.commands != CommandsSpec::None && !matches!(self.poses, PosesSpec::Recording(_))
    }

    pub(super) fn is_fast(&self) -> bool {
        matches!(&self.poses, PosesSpec::Recording(spec) if spec.pace == Pace::Fast)
    }
}

//! Which server, in the settings of a link.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use serde::{Deserialize, Serialize};

use super::axes::Up;
use crate::Error;

/// Which server, and how it streams.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NatNetSpec {
    /// Address of the server
    pub server: IpAddr,
    /// UDP port of the server for commands
    #[serde(default = "command_port")]
    pub command_port: u16,
    /// UDP port for frames: of the group, or in unicast of this machine
    #[serde(default = "data_port")]
    pub data_port: u16,
    /// How the server sends frames
    #[serde(default)]
    pub transport: Transport,
    /// The group of multicast frames
    #[serde(default = "group")]
    pub group: Ipv4Addr,
    /// Address of this machine in the server's network; any if it has only one network
    #[serde(default = "any")]
    pub local: IpAddr,
    /// Which axis of the server points up
    #[serde(default)]
    pub up: Up,
    /// How old a pose is when its frame is sent, beyond what the server says of it, in s
    #[serde(default)]
    pub latency_s: f64,
}

/// How a server sends frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transport {
    /// To a group, as servers are delivered
    #[default]
    Multicast,
    /// To each client that connects
    Unicast,
}

fn command_port() -> u16 {
    1510
}

fn data_port() -> u16 {
    1511
}

fn group() -> Ipv4Addr {
    Ipv4Addr::new(239, 255, 42, 99)
}

fn any() -> IpAddr {
    Ipv4Addr::UNSPECIFIED.into()
}

impl NatNetSpec {
    /// A server with everything else as it is delivered.
    #[must_use]
    pub fn new(server: IpAddr) -> Self {
        Self {
            server,
            command_port: command_port(),
            data_port: data_port(),
            transport: Transport::default(),
            group: group(),
            local: any(),
            up: Up::default(),
            latency_s: 0.0,
        }
    }

    /// Where commands go.
    pub(super) fn command_address(&self) -> SocketAddr {
        SocketAddr::new(self.server, self.command_port)
    }

    pub(super) fn error(&self, problem: impl Into<String>, help: impl Into<String>) -> Error {
        Error::Link {
            peer: format!("NatNet server {}", self.server),
            problem: problem.into(),
            help: help.into(),
        }
    }
}

//! The Robotarium: poses and commands over an MQTT broker.
//!
//! A robot goes on with its last command for ever. Every robot therefore has a connection of its own, for its commands and for
//! a last will that stops it: the broker sends the will when the connection ends in any way but the proper one, and after
//! everything that the connection brought before.

mod commands;
mod login;
mod messages;
mod mqtt;
mod poses;
mod problem;
mod status;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use login::Password;
pub use messages::{
    LARGEST_MESSAGE, Malformed, NotFinite, TrackedPose, decode_command, decode_poses,
    encode_command, encode_poses,
};
pub use mqtt::{Robotarium, connect};

use crate::Error;

/// Where the broker is and what it calls things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotariumSpec {
    /// Name or address of the broker
    pub broker: String,
    /// Its port; older trackers use 1883
    pub port: u16,
    /// Who we are, at a broker that asks
    #[serde(skip_serializing_if = "Option::is_none")]
    pub user: Option<String>,
    /// The user's password; not written into run logs
    #[serde(skip_serializing)]
    pub password: Option<Password>,
    /// In its place a file with the password in its first line
    #[serde(skip_serializing_if = "Option::is_none")]
    pub password_file: Option<PathBuf>,
    /// Age of a pose on arrival, in s: poses carry no stamps, and camera, detection and network take this long
    pub latency_s: f64,
    /// Topic of the poses
    pub pose_topic: String,
    /// Topic of the commands, before `/` and the robot's id
    pub command_topic: String,
}

impl Default for RobotariumSpec {
    fn default() -> Self {
        Self {
            broker: "127.0.0.1".to_owned(),
            port: 1884,
            user: None,
            password: None,
            password_file: None,
            latency_s: 0.03,
            pose_topic: "overhead_tracker/all_robot_pose_data".to_owned(),
            command_topic: "matlab_api".to_owned(),
        }
    }
}

impl RobotariumSpec {
    fn error(&self, problem: String, help: &str) -> Error {
        Error::Link {
            peer: format!("{}:{}", self.broker, self.port),
            problem,
            help: help.to_owned(),
        }
    }
}

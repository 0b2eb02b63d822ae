//! The Robotarium: poses and commands over an MQTT broker.
//!
//! A robot goes on with its last command for ever. Every robot therefore has a connection of its own, for its commands and for
//! a last will that stops it: the broker sends the will when the connection ends in any way but the proper one, and after
//! everything that the connection brought before.

mod commands;
mod messages;
mod mqtt;
mod poses;
mod status;

use serde::{Deserialize, Serialize};

pub use messages::{
    LARGEST_MESSAGE, Malformed, NotFinite, TrackedPose, decode_command, decode_poses,
    encode_command, encode_poses,
};
pub use mqtt::{Robotarium, connect};

/// Where the broker is and what it calls things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotariumSpec {
    /// Name or address of the broker
    pub broker: String,
    /// Its port; older trackers use 1883
    pub port: u16,
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
            latency_s: 0.03,
            pose_topic: "overhead_tracker/all_robot_pose_data".to_owned(),
            command_topic: "matlab_api".to_owned(),
        }
    }
}

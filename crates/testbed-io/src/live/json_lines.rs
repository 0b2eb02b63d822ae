//! One JSON object per line, so that any program in any language can be the robots.
//!
//! ```text
//! to drivekit    {"robot": 1, "x": 0.25, "y": 0.0, "theta": 1.57, "t": 12.3}
//! from drivekit  {"robot": 1, "v": 0.1, "w": 0.4, "left": 0.078, "right": 0.122}
//! ```
//!
//! Before there are poses, `{"getting_ready": "why"}` keeps a session waiting that would give up after a minute.
//!
//! Metres, radians and seconds. `t` of poses is the sender's own clock and may be left out; `left` and `right` are speeds of the wheels.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Pose, Speeds, WheelSpeeds};

use super::commands::Command;
use super::seen::Seen;

/// The longest line that is read, in bytes.
pub(super) const LONGEST: usize = 4096;

/// A pose as a line. Other keys are ignored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PoseLine {
    /// How the link calls the robot
    pub robot: u32,
    /// In m
    pub x: f64,
    /// In m
    pub y: f64,
    /// Counter-clockwise from the x axis, in rad
    pub theta: f64,
    /// When it was there, on the sender's clock, in s
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
}

/// That robots are on their way to where they can start, as a line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct GettingReadyLine {
    /// What is being done, for the user
    pub getting_ready: String,
}

/// A command as a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CommandLine {
    /// How the link calls the robot
    pub robot: u32,
    /// Speed, in m/s
    pub v: f64,
    /// Turn rate, in rad/s
    pub w: f64,
    /// Speed of the left wheel, in m/s
    pub left: f64,
    /// Speed of the right wheel, in m/s
    pub right: f64,
}

impl PoseLine {
    pub(super) fn new(id: u32, pose: &Pose) -> Self {
        Self {
            robot: id,
            x: pose.x_m,
            y: pose.y_m,
            theta: pose.heading_rad,
            t: None,
        }
    }

    /// Reads a line; `None` if it is not one.
    #[must_use]
    pub fn parse(line: &[u8]) -> Option<Self> {
        if line.len() > LONGEST {
            return None;
        }
        serde_json::from_slice(line).ok()
    }

    pub(super) fn seen(&self, latency_s: f64) -> Seen {
        Seen {
            id: self.robot,
            pose: Pose {
                x_m: self.x,
                y_m: self.y,
                heading_rad: self.theta,
            },
            stamp_s: self.t,
            age_s: latency_s,
        }
    }
}

impl GettingReadyLine {
    /// Reads a line; `None` if it is not one.
    #[must_use]
    pub fn parse(line: &[u8]) -> Option<Self> {
        if line.len() > LONGEST {
            return None;
        }
        serde_json::from_slice(line).ok()
    }
}

impl CommandLine {
    pub(super) fn new(id: u32, command: &Command) -> Self {
        let Speeds {
            speed_mps,
            turn_rate_rad_s,
        } = command.speeds;
        let WheelSpeeds {
            left_mps,
            right_mps,
        } = command.wheels;
        Self {
            robot: id,
            v: speed_mps,
            w: turn_rate_rad_s,
            left: left_mps,
            right: right_mps,
        }
    }

    /// Reads a line; `None` if it is not one.
    #[must_use]
    pub fn parse(line: &[u8]) -> Option<Self> {
        serde_json::from_slice(line).ok()
    }
}

/// All commands, each with a line break.
pub(super) fn lines(ids: &[u32], commands: &[Command]) -> Vec<u8> {
    let mut text = Vec::with_capacity(128 * commands.len());
    for command in commands {
        let Some(id) = ids.get(command.robot) else {
            continue;
        };
        // Writing numbers to memory cannot fail.
        let _ = serde_json::to_writer(&mut text, &CommandLine::new(*id, command));
        text.push(b'\n');
    }
    text
}

/// The lines of a packet that are not blank.
pub(super) fn lines_of(packet: &[u8]) -> impl DoubleEndedIterator<Item = &[u8]> {
    let lines = packet.split(|byte| *byte == b'\n');
    lines.filter(|line| !line.iter().all(u8::is_ascii_whitespace))
}

//! Messages of the Robotarium, in JSON.

use std::collections::HashSet;
use std::fmt;

use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use unicycle_cbf::{Pose, Speeds};

/// Longer messages are malformed, in bytes.
pub const LARGEST_MESSAGE: usize = 64 * 1024;
/// Robots in one message, at most.
const MOST_ROBOTS: usize = 1000;

/// A message that is not what the protocol says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("malformed: {0}")]
pub struct Malformed(String);

/// Speeds that are NaN or infinite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a command must be finite")]
pub struct NotFinite;

/// Where the tracker sees a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackedPose {
    /// Number of its tag
    pub id: u32,
    /// Where
    pub pose: Pose,
}

/// What the tracker says about one robot. It also says how its battery is, older trackers under other keys.
#[derive(Serialize, Deserialize)]
struct Entry {
    x: f64,
    y: f64,
    theta: f64,
}

#[derive(Serialize, Deserialize)]
struct Command {
    v: f64,
    w: f64,
}

/// The poses in a message of the tracker, also of an older one. Keys that are not known do not matter.
///
/// # Errors
///
/// The message is too long, no JSON, or names a robot twice, by no number, or without a pose.
pub fn decode_poses(message: &[u8]) -> Result<Vec<TrackedPose>, Malformed> {
    let poses: PosesIn = decode(message)?;
    Ok(poses.0)
}

/// A message of the tracker. It is malformed if a pose is not finite, which JSON cannot say.
#[must_use]
pub fn encode_poses(poses: &[TrackedPose]) -> String {
    serde_json::to_string(&PosesOut(poses)).unwrap_or_default()
}

/// A command to a robot, with the fewest digits that give the same numbers again.
///
/// # Errors
///
/// The speeds are NaN or infinite.
pub fn encode_command(speeds: Speeds) -> Result<String, NotFinite> {
    let command = Command {
        v: speeds.speed_mps,
        w: speeds.turn_rate_rad_s,
    };
    if !(command.v.is_finite() && command.w.is_finite()) {
        return Err(NotFinite);
    }
    serde_json::to_string(&command).map_err(|_| NotFinite)
}

/// What a robot is told. Keys that are not known do not matter.
///
/// # Errors
///
/// The message is too long, no JSON, or lacks a speed.
pub fn decode_command(message: &[u8]) -> Result<Speeds, Malformed> {
    let command: Command = decode(message)?;
    Ok(Speeds {
        speed_mps: command.v,
        turn_rate_rad_s: command.w,
    })
}

fn decode<'de, T: Deserialize<'de>>(message: &'de [u8]) -> Result<T, Malformed> {
    if message.len() > LARGEST_MESSAGE {
        let problem = format!("more than {LARGEST_MESSAGE} bytes");
        return Err(Malformed(problem));
    }
    serde_json::from_slice(message).map_err(|error| Malformed(error.to_string()))
}

struct PosesIn(Vec<TrackedPose>);

impl<'de> Deserialize<'de> for PosesIn {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(PosesVisitor)
    }
}

struct PosesVisitor;

impl<'de> Visitor<'de> for PosesVisitor {
    type Value = PosesIn;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("poses by robots")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PosesIn, A::Error> {
        let mut ids = HashSet::new();
        let mut poses = Vec::new();
        while let Some((id, entry)) = map.next_entry::<u32, Entry>()? {
            if !ids.insert(id) {
                return Err(A::Error::custom(format_args!("robot {id} twice")));
            }
            if poses.len() == MOST_ROBOTS {
                let problem = format_args!("more than {MOST_ROBOTS} robots");
                return Err(A::Error::custom(problem));
            }
            poses.push(entry.tracked(id));
        }
        Ok(PosesIn(poses))
    }
}

impl Entry {
    fn tracked(&self, id: u32) -> TrackedPose {
        TrackedPose {
            id,
            pose: Pose {
                x_m: self.x,
                y_m: self.y,
                heading_rad: self.theta,
            },
        }
    }
}

struct PosesOut<'a>(&'a [TrackedPose]);

impl Serialize for PosesOut<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|tracked| {
            let entry = Entry {
                x: tracked.pose.x_m,
                y: tracked.pose.y_m,
                theta: tracked.pose.heading_rad,
            };
            (tracked.id, entry)
        }))
    }
}

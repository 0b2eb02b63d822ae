//! The poses of a run log once more, at their times.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use unicycle_cbf::StampedPose;

use crate::error::Error;
use crate::live::inbox::Inbox;
use crate::live::seen::Seen;
use crate::log_file;

/// Which run log, and how fast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingSpec {
    /// A run log of `ctrl run`
    pub file: PathBuf,
    /// In real time or as fast as possible
    #[serde(default)]
    pub pace: Pace,
}

/// How time passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pace {
    /// As it did
    #[default]
    RealTime,
    /// Without waiting
    Fast,
}

/// A recording that is being played.
#[derive(Debug)]
pub(in crate::live) struct Recorded {
    poses: Vec<(f64, usize, StampedPose)>,
    next: usize,
}

impl Recorded {
    /// For a number of robots.
    pub(in crate::live) fn open(spec: &RecordingSpec, robots: usize) -> Result<Self, Error> {
        let log = log_file::read(&spec.file)?.run_log()?;
        let recording = log.scenario.robots.len();
        if recording != robots {
            return Err(Error::RobotCount {
                scenario: robots,
                recording,
            });
        }
        let rows = log.rows.iter();
        let seen = rows.filter_map(|row| Some((row.time_s, row.robot, row.seen?)));
        Ok(Self {
            poses: seen.collect(),
            next: 0,
        })
    }

    /// Hands over what had arrived by `time_s` after the start, which was at `start_s` on the inbox's clock.
    pub(in crate::live) fn play(&mut self, time_s: f64, start_s: f64, ids: &[u32], inbox: &Inbox) {
        let due = self.poses.iter().skip(self.next);
        for (arrival_s, robot, seen) in due.take_while(|(arrival_s, ..)| *arrival_s <= time_s) {
            self.next += 1;
            let Some(id) = ids.get(*robot) else { continue };
            inbox.packet();
            let seen = Seen {
                id: *id,
                pose: seen.pose,
                stamp_s: None,
                age_s: arrival_s - seen.stamp_s,
            };
            inbox.pose(start_s + arrival_s, seen);
        }
    }

    /// Time at which every robot had been seen, or the end.
    pub(in crate::live) fn all_seen_s(&self, robots: usize) -> f64 {
        let first_s = |robot: usize| {
            let mut own = self.poses.iter().filter(|(_, of, _)| *of == robot);
            own.next()
                .map_or(f64::INFINITY, |(arrival_s, ..)| *arrival_s)
        };
        (0..robots).map(first_s).fold(0.0, f64::max)
    }

    pub(in crate::live) fn has_ended(&self) -> bool {
        self.next >= self.poses.len()
    }
}

//! What a session reports, while it goes on and when it is over.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Serialize, Serializer};
use testbed_sim::Tick;

use super::commands::CommandCounts;
use super::counts::Counts;
use super::note::{Loss, Note};
use super::pacer::Deadlines;

/// Ends a session from another thread: a signal, a button.
#[derive(Debug, Clone, Default)]
pub struct StopSwitch(Arc<AtomicBool>);

impl StopSwitch {
    /// The robots stop within a period.
    pub fn stop(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// What signal handlers set.
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }

    /// Whether someone has.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// What happens in a session, as it happens.
#[derive(Debug, Clone, Copy)]
pub enum Update<'a> {
    /// Something to know
    Note(&'a Note),
    /// A step of all robots, from the back, after its commands were sent
    Step {
        /// One per robot
        ticks: &'a [Tick],
        /// Of the newest pose of each robot from the front, in s
        pose_ages_s: &'a [f64],
        /// Packets and poses so far
        counts: &'a Counts,
        /// Deadlines missed so far
        missed: u64,
    },
}

/// Why a session ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The scenario was over
    Finished,
    /// Asked to, by a signal or a button
    Stopped,
    /// The tracker or a robot was silent for too long
    Lost(Loss),
}

/// A session that is over; the robots stand, but for those named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LiveReport {
    /// Why it ended
    pub ending: Ending,
    /// Robots by their ids that may not have got the command to stand
    pub untold: Vec<u32>,
    /// How punctual the loop was
    pub deadlines: Deadlines,
    /// Packets and poses
    pub received: Counts,
    /// Commands
    pub commands: CommandCounts,
    /// All robots by their ids, from the front
    pub robots: Vec<u32>,
    /// Seconds of each without a usable pose, those over 0.3 s at a time
    pub unseen_s: Vec<f64>,
    /// The longest of them at one time, for each robot
    pub longest_unseen_s: Vec<f64>,
    /// Whether no robot can have left its lane or touched another one unseen, by what they were told
    pub seen_enough: bool,
    /// Why it is not known whether the session was safe, unless it was unsafe: too little was seen, or robots may still move
    pub doubts: Vec<String>,
}

impl Serialize for Loss {
    /// In words.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

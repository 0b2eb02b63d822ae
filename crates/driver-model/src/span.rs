use std::ops::Range;

use drive_log::DriveLog;
use serde::{Deserialize, Serialize};
use tseg::Segmentation;

use crate::segmentation::lead;

/// What the driver does during a stretch of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PhaseKind {
    /// Speeding up.
    Acceleration,
    /// Slowing down.
    Braking,
    /// Holding a speed.
    Cruise,
    /// Anything else, standstill included.
    Other,
}

impl PhaseKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Acceleration, Self::Braking, Self::Cruise, Self::Other];

    /// As written in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Acceleration => "acceleration",
            Self::Braking => "braking",
            Self::Cruise => "cruise",
            Self::Other => "other",
        }
    }
}

/// Samples `start..end` of a log with what happens there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// What the driver does.
    pub kind: PhaseKind,
    /// A vehicle ahead is near enough to matter, see [`crate::segmentation::lead_influenced`].
    pub lead_influenced: bool,
}

impl Span {
    pub(crate) fn of(log: &DriveLog, range: Range<usize>, kind: PhaseKind) -> Self {
        Self {
            kind,
            lead_influenced: lead::lead_influenced(log, range.clone()),
            start: range.start,
            end: range.end,
        }
    }
}

/// The acceleration among `phases` that a finer segmentation of the same log cuts into most segments, the first of equals.
#[must_use]
pub fn most_divided<'a>(phases: &'a [Span], finer: &Segmentation) -> Option<&'a Span> {
    let boundaries = finer.boundaries();
    let inside = |phase: &Span| {
        let upto = |sample| boundaries.partition_point(|&b| b < sample);
        upto(phase.end) - upto(phase.start)
    };
    let accelerations = phases.iter().filter(|p| p.kind == PhaseKind::Acceleration);
    accelerations.rev().max_by_key(|phase| inside(phase))
}

//! What arrived, and why some of it was not used.

use std::collections::BTreeMap;

use serde::Serialize;
use strum::{IntoStaticStr, VariantArray};

/// Why a packet or a pose was dropped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
pub enum Dropped {
    /// From an address other than the configured one
    #[strum(to_string = "from another address")]
    Stranger,
    /// Not what the protocol says, or cut
    #[strum(to_string = "malformed")]
    Malformed,
    /// A number that is NaN or infinite
    #[strum(to_string = "not a number")]
    NotFinite,
    /// Outside the arena
    #[strum(to_string = "outside the arena")]
    Outside,
    /// Farther from the last pose than the robot can have moved
    #[strum(to_string = "jumps")]
    Jump,
    /// Where another robot is
    #[strum(to_string = "where another robot is")]
    Overlapping,
    /// The tracker says that it does not see the body
    #[strum(to_string = "untracked")]
    Untracked,
    /// Of a robot that does not take part
    #[strum(to_string = "of other robots")]
    OtherRobot,
    /// Not newer than the last: late, repeated, or out of order
    #[strum(to_string = "late or repeated")]
    Old,
    /// A stamp that contradicts the time of arrival
    #[strum(to_string = "impossible stamps")]
    Stamp,
}

impl Dropped {
    /// For people.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Numbers of packets and poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Packets of the tracker
    pub packets: u64,
    /// Poses that were used
    pub poses: u64,
    /// Dropped packets: from another address
    pub stranger: u64,
    /// Dropped packets: malformed or cut
    pub malformed: u64,
    /// Dropped poses: NaN or infinite
    pub not_finite: u64,
    /// Dropped poses: outside the arena
    pub outside: u64,
    /// Dropped poses: farther away than the robot can have moved
    pub jump: u64,
    /// Dropped poses: where another robot is
    pub overlapping: u64,
    /// Dropped poses: the tracker does not see the body
    pub untracked: u64,
    /// Dropped poses: of robots that do not take part
    pub other_robot: u64,
    /// Dropped poses: late, repeated, or out of order
    pub old: u64,
    /// Dropped poses: the stamp contradicts the time of arrival
    pub stamp: u64,
    /// Times that the tracker's clock was found to have jumped
    pub clock_jumps: u64,
}

impl Counts {
    /// Counts one.
    pub fn add(&mut self, reason: Dropped) {
        *self.count_of(reason) += 1;
    }

    /// How many were dropped, by reason; those that never occurred are left out.
    #[must_use]
    pub fn dropped(mut self) -> BTreeMap<&'static str, u64> {
        let reasons = Dropped::VARIANTS.iter();
        let counted = reasons.map(|reason| (reason.name(), *self.count_of(*reason)));
        counted.filter(|(_, count)| *count > 0).collect()
    }

    /// For messages.
    pub(super) fn text(&self) -> String {
        let dropped = self.dropped().into_iter();
        let dropped: String = dropped
            .map(|(reason, count)| format!(", {count} {reason}"))
            .collect();
        format!(
            "{} packets, {} poses used{dropped}",
            self.packets, self.poses
        )
    }

    fn count_of(&mut self, reason: Dropped) -> &mut u64 {
        match reason {
            Dropped::Stranger => &mut self.stranger,
            Dropped::Malformed => &mut self.malformed,
            Dropped::NotFinite => &mut self.not_finite,
            Dropped::Outside => &mut self.outside,
            Dropped::Jump => &mut self.jump,
            Dropped::Overlapping => &mut self.overlapping,
            Dropped::Untracked => &mut self.untracked,
            Dropped::OtherRobot => &mut self.other_robot,
            Dropped::Old => &mut self.old,
            Dropped::Stamp => &mut self.stamp,
        }
    }
}

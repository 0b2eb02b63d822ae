//! How far a phase reaches: to the threshold that finds it, or to where the car stops gaining or losing speed.

use drive_log::DriveLog;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use super::{HeuristicRules, lead};
use crate::grid::at_least;
use crate::{PhaseKind, Span};

/// What counts as one phase.
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    Serialize,
    Deserialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "lowercase")]
#[strum(serialize_all = "lowercase")]
pub enum PhaseExtent {
    /// As far as the acceleration reaches the threshold by which phases are found.
    #[default]
    Threshold,
    /// From where the car begins to gain or lose speed to where it no longer does.
    Whole,
}

impl PhaseExtent {
    /// Of the phases that a model is about, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Threshold => "cut at the threshold",
            Self::Whole => "from begin to end",
        }
    }
}

impl HeuristicRules {
    /// Acceleration and braking phases from where they begin to where they end.
    ///
    /// Each of `phases` grows to either side while the acceleration keeps its sign and at least
    /// [`HeuristicRules::end_accel_mps2`]; a car that stands has none, so that standstill ends a phase. Phases of one kind that meet
    /// are one. A whole phase has every such step with both its ends, one sample more than the steps, so that the same drive backwards
    /// has the same phases. A leader influences it where it influences one of `phases` in it, or the whole.
    ///
    /// `phases` are in the order of time, as [`HeuristicRules::segment`] gives them; those of other kinds are left out.
    #[must_use]
    pub fn whole_phases(&self, log: &DriveLog, phases: &[Span]) -> Vec<Span> {
        let mut whole: Vec<Span> = Vec::new();
        for phase in phases {
            let Some(mut grown) = self.grown(log, phase) else {
                continue;
            };
            let before = whole.iter_mut().rev().find(|w| w.kind == grown.kind);
            match before.filter(|before| grown.start < before.end) {
                Some(before) => {
                    before.end = before.end.max(grown.end);
                    before.lead_influenced |= grown.lead_influenced;
                }
                None => {
                    grown.lead_influenced |= lead::lead_influenced(log, grown.start..grown.end);
                    whole.push(grown);
                }
            }
        }
        whole
    }

    /// `None` for what neither accelerates nor brakes, and outside of the log.
    fn grown(&self, log: &DriveLog, phase: &Span) -> Option<Span> {
        let sign = match phase.kind {
            PhaseKind::Acceleration => 1.0,
            PhaseKind::Braking => -1.0,
            PhaseKind::Cruise | PhaseKind::Other => return None,
        };
        let speed_mps = log.speed_mps();
        let last = speed_mps.len().checked_sub(1)?;
        // Step k leads from sample k to sample k + 1.
        let goes_on = |step: usize| {
            let accel_mps2 = (speed_mps[step + 1] - speed_mps[step]) / log.step_s();
            at_least(sign * accel_mps2, self.end_accel_mps2)
        };
        let (mut start, mut end) = (phase.start, phase.end.checked_sub(1)?);
        if start > end || end > last {
            return None;
        }
        while start > 0 && goes_on(start - 1) {
            start -= 1;
        }
        while end < last && goes_on(end) {
            end += 1;
        }
        Some(Span {
            start,
            end: end + 1,
            ..*phase
        })
    }
}

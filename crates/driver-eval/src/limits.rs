//! How drives know their speed limits: what was filled is said.

use driver_model::{LimitCover, Motion};
use serde::Serialize;

use crate::words::{listed, plural};

/// Speed limits over all drives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitsKnown {
    /// Drives with limits that are used.
    pub drives: usize,
    /// Share of their time with a recorded limit.
    pub known_pct: f64,
    /// Drives among them with gaps.
    pub filled_drives: usize,
    /// Time over which the limit before was held.
    pub held_s: f64,
    /// Time at the start that got the first limit.
    pub back_filled_s: f64,
    /// Drives with limits for less than half of the time, which are not used.
    pub not_used: Vec<String>,
}

impl LimitsKnown {
    /// `None` where no drive has limits.
    #[must_use]
    pub fn of(motions: &[Motion]) -> Option<Self> {
        let covers = motions.iter().filter_map(|m| Some((m, m.limit_cover()?)));
        let (used, unused): (Vec<_>, Vec<_>) = covers.partition(|(_, cover)| cover.is_enough());
        if used.is_empty() && unused.is_empty() {
            return None;
        }
        let sum = |of: fn(&LimitCover) -> f64| used.iter().map(|(_, c)| of(c)).sum();
        let (all_s, known_s): (f64, f64) = (sum(LimitCover::duration_s), sum(|c| c.known_s));
        Some(Self {
            drives: used.len(),
            known_pct: if all_s > 0.0 {
                100.0 * known_s / all_s
            } else {
                0.0
            },
            filled_drives: used.iter().filter(|(_, c)| c.filled_s() > 0.0).count(),
            held_s: sum(|c| c.held_s),
            back_filled_s: sum(|c| c.back_filled_s),
            not_used: unused.iter().map(|(m, _)| m.name().to_owned()).collect(),
        })
    }

    /// What was filled and what is not used; `None` where every used drive knows its limit throughout.
    #[must_use]
    pub fn in_words(&self) -> Option<String> {
        let mut parts = Vec::new();
        if self.filled_drives > 0 {
            parts.push(format!(
                "speed limits of {} of {} have gaps: {:.1} % of the time is recorded, {:.0} s hold the limit before, {:.0} s at the start have the first one",
                self.filled_drives,
                plural(self.drives, "drive"),
                self.known_pct,
                self.held_s,
                self.back_filled_s,
            ));
        }
        if !self.not_used.is_empty() {
            let names: Vec<&str> = self.not_used.iter().map(String::as_str).collect();
            parts.push(format!(
                "speed limits for less than half of the time are not used: {}",
                listed(&names)
            ));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

//! A recording while it is checked.

use std::ops::Range;

use super::quantised::Rounding;
use crate::{Action, Channel, Finding, FindingKind, RawLog};

/// A recording without what was found wrong with it.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Checked {
    /// The recording: time strictly increasing, values that cannot be true set to missing.
    pub log: RawLog,
    /// What was found and what was done, in the order of time.
    pub findings: Vec<Finding>,
    /// Samples before which the recording is not continuous, though there is no gap.
    pub(crate) cuts: Vec<usize>,
    /// How the speed was rounded, if it was.
    pub(crate) rounding: Option<Rounding>,
}

impl Checked {
    /// Reports a finding about the samples of `range`.
    pub(super) fn report(
        &mut self,
        kind: FindingKind,
        channel: Channel,
        range: &Range<usize>,
        action: Action,
        detail: String,
    ) {
        let time_s = self.log.time_s();
        let span_s = (
            time_s[range.start],
            time_s[range.end.max(range.start + 1) - 1],
        );
        self.findings
            .push(Finding::of_channel(kind, channel, span_s, action, detail));
    }

    /// Reports a finding about all samples.
    pub(super) fn report_all(
        &mut self,
        kind: FindingKind,
        channel: Channel,
        action: Action,
        detail: String,
    ) {
        self.report(kind, channel, &(0..self.log.len()), action, detail);
    }

    /// Sets the samples of `range` to missing.
    pub(super) fn remove(&mut self, channel: Channel, range: Range<usize>) {
        if let Some(values) = self.log.channels.get_mut(&channel) {
            values[range].fill(f64::NAN);
        }
    }

    pub(super) fn values(&self, channel: Channel) -> Option<&[f64]> {
        self.log.channel(channel)
    }

    /// Time between the first and the last sample of `range`, s.
    pub(super) fn duration_s(&self, range: &Range<usize>) -> f64 {
        let time_s = self.log.time_s();
        time_s[range.end - 1] - time_s[range.start]
    }

    /// Distance driven up to each sample, m. A speed counts until the next, for 2 s at most.
    pub(super) fn distance_m(&self) -> Vec<f64> {
        let (time_s, speed_mps) = (self.log.time_s(), self.log.speed_mps());
        let mut distance_m = vec![0.0; time_s.len()];
        let (mut known, mut known_m) = (0, 0.0);
        for i in 1..time_s.len() {
            if speed_mps[i - 1].is_finite() {
                (known, known_m) = (i - 1, distance_m[i - 1]);
            }
            let step_m = speed_mps[known].abs() * (time_s[i] - time_s[known]).min(2.0);
            distance_m[i] = if step_m.is_finite() {
                known_m + step_m
            } else {
                known_m
            };
        }
        distance_m
    }
}

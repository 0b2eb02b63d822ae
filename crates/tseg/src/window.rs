use std::collections::VecDeque;

use crate::cost::Cost;
use crate::merger::Merger;
use crate::series::Series;

/// A part `start..end` of a series with its bottom-up segmentation, kept up to date as samples leave on the left and
/// come in on the right.
///
/// Bottom-up is a greedy choice among independent candidates, so a part of the samples that ends on boundaries of the
/// result has, on its own, the same merges in the same order. Hence emitting a segment changes nothing. Conversely,
/// parts segmented on their own are together the result for the whole if bottom-up on the two segments beside each
/// boundary between neighbouring parts keeps that boundary. Hence two parts are joined by segmenting together as many of
/// the segments beside their joint as it takes until, on either side, a boundary survives: what is beyond it stays.
#[derive(Debug, Clone)]
pub(crate) struct Window {
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// Ends of the segments, the last of them `end`.
    pub(crate) ends: VecDeque<usize>,
    merger: Merger,
    /// Segment ends of new samples on their own.
    fresh: Vec<usize>,
}

/// More new samples than this are segmented on their own first, then joined.
const LONG: usize = 256;

impl Window {
    pub(crate) fn new(cost: Cost, threshold: f64) -> Self {
        Self {
            start: 0,
            end: 0,
            ends: VecDeque::new(),
            merger: Merger::new(cost, threshold),
            fresh: Vec::new(),
        }
    }

    /// Removes the leftmost segment and returns its end.
    pub(crate) fn pop_front(&mut self) -> Option<usize> {
        let end = self.ends.pop_front()?;
        self.start = end;
        Some(end)
    }

    /// Counts samples from `count` on.
    pub(crate) fn drop_front(&mut self, count: usize) {
        self.start -= count;
        self.end -= count;
        for end in &mut self.ends {
            *end -= count;
        }
    }

    /// Takes in the samples up to `end`, more than so far; returns how many had to be segmented together.
    pub(crate) fn extend(&mut self, series: &Series, end: usize) -> usize {
        self.fresh.clear();
        if end - self.end > LONG {
            self.merger.run(series, self.end..end);
            self.fresh.extend(self.merger.ends());
        } else {
            self.fresh.push(end);
        }
        // The last segment ended where the window did, seldom where it should; the one before is the witness.
        let mut left = self.ends.len().saturating_sub(2);
        let mut right = 1.min(self.fresh.len() - 1);
        loop {
            let (from, to) = (self.start_of(left), self.fresh[right]);
            self.merger.run(series, from..to);
            let left_holds = left == 0 || self.merger.first_end() == self.ends[left];
            let right_holds =
                right + 1 == self.fresh.len() || self.merger.last_start() == self.fresh[right - 1];
            if left_holds && right_holds {
                self.ends.truncate(left);
                self.ends.extend(self.merger.ends());
                self.ends.extend(&self.fresh[right + 1..]);
                self.end = end;
                return to - from;
            }
            // Twice as far, so that all attempts together take about twice the time of the last.
            if !left_holds {
                let target = from.saturating_sub(self.end - from);
                left = self.ends.partition_point(|&e| e <= target).min(left - 1);
            }
            if !right_holds {
                let target = to + (to - self.end);
                let past = self.fresh.partition_point(|&e| e <= target);
                right = past.clamp(right + 1, self.fresh.len() - 1);
            }
        }
    }

    /// Where segment number `segment` starts.
    fn start_of(&self, segment: usize) -> usize {
        if segment == 0 {
            self.start
        } else {
            self.ends[segment - 1]
        }
    }
}

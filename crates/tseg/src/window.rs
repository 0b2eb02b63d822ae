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
/// boundary between neighbouring parts keeps that boundary. Hence new samples are segmented together with as many old
/// segments as it takes until one boundary between old segments survives: what is left of it stays.
#[derive(Debug)]
pub(crate) struct Window {
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// Ends of the segments, the last of them `end`.
    pub(crate) ends: VecDeque<usize>,
    merger: Merger,
}

impl Window {
    pub(crate) fn new(cost: Cost, threshold: f64) -> Self {
        Self {
            start: 0,
            end: 0,
            ends: VecDeque::new(),
            merger: Merger::new(cost, threshold),
        }
    }

    /// Removes the leftmost segment and returns its end.
    pub(crate) fn pop_front(&mut self) -> Option<usize> {
        let end = self.ends.pop_front()?;
        self.start = end;
        Some(end)
    }

    /// Takes in the samples up to `end`, more than so far; returns how many old ones had to be segmented anew.
    pub(crate) fn extend(&mut self, series: &Series, end: usize) -> usize {
        // The last segment ended where the window did, seldom where it should; the one before is the witness.
        let mut witness = self.ends.len().saturating_sub(2);
        loop {
            let from = self.start_of(witness);
            self.merger.run(series, from..end);
            if witness == 0 || self.merger.ends().next() == Some(self.ends[witness]) {
                let old = self.end - from;
                self.ends.truncate(witness);
                self.ends.extend(self.merger.ends());
                self.end = end;
                return old;
            }
            // Twice the length, so that all attempts together take about twice the time of the last.
            let target = from.saturating_sub(end - from);
            witness = self.ends.partition_point(|&e| e <= target).min(witness - 1);
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

use std::ops::Range;

use crate::cost::Cost;
use crate::series::Series;
use crate::tournament::Tournament;

/// The bottom-up iteration on a part of a series, with buffers that are reused from run to run.
#[derive(Debug, Clone)]
pub(crate) struct Merger {
    cost: Cost,
    threshold: f64,
    /// Boundaries at the start of the run; the other fields refer to them by index.
    boundaries: Vec<usize>,
    /// The surviving boundary before and after each surviving one.
    previous: Vec<usize>,
    next: Vec<usize>,
    /// What it costs to remove each boundary; infinite where that is above the threshold or the boundary is gone.
    candidates: Tournament,
}

/// A merge that is due: the segments `start..middle` and `middle..end` become one, of the given cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Merge {
    pub(crate) cost: f64,
    pub(crate) start: usize,
    pub(crate) middle: usize,
    pub(crate) end: usize,
}

impl Merger {
    pub(crate) fn new(cost: Cost, threshold: f64) -> Self {
        Self {
            cost,
            threshold,
            boundaries: Vec::new(),
            previous: Vec::new(),
            next: Vec::new(),
            candidates: Tournament::default(),
        }
    }

    /// Segments the samples of `range`: merges until the cheapest candidate is above the threshold.
    pub(crate) fn run(&mut self, series: &Series, range: Range<usize>) {
        self.start(series, range);
        while self.merge(series).is_some() {}
    }

    /// Starts over with the runs of equal samples of `range`.
    ///
    /// The merges within such a run cost nothing and so come before all others.
    pub(crate) fn start(&mut self, series: &Series, range: Range<usize>) {
        let first = range.start;
        let changes = range
            .clone()
            .filter(|&i| i == first || series.constant_since(i) == i);
        self.start_from(series, changes, range.end);
    }

    /// Starts over with the segments that start at the given samples; the last ends at `end`.
    pub(crate) fn start_from(
        &mut self,
        series: &Series,
        starts: impl Iterator<Item = usize>,
        end: usize,
    ) {
        self.boundaries.clear();
        self.boundaries.extend(starts);
        self.boundaries.push(end);
        let last = self.boundaries.len() - 1;
        self.next.clear();
        self.next.extend(1..=last + 1);
        self.previous.clear();
        self.previous.push(0);
        self.previous.extend(0..last);
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.reset(last);
        candidates.fill(1, (1..last).map(|i| self.candidate(series, i)));
        self.candidates = candidates;
    }

    /// The merge that is due, the leftmost of the cheapest, unless all are above the threshold.
    pub(crate) fn due(&self) -> Option<Merge> {
        let (middle, cost) = self.candidates.leftmost_min()?;
        Some(Merge {
            cost,
            start: self.boundaries[self.previous[middle]],
            middle: self.boundaries[middle],
            end: self.boundaries[self.next[middle]],
        })
    }

    /// Does the merge that is due, and tells whether both candidates that it changes are within the threshold.
    pub(crate) fn merge(&mut self, series: &Series) -> Option<bool> {
        let (middle, _) = self.candidates.leftmost_min()?;
        let last = self.boundaries.len() - 1;
        let (start, end) = (self.previous[middle], self.next[middle]);
        self.next[start] = end;
        self.previous[end] = start;
        self.candidates.set(middle, f64::INFINITY);
        let mut within = true;
        for boundary in [start, end] {
            if boundary != 0 && boundary != last {
                let cost = self.candidate(series, boundary);
                within &= cost.is_finite();
                self.candidates.set(boundary, cost);
            }
        }
        Some(within)
    }

    /// Whether every candidate is within the threshold.
    pub(crate) fn all_within(&self) -> bool {
        let last = self.boundaries.len() - 1;
        self.candidates.all_finite(1..last)
    }

    pub(crate) fn first_end(&self) -> usize {
        self.boundaries[self.next[0]]
    }

    pub(crate) fn last_start(&self) -> usize {
        self.boundaries[self.previous[self.boundaries.len() - 1]]
    }

    /// Segment ends, from left to right.
    pub(crate) fn ends(&self) -> impl Iterator<Item = usize> + '_ {
        let last = self.boundaries.len() - 1;
        let after = move |&boundary: &usize| (boundary < last).then(|| self.next[boundary]);
        std::iter::successors(after(&0), after).map(|boundary| self.boundaries[boundary])
    }

    /// What it costs to remove the boundary, infinite if that is above the threshold.
    fn candidate(&self, series: &Series, boundary: usize) -> f64 {
        let start = self.boundaries[self.previous[boundary]];
        let end = self.boundaries[self.next[boundary]];
        let cost = self.cost.between(series, start, end);
        if cost <= self.threshold {
            cost
        } else {
            f64::INFINITY
        }
    }
}

use std::ops::Range;

use crate::cost::Cost;
use crate::series::Series;
use crate::tournament::Tournament;

/// The bottom-up iteration on a part of a series, with buffers that are reused from run to run.
#[derive(Debug, Clone)]
pub(crate) struct Merger {
    cost: Cost,
    threshold: f64,
    /// The boundaries at the start of the run, and which of them survive.
    boundaries: Vec<Boundary>,
    /// What it costs to remove each boundary; infinite where that is above the threshold or the boundary is gone.
    candidates: Tournament,
}

/// A boundary between samples, and the index of the surviving one before and after it while it survives.
#[derive(Debug, Clone, Copy)]
struct Boundary {
    sample: usize,
    previous: usize,
    next: usize,
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
            .filter(|&i| i == first || series.constant_since(i + 1) == i);
        self.start_from(series, changes, range.end);
    }

    /// Starts over with the segments that start at the given samples; the last ends at `end`.
    pub(crate) fn start_from(
        &mut self,
        series: &Series,
        starts: impl Iterator<Item = usize>,
        end: usize,
    ) {
        let chained = |(index, sample): (usize, usize)| Boundary {
            sample,
            previous: index.saturating_sub(1),
            next: index + 1,
        };
        self.boundaries.clear();
        self.boundaries
            .extend(starts.chain([end]).enumerate().map(chained));
        let last = self.boundaries.len() - 1;
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.reset(last);
        candidates.fill(1, (1..last).map(|i| self.candidate(series, i)));
        self.candidates = candidates;
    }

    /// The merge that is due, the leftmost of the cheapest, unless all are above the threshold.
    pub(crate) fn due(&self) -> Option<Merge> {
        let (middle, cost) = self.candidates.leftmost_min()?;
        let Boundary {
            sample,
            previous,
            next,
        } = self.boundaries[middle];
        Some(Merge {
            cost,
            start: self.boundaries[previous].sample,
            middle: sample,
            end: self.boundaries[next].sample,
        })
    }

    /// Does the merge that is due, and tells whether both candidates that it changes are within the threshold.
    pub(crate) fn merge(&mut self, series: &Series) -> Option<bool> {
        let (middle, _) = self.candidates.leftmost_min()?;
        let last = self.boundaries.len() - 1;
        let Boundary { previous, next, .. } = self.boundaries[middle];
        self.boundaries[previous].next = next;
        self.boundaries[next].previous = previous;
        let mut within = true;
        // Where there is no boundary to change, the one that is gone is named again.
        let mut changed = |boundary: usize| {
            if boundary == 0 || boundary == last {
                return (middle, f64::INFINITY);
            }
            let cost = self.candidate(series, boundary);
            within &= cost.is_finite();
            (boundary, cost)
        };
        let changes = [changed(previous), (middle, f64::INFINITY), changed(next)];
        self.candidates.set(changes);
        Some(within)
    }

    /// Whether every candidate is within the threshold.
    pub(crate) fn all_within(&self) -> bool {
        let last = self.boundaries.len() - 1;
        self.candidates.all_finite(1..last)
    }

    pub(crate) fn first_end(&self) -> usize {
        self.boundaries[self.boundaries[0].next].sample
    }

    pub(crate) fn last_start(&self) -> usize {
        self.boundaries[self.boundaries[self.boundaries.len() - 1].previous].sample
    }

    /// Segment ends, from left to right.
    pub(crate) fn ends(&self) -> impl Iterator<Item = usize> + '_ {
        let last = self.boundaries.len() - 1;
        let after = move |&index: &usize| (index < last).then(|| self.boundaries[index].next);
        std::iter::successors(after(&0), after).map(|index| self.boundaries[index].sample)
    }

    /// What it costs to remove the boundary, infinite if that is above the threshold.
    fn candidate(&self, series: &Series, boundary: usize) -> f64 {
        let Boundary { previous, next, .. } = self.boundaries[boundary];
        let start = self.boundaries[previous].sample;
        let end = self.boundaries[next].sample;
        let cost = self.cost.between(series, start, end);
        if cost <= self.threshold {
            cost
        } else {
            f64::INFINITY
        }
    }
}

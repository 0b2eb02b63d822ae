use std::ops::Range;

use crate::cost::Cost;
use crate::error::{Error, check_threshold};
use crate::segmentation::Segmentation;
use crate::series::Series;
use crate::tournament::Tournament;

/// Bottom-up segmentation: start from single samples and merge, again and again, the adjacent pair whose *union* is
/// cheapest, the leftmost of equals, until the cheapest union costs more than the threshold.
///
/// Thesis Algorithm 3; corrected: stops on the cheapest candidate as in Keogh et al. (2001), not on the dearest.
///
/// With `n` samples and segments of `l` samples it takes `O(n (log n + l))` time, and `O(n)` memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BottomUp {
    cost: Cost,
    threshold: f64,
}

impl BottomUp {
    /// A threshold in units of the cost.
    ///
    /// # Errors
    ///
    /// [`Error::Threshold`] unless the threshold is finite and at least 0.
    pub fn new(cost: Cost, threshold: f64) -> Result<Self, Error> {
        let threshold = check_threshold(threshold)?;
        Ok(Self { cost, threshold })
    }

    /// Segments the series.
    pub fn segment(&self, series: &Series) -> Segmentation {
        let mut merger = Merger::new(self.cost, self.threshold);
        merger.run(series, 0..series.len(), |_| {});
        let mut boundaries = vec![0];
        boundaries.extend(merger.ends());
        Segmentation::from_ordered(boundaries)
    }
}

/// One merge: the segments `start..middle` and `middle..end` became one, of the given cost.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Merge {
    pub(crate) cost: f64,
    pub(crate) start: usize,
    pub(crate) middle: usize,
    pub(crate) end: usize,
}

/// The bottom-up iteration on a part of a series, with buffers that are reused from run to run.
#[derive(Debug)]
pub(crate) struct Merger {
    pub(crate) cost: Cost,
    pub(crate) threshold: f64,
    /// Boundaries at the start of the run; the other fields refer to them by index.
    boundaries: Vec<usize>,
    /// The surviving boundary before and after each surviving one.
    previous: Vec<usize>,
    next: Vec<usize>,
    /// What it costs to remove each boundary; infinite where that is above the threshold or the boundary is gone.
    candidates: Tournament,
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

    /// Segments the samples of `range`, reporting each merge that is not free.
    ///
    /// Merges within a run of constant samples cost nothing and so come before all others; they are done at once.
    pub(crate) fn run(
        &mut self,
        series: &Series,
        range: Range<usize>,
        mut merged: impl FnMut(Merge),
    ) {
        self.start(series, range);
        let last = self.boundaries.len() - 1;
        while let Some((middle, cost)) = self.candidates.leftmost_min() {
            let (start, end) = (self.previous[middle], self.next[middle]);
            self.next[start] = end;
            self.previous[end] = start;
            self.candidates.set(middle, f64::INFINITY);
            for boundary in [start, end] {
                if boundary != 0 && boundary != last {
                    let cost = self.candidate(series, self.previous[boundary], self.next[boundary]);
                    self.candidates.set(boundary, cost);
                }
            }
            merged(Merge {
                cost,
                start: self.boundaries[start],
                middle: self.boundaries[middle],
                end: self.boundaries[end],
            });
        }
    }

    /// Segment ends after a run, from left to right.
    pub(crate) fn ends(&self) -> impl Iterator<Item = usize> + '_ {
        let last = self.boundaries.len() - 1;
        let after = move |&boundary: &usize| (boundary < last).then(|| self.next[boundary]);
        std::iter::successors(after(&0), after).map(|boundary| self.boundaries[boundary])
    }

    fn start(&mut self, series: &Series, range: Range<usize>) {
        self.boundaries.clear();
        let mut boundary = range.start;
        while boundary < range.end {
            self.boundaries.push(boundary);
            boundary = series.constant_until(boundary).min(range.end);
        }
        self.boundaries.push(range.end);

        let last = self.boundaries.len() - 1;
        self.next.clear();
        self.next.extend(1..=last + 1);
        self.previous.clear();
        self.previous.push(0);
        self.previous.extend(0..last);
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.reset(last);
        candidates.fill(1, (1..last).map(|i| self.candidate(series, i - 1, i + 1)));
        self.candidates = candidates;
    }

    fn candidate(&self, series: &Series, start: usize, end: usize) -> f64 {
        let cost = self
            .cost
            .between(series, self.boundaries[start], self.boundaries[end]);
        if cost <= self.threshold {
            cost
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn boundaries(samples: &[f64], threshold: f64) -> Vec<usize> {
        let series = Series::new(&[(samples, 1.0)]).unwrap();
        let method = BottomUp::new(Cost::MeanDeviation, threshold).unwrap();
        method.segment(&series).boundaries().to_vec()
    }

    #[test]
    fn splits_two_levels() {
        assert_eq!(boundaries(&[1.0, 1.1, 1.0, 5.0, 5.1, 5.0], 0.5), [0, 3, 6]);
    }

    #[test]
    fn equal_candidates_merge_from_the_left() {
        // Every pair costs 0.5, every triple 2/3.
        assert_eq!(boundaries(&[0.0, 1.0, 2.0, 3.0, 4.0], 0.6), [0, 2, 4, 5]);
    }

    #[test]
    fn the_threshold_itself_still_merges() {
        assert_eq!(boundaries(&[0.0, 1.0], 0.5), [0, 2]);
        assert_eq!(boundaries(&[0.0, 1.0], 0.499), [0, 1, 2]);
        assert_eq!(boundaries(&[2.0, 2.0, 2.0], 0.0), [0, 3]);
    }

    #[test]
    fn refuses_impossible_thresholds() {
        for value in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                BottomUp::new(Cost::ZScale, value),
                Err(Error::Threshold { .. })
            ));
        }
    }
}

use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::cost::Cost;
use crate::error::{Error, check_threshold};
use crate::merger::Merger;
use crate::segmentation::Segmentation;
use crate::series::Series;
use crate::window::Window;

/// When [`BottomUp`] stops merging; one segment is always the end.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    Default,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Stop {
    /// Before the cheapest candidate merge would cost more than the threshold. Keogh et al. (2001).
    #[default]
    #[strum(message = "Before a merged segment would cost more than the threshold")]
    Keogh,
    /// After the merge that brings the highest cost of a segment over the threshold. Text of thesis section 3.1.3.
    #[strum(message = "Once a segment costs more than the threshold")]
    SegmentMax,
    /// After the merge that leaves a candidate dearer than the threshold, and after one merge at least: thesis
    /// Algorithm 3 to the letter. On most signals that is after the first merge.
    #[strum(message = "Once any possible merge would (Algorithm 3 as printed)")]
    CandidateMax,
    /// Before the merge that would bring the sum of the costs of all segments over the threshold.
    #[strum(message = "Before all segments together would")]
    Total,
}

/// Bottom-up segmentation: start from single samples and merge, again and again, the adjacent pair whose *union* is
/// cheapest, the leftmost of equals, until the stop rule holds.
///
/// Thesis Algorithm 3; corrected: stops on the cheapest candidate by default, not on the dearest, see [`Stop`].
///
/// With `n` samples and segments of `l` samples it takes `O(n (log n + l))` time, and `O(n)` memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BottomUp {
    cost: Cost,
    threshold: f64,
    stop: Stop,
}

/// Samples that are segmented at once: few enough for the processor's cache, many enough to make joints rare.
const BLOCK: usize = 4096;

impl BottomUp {
    /// A threshold in units of the cost, and the default stop rule.
    ///
    /// # Errors
    ///
    /// [`Error::Threshold`] unless the threshold is finite and at least 0.
    pub fn new(cost: Cost, threshold: f64) -> Result<Self, Error> {
        Ok(Self {
            cost,
            threshold: check_threshold(threshold)?,
            stop: Stop::default(),
        })
    }

    /// The same with another stop rule.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// Segments the series.
    pub fn segment(&self, series: &Series) -> Segmentation {
        let mut boundaries = match self.stop {
            Stop::Keogh => self.cheapest(series),
            Stop::SegmentMax => self.segment_max(series),
            Stop::CandidateMax => self.candidate_max(series),
            Stop::Total => self.total(series),
        };
        boundaries.insert(0, 0);
        Segmentation::from_ordered(boundaries)
    }

    /// Segment ends under [`Stop::Keogh`].
    fn cheapest(&self, series: &Series) -> Vec<usize> {
        let mut window = Window::new(self.cost, self.threshold);
        let mut block = BLOCK;
        while window.end < series.len() {
            let end = window.end.saturating_add(block).min(series.len());
            // As many new samples as old ones were redone, so that segments of any length cost about twice their share.
            block = window.extend(series, end).max(BLOCK);
        }
        window.ends.into()
    }

    /// One merge more than [`Stop::Keogh`]: a segment over the threshold comes of a candidate over the threshold.
    fn segment_max(&self, series: &Series) -> Vec<usize> {
        let mut ends = self.cheapest(series);
        if let Some(middle) = self.leftmost_cheapest(series, &ends) {
            ends.remove(middle);
        }
        ends
    }

    /// Which of the segment ends is cheapest to remove.
    fn leftmost_cheapest(&self, series: &Series, ends: &[usize]) -> Option<usize> {
        let union = |i: usize| {
            let start = if i == 0 { 0 } else { ends[i - 1] };
            self.cost.between(series, start, ends[i + 1])
        };
        let candidates = (0..ends.len() - 1).map(|i| (i, union(i)));
        candidates
            .reduce(|best, next| if next.1 < best.1 { next } else { best })
            .map(|(i, _)| i)
    }

    fn candidate_max(&self, series: &Series) -> Vec<usize> {
        let mut ends: Vec<usize> = (1..=series.len()).collect();
        if let Some(middle) = self.leftmost_cheapest(series, &ends) {
            ends.remove(middle);
        }
        let mut merger = Merger::new(self.cost, self.threshold);
        let starts = ends[..ends.len() - 1].iter().copied();
        merger.start_from(series, std::iter::once(0).chain(starts), series.len());
        let mut within = merger.all_within();
        while within {
            within = merger.merge(series).unwrap_or(false);
        }
        merger.ends().collect()
    }

    fn total(&self, series: &Series) -> Vec<usize> {
        let mut merger = Merger::new(self.cost, self.threshold);
        merger.start(series, 0..series.len());
        let mut total = Sum::default();
        while let Some(merge) = merger.due() {
            for part in [merge.start..merge.middle, merge.middle..merge.end] {
                total.add(-self.cost.between(series, part.start, part.end));
            }
            total.add(merge.cost);
            if total.value() > self.threshold {
                break;
            }
            merger.merge(series);
        }
        merger.ends().collect()
    }
}

/// A sum with about twice the digits of its terms (Dekker, Knuth), so that adding and taking away leaves no trace.
#[derive(Debug, Default)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let high = self.high + term;
        let shift = high - self.high;
        let error = (self.high - (high - shift)) + (term - shift);
        let low = self.low + error;
        self.high = high + low;
        self.low = low - (self.high - high);
    }

    fn value(&self) -> f64 {
        self.high
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

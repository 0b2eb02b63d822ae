use std::collections::VecDeque;

use crate::bottom_up::{Merge, Merger};
use crate::cost::Cost;
use crate::error::{Error, check_threshold};
use crate::segmentation::Segmentation;
use crate::series::Series;

/// How [`Swab`] refills its window after a segment has left it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Refill {
    /// Append sliding-window segments, at least one, until the window holds half its nominal length; it never holds more
    /// than twice its nominal length.
    ///
    /// A sliding-window segment grows sample by sample and stops *before* the one that would push its cost over the
    /// threshold; it has at least one sample. Keogh et al. (2001).
    #[default]
    Keogh,
    /// Append one segment that grows while its cost is below the threshold, so that it includes the crossing sample;
    /// the window has no upper bound. Thesis Algorithm 4 to the letter.
    Literal,
    /// Append single samples up to the nominal length.
    Fixed,
}

/// SWAB (sliding window and bottom-up): bottom-up on a window, emit the leftmost segment, refill, repeat; when no
/// sample is left to read, emit all of the window. Thesis Algorithm 4, after Keogh et al. (2001).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swab {
    cost: Cost,
    threshold: f64,
    window: usize,
    refill: Refill,
}

impl Swab {
    /// A threshold in units of the cost, a nominal window length in samples, and the default refill.
    ///
    /// # Errors
    ///
    /// [`Error::Threshold`] unless the threshold is finite and at least 0, [`Error::Window`] for a window of 0.
    pub fn new(cost: Cost, threshold: f64, window: usize) -> Result<Self, Error> {
        let threshold = check_threshold(threshold)?;
        if window == 0 {
            return Err(Error::Window);
        }
        Ok(Self {
            cost,
            threshold,
            window,
            refill: Refill::default(),
        })
    }

    /// The same with another refill.
    #[must_use]
    pub fn with_refill(self, refill: Refill) -> Self {
        Self { refill, ..self }
    }

    /// Segments the series.
    pub fn segment(&self, series: &Series) -> Segmentation {
        let mut window = Window::new(self.cost, self.threshold);
        window.extend(series, self.window.min(series.len()));
        let mut boundaries = vec![0];
        while window.end < series.len() {
            boundaries.extend(window.pop_front());
            let end = self.refilled(series, window.start, window.end);
            window.extend(series, end);
        }
        boundaries.extend(window.ends);
        Segmentation::from_ordered(boundaries)
    }

    /// Where the window that now is `start..end` ends after refilling.
    fn refilled(&self, series: &Series, start: usize, mut end: usize) -> usize {
        let n = series.len();
        match self.refill {
            Refill::Keogh => {
                let most = start.saturating_add(self.window.saturating_mul(2)).min(n);
                while end < most {
                    let first = end;
                    end += 1;
                    while end < most && self.cost.between(series, first, end + 1) <= self.threshold
                    {
                        end += 1;
                    }
                    if end - start >= self.window.div_ceil(2) {
                        break;
                    }
                }
                end
            }
            Refill::Literal => {
                let first = end;
                end += 1;
                while end < n && self.cost.between(series, first, end) < self.threshold {
                    end += 1;
                }
                end
            }
            Refill::Fixed => start.saturating_add(self.window).min(n),
        }
    }
}

/// A part `start..end` of the series with its bottom-up segmentation, kept up to date as samples leave on the left and
/// come in on the right.
///
/// Bottom-up is a greedy choice among independent candidates, so its result cuts the samples into parts that never
/// interacted: a part that ends on boundaries of the result has, on its own, the same merges in the same order.
/// Conversely, parts segmented on their own are together the result for the whole if no boundary between neighbouring
/// parts is ever the cheapest candidate while the merges on either side of it happen. Hence emitting a segment changes
/// nothing, and new samples are segmented with only as many old segments as [`Window::boundary_holds`] asks for.
#[derive(Debug)]
struct Window {
    start: usize,
    end: usize,
    /// Ends of the segments, the last of them `end`.
    ends: VecDeque<usize>,
    /// The merges that made the segments: segment by segment, within each in the order in which they happened.
    merges: VecDeque<Merge>,
    merger: Merger,
    /// Ends and merges of the samples segmented last, before they become part of the window.
    fresh_ends: Vec<usize>,
    fresh_merges: Vec<Merge>,
}

impl Window {
    fn new(cost: Cost, threshold: f64) -> Self {
        Self {
            start: 0,
            end: 0,
            ends: VecDeque::new(),
            merges: VecDeque::new(),
            merger: Merger::new(cost, threshold),
            fresh_ends: Vec::new(),
            fresh_merges: Vec::new(),
        }
    }

    /// Removes the leftmost segment and returns its end.
    fn pop_front(&mut self) -> Option<usize> {
        let end = self.ends.pop_front()?;
        self.start = end;
        while self.merges.front().is_some_and(|merge| merge.end <= end) {
            self.merges.pop_front();
        }
        Some(end)
    }

    /// Takes in the samples up to `end`.
    fn extend(&mut self, series: &Series, end: usize) {
        if end <= self.end {
            return;
        }
        // The last segment ended where the window did, seldom where it should.
        let mut kept = self.ends.len().saturating_sub(1);
        self.segment_fresh(series, self.start_of(kept), end);
        while kept > 0 && !self.boundary_holds(series, kept - 1) {
            // Segment anew one old segment more at least, and twice the length, so that all attempts together take
            // about twice the time of the last.
            let from = self.start_of(kept);
            let target = from.saturating_sub(end - from);
            kept = self.ends.partition_point(|&e| e <= target).min(kept - 1);
            self.segment_fresh(series, self.start_of(kept), end);
        }
        let from = self.start_of(kept);
        self.ends.truncate(kept);
        self.ends.extend(&self.fresh_ends);
        self.merges
            .truncate(self.merges.partition_point(|merge| merge.end <= from));
        self.merges.extend(&self.fresh_merges);
        self.end = end;
    }

    /// Where segment number `segment` of the window starts.
    fn start_of(&self, segment: usize) -> usize {
        if segment == 0 {
            self.start
        } else {
            self.ends[segment - 1]
        }
    }

    fn segment_fresh(&mut self, series: &Series, start: usize, end: usize) {
        let (merges, ends) = (&mut self.fresh_merges, &mut self.fresh_ends);
        merges.clear();
        self.merger
            .run(series, start..end, |merge| merges.push(merge));
        ends.clear();
        ends.extend(self.merger.ends());
        merges.sort_by_key(|merge| ends.partition_point(|&e| e < merge.end));
    }

    /// Whether bottom-up on segment number `left` of the window and the first fresh one keeps the boundary between them.
    ///
    /// Replays the merges of both in the order in which they would happen together, the removal of the boundary being
    /// one candidate more.
    fn boundary_holds(&self, series: &Series, left: usize) -> bool {
        let (left_start, boundary) = (self.start_of(left), self.ends[left]);
        let right_end = self.fresh_ends.first().copied().unwrap_or(boundary);
        let first = self.merges.partition_point(|merge| merge.end <= left_start);
        let past = self.merges.partition_point(|merge| merge.end <= boundary);
        let mut on_left = self.merges.range(first..past).peekable();
        let mut on_right = self
            .fresh_merges
            .iter()
            .take_while(|merge| merge.end <= right_end)
            .peekable();

        let mut start = boundary - 1;
        while start > left_start && series.constant_until(start - 1) >= boundary {
            start -= 1;
        }
        let mut end = series.constant_until(boundary).min(right_end);
        let mut removal = self.merger.cost.between(series, start, end);
        loop {
            let left_cost = on_left.peek().map_or(f64::INFINITY, |merge| merge.cost);
            let right_cost = on_right.peek().map_or(f64::INFINITY, |merge| merge.cost);
            if removal <= self.merger.threshold && removal < left_cost && removal <= right_cost {
                return false;
            }
            let next = if left_cost <= right_cost {
                on_left.next()
            } else {
                on_right.next()
            };
            let Some(merge) = next else { return true };
            if merge.middle == start {
                start = merge.start;
            } else if merge.middle == end {
                end = merge.end;
            } else {
                continue;
            }
            removal = self.merger.cost.between(series, start, end);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn refills_differ_on_a_constant() {
        let series = Series::new(&[(&[12.5; 80], 1.8)]).unwrap();
        let swab = Swab::new(Cost::MeanDeviation, 0.2, 25).unwrap();
        for (refill, boundaries) in [
            (Refill::Keogh, &[0, 25, 75, 80][..]),
            (Refill::Literal, &[0, 25, 80]),
            (Refill::Fixed, &[0, 25, 50, 75, 80]),
        ] {
            assert_eq!(
                swab.with_refill(refill).segment(&series).boundaries(),
                boundaries
            );
        }
    }

    #[test]
    fn literal_refill_takes_the_crossing_sample() {
        let swab = Swab::new(Cost::MeanDeviation, 0.4, 1).unwrap();
        let series = Series::new(&[(&[0.0, 1.0, 1.0, 5.0, 5.0], 1.0)]).unwrap();
        assert_eq!(swab.refilled(&series, 1, 1), 3);
        assert_eq!(swab.with_refill(Refill::Literal).refilled(&series, 1, 1), 4);
    }

    #[test]
    fn refuses_an_empty_window() {
        assert_eq!(Swab::new(Cost::ZScale, 0.2, 0).unwrap_err(), Error::Window);
    }
}

use crate::cost::Cost;
use crate::error::{Error, check_threshold};
use crate::segmentation::Segmentation;
use crate::series::Series;

/// The sliding window: a segment grows sample by sample and ends *before* the one that would push its cost over the
/// threshold, which starts the next segment. Thesis section 3.1.3, for comparison: it looks at no sample twice but also
/// never ahead.
///
/// With `n` samples and segments of `l` samples it takes `O(n l)` time, `O(n)` where they are constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingWindow {
    pub(crate) cost: Cost,
    pub(crate) threshold: f64,
}

impl SlidingWindow {
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
        let mut boundaries = vec![0];
        let mut start = 0;
        for sample in 1..series.len() {
            if self.ends_before(series, start, sample) {
                boundaries.push(sample);
                start = sample;
            }
        }
        boundaries.push(series.len());
        Segmentation::from_ordered(boundaries)
    }

    /// Whether the segment that so far is `start..sample`, not empty, ends there.
    pub(crate) fn ends_before(&self, series: &Series, start: usize, sample: usize) -> bool {
        self.cost.between(series, start, sample + 1) > self.threshold
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_crossing_sample_starts_the_next_segment() {
        let series = Series::new(&[(&[0.0, 1.0, 1.0, 5.0, 5.0, 9.0], 1.0)]).unwrap();
        let method = SlidingWindow::new(Cost::MeanDeviation, 0.5).unwrap();
        assert_eq!(method.segment(&series).boundaries(), [0, 3, 5, 6]);
        assert!(SlidingWindow::new(Cost::MeanDeviation, f64::NAN).is_err());
    }
}

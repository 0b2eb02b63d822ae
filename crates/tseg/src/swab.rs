use crate::cost::Cost;
use crate::error::{Error, check_threshold};
use crate::segmentation::Segmentation;
use crate::series::Series;
use crate::window::Window;

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

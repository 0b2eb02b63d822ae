use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::cost::Cost;
use crate::error::Error;
use crate::segmentation::Segmentation;
use crate::series::Series;
use crate::sliding_window::SlidingWindow;
use crate::stream::SwabStream;
use crate::window::Window;

/// How [`Swab`] refills its window after a segment has left it.
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
pub enum Refill {
    /// Append sliding-window segments, at least one, until the window holds half its nominal length; it never holds more
    /// than twice its nominal length.
    ///
    /// A sliding-window segment grows sample by sample and stops *before* the one that would push its cost over the
    /// threshold; it has at least one sample. Keogh et al. (2001).
    #[default]
    #[strum(message = "Sliding-window segments until the window is half full")]
    Keogh,
    /// Append one segment that grows while its cost is below the threshold, so that it includes the crossing sample;
    /// the window has no upper bound. Thesis Algorithm 4 to the letter.
    #[strum(message = "One segment including the crossing sample (Algorithm 4)")]
    Literal,
    /// Append single samples up to the nominal length.
    #[strum(message = "Single samples up to the window length")]
    Fixed,
}

/// SWAB (sliding window and bottom-up): bottom-up on a window, emit the leftmost segment, refill, repeat; when no
/// sample is left to read, emit all of the window. Thesis Algorithm 4, after Keogh et al. (2001).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swab {
    sliding: SlidingWindow,
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
        let sliding = SlidingWindow::new(cost, threshold)?;
        if window == 0 {
            return Err(Error::Window);
        }
        Ok(Self {
            sliding,
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
        let mut state = SwabState::new(*self);
        let mut boundaries = vec![0];
        boundaries.extend((0..series.len()).filter_map(|sample| state.advance(series, sample)));
        boundaries.extend(state.finish(series));
        Segmentation::from_ordered(boundaries)
    }

    /// The same one sample at a time, for variables of the given weights.
    ///
    /// # Errors
    ///
    /// [`Error::NoVariables`] and [`Error::Weight`].
    pub fn stream(&self, weights: &[f64]) -> Result<SwabStream, Error> {
        SwabStream::new(*self, weights)
    }
}

/// SWAB between two samples: a segmented window, and behind it the samples of its next refill.
#[derive(Debug, Clone)]
pub(crate) struct SwabState {
    swab: Swab,
    pub(crate) window: Window,
    /// Where the sliding-window segment that is growing starts; none grows in the first window.
    growing: Option<usize>,
}

impl SwabState {
    pub(crate) fn new(swab: Swab) -> Self {
        Self {
            swab,
            window: Window::new(swab.sliding.cost, swab.sliding.threshold),
            growing: None,
        }
    }

    /// Takes in the sample of that number, the one after the last; returns the end of a segment that is now certain.
    ///
    /// The leftmost segment of the window is certain as soon as the window is full: it is emitted whether or not
    /// another sample follows.
    pub(crate) fn advance(&mut self, series: &Series, sample: usize) -> Option<usize> {
        let end = self.refilled(series, sample)?;
        self.window.extend(series, end);
        self.growing = Some(end);
        self.window.pop_front()
    }

    /// The ends of the remaining segments, if no sample follows.
    pub(crate) fn finish(mut self, series: &Series) -> impl Iterator<Item = usize> {
        if self.window.end < series.len() {
            self.window.extend(series, series.len());
        }
        self.window.ends.into_iter()
    }

    /// Counts samples from `count` on.
    pub(crate) fn drop_front(&mut self, count: usize) {
        self.window.drop_front(count);
        self.growing = self.growing.map(|start| start - count);
    }

    /// Where the window ends, if the given sample completes it.
    fn refilled(&mut self, series: &Series, sample: usize) -> Option<usize> {
        let Swab {
            sliding,
            window,
            refill,
        } = self.swab;
        let seen = sample + 1;
        let held = seen - self.window.start;
        let (Some(start), Refill::Keogh | Refill::Literal) = (self.growing, refill) else {
            return (held == window).then_some(seen);
        };
        if refill == Refill::Literal {
            return (sliding.cost.between(series, start, seen) >= sliding.threshold)
                .then_some(seen);
        }
        if start < sample && sliding.ends_before(series, start, sample) {
            self.growing = Some(sample);
            if sample - self.window.start >= window.div_ceil(2) {
                return Some(sample);
            }
        }
        (held == window.saturating_mul(2)).then_some(seen)
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
    fn refuses_an_empty_window() {
        assert_eq!(Swab::new(Cost::ZScale, 0.2, 0).unwrap_err(), Error::Window);
    }
}

use std::ops::Range;

use crate::error::Error;
use crate::series::{LARGEST_SUM, STEPS_PER_UNIT, Series};
use crate::swab::{Swab, SwabState};

/// Samples of emitted segments are dropped together, when they number this and this share of the samples held.
const SLACK: usize = 64;
const SLACK_SHARE: usize = 8;

/// SWAB for samples that arrive one at a time, from [`Swab::stream`].
///
/// The segments are those of [`Swab::segment`] on the whole series, each given as soon as no later sample can change it.
///
/// With a window of `w` samples it holds up to `2w` samples for [`Refill::Keogh`](crate::Refill::Keogh), `w` for
/// [`Refill::Fixed`](crate::Refill::Fixed), and for [`Refill::Literal`](crate::Refill::Literal) as many as it takes, and
/// a seventh more or 63 of segments given already. A push takes `O(w (log w + l))` time at most, for segments of `l`
/// samples, and mostly `O(l)`.
#[derive(Debug, Clone)]
#[must_use]
pub struct SwabStream {
    state: SwabState,
    weights: Vec<f64>,
    /// The samples since the last that was dropped.
    held: Series,
    dropped: usize,
    /// Where the next segment starts, counted from the first sample of all.
    start: usize,
}

impl SwabStream {
    pub(crate) fn new(swab: Swab, weights: &[f64]) -> Result<Self, Error> {
        Ok(Self {
            state: SwabState::new(swab),
            weights: weights.to_vec(),
            held: Series::growing(weights)?,
            dropped: 0,
            start: 0,
        })
    }

    /// Number of samples taken in.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        self.dropped + self.held.len()
    }

    /// Takes in the next sample, one value per variable; returns a segment that is now certain, in sample numbers.
    ///
    /// # Errors
    ///
    /// [`Error::Variables`], [`Error::NotFinite`], and [`Error::TooLarge`] where the samples held, this one included,
    /// number more than 2²⁹ divided by the largest magnitude. A sample that is refused leaves no trace: another may be
    /// pushed in its place.
    pub fn push(&mut self, sample: &[f64]) -> Result<Option<Range<usize>>, Error> {
        self.check(sample)?;
        let weighted = sample.iter().zip(&self.weights);
        self.held.push(
            weighted
                .filter(|&(_, &weight)| weight > 0.0)
                .map(|(&x, _)| x),
        );
        let Some(end) = self.state.advance(&self.held, self.held.len() - 1) else {
            return Ok(None);
        };
        let segment = self.start..self.dropped + end;
        self.start = segment.end;
        if end >= SLACK && end >= self.held.len() / SLACK_SHARE {
            self.held.drop_front(end);
            self.state.drop_front(end);
            self.dropped += end;
        }
        Ok(Some(segment))
    }

    /// The remaining segments, when no sample follows; none if there never was one.
    pub fn finish(self) -> impl Iterator<Item = Range<usize>> {
        let Self {
            state,
            held,
            dropped,
            mut start,
            ..
        } = self;
        let ends: Vec<usize> = state.finish(&held).collect();
        ends.into_iter().map(move |end| {
            let segment = start..dropped + end;
            start = segment.end;
            segment
        })
    }

    fn check(&self, sample: &[f64]) -> Result<(), Error> {
        let (found, expected) = (sample.len(), self.weights.len());
        if found != expected {
            return Err(Error::Variables { found, expected });
        }
        let limit = LARGEST_SUM / (self.held.len() + 1) as f64;
        let mut held = self.held.variables().iter();
        for (variable, (&value, &weight)) in sample.iter().zip(&self.weights).enumerate() {
            if !value.is_finite() {
                let sample = self.sample_count();
                return Err(Error::NotFinite {
                    variable,
                    sample,
                    value,
                });
            }
            let Some(held) = (weight > 0.0).then(|| held.next()).flatten() else {
                continue;
            };
            if value.abs().max(held.largest as f64 / STEPS_PER_UNIT) > limit {
                // The new sample, or one that was small enough while there were fewer.
                let steps = held.steps.iter().map(|&x| x as f64 / STEPS_PER_UNIT);
                let values = steps.chain([value]).enumerate();
                let largest = values.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
                let (sample, value) = largest.unwrap_or((0, value));
                let sample = self.dropped + sample;
                return Err(Error::TooLarge {
                    variable,
                    sample,
                    value,
                    limit,
                });
            }
        }
        Ok(())
    }
}

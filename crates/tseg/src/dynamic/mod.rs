use std::ops::ControlFlow;

use crate::cost::Cost;
use crate::error::Error;
use crate::segmentation::Segmentation;
use crate::series::Series;

mod certify;
mod counts;
mod growing_windows;
mod lanes;
mod path;
mod penalised;
mod rank_set;
mod sparse;
mod sweep;
mod table;
mod walk;

pub use path::{PathPoint, PenaltyPath};
pub use sweep::Progress;

use certify::{Certified, Problem, certified};
use sweep::sweep;
use table::Recurrence;
use walk::Walkable;

/// Values of the plain recurrence, 12 bytes each, up to which it is the first choice, and the last resort.
const FEW_VALUES: usize = 4_000_000;
const MOST_VALUES: usize = 25_000_000;

/// Segmentation of least total cost into a given number of segments: thesis Algorithm 2, (3.16) to (3.18).
///
/// The recurrence `E_k(r) = min_l E_{k−1}(l) + c(l, r)` in one pass over the `n² / 2` segments, with `O(n k)` values and
/// no table of costs. Beyond four million values the optimum is found, and proved to be one, by way of the penalised
/// problem, in less memory; where that leaves a gap the recurrence is run all the same up to 25 million values (300 MB).
/// Beyond these the best solution known is given with the gap that remains: see [`Certificate`].
///
/// Of several optima the one whose last segment starts first, recursively, up to rounding.
///
/// # Example
///
/// ```
/// use tseg::{Certificate, Cost, Dynamic, Series};
///
/// let series = Series::new(&[(&[1.0, 1.1, 1.0, 5.0, 5.1, 9.0, 9.1], 1.0)])?;
/// let best = Dynamic::new(Cost::SquaredError, 3)?.segment(&series)?;
/// assert_eq!(best.segmentation.boundaries(), [0, 3, 5, 7]);
/// assert_eq!(best.certificate, Certificate::Optimal);
/// # Ok::<(), tseg::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dynamic {
    cost: Cost,
    segments: usize,
    at_most: bool,
    min_length: usize,
}

/// What is known of a segmentation's cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Certificate {
    /// No segmentation of the kind asked for costs less, up to a relative 1e-10.
    Optimal,
    /// None costs less by more than this.
    Gap(f64),
}

/// A segmentation with its cost and what is known of that.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Optimum {
    /// The partition.
    pub segmentation: Segmentation,
    /// Sum of the costs of its segments.
    pub cost: f64,
    /// Whether any could be cheaper.
    pub certificate: Certificate,
}

impl Dynamic {
    /// Exactly so many segments, each of at least one sample.
    ///
    /// # Errors
    ///
    /// [`Error::NoSegments`] for 0.
    pub fn new(cost: Cost, segments: usize) -> Result<Self, Error> {
        if segments == 0 {
            return Err(Error::NoSegments);
        }
        Ok(Self {
            cost,
            segments,
            at_most: false,
            min_length: 1,
        })
    }

    /// The same with at most so many segments: thesis Algorithm 2, whose zero column allows fewer.
    #[must_use]
    pub fn at_most(self) -> Self {
        Self {
            at_most: true,
            ..self
        }
    }

    /// The same with segments of at least so many samples; 0 counts as 1.
    #[must_use]
    pub fn with_min_length(self, samples: usize) -> Self {
        Self {
            min_length: samples.max(1),
            ..self
        }
    }

    /// Segments the series, on all threads of the current `rayon` pool; the result does not depend on their number.
    ///
    /// # Errors
    ///
    /// [`Error::TooManySegments`] if the series is too short, [`Error::CostOverflow`] if costs exceed the largest `f64`.
    pub fn segment(&self, series: &Series) -> Result<Optimum, Error> {
        self.segment_with(series, &|_| ControlFlow::Continue(()))
    }

    /// The same, reporting its progress to, and cancelled by, `progress`. The fraction starts anew where bounds left a gap.
    ///
    /// # Errors
    ///
    /// As [`Self::segment`], and [`Error::Cancelled`].
    pub fn segment_with(&self, series: &Series, progress: &Progress<'_>) -> Result<Optimum, Error> {
        let problem = self.problem(series.len())?;
        check_finite_costs(self.cost, series)?;
        let walkable = Walkable::new(series, self.cost);
        let Certified { boundaries, gap } = self.solve(&walkable, problem, progress)?;
        let segmentation = Segmentation::from_ordered(boundaries);
        Ok(Optimum {
            cost: self.cost.total(series, &segmentation)?,
            segmentation,
            certificate: if gap > 0.0 {
                Certificate::Gap(gap)
            } else {
                Certificate::Optimal
            },
        })
    }

    fn solve(
        &self,
        walkable: &Walkable<'_>,
        problem: Problem,
        progress: &Progress<'_>,
    ) -> Result<Certified, Error> {
        let values = problem.segments.saturating_mul(walkable.series().len());
        // Means of deviations do not add up, so that their penalised problem says little.
        let bounded = self.cost != Cost::MeanDeviation;
        if values > MOST_VALUES || bounded && values > FEW_VALUES {
            let found = certified(walkable, problem, progress)?;
            if found.gap <= 0.0 || values > MOST_VALUES {
                return Ok(found);
            }
        }
        plain(walkable, problem, progress)
    }

    fn problem(&self, samples: usize) -> Result<Problem, Error> {
        let most = samples / self.min_length;
        if most == 0 || (self.segments > most && !self.at_most) {
            return Err(Error::TooManySegments {
                segments: self.segments,
                min_length: self.min_length,
                samples,
            });
        }
        Ok(Problem {
            segments: self.segments.min(most),
            at_most: self.at_most,
            min_length: self.min_length,
        })
    }
}

fn plain(
    walkable: &Walkable<'_>,
    problem: Problem,
    progress: &Progress<'_>,
) -> Result<Certified, Error> {
    let recurrence = Recurrence::Counted(problem.segments);
    let table = sweep(walkable, problem.min_length, &recurrence, None, progress)?;
    let last = |row: &usize| table.value(*row, table.len());
    let fewest = if problem.at_most {
        0
    } else {
        problem.segments - 1
    };
    let row = (fewest..problem.segments).min_by(|a, b| last(a).total_cmp(&last(b)));
    let boundaries = table.boundaries(walkable, row.unwrap_or(fewest));
    Ok(Certified {
        boundaries,
        gap: 0.0,
    })
}

/// Refuses weights so large that the sum of costs might overflow.
fn check_finite_costs(cost: Cost, series: &Series) -> Result<(), Error> {
    if cost.bound(series).is_finite() {
        Ok(())
    } else {
        Err(Error::CostOverflow)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Few levels and constant stretches, or a random walk.
    fn samples(len: usize) -> impl Strategy<Value = Vec<f64>> {
        let levels = prop::collection::vec((0..4_i32, 1..9_usize), len).prop_map(move |pieces| {
            let spread =
                |(level, run): (i32, usize)| std::iter::repeat_n(f64::from(level) * 0.1, run);
            pieces
                .into_iter()
                .flat_map(spread)
                .take(len)
                .collect::<Vec<_>>()
        });
        let walk = prop::collection::vec(-0.3..0.3_f64, len).prop_map(|steps| {
            let walked = steps.into_iter().scan(0.0, |x, step| {
                *x += step;
                Some(*x)
            });
            walked.collect::<Vec<_>>()
        });
        prop_oneof![levels, walk]
    }

    proptest! {
        #[test]
        fn bounds_lead_to_the_optimum_of_the_recurrence(
            (first, second) in (1..300_usize).prop_flat_map(|len| (samples(len), samples(len))),
            share in 0.0..1.0_f64,
            min_length in 1..8_usize,
            at_most: bool,
            cost in prop::sample::select(vec![Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError]),
        ) {
            let series = Series::new(&[(&first, 1.8), (&second, 1.0)]).unwrap();
            let min_length = min_length.min(series.len());
            let most = series.len() / min_length;
            let segments = 1 + (share * share * (most - 1) as f64) as usize;
            let problem = Problem { segments, at_most, min_length };
            let walkable = Walkable::new(&series, cost);
            let on = |_| ControlFlow::Continue(());
            let plain = super::plain(&walkable, problem, &on).unwrap();
            let certified = super::certified(&walkable, problem, &on).unwrap();
            let (least, found) = (walkable.total(&plain.boundaries), walkable.total(&certified.boundaries));
            prop_assert!((least - found).abs() <= 1e-9 * least.max(1.0), "{least} against {found}, gap {}", certified.gap);
            prop_assert!(certified.gap.abs() <= 1e-9 * least.max(1.0), "gap {} of {least}", certified.gap);
            let count = certified.boundaries.len() - 1;
            prop_assert!(count == segments || at_most && count < segments);
            prop_assert!(certified.boundaries.windows(2).all(|b| b[1] - b[0] >= min_length));
        }
    }
}

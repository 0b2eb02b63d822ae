use crate::cost::Cost;
use crate::dynamic::check_finite_costs;
use crate::dynamic::penalised::{Penalised, Penalties, between, first_penalties};
use crate::dynamic::sweep::Progress;
use crate::dynamic::walk::Walkable;
use crate::error::Error;
use crate::segmentation::Segmentation;
use crate::series::Series;

/// How the least cost falls with the number of segments, and where that stops to pay.
///
/// A point per penalty `λ`, the optimum of cost plus `λ` times the number of segments. Each is also the optimum for its own
/// number of segments.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct PenaltyPath {
    /// By rising number of segments, each number once.
    pub points: Vec<PathPoint>,
    /// Index of the point at the knee.
    pub knee: usize,
}

/// The optimum for one penalty.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// The penalty, in units of the cost.
    pub penalty: f64,
    /// The partition.
    pub segmentation: Segmentation,
    /// Its cost without penalties.
    pub cost: f64,
}

impl PenaltyPath {
    /// The path for segments of at least `min_length` samples (0 counts as 1).
    ///
    /// # Errors
    ///
    /// As [`Dynamic::segment_with`](crate::Dynamic::segment_with).
    pub fn new(
        cost: Cost,
        min_length: usize,
        series: &Series,
        progress: &Progress<'_>,
    ) -> Result<Self, Error> {
        let min_length = min_length.max(1);
        if min_length > series.len() {
            return Err(Error::TooManySegments {
                segments: 1,
                min_length,
                samples: series.len(),
            });
        }
        check_finite_costs(cost, series)?;
        let walkable = Walkable::new(series, cost);
        let half = |done: f64| progress(done / 2.0);
        let sweep = Penalties::sweep(&walkable, min_length, first_penalties(&walkable), &half)?;
        let mut optima = sweep.optima(&walkable);
        let rough = knee(&optima);
        let (most, least) = (
            optima[rough.saturating_sub(1)].penalty,
            optima[(rough + 1).min(optima.len() - 1)].penalty,
        );
        let rest = |done: f64| progress(0.5 + done / 2.0);
        let sweep = Penalties::sweep(&walkable, min_length, between(most, least), &rest)?;
        optima.extend(sweep.optima(&walkable));
        optima.sort_by(|a, b| {
            a.segments()
                .cmp(&b.segments())
                .then(b.penalty.total_cmp(&a.penalty))
        });
        optima.dedup_by_key(|optimum| optimum.segments());
        let knee = knee(&optima);
        let points = optima.into_iter().map(PathPoint::from).collect();
        Ok(Self { points, knee })
    }

    /// The point at the knee.
    #[must_use]
    pub fn at_knee(&self) -> &PathPoint {
        &self.points[self.knee]
    }
}

impl From<Penalised> for PathPoint {
    fn from(optimum: Penalised) -> Self {
        Self {
            penalty: optimum.penalty,
            cost: optimum.cost,
            segmentation: Segmentation::from_ordered(optimum.boundaries),
        }
    }
}

/// The optimum farthest below the line from the first to the last, both axes scaled to `[0, 1]` (Satopää et al.). Of
/// equals the first.
fn knee(optima: &[Penalised]) -> usize {
    let (Some(first), Some(last)) = (optima.first(), optima.last()) else {
        return 0;
    };
    let position = |value: f64, from: f64, to: f64| {
        if from.total_cmp(&to).is_eq() {
            0.0
        } else {
            (value - from) / (to - from)
        }
    };
    let below = |optimum: &Penalised| {
        let x = position(
            optimum.segments() as f64,
            first.segments() as f64,
            last.segments() as f64,
        );
        position(optimum.cost, first.cost, last.cost) - x
    };
    (1..optima.len()).fold(0, |best, i| {
        if below(&optima[i]) > below(&optima[best]) {
            i
        } else {
            best
        }
    })
}

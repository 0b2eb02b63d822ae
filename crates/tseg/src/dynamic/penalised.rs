//! Segmentations of least cost plus a penalty per segment, for many penalties at once.

use crate::dynamic::sweep::{Progress, sweep};
use crate::dynamic::table::{Recurrence, Table};
use crate::dynamic::walk::Walkable;
use crate::error::Error;

/// Penalties per sweep.
pub(crate) const PENALTIES: usize = 24;

/// Ratio of neighbouring penalties in the first sweep, and of their distances from the target in later ones.
pub(crate) const FIRST_RATIO: f64 = 1.8;
const LATER_RATIO: f64 = 2.5;

/// The optimum of the penalised problem for one penalty.
#[derive(Debug, Clone)]
pub(crate) struct Penalised {
    pub(crate) penalty: f64,
    pub(crate) boundaries: Vec<usize>,
    /// Without penalties.
    pub(crate) cost: f64,
}

impl Penalised {
    pub(crate) fn segments(&self) -> usize {
        self.boundaries.len() - 1
    }
}

/// The penalised optima with the penalties given.
pub(crate) struct Penalties {
    /// In falling order, so that segments are in rising order.
    pub(crate) penalties: Vec<f64>,
    pub(crate) table: Table,
}

impl Penalties {
    pub(crate) fn sweep(
        walkable: &Walkable<'_>,
        min_length: usize,
        mut penalties: Vec<f64>,
        progress: &Progress<'_>,
    ) -> Result<Self, Error> {
        penalties.sort_unstable_by(|a, b| b.total_cmp(a));
        penalties.dedup();
        let recurrence = Recurrence::Penalised(&penalties);
        let table = sweep(walkable, min_length, &recurrence, None, progress)?;
        Ok(Self { penalties, table })
    }

    fn len(&self) -> usize {
        self.penalties.len()
    }

    fn optimum(&self, walkable: &Walkable<'_>, row: usize) -> Penalised {
        let boundaries = self.table.boundaries(walkable, row);
        Penalised {
            penalty: self.penalties[row],
            cost: walkable.total(&boundaries),
            boundaries,
        }
    }

    /// All of them, by rising number of segments, each number once.
    pub(crate) fn optima(&self, walkable: &Walkable<'_>) -> Vec<Penalised> {
        let mut optima: Vec<Penalised> = (0..self.len())
            .map(|row| self.optimum(walkable, row))
            .collect();
        optima.dedup_by_key(|optimum| optimum.segments());
        optima
    }

    /// The first row whose optimum has more segments than given, by bisection; shows every optimum looked at.
    pub(crate) fn first_row_with_more(
        &self,
        walkable: &Walkable<'_>,
        segments: usize,
        mut show: impl FnMut(Penalised),
    ) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let row = (low + high) / 2;
            let optimum = self.optimum(walkable, row);
            if optimum.segments() <= segments {
                low = row + 1;
            } else {
                high = row;
            }
            show(optimum);
        }
        low
    }

    /// The row with the largest lower bound of the cost of so many segments, and that bound.
    pub(crate) fn bound(&self, segments: usize, at_most: bool) -> (usize, f64) {
        let bound = |row: usize| {
            let penalty = self.penalties[row];
            if at_most && penalty < 0.0 {
                return f64::NEG_INFINITY;
            }
            self.table.value(row, self.table.len()) - penalty * segments as f64
        };
        let best = (0..self.len()).max_by(|&a, &b| bound(a).total_cmp(&bound(b)));
        best.map_or((0, f64::NEG_INFINITY), |row| (row, bound(row)))
    }
}

/// Penalties from one that allows a single segment only down to almost none, and none.
pub(crate) fn first_penalties(walkable: &Walkable<'_>) -> Vec<f64> {
    let most = walkable.between(0, walkable.series().len());
    falling(1.000_001 * most, FIRST_RATIO, PENALTIES - 1)
}

/// Penalties from `most` down to `least`, and 0.
pub(crate) fn between(most: f64, least: f64) -> Vec<f64> {
    let least = least.max(1e-3 * most);
    let ratio = (most / least).powf(1.0 / (PENALTIES - 2) as f64);
    falling(most, if ratio > 1.0 { ratio } else { 1.0 }, PENALTIES - 1)
}

/// `largest`, `largest / ratio`, …, and 0.
pub(crate) fn falling(largest: f64, ratio: f64, count: usize) -> Vec<f64> {
    let powers = (0..count).map(|i| largest * ratio.powi(-(i as i32)));
    powers.chain([0.0]).collect()
}

/// What a segment more saves on the way between two optima.
pub(crate) fn chord(fewer: &Penalised, more: &Penalised) -> f64 {
    (fewer.cost - more.cost) / (more.segments() - fewer.segments()).max(1) as f64
}

/// Penalties between `most` and `least` that close in on `target`, and the target.
pub(crate) fn around(target: f64, most: f64, least: f64) -> Vec<f64> {
    let distances = (1..=PENALTIES as i32 / 2).map(|i| LATER_RATIO.powi(-i));
    let penalties =
        distances.flat_map(|d| [target + d * (most - target), target + d * (least - target)]);
    penalties.chain([target]).collect()
}

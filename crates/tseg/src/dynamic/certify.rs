//! Many segments of long series: bounds from the penalised problem, and the exact optimum among the segments that these
//! leave.
//!
//! For every penalty `λ`, `g(λ) = min_m C(m) + λ m − λ k` is a lower bound of the least cost `C(k)` of `k` segments, and
//! equals it where the minimum has `k` segments. With `F_λ` and `B_λ` the penalised optima from the left and from the
//! right, no segmentation of cost at most `U` contains a segment with `F_λ(l) + c(l, r) + λ + B_λ(r) > U + λ k`.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cost::Cost;
use crate::dynamic::lanes::{LANES, Lanes};
use crate::dynamic::penalised::{
    FIRST_RATIO, PENALTIES, Penalised, Penalties, around, between, chord, falling, first_penalties,
};
use crate::dynamic::sparse::{Cell, Cells};
use crate::dynamic::sweep::{Progress, sweep};
use crate::dynamic::table::{Recurrence, Table};
use crate::dynamic::walk::Walkable;
use crate::error::Error;

/// What is asked for; `segments · min_length` does not exceed the length of the series.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem {
    pub(crate) segments: usize,
    pub(crate) at_most: bool,
    pub(crate) min_length: usize,
}

/// Boundaries, and by how much their cost may exceed the least; 0 if it does not.
pub(crate) struct Certified {
    pub(crate) boundaries: Vec<usize>,
    pub(crate) gap: f64,
}

/// Every so manyth sample gives the first guess.
const COARSE: usize = 4;

/// Sweeps over penalties at most; three are enough on all series tried.
const SWEEPS: usize = 6;

/// Relative difference between the bounds under which the segments that are left are few enough to be listed.
const NEAR_ENOUGH: f64 = 1e-3;

/// Relative difference under which two costs count as equal.
const TOLERANCE: f64 = 1e-10;

/// Segments and values that the last step may hold, 16 and 8 bytes each.
const MOST_CELLS: usize = 5_000_000;
const MOST_VALUES: usize = 16_000_000;

struct Search<'a> {
    walkable: &'a Walkable<'a>,
    problem: Problem,
    progress: &'a Progress<'a>,
    sweeps: usize,
    /// The nearest optima known with at most and at least as many segments as asked for.
    fewer: Option<Penalised>,
    more: Option<Penalised>,
    /// Segments from which good solutions are made.
    cells: Vec<Cell>,
    /// The sweep with the largest lower bound, its row, and the bound.
    bound: Option<(Penalties, usize, f64)>,
}

/// Solves the problem, or comes as near as the limits allow and says how near.
pub(crate) fn certified(
    walkable: &Walkable<'_>,
    problem: Problem,
    progress: &Progress<'_>,
) -> Result<Certified, Error> {
    let mut search = Search {
        walkable,
        problem,
        progress,
        sweeps: 0,
        fewer: None,
        more: None,
        cells: Vec::new(),
        bound: None,
    };
    search.add_path(&even(walkable.series().len(), problem.segments));
    let mut penalties = search.guessed_penalties()?;
    loop {
        let sweep = Penalties::sweep(walkable, problem.min_length, penalties, &search.report())?;
        search.sweeps += 1;
        search.learn(sweep);
        let next = search.next_penalties();
        let last = next.is_none() || search.sweeps >= SWEEPS;
        if last || search.spread() <= NEAR_ENOUGH {
            let found = search.best()?;
            if last || found.gap <= 0.0 {
                return Ok(found);
            }
        }
        penalties = next.unwrap_or_default();
    }
}

/// Boundaries of so many segments of nearly equal length.
fn even(len: usize, segments: usize) -> Vec<usize> {
    (0..=segments)
        .map(|i| (i as u128 * len as u128 / segments as u128) as usize)
        .collect()
}

impl Search<'_> {
    /// Penalties around the one that gives the number of segments asked for on every fourth sample, a sixteenth of the
    /// work.
    fn guessed_penalties(&self) -> Result<Vec<f64>, Error> {
        let coarse = self.walkable.series().every(COARSE);
        let coarse = Walkable::new(&coarse, self.walkable.cost());
        let min_length = self.problem.min_length.div_ceil(COARSE);
        let sweep = Penalties::sweep(
            &coarse,
            min_length,
            first_penalties(&coarse),
            &self.report(),
        )?;
        let row = sweep.first_row_with_more(&coarse, self.problem.segments, |_| {});
        let (most, least) = match (row.checked_sub(1), sweep.penalties.get(row)) {
            (Some(before), Some(&least)) if least > 0.0 => (sweep.penalties[before], least),
            _ => return Ok(first_penalties(self.walkable)),
        };
        let scale = match self.walkable.cost() {
            Cost::ZScale | Cost::SquaredError => COARSE as f64,
            Cost::MeanDeviation => 1.0,
        };
        Ok(between(3.0 * scale * most, scale * least / 3.0))
    }

    /// Penalties that come closer to the number of segments asked for, unless nothing can.
    fn next_penalties(&self) -> Option<Vec<f64>> {
        match (&self.fewer, &self.more) {
            (Some(fewer), Some(more)) => {
                let hit = [fewer, more]
                    .iter()
                    .any(|o| o.segments() == self.problem.segments);
                if hit || self.spread() <= TOLERANCE {
                    return None;
                }
                Some(around(chord(fewer, more), fewer.penalty, more.penalty))
            }
            (Some(fewer), None) if fewer.penalty > 0.0 => Some(first_penalties(self.walkable)),
            // More segments than without a penalty.
            (Some(_), None) if !self.problem.at_most => Some(self.negative_penalties()),
            (Some(_), None) => None,
            (None, _) => Some(first_penalties(self.walkable)),
        }
    }

    /// Relative difference between the bound and what a mixture of the nearest optima would cost.
    fn spread(&self) -> f64 {
        let (Some(fewer), Some(more)) = (&self.fewer, &self.more) else {
            return f64::INFINITY;
        };
        let missing = self.problem.segments - fewer.segments();
        let cost = fewer.cost - missing as f64 * chord(fewer, more);
        (cost - self.lower_bound()) / cost.abs().max(f64::MIN_POSITIVE)
    }

    fn report(&self) -> impl Fn(f64) -> ControlFlow<()> + Sync + use<'_> {
        let (sweeps, progress) = (self.sweeps as f64, self.progress);
        move |done| progress(1.0 - (1.0 - done / 4.0) * 0.75_f64.powf(sweeps))
    }

    fn lower_bound(&self) -> f64 {
        self.bound
            .as_ref()
            .map_or(f64::NEG_INFINITY, |&(_, _, bound)| bound)
    }

    /// Penalties down to one that makes every segment as short as allowed.
    fn negative_penalties(&self) -> Vec<f64> {
        let len = self.walkable.series().len();
        let most = self
            .walkable
            .total(&even(len, len / self.problem.min_length));
        let penalties = falling(1.000_001 * most, FIRST_RATIO, PENALTIES - 1);
        penalties.into_iter().map(|penalty| -penalty).collect()
    }

    /// Takes from a sweep the optima around the number of segments asked for, and the bound.
    fn learn(&mut self, sweep: Penalties) {
        sweep.first_row_with_more(self.walkable, self.problem.segments, |optimum| {
            self.add_path(&optimum.boundaries);
            self.remember(optimum);
        });
        let (row, bound) = sweep.bound(self.problem.segments, self.problem.at_most);
        if bound > self.lower_bound() {
            self.bound = Some((sweep, row, bound));
        }
    }

    fn remember(&mut self, optimum: Penalised) {
        let wanted = self.problem.segments;
        if optimum.segments() <= wanted
            && self
                .fewer
                .as_ref()
                .is_none_or(|known| known.segments() < optimum.segments())
        {
            self.fewer = Some(optimum.clone());
        }
        if optimum.segments() >= wanted
            && self
                .more
                .as_ref()
                .is_none_or(|known| known.segments() > optimum.segments())
        {
            self.more = Some(optimum);
        }
    }

    /// Adds the segments of a segmentation, and each two neighbours as one.
    fn add_path(&mut self, boundaries: &[usize]) {
        for width in [1, 2] {
            for window in boundaries.windows(width + 1) {
                let (start, end) = (window[0], window[width]);
                self.cells.push(self.walkable.cell(start, end));
            }
        }
    }

    /// The best solution known, or the optimum if the segments that can belong to it are few enough.
    fn best(&mut self) -> Result<Certified, Error> {
        let Problem {
            segments, at_most, ..
        } = self.problem;
        let known = Cells::new(self.cells.clone()).best(segments, at_most);
        let (cost, boundaries) = known.ok_or(Error::CostOverflow)?;
        let Some((sweep, row, bound)) = &self.bound else {
            return Err(Error::CostOverflow);
        };
        let gap = cost - bound;
        if gap <= TOLERANCE * cost.abs() {
            return Ok(Certified {
                boundaries,
                gap: 0.0,
            });
        }
        let cells = self.survivors(sweep, *row, cost)?;
        let best = cells.and_then(|cells| cells.best(segments, at_most));
        Ok(match best {
            Some((_, boundaries)) => Certified {
                boundaries,
                gap: 0.0,
            },
            None => Certified { boundaries, gap },
        })
    }

    /// All segments that a segmentation of at most the given cost can contain. `None` if they are too many.
    fn survivors(
        &self,
        forward: &Penalties,
        row: usize,
        cost: f64,
    ) -> Result<Option<Cells>, Error> {
        let reversed = self.walkable.series().reversed();
        let reversed = Walkable::new(&reversed, self.walkable.cost());
        let penalty = forward.penalties[row];
        let len = forward.table.len();
        let most = cost + TOLERANCE * cost.abs() + penalty * (self.problem.segments as f64 - 1.0);
        let cells = Mutex::new(Vec::new());
        let too_many = AtomicBool::new(false);
        let collect = |backward: &Table, first_end: usize, lo: usize, costs: &[Lanes]| {
            // Reversed, the segment from `len − end` to `len − start`.
            let mut limit = Lanes::all(f64::NEG_INFINITY);
            for j in 0..LANES.min(len + 1 - first_end) {
                limit[j] = most - forward.table.value(row, len - first_end - j);
            }
            for (l, costs) in (lo..).zip(costs) {
                let before = backward.value(0, l);
                if !(0..LANES).any(|j| before + costs[j] <= limit[j]) {
                    continue;
                }
                let Ok(mut cells) = cells.lock() else { return };
                for j in (0..LANES).filter(|&j| before + costs[j] <= limit[j]) {
                    cells.push(Cell {
                        start: (len - first_end - j) as u32,
                        end: (len - l) as u32,
                        cost: costs[j],
                    });
                }
                if cells.len() > MOST_CELLS {
                    too_many.store(true, Ordering::Relaxed);
                    cells.clear();
                }
            }
        };
        let report = self.report();
        let stop_when_too_many = |done| {
            if too_many.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                report(done)
            }
        };
        let recurrence = Recurrence::Penalised(&[penalty]);
        let swept = sweep(
            &reversed,
            self.problem.min_length,
            &recurrence,
            Some(&collect),
            &stop_when_too_many,
        );
        if too_many.into_inner() {
            return Ok(None);
        }
        swept?;
        let cells = Cells::new(cells.into_inner().unwrap_or_default());
        Ok((cells.size(self.problem.segments) <= MOST_VALUES).then_some(cells))
    }
}

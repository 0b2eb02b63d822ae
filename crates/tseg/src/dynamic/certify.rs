//! Many segments of long series: bounds from the penalised problem, and the exact optimum among the segments that these
//! leave.
//!
//! For every penalty `λ`, `g(λ) = min_m C(m) + λ m − λ k` is a lower bound of the least cost `C(k)` of `k` segments, and
//! equals it where the minimum has `k` segments. With `F_λ` and `B_λ` the penalised optima from the left and from the
//! right, no segmentation of cost at most `U` contains a segment with `F_λ(l) + c(l, r) + λ + B_λ(r) > U + λ k`.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::dynamic::sparse::{Cell, Cells};
use crate::dynamic::sweep::{Progress, Recurrence, Table, sweep};
use crate::dynamic::walk::{LANES, Lanes, Walkable};
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

/// Penalties per sweep.
const PENALTIES: usize = 24;

/// Ratio of neighbouring penalties in the first sweep, and of their distances from the target in later ones.
const FIRST_RATIO: f64 = 1.8;
const LATER_RATIO: f64 = 2.5;

/// Sweeps over penalties at most; three are enough on all series tried.
const SWEEPS: usize = 6;

/// Relative difference under which two costs count as equal.
const TOLERANCE: f64 = 1e-10;

/// Segments and values that the last step may hold, 16 and 8 bytes each.
const MOST_CELLS: usize = 5_000_000;
const MOST_VALUES: usize = 16_000_000;

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
    penalties: Vec<f64>,
    table: Table,
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

    pub(crate) fn len(&self) -> usize {
        self.penalties.len()
    }

    pub(crate) fn optimum(&self, walkable: &Walkable<'_>, row: usize) -> Penalised {
        let boundaries = self.table.boundaries(walkable, row);
        Penalised {
            penalty: self.penalties[row],
            cost: walkable.total(&boundaries),
            boundaries,
        }
    }

    /// The row with the largest lower bound of the cost of so many segments, and that bound.
    fn bound(&self, segments: usize, at_most: bool) -> (usize, f64) {
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

/// `largest`, `largest / ratio`, …, and 0.
fn falling(largest: f64, ratio: f64, count: usize) -> Vec<f64> {
    let powers = (0..count).map(|i| largest * ratio.powi(-(i as i32)));
    powers.chain([0.0]).collect()
}

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
    search.narrow()?;
    search.finish()
}

/// Boundaries of so many segments of nearly equal length.
fn even(len: usize, segments: usize) -> Vec<usize> {
    (0..=segments)
        .map(|i| (i as u128 * len as u128 / segments as u128) as usize)
        .collect()
}

impl Search<'_> {
    /// Sweeps over ever closer penalties until one has the number of segments asked for, or none can.
    fn narrow(&mut self) -> Result<(), Error> {
        let mut penalties = first_penalties(self.walkable);
        while self.sweeps < SWEEPS {
            let sweep = Penalties::sweep(
                self.walkable,
                self.problem.min_length,
                penalties,
                &self.report(),
            )?;
            self.sweeps += 1;
            self.learn(sweep);
            penalties = match (&self.fewer, &self.more) {
                (Some(fewer), Some(more)) => {
                    if fewer.segments() == self.problem.segments
                        || more.segments() == self.problem.segments
                    {
                        return Ok(());
                    }
                    let target =
                        (fewer.cost - more.cost) / (more.segments() - fewer.segments()) as f64;
                    let on_edge = fewer.cost
                        + (fewer.segments() as f64 - self.problem.segments as f64) * target;
                    if self.lower_bound() >= on_edge - TOLERANCE * on_edge.abs() {
                        return Ok(());
                    }
                    around(target, fewer.penalty, more.penalty)
                }
                // More segments than without a penalty.
                (Some(_), None) if !self.problem.at_most => self.negative_penalties(),
                _ => return Ok(()),
            };
        }
        Ok(())
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

    /// Takes from a sweep the two optima around the number of segments asked for, found by bisection, and the bound.
    fn learn(&mut self, sweep: Penalties) {
        let (mut low, mut high) = (0, sweep.len());
        while low < high {
            let row = (low + high) / 2;
            let optimum = sweep.optimum(self.walkable, row);
            self.add_path(&optimum.boundaries);
            if optimum.segments() <= self.problem.segments {
                low = row + 1;
            } else {
                high = row;
            }
            self.remember(optimum);
        }
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

    fn finish(mut self) -> Result<Certified, Error> {
        let Problem {
            segments, at_most, ..
        } = self.problem;
        let found = Cells::new(std::mem::take(&mut self.cells)).best(segments, at_most);
        let (mut cost, mut boundaries) = found.ok_or(Error::CostOverflow)?;
        let Some((sweep, row, bound)) = self.bound.take() else {
            return Err(Error::CostOverflow);
        };
        if cost - bound > TOLERANCE * cost.abs()
            && let Some(cells) = self.survivors(&sweep, row, cost)?
            && let Some(best) = cells.best(segments, at_most)
        {
            (cost, boundaries) = best;
            return Ok(Certified {
                boundaries,
                gap: 0.0,
            });
        }
        let gap = cost - bound;
        let gap = if gap > TOLERANCE * cost.abs() {
            gap
        } else {
            0.0
        };
        Ok(Certified { boundaries, gap })
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

/// Penalties between `most` and `least` that close in on `target`, and the target.
fn around(target: f64, most: f64, least: f64) -> Vec<f64> {
    let distances = (1..=PENALTIES as i32 / 2).map(|i| LATER_RATIO.powi(-i));
    let penalties =
        distances.flat_map(|d| [target + d * (most - target), target + d * (least - target)]);
    penalties.chain([target]).collect()
}

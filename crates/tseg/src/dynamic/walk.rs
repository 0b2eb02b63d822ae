//! Costs of the segments that end at a few neighbouring samples, for all starts, in a handful of instructions each.

use crate::cost::Cost;
use crate::dynamic::counts::Tables;
use crate::dynamic::growing_windows::{GrowingWindows, Ranked};
use crate::dynamic::lanes::Lanes;
use crate::dynamic::sparse::Cell;
use crate::series::Series;

/// A series with what every walk over it needs: per variable the ranks of its samples, and tables of small quotients.
pub(crate) struct Walkable<'a> {
    series: &'a Series,
    cost: Cost,
    variables: Vec<Ranked<'a>>,
    tables: Tables,
}

impl<'a> Walkable<'a> {
    pub(crate) fn new(series: &'a Series, cost: Cost) -> Self {
        Self {
            series,
            cost,
            variables: series.variables().iter().map(Ranked::new).collect(),
            tables: Tables::new(series.len()),
        }
    }

    pub(crate) fn series(&self) -> &'a Series {
        self.series
    }

    pub(crate) fn cost(&self) -> Cost {
        self.cost
    }

    /// The cost of all segments of a segmentation.
    pub(crate) fn total(&self, boundaries: &[usize]) -> f64 {
        boundaries
            .windows(2)
            .fold(0.0, |sum, pair| sum + self.between(pair[0], pair[1]))
    }

    pub(crate) fn cell(&self, start: usize, end: usize) -> Cell {
        Cell {
            start: start as u32,
            end: end as u32,
            cost: self.between(start, end),
        }
    }

    /// The exact cost of one segment.
    pub(crate) fn between(&self, start: usize, end: usize) -> f64 {
        self.cost.between(self.series, start, end)
    }

    /// A walk that can be started at any column.
    pub(crate) fn walk(&self) -> Walk<'_> {
        Walk {
            walkable: self,
            first_end: 0,
            start: 0,
            windows: self.variables.iter().map(GrowingWindows::new).collect(),
        }
    }
}

/// For the columns `r₀ … r₀ + LANES − 1`, the costs of `[l, r)` for `l` from `r₀ − 1` downwards.
pub(crate) struct Walk<'a> {
    walkable: &'a Walkable<'a>,
    /// `r₀`.
    first_end: usize,
    /// The samples `start..first_end` have been walked over.
    start: usize,
    windows: Vec<GrowingWindows<'a>>,
}

impl Walk<'_> {
    /// Starts at the columns `first_end..`, before any sample.
    pub(crate) fn begin(&mut self, first_end: usize) {
        for window in &mut self.windows {
            window.drop_front(self.start..self.first_end);
            window.begin(first_end);
        }
        self.first_end = first_end;
        self.start = first_end;
    }

    /// Costs of the segments that start at `lo..start`, one row per start.
    ///
    /// Lanes beyond the end of the series hold arbitrary costs.
    #[inline(always)]
    pub(crate) fn walk_to(&mut self, lo: usize, costs: &mut [Lanes]) {
        costs.fill(Lanes::all(0.0));
        let Walkable {
            cost, ref tables, ..
        } = *self.walkable;
        for window in &mut self.windows {
            window.walk(cost, tables, lo..self.start, costs);
        }
        self.start = lo;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;
    use crate::dynamic::lanes::LANES;
    use crate::series::STEPS_PER_UNIT;

    /// Independent of the walk, from integers.
    fn exact(cost: Cost, series: &Series, start: usize, end: usize) -> f64 {
        let n = (end - start) as i128;
        let terms = series.variables().iter().map(|v| {
            let total: i128 = v.steps[start..end].iter().map(|&x| i128::from(x)).sum();
            let deviations = || {
                v.steps[start..end]
                    .iter()
                    .map(|&x| i128::from(x) * n - total)
            };
            let absolute = deviations().map(i128::abs).sum::<i128>() as f64 / n as f64;
            let squares = deviations().map(|d| d * d).sum::<i128>() as f64 / (n * n) as f64;
            if absolute == 0.0 {
                return 0.0;
            }
            v.weight
                * match cost {
                    Cost::ZScale => absolute / (squares / (n - 1) as f64).sqrt(),
                    Cost::MeanDeviation => absolute / n as f64 / STEPS_PER_UNIT,
                    Cost::SquaredError => squares / STEPS_PER_UNIT / STEPS_PER_UNIT,
                }
        });
        terms.sum()
    }

    fn check(samples: &[f64], other: &[f64], tolerance: f64) {
        let series = Series::new(&[(samples, 1.8), (other, 1.0)]).unwrap();
        for cost in [Cost::ZScale, Cost::MeanDeviation, Cost::SquaredError] {
            let walkable = Walkable::new(&series, cost);
            let mut walk = walkable.walk();
            for first_end in (0..=series.len()).step_by(LANES) {
                walk.begin(first_end);
                let mut costs = vec![Lanes::all(0.0); first_end];
                walk.walk_to(0, &mut costs);
                for (l, row) in costs.iter().enumerate() {
                    for (j, &value) in row.0.iter().enumerate() {
                        let end = first_end + j;
                        if end <= series.len() {
                            let exact = exact(cost, &series, l, end);
                            assert!(
                                (value - exact).abs() <= tolerance * exact.max(1e-300),
                                "{cost:?} {l}..{end}: {value} against {exact}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn costs_are_the_exact_ones() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1 << 31)
        };
        let noise: Vec<f64> = (0..200).map(|_| random()).collect();
        let levels: Vec<f64> = (0..200)
            .map(|i| (f64::from(i / 23) * 0.7).sin().round())
            .collect();
        let waves: Vec<f64> = (0..200)
            .map(|i| 30.0 * (f64::from(i) / 17.0).sin() + 0.01 * random())
            .collect();
        let jumps: Vec<f64> = (0..200)
            .map(|i| f64::from((i / 31) % 3) * 10.0 + 1e-9 * random())
            .collect();
        check(&noise, &levels, 1e-12);
        check(&waves, &noise, 1e-12);
        check(&jumps, &levels, 1e-10);
        check(&levels, &levels, 1e-12);
    }
}

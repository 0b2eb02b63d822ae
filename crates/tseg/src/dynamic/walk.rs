//! Costs of the segments that end at a few neighbouring samples, for all starts, in a handful of instructions each.

use std::ops::{Index, IndexMut};

use crate::cost::Cost;
use crate::dynamic::sparse::Cell;
use crate::series::{STEPS_PER_UNIT, Series, Variable};

/// Columns that are walked together: the segments `[l, r₀), [l, r₀ + 1), …`.
pub(crate) const LANES: usize = 16;

/// One value per column, aligned for vector instructions.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes([f64; LANES]);

impl Lanes {
    pub(crate) fn all(value: f64) -> Self {
        Self([value; LANES])
    }
}

impl Index<usize> for Lanes {
    type Output = f64;
    #[inline(always)]
    fn index(&self, lane: usize) -> &f64 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Lanes {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0[lane]
    }
}

/// A series with what every walk over it needs: per variable the ranks of its samples, and tables of small quotients.
pub(crate) struct Walkable<'a> {
    series: &'a Series,
    cost: Cost,
    variables: Vec<Ranked<'a>>,
    /// `n`, `1 / n` and `1 / (n (n + 1))`; 0 where the divisor is 0.
    number: Vec<f64>,
    inverse: Vec<f64>,
    pair_inverse: Vec<f64>,
}

struct Ranked<'a> {
    variable: &'a Variable,
    /// Position of each sample among the distinct values.
    ranks: Vec<u32>,
    /// The distinct values in order.
    values: Vec<i64>,
}

impl<'a> Walkable<'a> {
    pub(crate) fn new(series: &'a Series, cost: Cost) -> Self {
        let quotient = |n: f64| if n > 0.0 { 1.0 / n } else { 0.0 };
        let number: Vec<f64> = (0..=series.len() + LANES).map(|n| n as f64).collect();
        Self {
            series,
            cost,
            variables: series.variables().iter().map(Ranked::new).collect(),
            inverse: number.iter().map(|&n| quotient(n)).collect(),
            pair_inverse: number.iter().map(|&n| quotient(n * (n + 1.0))).collect(),
            number,
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
            windows: self.variables.iter().map(Window::new).collect(),
        }
    }
}

impl<'a> Ranked<'a> {
    fn new(variable: &'a Variable) -> Self {
        let mut values = variable.steps.clone();
        values.sort_unstable();
        values.dedup();
        let rank = |x: &i64| values.partition_point(|v| v < x) as u32;
        Self {
            ranks: variable.steps.iter().map(rank).collect(),
            values,
            variable,
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
    windows: Vec<Window>,
}

impl Walk<'_> {
    /// Starts at the columns `first_end..`, before any sample.
    pub(crate) fn begin(&mut self, first_end: usize) {
        for (window, ranked) in self.windows.iter_mut().zip(&self.walkable.variables) {
            window.forget(ranked, self.start..self.first_end);
            window.begin(ranked, first_end);
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
        for (window, ranked) in self.windows.iter_mut().zip(&self.walkable.variables) {
            window.walk(self.walkable, ranked, self.first_end, lo..self.start, costs);
        }
        self.start = lo;
    }
}

/// One variable on the windows `[l, r₀ + j)`, where `l` decreases.
///
/// With a pivot `θ`, a sample that is near the means of all windows, `d = x − θ` and `δ_j = x̄_j − θ`,
///
/// `Σ|x − x̄_j| = Σ|d| + δ_j (#{d ≤ 0} − #{d > 0}) + 2 Σ_{0 < d < δ_j} (δ_j − d) + 2 Σ_{δ_j < d ≤ 0} (d − δ_j)`.
///
/// The last two sums run over the few distinct values between the pivot and the means, which a bit set of the values
/// present finds. Sums of `d` are integers and exact below 2⁵³.
struct Window {
    /// Which of the distinct values occur, one bit each.
    present: Vec<u64>,
    /// How often each occurs in `[l, r₀)`, with [`EXTRA`] where it occurs from `r₀` on.
    multiplicity: Vec<u32>,
    /// Ranks of the samples `r₀ …`, of which window `j` has the first `j`.
    extra: [u32; LANES],
    pivot_rank: usize,
    pivot: i64,
    /// `Σd`, `Σ|d|`, `#{d ≤ 0} − #{d > 0}` and `Σ(x − x̄)²`.
    sum: Lanes,
    absolute: Lanes,
    balance: Lanes,
    squares: Lanes,
}

const EXTRA: u32 = 1 << 31;

/// Square of the distance between a mean and the pivot, in standard deviations, beyond which 5 of 16 digits are lost.
const CANCELLING: f64 = 1e10;

impl Window {
    fn new(ranked: &Ranked<'_>) -> Self {
        let zero = Lanes::all(0.0);
        Self {
            present: vec![0; ranked.values.len().div_ceil(64)],
            multiplicity: vec![0; ranked.values.len()],
            extra: [0; LANES],
            pivot_rank: 0,
            pivot: 0,
            sum: zero,
            absolute: zero,
            balance: zero,
            squares: zero,
        }
    }

    /// Removes the samples that the last walk took in.
    fn forget(&mut self, ranked: &Ranked<'_>, walked: std::ops::Range<usize>) {
        for &rank in ranked.ranks[walked].iter().chain(&self.extra) {
            self.multiplicity[rank as usize] = 0;
            self.present[rank as usize / 64] = 0;
        }
    }

    fn begin(&mut self, ranked: &Ranked<'_>, first_end: usize) {
        let last = ranked.ranks.len() - 1;
        self.pivot_rank = ranked.ranks[first_end.saturating_sub(1).min(last)] as usize;
        self.pivot = ranked.values[self.pivot_rank];
        let (mut sum, mut absolute, mut balance, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for j in 0..LANES {
            self.sum[j] = sum;
            self.absolute[j] = absolute;
            self.balance[j] = balance;
            self.squares[j] = squares;
            let sample = (first_end + j).min(last);
            let rank = ranked.ranks[sample];
            self.extra[j] = rank;
            self.multiplicity[rank as usize] = EXTRA;
            self.mark(rank as usize);
            let d = (ranked.values[rank as usize] - self.pivot) as f64;
            let n = j as f64;
            if j > 0 {
                let lag = n * d - sum;
                squares += lag * lag / (n * (n + 1.0));
            }
            sum += d;
            absolute += d.abs();
            balance += sign(d);
        }
    }

    #[inline(always)]
    fn mark(&mut self, rank: usize) {
        self.present[rank / 64] |= 1 << (rank % 64);
    }

    #[inline(always)]
    fn walk(
        &mut self,
        walkable: &Walkable<'_>,
        ranked: &Ranked<'_>,
        first_end: usize,
        starts: std::ops::Range<usize>,
        costs: &mut [Lanes],
    ) {
        let lo = starts.start;
        let weight = ranked.variable.weight;
        for l in starts.rev() {
            // Window `j` has `n + j` samples before and `n + 1 + j` after this one.
            let n = first_end - 1 - l;
            let before = lanes(&walkable.number[n..]);
            self.insert(ranked, l, before, lanes(&walkable.pair_inverse[n..]));
            let inverse = lanes(&walkable.inverse[n + 1..]);
            let mut terms = Lanes::all(0.0);
            match walkable.cost {
                Cost::ZScale => {
                    let count = lanes(&walkable.number[n + 1..]);
                    let absolute = self.absolute_deviation(ranked, first_end, l, inverse, count);
                    for j in 0..LANES {
                        terms[j] = weight * absolute[j] * (before[j] / self.squares[j]).sqrt();
                    }
                }
                Cost::MeanDeviation => {
                    let count = lanes(&walkable.number[n + 1..]);
                    let absolute = self.absolute_deviation(ranked, first_end, l, inverse, count);
                    let weight = weight / STEPS_PER_UNIT;
                    for j in 0..LANES {
                        terms[j] = weight * absolute[j] * inverse[j];
                    }
                }
                Cost::SquaredError => {
                    let weight = weight / (STEPS_PER_UNIT * STEPS_PER_UNIT);
                    for j in 0..LANES {
                        terms[j] = weight * self.squares[j];
                    }
                }
            }
            let run_end = ranked.variable.run_end[l];
            if run_end >= first_end {
                // These windows are constant.
                for j in 0..LANES.min(run_end - first_end + 1) {
                    self.squares[j] = 0.0;
                    terms[j] = 0.0;
                }
            }
            let row = &mut costs[l - lo];
            for j in 0..LANES {
                row[j] += terms[j];
            }
        }
    }

    /// Takes in sample `l`, where window `j` has `before[j]` samples and `pair_inverse[j] = 1 / (n (n + 1))`.
    #[inline(always)]
    fn insert(
        &mut self,
        ranked: &Ranked<'_>,
        l: usize,
        before: &[f64; LANES],
        pair_inverse: &[f64; LANES],
    ) {
        let rank = ranked.ranks[l] as usize;
        self.multiplicity[rank] += 1;
        self.mark(rank);
        let d = (ranked.variable.steps[l] - self.pivot) as f64;
        let sign = sign(d);
        for j in 0..LANES {
            // n times the deviation of the sample from the mean of those before; Welford's update of the squares.
            let lag = before[j] * d - self.sum[j];
            self.squares[j] += lag * lag * pair_inverse[j];
            self.sum[j] += d;
            self.absolute[j] += d.abs();
            self.balance[j] += sign;
        }
    }

    /// `Σ|x − x̄|` of the windows `[l, first_end + j)`, in grid steps.
    #[inline(always)]
    fn absolute_deviation(
        &mut self,
        ranked: &Ranked<'_>,
        first_end: usize,
        l: usize,
        inverse: &[f64; LANES],
        count: &[f64; LANES],
    ) -> Lanes {
        self.follow_mean(ranked, inverse, count);
        let mut deviation = Lanes::all(0.0);
        let mut delta = Lanes::all(0.0);
        for j in 0..LANES {
            delta[j] = self.sum[j] * inverse[j];
            deviation[j] = self.absolute[j] + delta[j] * self.balance[j];
        }
        let (least, most) = extremes(&delta);
        let mut rank = self.pivot_rank;
        while let Some(above) = next_above(&self.present, rank) {
            let d = (ranked.values[above] - self.pivot) as f64;
            if d >= most {
                break;
            }
            let twice = self.twice_multiplicity(above);
            for j in 0..LANES {
                deviation[j] += twice[j] * larger(delta[j] - d, 0.0);
            }
            rank = above;
        }
        let mut below = Some(self.pivot_rank);
        while let Some(rank) = below {
            let d = (ranked.values[rank] - self.pivot) as f64;
            if d <= least {
                break;
            }
            let twice = self.twice_multiplicity(rank);
            for j in 0..LANES {
                deviation[j] += twice[j] * larger(d - delta[j], 0.0);
            }
            below = next_below(&self.present, rank);
        }
        // The first window has the least squares.
        let farthest = larger(most, -least);
        if farthest * farthest * count[0] > CANCELLING * self.squares[0] {
            self.replace_cancelled(ranked, first_end, l, &delta, &mut deviation);
        }
        deviation
    }

    /// Where a mean is very far from the pivot for the spread of its window, the sum above has cancelled: scans.
    #[cold]
    fn replace_cancelled(
        &self,
        ranked: &Ranked<'_>,
        first_end: usize,
        l: usize,
        delta: &Lanes,
        deviation: &mut Lanes,
    ) {
        let constant_until = ranked.variable.run_end[l];
        for j in 0..LANES {
            let end = first_end + j;
            let count = (end - l) as f64;
            if constant_until < end
                && end <= ranked.ranks.len()
                && delta[j] * delta[j] * count > CANCELLING * self.squares[j]
            {
                deviation[j] = exact_absolute_deviation(ranked.variable, l, end);
            }
        }
    }

    /// Moves the pivot to the largest value that is at most the mean of the middle window.
    #[inline(always)]
    fn follow_mean(&mut self, ranked: &Ranked<'_>, inverse: &[f64; LANES], count: &[f64; LANES]) {
        const MIDDLE: usize = LANES / 2;
        while let Some(above) = next_above(&self.present, self.pivot_rank) {
            let step = ranked.values[above] - self.pivot;
            if step as f64 > self.sum[MIDDLE] * inverse[MIDDLE] {
                break;
            }
            let crossed = self.twice_multiplicity(above);
            self.shift(step, count);
            for j in 0..LANES {
                self.balance[j] += crossed[j];
            }
            self.pivot_rank = above;
        }
        while self.sum[MIDDLE] < 0.0 {
            let Some(below) = next_below(&self.present, self.pivot_rank) else {
                break;
            };
            let step = ranked.values[below] - self.pivot;
            let crossed = self.twice_multiplicity(self.pivot_rank);
            for j in 0..LANES {
                self.balance[j] -= crossed[j];
            }
            self.shift(step, count);
            self.pivot_rank = below;
        }
    }

    /// Moves the pivot by `step`, with no sample strictly between.
    #[inline(always)]
    fn shift(&mut self, step: i64, count: &[f64; LANES]) {
        self.pivot += step;
        let step = step as f64;
        for j in 0..LANES {
            self.absolute[j] += step * self.balance[j];
            self.sum[j] -= count[j] * step;
        }
    }

    #[inline(always)]
    fn twice_multiplicity(&self, rank: usize) -> Lanes {
        let multiplicity = self.multiplicity[rank];
        let mut twice = Lanes::all(2.0 * f64::from(multiplicity & !EXTRA));
        if multiplicity & EXTRA != 0 {
            self.add_extra(rank, &mut twice);
        }
        twice
    }

    #[cold]
    fn add_extra(&self, rank: usize, twice: &mut Lanes) {
        for (e, _) in self
            .extra
            .iter()
            .enumerate()
            .filter(|&(_, &r)| r as usize == rank)
        {
            for value in &mut twice.0[e + 1..] {
                *value += 2.0;
            }
        }
    }
}

/// `Σ|x − x̄|` in grid steps, from integers.
fn exact_absolute_deviation(variable: &Variable, start: usize, end: usize) -> f64 {
    let n = (end - start) as i128;
    let total = i128::from(variable.sums[end] - variable.sums[start]);
    let deviation = |&x: &i64| (i128::from(x) * n - total).abs();
    variable.steps[start..end]
        .iter()
        .map(deviation)
        .sum::<i128>() as f64
        / n as f64
}

#[inline(always)]
fn sign(d: f64) -> f64 {
    if d <= 0.0 { 1.0 } else { -1.0 }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The first values of a longer slice.
#[inline(always)]
fn lanes(values: &[f64]) -> &[f64; LANES] {
    match values.first_chunk() {
        Some(lanes) => lanes,
        None => &[0.0; LANES],
    }
}

#[inline(always)]
fn extremes(values: &Lanes) -> (f64, f64) {
    let (mut least, mut most) = (*values, *values);
    let mut half = LANES / 2;
    while half > 0 {
        for j in 0..half {
            least[j] = smaller(least[j], least[j + half]);
            most[j] = larger(most[j], most[j + half]);
        }
        half /= 2;
    }
    (least[0], most[0])
}

/// The smallest member above `rank`.
#[inline(always)]
fn next_above(present: &[u64], rank: usize) -> Option<usize> {
    let mut word = rank / 64;
    // Two shifts, as one by 64 is not defined.
    let mut bits = present[word] & (u64::MAX << (rank % 64) << 1);
    while bits == 0 {
        word += 1;
        bits = *present.get(word)?;
    }
    Some(64 * word + bits.trailing_zeros() as usize)
}

/// The largest member below `rank`.
#[inline(always)]
fn next_below(present: &[u64], rank: usize) -> Option<usize> {
    let mut word = rank / 64;
    let mut bits = present[word] & !(u64::MAX << (rank % 64));
    while bits == 0 {
        word = word.checked_sub(1)?;
        bits = present[word];
    }
    Some(64 * word + 63 - bits.leading_zeros() as usize)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

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

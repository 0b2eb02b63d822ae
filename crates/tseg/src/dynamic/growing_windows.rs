//! The deviations of one variable on windows that grow to the left.

use std::ops::Range;

use crate::cost::Cost;
use crate::deviation::exact_absolute_deviation;
use crate::dynamic::counts::{Counts, Tables};
use crate::dynamic::lanes::{LANES, Lanes, extremes, larger};
use crate::dynamic::rank_set::RankSet;
use crate::series::{STEPS_PER_UNIT, Variable};

/// A variable with its distinct values.
pub(crate) struct Ranked<'a> {
    variable: &'a Variable,
    /// Position of each sample among the distinct values.
    ranks: Vec<u32>,
    /// The distinct values in order.
    values: Vec<i64>,
}

impl<'a> Ranked<'a> {
    pub(crate) fn new(variable: &'a Variable) -> Self {
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

/// One variable on the windows `[l, r₀ + j)`, where `l` decreases.
///
/// With a pivot `θ`, a sample that is near the means of all windows, `d = x − θ` and `δ_j = x̄_j − θ`,
///
/// `Σ|x − x̄_j| = Σ|d| + δ_j (#{d ≤ 0} − #{d > 0}) + 2 Σ_{0 < d < δ_j} (δ_j − d) + 2 Σ_{δ_j < d ≤ 0} (d − δ_j)`.
///
/// The last two sums run over the few distinct values between the pivot and the means, which a bit set of the values
/// present finds. Sums of `d` are integers and exact below 2⁵³.
pub(crate) struct GrowingWindows<'a> {
    ranked: &'a Ranked<'a>,
    /// `r₀`.
    first_end: usize,
    /// Which of the distinct values occur.
    present: RankSet,
    /// How often each occurs in `[l, r₀)`, with [`EXTRA`] where it occurs from `r₀` on.
    multiplicity: Vec<u32>,
    /// Ranks of the samples `r₀ …`, of which window `j` has the first `j`.
    extra: [u32; LANES],
    /// From which start on each window is constant; rises with the window.
    constant_since: [usize; LANES],
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

impl<'a> GrowingWindows<'a> {
    pub(crate) fn new(ranked: &'a Ranked<'a>) -> Self {
        let zero = Lanes::all(0.0);
        Self {
            ranked,
            first_end: 0,
            present: RankSet::new(ranked.values.len()),
            multiplicity: vec![0; ranked.values.len()],
            extra: [0; LANES],
            constant_since: [0; LANES],
            pivot_rank: 0,
            pivot: 0,
            sum: zero,
            absolute: zero,
            balance: zero,
            squares: zero,
        }
    }

    /// Removes the samples that the last walk took in.
    pub(crate) fn drop_front(&mut self, walked: Range<usize>) {
        let ranked = self.ranked;
        for &rank in ranked.ranks[walked].iter().chain(&self.extra) {
            self.multiplicity[rank as usize] = 0;
            self.present.clear_near(rank as usize);
        }
    }

    /// Starts at the windows that end at `first_end, first_end + 1, …`, with no sample before.
    pub(crate) fn begin(&mut self, first_end: usize) {
        self.first_end = first_end;
        let ranked = self.ranked;
        let last = ranked.ranks.len() - 1;
        self.pivot_rank = ranked.ranks[first_end.saturating_sub(1).min(last)] as usize;
        self.pivot = ranked.values[self.pivot_rank];
        let (mut sum, mut absolute, mut balance, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for j in 0..LANES {
            self.sum[j] = sum;
            self.absolute[j] = absolute;
            self.balance[j] = balance;
            self.squares[j] = squares;
            self.constant_since[j] = ranked.variable.constant_since(first_end + j);
            let sample = (first_end + j).min(last);
            let rank = ranked.ranks[sample];
            self.extra[j] = rank;
            self.multiplicity[rank as usize] = EXTRA;
            self.present.insert(rank as usize);
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

    /// Adds the variable's part of the costs of the segments that start at `starts`, one row per start.
    #[inline(always)]
    pub(crate) fn walk(
        &mut self,
        cost: Cost,
        tables: &Tables,
        starts: Range<usize>,
        costs: &mut [Lanes],
    ) {
        for (l, row) in starts.zip(costs).rev() {
            let counts = tables.counts(self.first_end - 1 - l);
            self.insert(l, &counts);
            let mut terms = self.terms(cost, l, &counts);
            for j in 0..LANES {
                if l < self.constant_since[j] {
                    break;
                }
                self.squares[j] = 0.0;
                terms[j] = 0.0;
            }
            for j in 0..LANES {
                row[j] += terms[j];
            }
        }
    }

    #[inline(always)]
    fn terms(&mut self, cost: Cost, l: usize, counts: &Counts<'_>) -> Lanes {
        let weight = self.ranked.variable.weight;
        let mut terms = Lanes::all(0.0);
        match cost {
            Cost::ZScale => {
                let absolute = self.absolute_deviation(l, counts);
                for j in 0..LANES {
                    terms[j] = weight * absolute[j] * (counts.before[j] / self.squares[j]).sqrt();
                }
            }
            Cost::MeanDeviation => {
                let absolute = self.absolute_deviation(l, counts);
                for j in 0..LANES {
                    terms[j] = weight / STEPS_PER_UNIT * absolute[j] * counts.inverse[j];
                }
            }
            Cost::SquaredError => {
                for j in 0..LANES {
                    terms[j] = weight / (STEPS_PER_UNIT * STEPS_PER_UNIT) * self.squares[j];
                }
            }
        }
        terms
    }

    #[inline(always)]
    fn insert(&mut self, l: usize, counts: &Counts<'_>) {
        let rank = self.ranked.ranks[l] as usize;
        self.multiplicity[rank] += 1;
        self.present.insert(rank);
        let d = (self.ranked.variable.steps[l] - self.pivot) as f64;
        let sign = sign(d);
        for j in 0..LANES {
            // n times the deviation of the sample from the mean of those before; Welford's update of the squares.
            let lag = counts.before[j] * d - self.sum[j];
            self.squares[j] += lag * lag * counts.pair_inverse[j];
            self.sum[j] += d;
            self.absolute[j] += d.abs();
            self.balance[j] += sign;
        }
    }

    /// `Σ|x − x̄|` of the windows `[l, first_end + j)`, in grid steps.
    #[inline(always)]
    fn absolute_deviation(&mut self, l: usize, counts: &Counts<'_>) -> Lanes {
        self.follow_mean(counts);
        let values = &self.ranked.values;
        let mut deviation = Lanes::all(0.0);
        let mut delta = Lanes::all(0.0);
        for j in 0..LANES {
            delta[j] = self.sum[j] * counts.inverse[j];
            deviation[j] = self.absolute[j] + delta[j] * self.balance[j];
        }
        let (least, most) = extremes(&delta);
        let mut rank = self.pivot_rank;
        while let Some(above) = self.present.next_above(rank) {
            let d = (values[above] - self.pivot) as f64;
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
            let d = (values[rank] - self.pivot) as f64;
            if d <= least {
                break;
            }
            let twice = self.twice_multiplicity(rank);
            for j in 0..LANES {
                deviation[j] += twice[j] * larger(d - delta[j], 0.0);
            }
            below = self.present.next_below(rank);
        }
        // The first window has the least squares.
        let farthest = larger(most, -least);
        if farthest * farthest * counts.after[0] > CANCELLING * self.squares[0] {
            self.replace_cancelled(l, &delta, &mut deviation);
        }
        deviation
    }

    /// Where a mean is very far from the pivot for the spread of its window, the sum above has cancelled: scans.
    #[cold]
    fn replace_cancelled(&self, l: usize, delta: &Lanes, deviation: &mut Lanes) {
        let ranked = self.ranked;
        for j in 0..LANES {
            let end = self.first_end + j;
            let count = (end - l) as f64;
            if l < self.constant_since[j]
                && end <= ranked.ranks.len()
                && delta[j] * delta[j] * count > CANCELLING * self.squares[j]
            {
                deviation[j] = exact_absolute_deviation(ranked.variable, l, end);
            }
        }
    }

    /// Moves the pivot to the largest value that is at most the mean of the middle window.
    #[inline(always)]
    fn follow_mean(&mut self, counts: &Counts<'_>) {
        let values = &self.ranked.values;
        const MIDDLE: usize = LANES / 2;
        while let Some(above) = self.present.next_above(self.pivot_rank) {
            let step = values[above] - self.pivot;
            if step as f64 > self.sum[MIDDLE] * counts.inverse[MIDDLE] {
                break;
            }
            let crossed = self.twice_multiplicity(above);
            self.shift(step, counts);
            for j in 0..LANES {
                self.balance[j] += crossed[j];
            }
            self.pivot_rank = above;
        }
        while self.sum[MIDDLE] < 0.0 {
            let Some(below) = self.present.next_below(self.pivot_rank) else {
                break;
            };
            let step = values[below] - self.pivot;
            let crossed = self.twice_multiplicity(self.pivot_rank);
            for j in 0..LANES {
                self.balance[j] -= crossed[j];
            }
            self.shift(step, counts);
            self.pivot_rank = below;
        }
    }

    /// Moves the pivot by `step`, with no sample strictly between.
    #[inline(always)]
    fn shift(&mut self, step: i64, counts: &Counts<'_>) {
        self.pivot += step;
        let step = step as f64;
        for j in 0..LANES {
            self.absolute[j] += step * self.balance[j];
            self.sum[j] -= counts.after[j] * step;
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

#[inline(always)]
fn sign(d: f64) -> f64 {
    if d <= 0.0 { 1.0 } else { -1.0 }
}

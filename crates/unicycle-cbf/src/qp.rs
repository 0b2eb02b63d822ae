//! The quadratic program of one control step, solved by a dual active set without heap memory.
//!
//! ```text
//! minimise    Σ_i w_i z_i²          w_i > 0,  i = 1 … N
//! subject to  a_j · z ≤ b_j         j = 1 … m ≤ 20
//! ```
//!
//! With `y = W^(1/2) z` the Hessian becomes the identity: the optimum is the point of a polyhedron
//! that is nearest to the origin. Every row is divided by the length of its normal in `y`,
//! `â_j · y ≤ b̂_j` with `|â_j| = 1`, so the units of rows and variables do not matter.
//!
//! The method starts from `y = 0` without active rows and adds the most violated row, the first of
//! equals, dropping rows whose multipliers would turn negative on the way. Every iterate is the
//! optimum for its active rows and the objective only grows; rows that contradict each other show
//! by a combination that no point satisfies. The active normals are kept as `QR`, by Gram-Schmidt,
//! twice where much cancels. With `Rᵀ c = b̂` the optimum for the active rows is `y = Q c`, its multipliers are
//! `−R⁻¹ c`. Both are refined once against the program as given.
//!
//! D. Goldfarb, A. Idnani, A numerically stable dual method for solving strictly convex quadratic
//! programs, Mathematical Programming 27, 1983.

mod basis;
mod scaled;

use std::array::from_fn;
use std::ops::Range;

use basis::Basis;
use scaled::{FEASIBILITY, Scaled, dot, norm};

/// Variables of the controller, `z = [u_l, u_a, δ1, δ2, δ3]`.
pub const VARIABLES: usize = 5;

/// Most rows that [`solve`] takes.
pub const MAX_ROWS: usize = 25;

/// A normal is a combination of others up to here, relative to the sum of the factors in it.
const ROUND_OFF: f64 = 32.0 * f64::EPSILON;

/// Rows that contradict each other pass up to here, relative to `|b̂_j| + |y|`, if that is round-off.
const MOST_ROUND_OFF: f64 = 5e-10;

/// Weights that leave room for all squares.
const WEIGHTS: Range<f64> = 1e-60..1e60;

/// One row `a · z ≤ b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<const N: usize = VARIABLES> {
    /// Factors of the variables
    pub a: [f64; N],
    /// Right side
    pub b: f64,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub enum Status {
    /// The optimum was found
    Optimal,
    /// No point satisfies all rows
    Infeasible,
    /// `10 (m + N)` changes of the active set were not enough
    IterationLimit,
    /// A number is NaN or infinite, a weight is not positive, or the range of numbers is exceeded
    NotFinite,
    /// There are more than [`MAX_ROWS`] rows
    TooManyRows,
}

/// Optimum of a quadratic program with its multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution<const N: usize = VARIABLES> {
    /// How the solve ended
    pub status: Status,
    /// The optimum; zero unless optimal
    pub z: [f64; N],
    /// `λ ≥ 0` of the rows as given, `2 w_i z_i + Σ_j λ_j a_ji = 0`. If infeasible the proof of it:
    /// `λ ≥ 0` with `Σ_j λ_j a_j = 0` and `Σ_j λ_j b_j < 0`. Otherwise zero
    pub multipliers: [f64; MAX_ROWS],
    /// Bit `j` stands for row `j` in the final active set
    pub active: u32,
    /// Changes of the active set
    pub iterations: u32,
}

impl<const N: usize> Default for Solution<N> {
    /// Nothing solved yet: no iteration was allowed.
    fn default() -> Self {
        Self::ended(Status::IterationLimit, 0)
    }
}

impl<const N: usize> Solution<N> {
    fn ended(status: Status, iterations: u32) -> Self {
        Self {
            status,
            z: [0.0; N],
            multipliers: [0.0; MAX_ROWS],
            active: 0,
            iterations,
        }
    }

    /// `Σ w_i z_i²`
    #[must_use]
    pub fn objective(&self, weights: &[f64; N]) -> f64 {
        weights.iter().zip(&self.z).map(|(w, z)| w * z * z).sum()
    }

    /// Whether a row is in the final active set.
    #[must_use]
    pub fn is_active(&self, row: usize) -> bool {
        row < MAX_ROWS && self.active >> row & 1 == 1
    }

    /// How far the solution is from the conditions of Karush, Kuhn and Tucker: the largest of
    ///
    /// - stationarity, `|y + Σ_j λ̂_j â_j|_∞ / s`
    /// - violation, `(â_j · y − b̂_j) / (|y| + |b̂_j|)`
    /// - negative multipliers, `−λ̂_j / s`
    /// - complementarity, `|λ̂_j| / s · |â_j · y − b̂_j| / (|y| + |b̂_j|)`
    ///
    /// with `y`, `â_j` and `b̂_j` as in the module documentation, `λ̂_j` the multipliers of these rows
    /// for `½ |y|²`, and `s = max(|y|, max_j |λ̂_j|)`. It has no unit: with a residual `ε` the solution
    /// is exact for rows that differ by a relative `ε`. The violation of a row without a normal is
    /// `−b_j`. NaN for numbers that [`solve`] refuses.
    #[must_use]
    pub fn kkt_residual(&self, weights: &[f64; N], rows: &[Row<N>]) -> f64 {
        let inverse_root = weights.map(|w| w.sqrt().recip());
        let mut scaled = Scaled::new(rows.len());
        match scaled.fill(&inverse_root, rows) {
            Err((Status::Infeasible, _)) => return f64::INFINITY,
            Err(_) => return f64::NAN,
            Ok(()) => {}
        }
        let y: [f64; N] = from_fn(|i| self.z[i] / inverse_root[i]);
        let length = norm(&y);
        let (mut gradient, mut size, mut worst, mut by_size) = (y, length, 0.0, 0.0);
        for (j, row) in rows.iter().enumerate() {
            let (normal, offset) = (&scaled.normals[j], scaled.offsets[j]);
            if scaled.limits[j].is_infinite() {
                worst = most(worst, -row.b);
                continue;
            }
            let multiplier = 0.5 * self.multipliers[j] / scaled.scales[j];
            let reach = (length + offset.abs()).max(f64::MIN_POSITIVE);
            let excess = (dot(normal, &y) - offset) / reach;
            worst = most(worst, excess);
            size = most(size, multiplier.abs());
            by_size = most(by_size, most(multiplier.abs() * excess.abs(), -multiplier));
            gradient = from_fn(|i| gradient[i] + multiplier * normal[i]);
        }
        by_size = gradient
            .iter()
            .fold(by_size, |worst, g| most(worst, g.abs()));
        most(worst, by_size / size.max(f64::MIN_POSITIVE))
    }
}

/// The larger one, NaN if one is NaN.
fn most(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// How the changes of the active set end.
enum End<const N: usize> {
    Optimal,
    /// The normal of a row is this combination of the active ones, without positive factors
    Infeasible(usize, [f64; N]),
    IterationLimit,
}

/// Changes the active set until no row is violated.
#[inline(always)]
fn settle<const N: usize>(
    basis: &mut Basis<N>,
    scaled: &mut Scaled<N>,
    iterations: &mut u32,
) -> End<N> {
    let limit = 10 * (scaled.count + N);
    let mut entering = None;
    loop {
        let violated = || scaled.most_violated(&basis.point());
        entering = entering.or_else(violated);
        let Some(row) = entering else {
            let (negated, _) = basis.back(basis.c, [0.0; N]);
            match negated.iter().take(basis.count).position(|l| *l > 0.0) {
                None => return End::Optimal,
                Some(_) if *iterations as usize == limit => return End::IterationLimit,
                Some(k) => basis.drop(k, scaled),
            }
            *iterations += 1;
            scaled.admit_passed();
            continue;
        };
        let offset = scaled.offsets[row];
        let split = basis.split(&scaled.normals[row]);
        let (factors, negated) = basis.back(split.along, basis.c);
        let round_off = ROUND_OFF * factors.iter().fold(1.0, |sum, f| sum + f.abs());
        let violation = dot(&split.along, &basis.c) - offset;
        let dependent = basis.count == N || split.across_squared <= round_off * round_off;
        if *iterations as usize == limit {
            return End::IterationLimit;
        }
        *iterations += 1;
        let full = violation / split.across_squared;
        let mut step = if dependent { f64::INFINITY } else { full };
        let mut leaving = None;
        for (k, factor) in factors.iter().enumerate().take(basis.count) {
            if *factor > round_off && -negated[k] < step * factor {
                step = -negated[k] / factor;
                leaving = Some(k);
            }
        }
        match leaving {
            Some(k) => basis.drop(k, scaled),
            None if dependent => {
                let reach = offset.abs() + norm(&basis.c);
                if violation > round_off.min(MOST_ROUND_OFF) * reach {
                    return End::Infeasible(row, factors);
                }
                scaled.pass(row);
                entering = None;
            }
            None => {
                basis.push(row, offset, &split);
                scaled.limits[row] = f64::INFINITY;
                scaled.admit_passed();
                entering = None;
            }
        }
    }
}

/// Refines point and multipliers of the final active set once against the program as given.
#[inline(always)]
fn refined<const N: usize>(
    basis: &Basis<N>,
    scales: &[f64; MAX_ROWS],
    inverse_root: &[f64; N],
    weights: &[f64; N],
    rows: &[Row<N>],
) -> Solution<N> {
    let active = || basis.rows.iter().copied().enumerate().take(basis.count);
    let y = basis.point();
    let z: [f64; N] = from_fn(|i| y[i] * inverse_root[i]);
    let mut residual = [0.0; N];
    for (k, j) in active() {
        residual[k] = (rows[j].b - dot(&rows[j].a, &z)) * scales[j];
    }
    let mut change = basis.combined(basis.forward(residual));
    // A larger one is round-off itself, and other rows would pay for it.
    if norm(&change) > FEASIBILITY * norm(&y) {
        change = [0.0; N];
    }
    let z: [f64; N] = from_fn(|i| z[i] + change[i] * inverse_root[i]);

    let (negated, _) = basis.back(basis.c, [0.0; N]);
    let mut gradient: [f64; N] = from_fn(|i| weights[i] * z[i]);
    for (k, j) in active() {
        let multiplier = -negated[k] * scales[j];
        gradient = from_fn(|i| gradient[i] + multiplier * rows[j].a[i]);
    }
    let gradient = from_fn(|i| gradient[i] * inverse_root[i]);
    let (change, _) = basis.back(basis.projected(&gradient), [0.0; N]);
    let mut solution = Solution::ended(Status::Optimal, 0);
    solution.z = z;
    for (k, j) in active() {
        solution.multipliers[j] = 2.0 * scales[j] * (-negated[k] - change[k]).max(0.0);
        solution.active |= 1 << j;
    }
    solution
}

/// Solves the program: minimise `Σ weights_i z_i²` subject to `rows`.
///
/// The order of the rows changes the result by round-off only. Rows that contradict each other by
/// no more than round-off count as feasible.
#[must_use]
pub fn solve<const N: usize>(weights: &[f64; N], rows: &[Row<N>]) -> Solution<N> {
    if !weights.iter().all(|w| WEIGHTS.contains(w)) {
        return Solution::ended(Status::NotFinite, 0);
    }
    let inverse_root = weights.map(|w| w.sqrt().recip());
    let mut scaled = Scaled::new(rows.len());
    if let Err((status, row)) = scaled.fill(&inverse_root, rows) {
        let mut solution = Solution::ended(status, 0);
        if status == Status::Infeasible {
            solution.multipliers[row] = 1.0;
        }
        return solution;
    }
    let (mut basis, mut iterations) = (Basis::new(), 0);
    let end = settle(&mut basis, &mut scaled, &mut iterations);
    let mut solution = match end {
        End::Optimal => refined(&basis, &scaled.scales, &inverse_root, weights, rows),
        End::IterationLimit => Solution::ended(Status::IterationLimit, 0),
        End::Infeasible(row, factors) => {
            let mut solution = Solution::ended(Status::Infeasible, 0);
            solution.multipliers[row] = scaled.scales[row];
            for (&row, factor) in basis.rows.iter().zip(factors).take(basis.count) {
                solution.multipliers[row] = scaled.scales[row] * (-factor).max(0.0);
            }
            solution
        }
    };
    solution.iterations = iterations;
    if !(norm(&basis.c) + norm(&solution.z)).is_finite() {
        return Solution::ended(Status::NotFinite, iterations);
    }
    debug_assert!({
        let residual = solution.kkt_residual(weights, rows);
        solution.status != Status::Optimal || residual.is_nan() || residual <= 1e-7
    });
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-15 * expected.abs()
    }

    #[test]
    fn one_row_is_a_projection() {
        let (weights, row) = (
            [2.0, 8.0],
            Row {
                a: [-1.0, -2.0],
                b: -3.0,
            },
        );
        let solution = solve(&weights, &[row]);
        // z = t W⁻¹ a with a · z = b
        assert_eq!(solution.status, Status::Optimal);
        assert!(near(solution.z[0], 1.5) && near(solution.z[1], 0.75));
        assert!(near(solution.multipliers[0], 6.0) && near(solution.objective(&weights), 9.0));
        assert!(solution.is_active(0) && !solution.is_active(1) && !solution.is_active(99));
    }

    #[test]
    fn the_later_row_takes_the_place_of_the_first() {
        let rows = [
            Row {
                a: [-1.0, 0.0],
                b: -1.0,
            },
            Row {
                a: [-1.0, -0.1],
                b: -2.0,
            },
        ];
        let solution = solve(&[1.0, 1.0], &rows);
        assert_eq!((solution.status, solution.active), (Status::Optimal, 0b10));
        assert!(solution.kkt_residual(&[1.0, 1.0], &rows) <= 1e-15);
    }

    #[test]
    fn contradictions_come_with_a_proof() {
        let rows = [
            Row {
                a: [1e-3],
                b: -1e-3,
            },
            Row { a: [-2e5], b: -1e5 },
        ];
        let solution = solve(&[4.0], &rows);
        assert_eq!(solution.status, Status::Infeasible);
        let sum = |f: fn(&Row<1>) -> f64| -> f64 {
            rows.iter()
                .zip(solution.multipliers)
                .map(|(row, l)| l * f(row))
                .sum()
        };
        assert!(sum(|row| row.a[0]).abs() <= 1e-15 && sum(|row| row.b) < 0.0);
    }

    #[test]
    fn numbers_at_the_ends_of_their_range_have_a_status() {
        for weight in [f64::MIN_POSITIVE, 5e-324, 1.0, f64::MAX] {
            for a in [0.0, 5e-324, 1e-300, 1e-160, 1.0, 1e160, f64::MAX] {
                for b in [0.0, -5e-324, -1e-300, -1.0, -1e160, f64::MIN] {
                    let rows = [Row { a: [a, 1.0], b }, Row { a: [a, a], b: -b }];
                    let solution = solve(&[weight, 1.0], &rows);
                    let is_finite = solution.z.iter().all(|z| z.is_finite());
                    let are_multipliers = solution.multipliers.iter().all(|l| *l >= 0.0);
                    assert!(is_finite && are_multipliers, "{weight:e} {rows:?}");
                    assert_ne!(solution.status, Status::TooManyRows);
                }
            }
        }
    }
}

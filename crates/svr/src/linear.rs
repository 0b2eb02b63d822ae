//! Interior point method for the linear kernel.
//!
//! In the multipliers `u = α*`, `l = α` of (4.19) and `ω = (w, b)`, with `x̃ = (x, 1)` and `r = y − x̃·ω`:
//!
//! ```text
//! z_u − t_u = ε − r,   z_l − t_l = ε + r,   w = Σ (u − l) x,   Σ (u − l) = 0
//! u z_u = (c − u) t_u = l z_l = (c − l) t_l = μ,   c = C·weight
//! ```
//!
//! Newton's step needs `(diag(1, …, 1, 0) + Σ D_i x̃_i x̃_iᵀ) Δω = Σ q_i x̃_i` alone, a system of d + 1. It starts at
//! `u = l = c/2`, `w = 0`, where all but the products hold, and the steps keep them; so the sum of the products is the
//! duality gap. Predictor and corrector are S. Mehrotra's (SIAM Journal on Optimization 2, 1992).

use faer::linalg::solvers::{Llt, Solve};
use faer::{Col, ColRef, Side};

use crate::Status;
use crate::deadline::Deadline;
use crate::linear_rows::LinearRows;
use crate::multipliers::{Multipliers, Step};

/// What one fit is given: response, bounds `c`, half width of the tube.
pub(crate) struct Target<'a> {
    pub(crate) response: &'a [f64],
    pub(crate) bound: &'a [f64],
    pub(crate) tube_epsilon: f64,
}

/// A solution in scaled predictors.
pub(crate) struct LinearSolution {
    /// `w`, then `b`.
    pub(crate) omega: Vec<f64>,
    /// `β = α* − α`.
    pub(crate) beta: Vec<f64>,
    pub(crate) status: Status,
    pub(crate) iterations: usize,
}

/// How far a step goes toward the nearest bound.
const TO_THE_BOUND: f64 = 0.995;

impl LinearRows {
    /// Minimises (4.17) until the duality gap is at most `tolerance` of the objective.
    pub(crate) fn solve(
        &self,
        target: &Target<'_>,
        tolerance: f64,
        deadline: &Deadline,
    ) -> LinearSolution {
        let counts: Vec<bool> = target.bound.iter().map(|&c| c > 0.0).collect();
        if counts.iter().all(|&counts| counts) {
            return self.solve_inside(target, tolerance, deadline);
        }
        // Between equal bounds there is no inside.
        let rows = self.values.chunks_exact(self.columns).zip(&counts);
        let rows = rows.filter(|(_, counts)| **counts).flat_map(|(row, _)| row);
        let rows = Self {
            values: rows.copied().collect(),
            columns: self.columns,
        };
        let pick = |values: &[f64]| -> Vec<f64> {
            let values = values.iter().zip(&counts);
            let values = values.filter(|(_, counts)| **counts);
            values.map(|(value, _)| *value).collect()
        };
        let kept = Target {
            response: &pick(target.response),
            bound: &pick(target.bound),
            tube_epsilon: target.tube_epsilon,
        };
        let solution = rows.solve_inside(&kept, tolerance, deadline);
        let mut beta = solution.beta.iter().copied();
        let spread = counts
            .iter()
            .map(|&counts| counts.then(|| beta.next()).flatten().unwrap_or(0.0));
        LinearSolution {
            beta: spread.collect(),
            ..solution
        }
    }

    /// As [`Self::solve`], with all bounds positive.
    fn solve_inside(
        &self,
        target: &Target<'_>,
        tolerance: f64,
        deadline: &Deadline,
    ) -> LinearSolution {
        if let Some(solution) = self.constant(target) {
            return solution;
        }
        let mut state = State::new(self, target);
        let mut iterations = 0;
        let status = loop {
            let gap = state.gap(target);
            if gap <= tolerance * state.objective(target) {
                break Status::Optimal;
            }
            if let Some(status) = deadline.passed(iterations) {
                break status;
            }
            if !state.step(self, target, gap) {
                break Status::Stalled;
            }
            iterations += 1;
        };
        state.into_solution(status, iterations)
    }

    /// Where one constant keeps all samples in the tube, the middle of all that do.
    fn constant(&self, target: &Target<'_>) -> Option<LinearSolution> {
        let extremes = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = target
            .response
            .iter()
            .fold(extremes, |(low, high), &y| (low.min(y), high.max(y)));
        // Without any sample, every constant does.
        if high - low > 2.0 * target.tube_epsilon {
            return None;
        }
        let mut omega = vec![0.0; self.columns];
        if low <= high {
            omega[self.columns - 1] = 0.5 * (low + high);
        }
        Some(LinearSolution {
            omega,
            beta: vec![0.0; target.response.len()],
            status: Status::Optimal,
            iterations: 0,
        })
    }
}

/// Where the method is, and what a step needs room for.
struct State {
    omega: Vec<f64>,
    up: Multipliers,
    down: Multipliers,
    residual: Vec<f64>,
    theta_up: Vec<f64>,
    theta_down: Vec<f64>,
    g_up: Vec<f64>,
    g_down: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    step_up: Step,
    step_down: Step,
    scratch: Vec<f64>,
}

impl State {
    fn new(rows: &LinearRows, target: &Target<'_>) -> Self {
        let n = target.response.len();
        let mut omega = vec![0.0; rows.columns];
        let bias = crate::quantile::hazen(target.response, 0.5);
        omega[rows.columns - 1] = bias;
        let residual: Vec<f64> = target.response.iter().map(|y| y - bias).collect();
        let epsilon = target.tube_epsilon;
        let tau = residual.iter().map(|r| r.abs()).sum::<f64>() / n as f64 + epsilon;
        Self {
            omega,
            up: Multipliers::centred(target.bound, residual.iter().map(|r| epsilon - r), tau),
            down: Multipliers::centred(target.bound, residual.iter().map(|r| epsilon + r), tau),
            residual,
            theta_up: vec![0.0; n],
            theta_down: vec![0.0; n],
            g_up: vec![0.0; n],
            g_down: vec![0.0; n],
            p: vec![0.0; n],
            q: vec![0.0; n],
            step_up: Step::zero(n),
            step_down: Step::zero(n),
            scratch: Vec::new(),
        }
    }

    fn gap(&self, target: &Target<'_>) -> f64 {
        self.up.products(target.bound) + self.down.products(target.bound)
    }

    /// (4.17) at `ω`.
    fn objective(&self, target: &Target<'_>) -> f64 {
        let weights = &self.omega[..self.omega.len() - 1];
        let loss = self.residual.iter().zip(target.bound);
        let loss = loss.map(|(r, c)| c * (r.abs() - target.tube_epsilon).max(0.0));
        0.5 * weights.iter().map(|w| w * w).sum::<f64>() + loss.sum::<f64>()
    }

    /// One predictor and one corrector on the same factors. Says whether it got anywhere.
    fn step(&mut self, rows: &LinearRows, target: &Target<'_>, gap: f64) -> bool {
        let bound = target.bound;
        let mu = gap / (4 * bound.len()) as f64;
        self.up
            .newton(bound, 0.0, None, &mut self.theta_up, &mut self.g_up);
        self.down
            .newton(bound, 0.0, None, &mut self.theta_down, &mut self.g_down);
        for (q, (up, down)) in self
            .q
            .iter_mut()
            .zip(self.theta_up.iter().zip(&self.theta_down))
        {
            *q = 1.0 / up + 1.0 / down;
        }
        let normal = rows.normal_matrix(&self.q, &mut self.scratch);
        let Ok(factors) = Llt::new(normal.as_ref(), Side::Lower) else {
            return false;
        };
        drop(normal);

        let (_, worst) = self.direction(rows, bound, &factors, 0.0, None);
        let length = 1.0 / worst.max(1.0);
        let after = self.up.products_after(bound, &self.step_up, length)
            + self.down.products_after(bound, &self.step_down, length);
        let centring = (after / gap).powi(3).min(1.0);

        let predictor = (self.step_up.clone(), self.step_down.clone());
        let (d_omega, worst) =
            self.direction(rows, bound, &factors, centring * mu, Some(&predictor));
        let length = (TO_THE_BOUND / worst).min(1.0);
        if !(length > 1e-12 && d_omega.iter().all(|d| d.is_finite())) {
            return false;
        }
        self.up.advance(&self.step_up, length);
        self.down.advance(&self.step_down, length);
        for (omega, d) in self.omega.iter_mut().zip(&d_omega) {
            *omega += length * d;
        }
        for (r, p) in self.residual.iter_mut().zip(&self.p) {
            *r -= length * p;
        }
        true
    }

    /// Newton's direction toward the centre `mu`: `Δω`, and the reciprocal of the longest step.
    fn direction(
        &mut self,
        rows: &LinearRows,
        bound: &[f64],
        factors: &Llt<f64>,
        mu: f64,
        predictor: Option<&(Step, Step)>,
    ) -> (Vec<f64>, f64) {
        let (before_up, before_down) = (predictor.map(|p| &p.0), predictor.map(|p| &p.1));
        if predictor.is_some() {
            self.up
                .newton(bound, mu, before_up, &mut self.theta_up, &mut self.g_up);
            self.down.newton(
                bound,
                mu,
                before_down,
                &mut self.theta_down,
                &mut self.g_down,
            );
        }
        for i in 0..self.q.len() {
            // What rounding has left over of Σ(u − l)x = w is carried along.
            self.q[i] = self.g_up[i] / self.theta_up[i] - self.g_down[i] / self.theta_down[i]
                + (self.up.m[i] - self.down.m[i]);
        }
        let mut right = vec![0.0; rows.columns];
        rows.combination(&self.q, &mut right);
        for (right, omega) in right.iter_mut().zip(&self.omega[..rows.columns - 1]) {
            *right -= omega;
        }
        let solved: Col<f64> = factors.solve(ColRef::from_slice(&right));
        let d_omega: Vec<f64> = solved.iter().copied().collect();
        rows.products(&d_omega, &mut self.p);
        let up = self.up.resolve(
            bound,
            mu,
            before_up,
            &self.theta_up,
            &self.g_up,
            &self.p,
            1.0,
            &mut self.step_up,
        );
        let down = self.down.resolve(
            bound,
            mu,
            before_down,
            &self.theta_down,
            &self.g_down,
            &self.p,
            -1.0,
            &mut self.step_down,
        );
        (d_omega, up.max(down))
    }

    fn into_solution(self, status: Status, iterations: usize) -> LinearSolution {
        let beta: Vec<f64> = self
            .up
            .m
            .iter()
            .zip(&self.down.m)
            .map(|(u, l)| u - l)
            .collect();
        LinearSolution {
            omega: self.omega,
            beta,
            status,
            iterations,
        }
    }
}

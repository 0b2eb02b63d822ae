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

use faer::linalg::matmul::{matmul, triangular};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Accum, Col, ColMut, ColRef, Mat, MatRef, Par, Side};

use crate::Status;
use crate::deadline::Deadline;
use crate::vectorised::vectorised;

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

/// Scaled predictors, each row with a one at its end.
pub(crate) struct LinearRows {
    values: Vec<f64>,
    columns: usize,
}

/// Rows whose scaled copy stays in the cache.
const BLOCK: usize = 256;

/// How far a step goes toward the nearest bound.
const TO_THE_BOUND: f64 = 0.995;

impl LinearRows {
    pub(crate) fn new(scaled: &[f64], predictors: usize) -> Self {
        let mut rows = Self::with_capacity(predictors, scaled.len() / predictors);
        rows.extend(scaled);
        rows
    }

    pub(crate) fn with_capacity(predictors: usize, samples: usize) -> Self {
        let columns = predictors + 1;
        Self {
            values: Vec::with_capacity(samples * columns),
            columns,
        }
    }

    /// Adds rows without their ones.
    pub(crate) fn extend(&mut self, scaled: &[f64]) {
        for row in scaled.chunks_exact(self.columns - 1) {
            self.values.extend_from_slice(row);
            self.values.push(1.0);
        }
    }

    fn matrix(&self) -> MatRef<'_, f64> {
        MatRef::from_row_major_slice(&self.values, self.values.len() / self.columns, self.columns)
    }

    /// `x̃_i·ω` of every sample.
    pub(crate) fn products(&self, omega: &[f64], out: &mut [f64]) {
        let out = ColMut::from_slice_mut(out);
        matmul(
            out.as_mat_mut(),
            Accum::Replace,
            self.matrix(),
            ColRef::from_slice(omega).as_mat(),
            1.0,
            Par::Seq,
        );
    }

    /// `Σ q_i x̃_i`.
    pub(crate) fn combination(&self, q: &[f64], out: &mut [f64]) {
        let out = ColMut::from_slice_mut(out);
        matmul(
            out.as_mat_mut(),
            Accum::Replace,
            self.matrix().transpose(),
            ColRef::from_slice(q).as_mat(),
            1.0,
            Par::Seq,
        );
    }

    /// Minimises `½‖w‖² + C/2 Σ (y − x̃·ω)²`; one `ω` per response. `None` where the system cannot be factored.
    pub(crate) fn least_squares(
        &self,
        responses: &[&[f64]],
        box_constraint: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let n = self.values.len() / self.columns;
        let normal = self.normal_matrix(&vec![box_constraint; n], &mut Vec::new());
        let factors = Llt::new(normal.as_ref(), Side::Lower).ok()?;
        let solve = |response: &&[f64]| {
            let mut right = vec![0.0; self.columns];
            self.combination(response, &mut right);
            for value in &mut right {
                *value *= box_constraint;
            }
            let solved: Col<f64> = factors.solve(ColRef::from_slice(&right));
            solved.iter().copied().collect()
        };
        Some(responses.iter().map(solve).collect())
    }

    /// Lower triangle of `diag(1, …, 1, 0) + Σ D_i x̃_i x̃_iᵀ`.
    fn normal_matrix(&self, d: &[f64], scratch: &mut Vec<f64>) -> Mat<f64> {
        let columns = self.columns;
        let mut normal = Mat::identity(columns, columns);
        normal[(columns - 1, columns - 1)] = 0.0;
        for (rows, d) in self.values.chunks(BLOCK * columns).zip(d.chunks(BLOCK)) {
            scratch.clear();
            for (row, d) in rows.chunks_exact(columns).zip(d) {
                let root = d.sqrt();
                scratch.extend(row.iter().map(|x| root * x));
            }
            let block = MatRef::from_row_major_slice(scratch, d.len(), columns);
            triangular::matmul(
                normal.as_mut(),
                triangular::BlockStructure::TriangularLower,
                Accum::Add,
                block.transpose(),
                triangular::BlockStructure::Rectangular,
                block,
                triangular::BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        }
        normal
    }

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

/// Multipliers of one side of the tube, and of their bounds.
struct Multipliers {
    m: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// A step of them.
#[derive(Clone)]
struct Step {
    m: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Step {
    fn zero(n: usize) -> Self {
        Self {
            m: vec![0.0; n],
            lower: vec![0.0; n],
            upper: vec![0.0; n],
        }
    }
}

impl Multipliers {
    /// In the middle, with bound multipliers that differ by `slack` and have the product `tau²`.
    fn centred(bound: &[f64], slack: impl Iterator<Item = f64>, tau: f64) -> Self {
        let (mut lower, mut upper) = (
            Vec::with_capacity(bound.len()),
            Vec::with_capacity(bound.len()),
        );
        for s in slack {
            // The smaller of the two by the product, not by a difference.
            let large = 0.5 * (s.abs() + s.hypot(2.0 * tau));
            let small = tau * tau / large;
            lower.push(if s > 0.0 { large } else { small });
            upper.push(if s > 0.0 { small } else { large });
        }
        Self {
            m: bound.iter().map(|c| 0.5 * c).collect(),
            lower,
            upper,
        }
    }

    fn products(&self, bound: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, &c) in bound.iter().enumerate() {
            sum += self.m[i] * self.lower[i] + (c - self.m[i]) * self.upper[i];
        }
        sum
    }

    /// `θ` and `g` of `Δm = (g ∓ p)/θ`, for the centre `mu` and the second-order terms of `predictor`.
    fn newton(
        &self,
        bound: &[f64],
        mu: f64,
        predictor: Option<&Step>,
        theta: &mut [f64],
        g: &mut [f64],
    ) {
        vectorised(
            #[inline(always)]
            || {
                for (i, &c) in bound.iter().enumerate() {
                    let (m, rest) = (self.m[i], c - self.m[i]);
                    let (mut low, mut high) = (mu, mu);
                    if let Some(step) = predictor {
                        low -= step.m[i] * step.lower[i];
                        high += step.m[i] * step.upper[i];
                    }
                    theta[i] = self.lower[i] / m + self.upper[i] / rest;
                    g[i] = (low / m - self.lower[i]) - (high / rest - self.upper[i]);
                }
            },
        );
    }

    /// The step for the movement `p` of this side's slack, and how much of it keeps everything positive.
    #[expect(clippy::too_many_arguments, reason = "one loop over all of it")]
    fn resolve(
        &self,
        bound: &[f64],
        mu: f64,
        predictor: Option<&Step>,
        theta: &[f64],
        g: &[f64],
        p: &[f64],
        sign: f64,
        step: &mut Step,
    ) -> f64 {
        let mut worst = [0.0_f64; 4];
        for (i, &c) in bound.iter().enumerate() {
            let (m, rest) = (self.m[i], c - self.m[i]);
            let (mut low, mut high) = (mu, mu);
            if let Some(step) = predictor {
                low -= step.m[i] * step.lower[i];
                high += step.m[i] * step.upper[i];
            }
            let dm = (g[i] - sign * p[i]) / theta[i];
            let dlower = (low - self.lower[i] * dm) / m - self.lower[i];
            let dupper = (high + self.upper[i] * dm) / rest - self.upper[i];
            worst[0] = worst[0].max(-dm / m);
            worst[1] = worst[1].max(dm / rest);
            worst[2] = worst[2].max(-dlower / self.lower[i]);
            worst[3] = worst[3].max(-dupper / self.upper[i]);
            (step.m[i], step.lower[i], step.upper[i]) = (dm, dlower, dupper);
        }
        worst.into_iter().fold(0.0, f64::max)
    }

    fn products_after(&self, bound: &[f64], step: &Step, length: f64) -> f64 {
        let mut sum = 0.0;
        for (i, &c) in bound.iter().enumerate() {
            let m = self.m[i] + length * step.m[i];
            sum += m * (self.lower[i] + length * step.lower[i])
                + (c - m) * (self.upper[i] + length * step.upper[i]);
        }
        sum
    }

    fn advance(&mut self, step: &Step, length: f64) {
        for (values, steps) in [
            (&mut self.m, &step.m),
            (&mut self.lower, &step.lower),
            (&mut self.upper, &step.upper),
        ] {
            for (value, step) in values.iter_mut().zip(steps) {
                *value += length * step;
            }
        }
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

//! A primal–dual interior point method in the squared speeds: tridiagonal, with one border per bound on a passing time.
//!
//! ```text
//! minimise   Σ E_k(z_k, z_{k+1}) + λ₀ t_N + Σ P_j d_j
//! subject to z within the reachable box, accelerations within their limits, waits d ≥ 0,
//!            ±(t_j − T_j) ≤ 0 at bounded nodes
//! ```

use ev_energy::{KinkWidths, SmoothStep, StepFormula};

use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;
use crate::tridiagonal::{Tridiagonal, solve_dense};

/// A bound on the time at which a node is passed, or left after waiting there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeBound {
    pub(crate) node: usize,
    /// After the wait at the node rather than on arrival.
    pub(crate) after_wait: bool,
    /// No later than the time; otherwise no earlier.
    pub(crate) at_most: bool,
    pub(crate) time_s: f64,
}

impl TimeBound {
    fn sign(&self) -> f64 {
        if self.at_most { 1.0 } else { -1.0 }
    }

    /// Whether time spent waiting at a node counts.
    fn includes_wait_at(&self, node: usize) -> bool {
        node < self.node || (self.after_wait && node == self.node)
    }
}

/// What is solved.
#[derive(Debug, Clone, Default)]
pub(crate) struct Task {
    /// Price of time on the whole trip, W.
    pub(crate) price_w: f64,
    pub(crate) time_bounds: Vec<TimeBound>,
    /// Nodes where the car stands and may wait for as long as it likes.
    pub(crate) waits: Vec<usize>,
}

impl Task {
    /// Price of the time that is spent waiting at a node, W.
    pub(crate) fn price_of_wait(&self, node: usize, multipliers_w: &[f64]) -> f64 {
        let bounds = self.time_bounds.iter().zip(multipliers_w);
        let later = bounds.filter(|(bound, _)| bound.includes_wait_at(node));
        self.price_w + later.map(|(bound, m)| bound.sign() * m).sum::<f64>()
    }
}

/// How precisely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Precision {
    /// Barrier at the end, J.
    pub(crate) barrier_j: f64,
    pub(crate) most_iterations: usize,
}

impl Default for Precision {
    fn default() -> Self {
        Self {
            barrier_j: 2e-3,
            most_iterations: 150,
        }
    }
}

/// Where the method ended.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    /// Squared speeds, m²/s².
    pub(crate) z: Vec<f64>,
    /// Waits, s.
    pub(crate) waits_s: Vec<f64>,
    /// Multiplier of every time bound, W; at least 0.
    pub(crate) multipliers_w: Vec<f64>,
    /// Price of time of every step, W.
    pub(crate) step_price_w: Vec<f64>,
    /// Derivative of the step before a node by the node's squared speed, J/(m²/s²).
    pub(crate) potential: Vec<f64>,
    /// Multipliers of the largest and the smallest acceleration of every step, J/(m/s²).
    pub(crate) accel_multiplier: Vec<[f64; 2]>,
    /// Width of rounded kinks at the end, N.
    pub(crate) kink_width_n: f64,
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
}

/// Width of rounded kinks at the end, N.
const LEAST_WIDTH_N: f64 = 0.02;

/// Kinds of bounds on the acceleration of a step.
const COMFORT: usize = 0;
const BRAKING: usize = 1;
const STRONGEST: usize = 2;
const KINDS: usize = 3;

/// A bound of a step: how much is left to it, its gradient by the two squared speeds, and its multiplier.
#[derive(Debug, Clone, Copy, Default)]
struct StepBound {
    slack: f64,
    gradient: [f64; 2],
    multiplier: f64,
    active: bool,
}

/// A variable or a bound with its multiplier.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    slack: f64,
    multiplier: f64,
}

pub(crate) struct InteriorPoint<'a> {
    problem: &'a Problem<'a>,
    formula: StepFormula,
    reachable: &'a Reachable,
    task: &'a Task,
    fixed: Vec<bool>,
    z: Vec<f64>,
    steps: Vec<SmoothStep>,
    bounds: Vec<[StepBound; KINDS]>,
    /// Multipliers of the lowest and the highest speed.
    speed_multiplier: Vec<[f64; 2]>,
    waits: Vec<Pair>,
    times: Vec<Pair>,
    passing_s: Vec<f64>,
    barrier_j: f64,
}

impl<'a> InteriorPoint<'a> {
    /// Starts from squared speeds strictly inside; `None` where they are not.
    pub(crate) fn new(
        problem: &'a Problem<'a>,
        formula: StepFormula,
        reachable: &'a Reachable,
        task: &'a Task,
        start: Vec<f64>,
        barrier_j: f64,
    ) -> Option<Self> {
        let nodes = problem.nodes();
        let mut this = Self {
            problem,
            formula,
            reachable,
            task,
            fixed: (0..nodes).map(|k| reachable.is_fixed(k)).collect(),
            z: start,
            steps: vec![SmoothStep::default(); nodes - 1],
            bounds: vec![[StepBound::default(); KINDS]; nodes - 1],
            speed_multiplier: vec![[0.0; 2]; nodes],
            waits: vec![
                Pair {
                    slack: 1.0,
                    multiplier: barrier_j
                };
                task.waits.len()
            ],
            times: Vec::new(),
            passing_s: Vec::new(),
            barrier_j,
        };
        for step in 0..nodes - 1 {
            this.bounds[step][COMFORT].active = true;
            this.bounds[step][BRAKING].active = true;
            this.bounds[step][STRONGEST].active = this.may_be_strongest(step);
        }
        for k in 0..nodes {
            if this.fixed[k] {
                this.z[k] = reachable.high[k];
                continue;
            }
            let room = [this.z[k] - reachable.low[k], reachable.high[k] - this.z[k]];
            if room.iter().any(|room| *room <= 0.0) {
                return None;
            }
            this.speed_multiplier[k] = room.map(|room| barrier_j / room);
        }
        this.evaluate();
        if !this.slacks_are_positive() {
            return None;
        }
        for bound in this
            .bounds
            .iter_mut()
            .flatten()
            .filter(|bound| bound.active)
        {
            bound.multiplier = barrier_j / bound.slack;
        }
        this.times = task
            .time_bounds
            .iter()
            .map(|bound| {
                let spare_s = bound.sign() * (bound.time_s - this.passing_time(bound));
                let slack = spare_s.max(0.02 * (1.0 + bound.time_s.abs()));
                Pair {
                    slack,
                    multiplier: (barrier_j / slack).max(200.0),
                }
            })
            .collect();
        Some(this)
    }

    /// Whether motor and battery can be weaker in a step than comfort, somewhere in the box.
    fn may_be_strongest(&self, step: usize) -> bool {
        let reachable = self.reachable;
        let top = mean_speed(reachable.high[step], reachable.high[step + 1]);
        let low = mean_speed(reachable.low[step], reachable.low[step + 1]);
        // What is left for acceleration falls with the speed but for envelopes and odd road loads: a margin of a third.
        [low, 0.5 * (low + top), top].iter().any(|&speed| {
            let comfort = self.problem.envelope.max_at(speed).accel_mps2;
            self.problem.strongest_accel(step, speed) < 1.33 * comfort
        })
    }

    fn widths(&self) -> KinkWidths {
        KinkWidths {
            force_n: (4.0 * self.barrier_j).clamp(LEAST_WIDTH_N, 300.0),
            fade: (1e-2 * self.barrier_j).clamp(1e-5, 0.2),
        }
    }

    /// Steps with derivatives; bounds and times are there already.
    fn evaluate_derivatives(&mut self) {
        let widths = self.widths();
        for k in 0..self.steps.len() {
            let (from, to) = (self.z[k], self.z[k + 1]);
            self.steps[k] = self.formula.step(&self.problem.steps[k], from, to, widths);
        }
    }

    /// Energy, time and bounds.
    fn evaluate(&mut self) {
        let widths = self.widths();
        for k in 0..self.steps.len() {
            let (from, to) = (self.z[k], self.z[k + 1]);
            let step = &mut self.steps[k];
            (step.energy_j, step.time_s) =
                self.formula
                    .energy_and_time(&self.problem.steps[k], from, to, widths);
            self.evaluate_bounds(k, from, to);
        }
        self.passing_s.clear();
        self.passing_s.push(0.0);
        let mut time_s = 0.0;
        for k in 0..self.steps.len() {
            time_s += self.problem.columns.dwell_s[k] + self.steps[k].time_s;
            self.passing_s.push(time_s);
        }
    }

    #[inline(always)]
    fn evaluate_bounds(&mut self, k: usize, from: f64, to: f64) {
        let problem = self.problem;
        let per_z = 0.5 / problem.steps[k].length_m();
        let accel = (to - from) * per_z;
        let bounds = &mut self.bounds[k];
        let inverse = |z: f64| if z > 0.0 { 0.25 / z.sqrt() } else { 0.0 };
        let by_speed = if problem.envelope.is_constant() && !bounds[STRONGEST].active {
            [0.0; 2]
        } else {
            [inverse(from), inverse(to)]
        };
        let speed = mean_speed(from, to);
        let upper = problem.envelope.max_at(speed);
        let lower = problem.envelope.min_at(speed);
        let set = |bound: &mut StepBound, sign: f64, limit: crate::envelope::Limit| {
            bound.slack = sign * (limit.accel_mps2 - accel);
            bound.gradient = [
                sign * (limit.per_s * by_speed[0] + per_z),
                sign * (limit.per_s * by_speed[1] - per_z),
            ];
        };
        set(&mut bounds[COMFORT], 1.0, upper);
        set(&mut bounds[BRAKING], -1.0, lower);
        if bounds[STRONGEST].active {
            set(&mut bounds[STRONGEST], 1.0, problem.strongest(k, speed));
        }
    }

    fn slacks_are_positive(&self) -> bool {
        let free = |k: usize| !(self.fixed[k] && self.fixed[k + 1]);
        (0..self.bounds.len()).filter(|&k| free(k)).all(|k| {
            self.bounds[k]
                .iter()
                .all(|bound| !bound.active || bound.slack > 0.0)
        })
    }

    fn passing_time(&self, bound: &TimeBound) -> f64 {
        let waited: f64 = self
            .task
            .waits
            .iter()
            .zip(&self.waits)
            .filter(|(node, _)| bound.includes_wait_at(**node))
            .map(|(_, wait)| wait.slack)
            .sum();
        self.passing_s[bound.node] + waited
    }

    /// Price of time of every step for multipliers of the time bounds.
    fn prices(&self, multipliers: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
        let mut price = vec![0.0; self.steps.len() + 1];
        for (bound, multiplier) in self.task.time_bounds.iter().zip(multipliers) {
            price[bound.node] += bound.sign() * multiplier;
        }
        price[self.steps.len()] += self.task.price_w;
        for k in (0..self.steps.len()).rev() {
            price[k] += price[k + 1];
        }
        price.remove(0);
        price
    }

    pub(crate) fn solve(mut self, precision: Precision) -> Solution {
        let mut newton = Newton::default();
        let mut iterations = 0;
        let mut converged = false;
        while iterations < precision.most_iterations {
            iterations += 1;
            self.evaluate_derivatives();
            let step = newton.direction(&self);
            let taken = self.advance(&step);
            let target_j = precision.barrier_j;
            let late = self.lateness();
            if self.barrier_j <= target_j
                && step.decrement_j < 1e-3 * target_j
                && late < 1e-7
                && taken > 0.9
            {
                converged = true;
                break;
            }
            if std::env::var_os("SPEED_PLAN_TRACE").is_some() {
                eprintln!(
                    "{iterations:3} mu {:9.3e} decrement {:9.3e} taken {taken:.3} t {:.6} late {late:.2e}",
                    self.barrier_j,
                    step.decrement_j,
                    self.passing_s.last().unwrap_or(&0.0)
                );
            }
            let average_j = self.complementarity();
            let factor = if taken > 0.8 {
                0.3
            } else if taken > 0.3 {
                0.6
            } else {
                0.9
            };
            if step.decrement_j < 40.0 * (self.barrier_j * self.steps.len() as f64).max(1e-6) {
                self.barrier_j = (factor * average_j).min(self.barrier_j).max(0.9 * target_j);
            }
        }
        self.evaluate_derivatives();
        self.finish(iterations, converged)
    }

    /// Largest violation of the equations `t + s = T`, s.
    fn lateness(&self) -> f64 {
        let bounds = self.task.time_bounds.iter().zip(&self.times);
        bounds
            .map(|(bound, pair)| {
                (bound.sign() * (self.passing_time(bound) - bound.time_s) + pair.slack).abs()
            })
            .fold(0.0, f64::max)
    }

    /// Mean of slack times multiplier over all bounds, J.
    fn complementarity(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        let mut add = |product: f64| {
            sum += product;
            count += 1.0;
        };
        for k in 0..self.z.len() {
            if !self.fixed[k] {
                let [low, high] = self.speed_multiplier[k];
                add(low * (self.z[k] - self.reachable.low[k]));
                add(high * (self.reachable.high[k] - self.z[k]));
            }
        }
        for bound in self.bounds.iter().flatten().filter(|bound| bound.active) {
            add(bound.slack * bound.multiplier);
        }
        for pair in self.times.iter().chain(&self.waits) {
            add(pair.slack * pair.multiplier);
        }
        sum / f64::max(count, 1.0)
    }

    /// The barrier Lagrangian at given multipliers of the time bounds, J.
    fn merit(&self, multipliers: &[f64]) -> f64 {
        let mu = self.barrier_j;
        let energy: f64 = self.steps.iter().map(|step| step.energy_j).sum();
        let mut logs = 0.0;
        // Logarithms of products: one in place of many.
        let mut product = 1.0_f64;
        let mut add = |slack: f64| {
            product *= slack;
            if !(1e-100..1e100).contains(&product) {
                logs += product.ln();
                product = 1.0;
            }
        };
        for k in 0..self.z.len() {
            if !self.fixed[k] {
                add(self.z[k] - self.reachable.low[k]);
                add(self.reachable.high[k] - self.z[k]);
            }
        }
        for k in 0..self.bounds.len() {
            if self.fixed[k] && self.fixed[k + 1] {
                continue;
            }
            for bound in self.bounds[k].iter().filter(|bound| bound.active) {
                add(bound.slack);
            }
        }
        for wait in &self.waits {
            add(wait.slack);
        }
        logs += product.ln();
        let last_s = self.passing_s.last().copied().unwrap_or(0.0);
        let waits = self.task.waits.iter().zip(&self.waits);
        let waiting: f64 = waits
            .map(|(node, wait)| {
                (self.problem.standing_power_w(*node) + self.task.price_w) * wait.slack
            })
            .sum();
        let times: f64 = self
            .task
            .time_bounds
            .iter()
            .zip(multipliers)
            .map(|(bound, m)| bound.sign() * m * self.passing_time(bound))
            .sum();
        energy + self.task.price_w * last_s + waiting + times - mu * logs
    }

    /// Goes along a Newton step as far as bounds and the merit allow; the share that was taken.
    fn advance(&mut self, step: &Direction) -> f64 {
        const TO_THE_EDGE: f64 = 0.995;
        let mut share = 1.0_f64;
        let mut limit = |slack: f64, change: f64| {
            if change < 0.0 {
                share = share.min(-TO_THE_EDGE * slack / change);
            }
        };
        for k in 0..self.z.len() {
            if !self.fixed[k] {
                limit(self.z[k] - self.reachable.low[k], step.z[k]);
                limit(self.reachable.high[k] - self.z[k], -step.z[k]);
            }
        }
        for (k, bounds) in self.bounds.iter().enumerate() {
            for bound in bounds.iter().filter(|bound| bound.active) {
                limit(
                    bound.slack,
                    bound.gradient[0] * step.z[k] + bound.gradient[1] * step.z[k + 1],
                );
            }
        }
        for (wait, change) in self.waits.iter().zip(&step.waits) {
            limit(wait.slack, *change);
        }
        let before = self.merit(&step.multipliers);
        let (z, waits) = (self.z.clone(), self.waits.clone());
        let bounds = self.bounds.clone();
        let old_passing: Vec<f64> = self
            .task
            .time_bounds
            .iter()
            .map(|b| self.passing_time(b))
            .collect();
        for trial in 0..30 {
            for (k, z) in z.iter().enumerate() {
                self.z[k] = z + share * step.z[k];
            }
            for (k, wait) in waits.iter().enumerate() {
                self.waits[k].slack = wait.slack + share * step.waits[k];
            }
            self.evaluate();
            let enough = before - 1e-4 * share * step.decrement_j + 1e-9 * before.abs();
            if self.slacks_are_positive()
                && (self.merit(&step.multipliers) <= enough || trial == 29)
            {
                break;
            }
            share *= 0.5;
        }
        self.update_multipliers(step, &z, &waits, &bounds, &old_passing, share);
        share
    }

    fn update_multipliers(
        &mut self,
        step: &Direction,
        z: &[f64],
        waits: &[Pair],
        bounds: &[[StepBound; KINDS]],
        old_passing: &[f64],
        share: f64,
    ) {
        let mu = self.barrier_j;
        // A multiplier follows its own equation, kept within a factor of the central path.
        let next = |slack: f64, change: f64, multiplier: f64, now: f64| {
            let full = (mu - multiplier * change) / slack;
            let moved = multiplier + share.max(0.1) * (full - multiplier);
            moved
                .max(0.005 * multiplier)
                .clamp(mu / (1e4 * now), 1e4 * mu / now)
        };
        for k in 0..self.z.len() {
            if self.fixed[k] {
                continue;
            }
            let [low, high] = self.speed_multiplier[k];
            let (l, h) = (self.reachable.low[k], self.reachable.high[k]);
            self.speed_multiplier[k] = [
                next(z[k] - l, step.z[k], low, self.z[k] - l),
                next(h - z[k], -step.z[k], high, h - self.z[k]),
            ];
        }
        for k in 0..self.bounds.len() {
            for kind in 0..KINDS {
                let old = bounds[k][kind];
                if !old.active || old.slack <= 0.0 {
                    continue;
                }
                let change = old.gradient[0] * step.z[k] + old.gradient[1] * step.z[k + 1];
                let now = self.bounds[k][kind].slack;
                self.bounds[k][kind].multiplier = next(old.slack, change, old.multiplier, now);
            }
        }
        for (k, old) in waits.iter().enumerate() {
            self.waits[k].multiplier = next(
                old.slack,
                step.waits[k],
                old.multiplier,
                self.waits[k].slack,
            );
        }
        for (k, bound) in self.task.time_bounds.iter().enumerate() {
            let old = self.times[k];
            let full = step.multipliers[k];
            let multiplier =
                (old.multiplier + share * (full - old.multiplier)).max(0.02 * old.multiplier);
            // The slack that belongs to the new time, or what is left of the old one.
            let exact = bound.sign() * (bound.time_s - self.passing_time(bound));
            let residual = bound.sign() * (old_passing[k] - bound.time_s) + old.slack;
            let change = (mu - old.slack * full) / old.multiplier;
            let _ = residual;
            let slack = (old.slack + share * change).max(0.02 * old.slack);
            let slack = if exact > 0.2 * slack && exact < 5.0 * slack {
                exact
            } else {
                slack
            };
            self.times[k] = Pair { slack, multiplier };
        }
    }

    fn finish(self, iterations: usize, converged: bool) -> Solution {
        let multipliers_w: Vec<f64> = self.times.iter().map(|pair| pair.multiplier).collect();
        let step_price_w = self.prices(multipliers_w.iter().copied());
        let mut potential = vec![0.0; self.z.len()];
        let mut accel_multiplier = Vec::with_capacity(self.steps.len());
        for k in 0..self.steps.len() {
            let step = &self.steps[k];
            let active = |kind: usize| Some(&self.bounds[k][kind]).filter(|bound| bound.active);
            let bent: f64 = (0..KINDS)
                .filter_map(active)
                .map(|bound| bound.multiplier * bound.gradient[1])
                .sum();
            potential[k + 1] =
                step.energy_gradient[1] + step_price_w[k] * step.time_gradient[1] - bent;
            let multiplier = |kind| active(kind).map_or(0.0, |bound| bound.multiplier);
            accel_multiplier.push([
                multiplier(COMFORT) + multiplier(STRONGEST),
                multiplier(BRAKING),
            ]);
        }
        Solution {
            waits_s: self.waits.iter().map(|wait| wait.slack).collect(),
            multipliers_w,
            kink_width_n: self.widths().force_n,
            step_price_w,
            potential,
            accel_multiplier,
            iterations,
            converged,
            z: self.z,
        }
    }
}

/// A Newton step.
#[derive(Debug, Default)]
struct Direction {
    z: Vec<f64>,
    waits: Vec<f64>,
    /// New multipliers of the time bounds.
    multipliers: Vec<f64>,
    /// Half of it is what the quadratic model gains, J.
    decrement_j: f64,
}

#[derive(Default)]
struct Newton {
    matrix: Tridiagonal,
    gradient: Vec<f64>,
}

impl Newton {
    fn direction(&mut self, ip: &InteriorPoint) -> Direction {
        let nodes = ip.z.len();
        self.assemble(ip);
        self.matrix.factorise();
        let mut step = self.gradient.iter().map(|g| -g).collect::<Vec<_>>();
        self.matrix.solve(&mut step);

        let mu = ip.barrier_j;
        // Waits are diagonal.
        let wait_h: Vec<f64> = ip.waits.iter().map(|w| w.multiplier / w.slack).collect();
        let wait_g: Vec<f64> = ip
            .task
            .waits
            .iter()
            .zip(&ip.waits)
            .map(|(node, wait)| {
                ip.problem.standing_power_w(*node) + ip.task.price_w - mu / wait.slack
            })
            .collect();
        let mut waits: Vec<f64> = wait_g.iter().zip(&wait_h).map(|(g, h)| -g / h).collect();

        let borders: Vec<Vec<f64>> = ip
            .task
            .time_bounds
            .iter()
            .map(|bound| {
                let mut gradient = vec![0.0; nodes];
                for k in 0..bound.node {
                    gradient[k] += ip.steps[k].time_gradient[0];
                    gradient[k + 1] += ip.steps[k].time_gradient[1];
                }
                for (g, fixed) in gradient.iter_mut().zip(&ip.fixed) {
                    *g = if *fixed { 0.0 } else { bound.sign() * *g };
                }
                gradient
            })
            .collect();
        let wait_border = |bound: &TimeBound, wait: usize| {
            if bound.includes_wait_at(ip.task.waits[wait]) {
                bound.sign()
            } else {
                0.0
            }
        };
        let solved: Vec<Vec<f64>> = borders
            .iter()
            .map(|border| {
                let mut x = border.clone();
                self.matrix.solve(&mut x);
                x
            })
            .collect();
        let count = borders.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut schur = vec![0.0; count * count];
        let mut multipliers = vec![0.0; count];
        for i in 0..count {
            let bound = &ip.task.time_bounds[i];
            let pair = ip.times[i];
            let residual = bound.sign() * (ip.passing_time(bound) - bound.time_s) + pair.slack;
            for j in 0..=i {
                let other = &ip.task.time_bounds[j];
                let by_waits: f64 = (0..waits.len())
                    .map(|w| wait_border(bound, w) * wait_border(other, w) / wait_h[w])
                    .sum();
                schur[i * count + j] = dot(&borders[i], &solved[j]) + by_waits;
                schur[j * count + i] = schur[i * count + j];
            }
            schur[i * count + i] += pair.slack / pair.multiplier;
            let by_waits: f64 = (0..waits.len())
                .map(|w| wait_border(bound, w) * waits[w])
                .sum();
            multipliers[i] = dot(&borders[i], &step) + by_waits + residual + mu / pair.multiplier;
        }
        if !solve_dense(&mut schur, &mut multipliers) {
            multipliers = ip.times.iter().map(|pair| pair.multiplier).collect();
        }
        for (multiplier, solved) in multipliers.iter().zip(&solved) {
            for (step, solved) in step.iter_mut().zip(solved) {
                *step -= multiplier * solved;
            }
        }
        for (w, wait) in waits.iter_mut().enumerate() {
            let bounds = ip.task.time_bounds.iter().zip(&multipliers);
            let pull: f64 = bounds.map(|(bound, m)| wait_border(bound, w) * m).sum();
            *wait -= pull / wait_h[w];
        }
        // Slope of the merit along the step, at the new multipliers.
        let mut slope = dot(&self.gradient, &step) + dot(&wait_g, &waits);
        for (i, multiplier) in multipliers.iter().enumerate() {
            let bound = &ip.task.time_bounds[i];
            let by_waits: f64 = (0..waits.len())
                .map(|w| wait_border(bound, w) * waits[w])
                .sum();
            slope += multiplier * (dot(&borders[i], &step) + by_waits);
        }
        Direction {
            z: step,
            waits,
            multipliers,
            decrement_j: -slope,
        }
    }

    fn assemble(&mut self, ip: &InteriorPoint) {
        let nodes = ip.z.len();
        let mu = ip.barrier_j;
        self.matrix.clear(nodes);
        self.gradient.clear();
        self.gradient.resize(nodes, 0.0);
        let price = ip.prices(ip.times.iter().map(|pair| pair.multiplier));
        for k in 0..nodes - 1 {
            let step = &ip.steps[k];
            let e = step.energy_hessian;
            let t = step.time_hessian;
            let mut h = semidefinite([0, 1, 2].map(|i| e[i] + price[k] * t[i]));
            let mut g =
                [0, 1].map(|i| step.energy_gradient[i] + ip.task.price_w * step.time_gradient[i]);
            for bound in ip.bounds[k]
                .iter()
                .filter(|bound| bound.active && bound.slack > 0.0)
            {
                let weight = bound.multiplier / bound.slack;
                let [g0, g1] = bound.gradient;
                h[0] += weight * g0 * g0;
                h[1] += weight * g0 * g1;
                h[2] += weight * g1 * g1;
                g[0] -= mu / bound.slack * g0;
                g[1] -= mu / bound.slack * g1;
            }
            self.matrix.diagonal[k] += h[0];
            self.matrix.diagonal[k + 1] += h[2];
            self.matrix.off[k] = h[1];
            self.gradient[k] += g[0];
            self.gradient[k + 1] += g[1];
        }
        for k in 0..nodes {
            if ip.fixed[k] {
                self.matrix.diagonal[k] = 1.0;
                self.gradient[k] = 0.0;
                if k > 0 {
                    self.matrix.off[k - 1] = 0.0;
                }
                if k + 1 < nodes {
                    self.matrix.off[k] = 0.0;
                }
                continue;
            }
            let room = [
                ip.z[k] - ip.reachable.low[k],
                ip.reachable.high[k] - ip.z[k],
            ];
            let [low, high] = ip.speed_multiplier[k];
            self.matrix.diagonal[k] += low / room[0] + high / room[1] + 1e-12;
            self.gradient[k] += mu / room[1] - mu / room[0];
        }
    }
}

/// The nearest positive semidefinite matrix to `[00, 01, 11]`.
#[inline(always)]
fn semidefinite(h: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = h;
    if a >= 0.0 && c >= 0.0 && a * c >= b * b {
        return h;
    }
    let (middle, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = (half * half + b * b).sqrt();
    let larger = middle + radius;
    if larger <= 0.0 {
        return [0.0; 3];
    }
    // larger · v vᵀ with the unit eigenvector v: (I + [half, b; b, −half]/radius)/2.
    let scale = 0.5 * larger / radius;
    [scale * (radius + half), scale * b, scale * (radius - half)]
}

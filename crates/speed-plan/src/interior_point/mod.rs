//! A primal–dual interior point method in the squared speeds: tridiagonal, with one border per bound on a passing time.
//!
//! ```text
//! minimise   Σ E_k(z_k, z_{k+1}) + λ₀ t_N + Σ P_j d_j
//! subject to z within the reachable box, accelerations within their limits, waits d ≥ 0,
//!            ±(t_j − T_j) ≤ 0 at bounded nodes
//! ```

mod newton;
mod task;

use ev_energy::{KinkWidths, SmoothStep, StepFormula};

use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;
use newton::{Direction, Newton};
pub(crate) use task::{Precision, Solution, Task, TimeBound};

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
            // Between ends that are given nothing can move, and bounds may have no slack to divide by.
            let moves = !(this.fixed[step] && this.fixed[step + 1]);
            this.bounds[step][COMFORT].active = moves;
            this.bounds[step][BRAKING].active = moves;
            this.bounds[step][STRONGEST].active = moves && this.may_be_strongest(step);
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
        let mut bounds = self.bounds.iter().flatten();
        bounds.all(|bound| !bound.active || bound.slack > 0.0)
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
        let dwell_s = if bound.after_wait {
            self.problem.dwell_s(bound.node)
        } else {
            0.0
        };
        self.passing_s[bound.node] + dwell_s + waited
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
            if !step.decrement_j.is_finite() {
                break;
            }
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
        self.finish(converged)
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
        let bounds = self.bounds.iter().flatten();
        bounds
            .filter(|bound| bound.active)
            .for_each(|bound| add(bound.slack));
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
        self.update_multipliers(step, &z, &waits, &bounds, share);
        share
    }

    fn update_multipliers(
        &mut self,
        step: &Direction,
        z: &[f64],
        waits: &[Pair],
        bounds: &[[StepBound; KINDS]],
        share: f64,
    ) {
        let mu = self.barrier_j;
        // A multiplier follows its own equation, kept within a factor of the central path.
        let next = |slack: f64, change: f64, multiplier: f64, now: f64| {
            let full = (mu - multiplier * change) / slack;
            let moved = multiplier + share.max(0.1) * (full - multiplier);
            // Not `clamp`: rounding may leave no slack.
            moved
                .max(0.005 * multiplier)
                .max(mu / (1e4 * now))
                .min(1e4 * mu / now)
        };
        for (k, z) in z.iter().enumerate().filter(|(k, _)| !self.fixed[*k]) {
            let [low, high] = self.speed_multiplier[k];
            let (l, h) = (self.reachable.low[k], self.reachable.high[k]);
            self.speed_multiplier[k] = [
                next(z - l, step.z[k], low, self.z[k] - l),
                next(h - z, -step.z[k], high, h - self.z[k]),
            ];
        }
        for (k, (old, now)) in bounds.iter().zip(&mut self.bounds).enumerate() {
            let active = |(old, _): &(&StepBound, &mut StepBound)| old.active && old.slack > 0.0;
            for (old, now) in old.iter().zip(now).filter(active) {
                let change = old.gradient[0] * step.z[k] + old.gradient[1] * step.z[k + 1];
                now.multiplier = next(old.slack, change, old.multiplier, now.slack);
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
            let change = (mu - old.slack * full) / old.multiplier;
            let slack = (old.slack + share * change).max(0.02 * old.slack);
            let slack = if exact > 0.2 * slack && exact < 5.0 * slack {
                exact
            } else {
                slack
            };
            self.times[k] = Pair { slack, multiplier };
        }
    }

    fn finish(self, converged: bool) -> Solution {
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
            converged,
            z: self.z,
        }
    }
}

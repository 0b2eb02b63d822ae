//! A lower bound on the cost of every plan.
//!
//! For any prices `π_k` of time and any potentials `p_k` of the squared speeds, every plan costs at least
//!
//! ```text
//! Σ_k min [E_k + π_k Δt_k + p_k z_k − p_{k+1} z_{k+1}] + p_N z_N − p_0 z_0 + Σ_j π dwell − Σ over time bounds of ±λ_j T_j
//! ```
//!
//! each minimum over the two speeds of one step alone. Its minima are found by branch and bound with [`curvature`], so that the
//! bound is proven where losses are a formula.

mod cells;
mod curvature;
mod interval;
#[cfg(test)]
mod tests;

use ev_energy::StepFormula;

use crate::interior_point::{Solution, Task};
use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;
use cells::{ACCEL_ROUNDING, StepCost};
use curvature::{Convexity, Ranges};
use interval::Interval;

/// Taken off for rounding, as a share of all magnitudes that were summed.
const ROUNDING: f64 = 1e-12;

/// Parts of one step's box that are looked at, at most.
const MOST_CELLS: usize = 400;

/// What every plan costs at least at given prices and potentials.
pub(crate) struct Bound {
    /// Energy in J, and time at its price, that any plan needs that keeps the time bounds.
    pub(crate) energy_j: f64,
    /// How much more it takes to stand at each of several nodes, J; below 0 where the bound holds for passing only.
    pub(crate) standing_extra_j: Vec<f64>,
    /// The step whose least cost lies the furthest below that of the plan, and by how much, J.
    pub(crate) weakest: (usize, f64),
}

/// A bound with the multipliers of a solution, and what standing at some nodes that it passes would add.
pub(crate) fn lower_bound(
    problem: &Problem,
    formula: &StepFormula,
    reachable: &Reachable,
    task: &Task,
    solution: &Solution,
    tolerance_j: f64,
    may_stand: &[usize],
) -> Bound {
    let steps = problem.steps.len();
    let bounder = Bounder::new(problem, formula, reachable, solution, tolerance_j);
    let mut sum = Sum::default();
    let mut losses_j = Vec::with_capacity(steps);
    let range = |k: usize| Interval::new(reachable.low[k], reachable.high[k]);
    let least: Vec<f64> = (0..steps)
        .scan(None, |convex, k| {
            Some(bounder.least_j(k, range(k), range(k + 1), convex))
        })
        .map(|(least_j, loss_j)| {
            losses_j.push(loss_j);
            least_j
        })
        .collect();
    least.iter().for_each(|least| sum.add(*least));
    let weakest = losses_j
        .iter()
        .copied()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    // Ends are given: what the potentials take there is added again.
    let end_j = |node: usize, sign: f64| {
        let end = sign * solution.potential[node];
        let z = range(node);
        end * if end >= 0.0 { z.low } else { z.high }
    };
    sum.add(end_j(0, -1.0));
    sum.add(end_j(steps, 1.0));
    let standing_w = |node: usize| {
        problem.standing_power_w(node) + task.price_of_wait(node, &solution.multipliers_w)
    };
    for (k, &dwell_s) in problem.columns.dwell_s.iter().enumerate().take(steps) {
        if dwell_s > 0.0 {
            sum.add(standing_w(k) * dwell_s);
        }
    }
    for &node in &task.waits {
        let waiting_w = standing_w(node);
        if waiting_w < 0.0 {
            // The longer the better, up to the bounds that the wait counts for.
            let latest_s = task
                .time_bounds
                .iter()
                .filter(|bound| bound.at_most && bound.includes_wait_at(node))
                .map(|bound| bound.time_s)
                .fold(f64::INFINITY, f64::min);
            sum.add(waiting_w * latest_s.max(0.0));
        }
    }
    for (bound, multiplier) in task.time_bounds.iter().zip(&solution.multipliers_w) {
        let sign = if bound.at_most { -1.0 } else { 1.0 };
        sum.add(sign * multiplier * bound.time_s);
    }
    let standing_extra_j = may_stand
        .iter()
        .map(|&node| {
            if standing_w(node) < 0.0 {
                return f64::NEG_INFINITY;
            }
            let still = Interval::point(0.0);
            let stopping = bounder
                .least_j(node - 1, range(node - 1), still, &mut None)
                .0;
            let (starting, passing) = if node < steps {
                let starting = bounder.least_j(node, still, range(node + 1), &mut None).0;
                (starting, least[node])
            } else {
                (0.0, end_j(node, 1.0))
            };
            stopping + starting - least[node - 1] - passing
        })
        .collect();
    // Where a wait has no end, neither has what it is worth.
    let energy_j = if sum.magnitude.is_finite() {
        sum.value - ROUNDING * sum.magnitude
    } else {
        f64::NEG_INFINITY
    };
    Bound {
        energy_j,
        standing_extra_j,
        weakest: weakest.unwrap_or((0, 0.0)),
    }
}

#[derive(Default)]
struct Sum {
    value: f64,
    magnitude: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        self.value += value;
        self.magnitude += value.abs();
    }
}

/// What the minima of all steps have in common.
struct Bounder<'a> {
    problem: &'a Problem<'a>,
    formula: &'a StepFormula,
    solution: &'a Solution,
    tolerance_j: f64,
    ranges: Ranges,
}

impl<'a> Bounder<'a> {
    fn new(
        problem: &'a Problem,
        formula: &'a StepFormula,
        reachable: &'a Reachable,
        solution: &'a Solution,
        tolerance_j: f64,
    ) -> Self {
        let top_mps = reachable.high.iter().copied().fold(0.0, f64::max).sqrt();
        let (min, max) = problem.envelope.range(0.0, top_mps);
        let steps = problem.steps.iter();
        Self {
            problem,
            formula,
            solution,
            tolerance_j: tolerance_j / problem.steps.len() as f64,
            ranges: Ranges {
                top_mps,
                accel: Interval::new(min - ACCEL_ROUNDING, max),
                standing_n: Interval::hull(
                    steps.clone().map(|step| formula.standing_force_n(step)),
                ),
                longest_m: steps.map(ev_energy::RoadStep::length_m).fold(0.0, f64::max),
            },
        }
    }

    /// The least cost of a step between squared speeds and how much more it costs where the plan is; `convex` is what was found for the price of the step before.
    fn least_j(
        &self,
        step: usize,
        from: Interval,
        to: Interval,
        convex: &mut Option<(f64, Convexity)>,
    ) -> (f64, f64) {
        let (problem, formula, solution) = (self.problem, self.formula, self.solution);
        let price_w = solution.step_price_w[step];
        if convex
            .as_ref()
            .is_none_or(|(at, _)| at.to_bits() != price_w.to_bits())
        {
            *convex = Some((price_w, Convexity::new(formula, price_w, &self.ranges)));
        }
        let convexity = convex.as_ref().map(|(_, convexity)| convexity);
        // At another end than the plan's, the nearest point.
        let at = [
            solution.z[step].clamp(from.low, from.high),
            solution.z[step + 1].clamp(to.low, to.high),
        ];
        let cost = StepCost {
            convexity,
            problem,
            formula,
            step,
            price_w,
            potential: [solution.potential[step], solution.potential[step + 1]],
            accel_multiplier: if problem.envelope.is_constant() {
                [0.0; 2]
            } else {
                solution.accel_multiplier[step]
            },
            at,
            shares: shares(problem, formula, step, at, solution.kink_width_n),
            tolerance_j: self.tolerance_j,
            most_cells: MOST_CELLS,
        };
        let least = cost.least_j(from, to);
        (least, cost.cost_j(at[0], at[1]) - least)
    }
}

/// How much of each branch the rounded cost takes at a point, as the interior point rounds it.
fn shares(
    problem: &Problem,
    formula: &StepFormula,
    step: usize,
    [from, to]: [f64; 2],
    width_n: f64,
) -> [f64; 3] {
    let road = &problem.steps[step];
    let w = mean_speed(from, to);
    let accel = (to - from) / (2.0 * road.length_m());
    let force = formula.effective_mass_kg * accel
        + formula.standing_force_n(road)
        + (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w;
    let share = |x: f64| 0.5 * (1.0 + x / x.hypot(width_n));
    let limit = formula.regeneration_limit_n(w);
    let above = force + limit;
    let free = share(above);
    let motor = 0.5 * (above + above.hypot(width_n)) - limit;
    let propelled = share(motor);
    let clean = |share: f64| if share < 1e-7 { 0.0 } else { share };
    let [p, r, f] = [free * propelled, free * (1.0 - propelled), 1.0 - free].map(clean);
    let total = p + r + f;
    [p / total, r / total, f / total]
}

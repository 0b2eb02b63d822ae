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

use ev_energy::StepFormula;

use crate::interior_point::{Solution, Task};
use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;
use cells::StepCost;
use curvature::ConvexFrom;
use interval::Interval;

/// Taken off for rounding, as a share of all magnitudes that were summed.
const ROUNDING: f64 = 1e-12;

/// Widths of rounded kinks at which the shares of the branches are read, N.
const KINK_WIDTH_N: f64 = 0.02;

/// Least energy in J, dwells at signals' waits included, that any plan needs for a task.
pub(crate) fn lower_bound_j(
    problem: &Problem,
    formula: &StepFormula,
    reachable: &Reachable,
    task: &Task,
    solution: &Solution,
    tolerance_j: f64,
) -> (f64, usize) {
    let steps = problem.steps.len();
    let z = &solution.z;
    let mut sum = 0.0;
    let mut magnitude = 0.0;
    let mut add = |value: f64| {
        sum += value;
        magnitude += value.abs();
    };
    let mut cells = 0;
    let hull = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(Interval::new(f64::INFINITY, f64::NEG_INFINITY), |hull, value| {
            Interval::new(hull.low.min(value), hull.high.max(value))
        })
    };
    let top_mps = reachable.high.iter().copied().fold(0.0, f64::max).sqrt();
    let (min, max) = problem.envelope.range(0.0, top_mps);
    let standing_n = hull(&mut problem.steps.iter().map(|step| formula.standing_force_n(step)));
    let length_m = hull(&mut problem.steps.iter().map(|step| step.length_m())).high;
    let convex_at = |price_w: f64| {
        ConvexFrom::new(formula, price_w, top_mps, Interval::new(min, max), standing_n, length_m)
    };
    let mut convex = (f64::NAN, ConvexFrom { speed_mps: [f64::INFINITY; 2] });
    let is_table = !problem.envelope.is_constant();
    for k in 0..steps {
        let price_w = solution.step_price_w[k];
        if convex.0.to_bits() != price_w.to_bits() {
            convex = (price_w, convex_at(price_w));
            if std::env::var_os("SPEED_PLAN_TRACE").is_some() { eprintln!("convex {convex:?}"); }
        }
        let shares = shares(problem, formula, k, z[k], z[k + 1]);
        let cost = StepCost {
            convex: convex.1,
            problem,
            formula,
            step: k,
            price_w,
            potential: [solution.potential[k], solution.potential[k + 1]],
            accel_multiplier: if is_table { solution.accel_multiplier[k] } else { [0.0; 2] },
            at: [z[k], onto_kink(problem, formula, reachable, k, [z[k], z[k + 1]], shares)],
            shares,
            tolerance_j: tolerance_j / steps as f64,
            most_cells: 400,
        };
        let range = |k: usize| Interval::new(reachable.low[k], reachable.high[k]);
        let (least, used) = cost.least_j(range(k), range(k + 1));
        if std::env::var_os("SPEED_PLAN_TRACE").is_some() {
            let g = cost.cost_j(z[k], z[k + 1]);
            eprintln!("step {k:4} h {:6.2} v {:6.3}..{:6.3} box {:6.3}..{:6.3} cost {g:12.3} least {least:12.3} loss {:10.4} cells {used} shares {:?}", problem.steps[k].length_m(), z[k].sqrt(), z[k+1].sqrt(), reachable.low[k].sqrt(), reachable.high[k].sqrt(), g - least, cost.shares);
        }
        cells += used;
        add(least);
    }
    // Ends are given: what the potentials take there is added again.
    let p = &solution.potential;
    for (node, sign) in [(0, -1.0), (steps, 1.0)] {
        let end = sign * p[node];
        let z = if end >= 0.0 { reachable.low[node] } else { reachable.high[node] };
        add(end * z);
    }
    for k in 0..steps {
        // The dwell at a node is priced like the step after it.
        let dwell_s = problem.columns.dwell_s[k];
        if dwell_s > 0.0 {
            add((problem.standing_power_w(k) + solution.step_price_w[k]) * dwell_s);
        }
    }
    add(0.0);
    for (bound, multiplier) in task.time_bounds.iter().zip(&solution.multipliers_w) {
        let sign = if bound.at_most { -1.0 } else { 1.0 };
        add(sign * multiplier * bound.time_s);
    }
    (sum - ROUNDING * magnitude, cells)
}

/// The squared speed at the end of a step that lies on a kink: moved onto it, where the box allows.
fn onto_kink(
    problem: &Problem,
    formula: &StepFormula,
    reachable: &Reachable,
    step: usize,
    [from, to]: [f64; 2],
    [propulsion, regeneration, friction]: [f64; 3],
) -> f64 {
    let inside = |share: f64| share > 2.0 && share < 1.0;
    let braked = inside(friction);
    if !braked && !(inside(propulsion) && inside(regeneration)) {
        return to;
    }
    let road = &problem.steps[step];
    let mut moved = to;
    for _ in 0..4 {
        let w = mean_speed(from, moved);
        let limit = if braked { formula.regeneration_limit_n(w) } else { 0.0 };
        let air = (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w;
        let accel = -(limit + formula.standing_force_n(road) + air) / formula.effective_mass_kg;
        moved = from + 2.0 * road.length_m() * accel;
        if !(reachable.low[step + 1] <= moved && moved <= reachable.high[step + 1]) {
            return to;
        }
    }
    moved
}

/// How much of each branch the rounded cost takes at a point.
fn shares(problem: &Problem, formula: &StepFormula, step: usize, from: f64, to: f64) -> [f64; 3] {
    let road = &problem.steps[step];
    let w = mean_speed(from, to);
    let accel = (to - from) / (2.0 * road.length_m());
    let force = formula.effective_mass_kg * accel
        + formula.standing_force_n(road)
        + (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w;
    let share = |x: f64| 0.5 * (1.0 + x / x.hypot(KINK_WIDTH_N));
    let limit = formula.regeneration_limit_n(w);
    let above = force + limit;
    let free = share(above);
    let motor = 0.5 * (above + above.hypot(KINK_WIDTH_N)) - limit;
    let propelled = share(motor);
    let clean = |share: f64| if share < 1e-7 { 0.0 } else { share };
    let [p, r, f] = [free * propelled, free * (1.0 - propelled), 1.0 - free].map(clean);
    let total = p + r + f;
    [p / total, r / total, f / total]
}

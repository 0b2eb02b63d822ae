//! The least that one step can cost at given prices and potentials: branch and bound over its two squared speeds.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use ev_energy::{RoadStep, StepFormula};

use super::curvature::{
    Bend, Branch, Convexity, Patch, below_from, bend, is_below, largest_regeneration, turn,
};
use super::interval::Interval;
use crate::problem::{Problem, mean_speed};

/// By how much rounding may take an acceleration beyond its limit, m/s².
pub(super) const ACCEL_ROUNDING: f64 = 1e-9;

/// Ratio of the ends of slices of the mean speed.
const SLICE_RATIO: f64 = 1.08;

const BRANCHES: [Branch; 3] = [Branch::Propulsion, Branch::Regeneration, Branch::Friction];

/// One step with what is charged for it.
pub(super) struct StepCost<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) formula: &'a StepFormula,
    pub(super) step: usize,
    pub(super) price_w: f64,
    /// Where the branches are known to be convex at that price.
    pub(super) convexity: Option<&'a Convexity>,
    /// Potentials of both ends, J/(m²/s²).
    pub(super) potential: [f64; 2],
    /// Multipliers of the largest and the smallest acceleration of the envelope, J/(m/s²); used where it is a table.
    pub(super) accel_multiplier: [f64; 2],
    /// Squared speeds of the plan.
    pub(super) at: [f64; 2],
    /// Shares of the branches at the plan, where it lies on a kink between them.
    pub(super) shares: [f64; 3],
    /// Within how much of the least the bound is wanted, J.
    pub(super) tolerance_j: f64,
    pub(super) most_cells: usize,
}

/// Squared speeds at both ends, and the mean speeds and accelerations that are looked at.
#[derive(Debug, Clone, Copy)]
struct Cell {
    from: Interval,
    to: Interval,
    w: Interval,
    accel: Interval,
}

/// A cell that may still hold the least, the lowest bound first.
#[derive(Debug, Clone, Copy)]
struct Open {
    bound: f64,
    cell: Cell,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

/// A function of both squared speeds at a point, with its gradient.
#[derive(Debug, Clone, Copy, Default)]
struct Tangent {
    value: f64,
    gradient: [f64; 2],
}

/// Lines above the largest and below the smallest acceleration of an envelope over speed, through the plan's speed.
#[derive(Debug, Clone, Copy, Default)]
struct Lines {
    speed_mps: f64,
    value: [f64; 2],
    per_s: [f64; 2],
}

impl Tangent {
    fn plus(self, other: Self, weight: f64) -> Self {
        Self {
            value: self.value + weight * other.value,
            gradient: [0, 1].map(|k| self.gradient[k] + weight * other.gradient[k]),
        }
    }
}

impl StepCost<'_> {
    fn road(&self) -> &RoadStep {
        &self.problem.steps[self.step]
    }

    fn accel(&self, from: f64, to: f64) -> f64 {
        (to - from) / (2.0 * self.road().length_m())
    }

    fn potential_j(&self, from: f64, to: f64) -> f64 {
        self.potential[0] * from - self.potential[1] * to
    }

    /// What a motion costs; infinite where it cannot be driven.
    pub(super) fn cost_j(&self, from: f64, to: f64) -> f64 {
        let energy_j = self
            .problem
            .model
            .energy_j(self.road(), from.sqrt(), to.sqrt());
        let time_s = self.road().length_m() / mean_speed(from, to);
        energy_j + self.price_w * time_s + self.potential_j(from, to)
    }

    /// A number that no motion between squared speeds within two ranges costs less than, in J.
    pub(super) fn least_j(&self, from: Interval, to: Interval) -> f64 {
        let lines = self.lines();
        let mut best = self.cost_j(self.at[0], self.at[1]);
        let Some(whole) = self.within_accelerations(Cell {
            from,
            to,
            w: Interval::new(0.0, f64::INFINITY),
            accel: Interval::new(f64::NEG_INFINITY, f64::INFINITY),
        }) else {
            // Nothing can be driven: any number is below it.
            return best;
        };
        let (near, rest) = self.convex_part(&whole);
        let mut open: BinaryHeap<Open> = rest
            .into_iter()
            .filter_map(|cell| self.within_accelerations(cell))
            .map(|cell| Open {
                bound: self.flat_slices(&cell),
                cell,
            })
            .collect();
        let mut cells = 0;
        // The cell with the lowest bound first: when it is near enough to the best that was seen, all are.
        while let Some(Open { bound, cell }) = open.pop() {
            if bound >= near.min(best - self.tolerance_j) || cells >= self.most_cells {
                return near.min(bound);
            }
            for half in self.halves(cell) {
                let Some(half) = self.within_accelerations(half) else {
                    continue;
                };
                cells += 1;
                let (tighter, seen) = self.bound(&half, &lines);
                best = best.min(seen);
                open.push(Open {
                    bound: tighter.max(bound),
                    cell: half,
                });
            }
        }
        near.min(best)
    }

    /// The least where the cost is convex, by the tangent plane at the plan, and what is left: what is slower, and what accelerates or brakes
    /// more.
    fn convex_part(&self, cell: &Cell) -> (f64, Vec<Cell>) {
        let nothing = || (f64::INFINITY, vec![*cell]);
        if !self.problem.envelope.is_constant() {
            return nothing();
        }
        let [from, to] = self.at;
        let accel = self.accel(from, to);
        // Where the car does not pass as planned, the nearest point may brake harder than any motion for which convexity is known.
        if accel < cell.accel.low - ACCEL_ROUNDING {
            return nothing();
        }
        let convexity = self
            .convexity
            .and_then(|convexity| convexity.part(cell.w.high, self.shares, accel));
        let Some(convex) = convexity else {
            return nothing();
        };
        let formula = self.formula;
        let (b, c) = (formula.linear_n_per_mps, formula.quadratic_n_per_mps2);
        let air = (cell.w * c + Interval::point(b)) * cell.w;
        let resistance_n = formula.standing_force_n(self.road()) + air.low.min(0.0);
        let length_m = self.road().length_m();
        let below_from = below_from(formula, length_m, cell.accel.low, resistance_n);
        let from_mps = convex.from_mps.max(below_from).max(cell.w.low);
        if from_mps >= mean_speed(from, to) {
            return nothing();
        }
        let mut tangent = Tangent::default();
        for (branch, share) in BRANCHES.into_iter().zip(self.shares) {
            if share > 0.0 {
                tangent = tangent.plus(self.branch_tangent(branch, self.at, false), share);
            }
        }
        tangent.value += self.potential_j(from, to);
        tangent.gradient[0] += self.potential[0];
        tangent.gradient[1] -= self.potential[1];
        let accel = Interval::new(
            cell.accel.low.max(convex.accel.low),
            cell.accel.high.min(convex.accel.high),
        );
        let near = tangent.value + self.lowest_linear(cell, accel, self.at, tangent.gradient);
        let mut rest = Vec::with_capacity(3);
        let w = Interval::new(from_mps, cell.w.high);
        let mut add = |w: Interval, accel: Interval| {
            if w.low < w.high && accel.low < accel.high {
                rest.push(Cell { w, accel, ..*cell });
            }
        };
        add(Interval::new(cell.w.low, from_mps), cell.accel);
        add(w, Interval::new(accel.high, cell.accel.high));
        add(w, Interval::new(cell.accel.low, accel.low));
        (near, rest)
    }

    /// The lowest of flat bounds over slices of the mean speed.
    fn flat_slices(&self, cell: &Cell) -> f64 {
        let length_m = self.road().length_m();
        let mut least = f64::INFINITY;
        let mut high = cell.w.high;
        // At least once: a step between given speeds is a single motion.
        loop {
            let slice = Interval::new((high / SLICE_RATIO).max(cell.w.low), high);
            // No end is below 0; from standstill, this is the acceleration but for rounding.
            let most = 2.0 * (1.0 + 1e-12) * high * high / length_m;
            let accel = Interval::new(cell.accel.low.max(-most), cell.accel.high.min(most));
            let apart = accel.magnitude() * length_m / (2.0 * slice.low);
            let sum = Interval::new(
                (2.0 * slice.low * slice.low).max(cell.from.low + cell.to.low),
                (2.0 * (high * high + apart * apart)).min(cell.from.high + cell.to.high),
            );
            if accel.low <= accel.high {
                least = least.min(self.flat_bound(sum, slice, accel));
            }
            high = slice.low;
            if high <= cell.w.low {
                return least;
            }
        }
    }

    /// All motions on the way from a point of a cell's rectangle to any of its motions: cuts by speed or acceleration leave no convex set
    /// with the point in it.
    fn hull(&self, cell: &Cell, at: [f64; 2], lines: &Lines) -> Patch {
        let formula = self.formula;
        let (b, c) = (formula.linear_n_per_mps, formula.quadratic_n_per_mps2);
        let w = Interval::new(
            mean_speed(cell.from.low, cell.to.low),
            mean_speed(cell.from.high, cell.to.high),
        );
        let own = self.accel(at[0], at[1]);
        let accel = Interval::new(cell.accel.low.min(own), cell.accel.high.max(own));
        let air = (w * c + Interval::point(b)) * w;
        let standing_n = formula.standing_force_n(self.road());
        // From or to standstill σ is linear in the other end.
        let is_still = cell.from.high <= 0.0 || cell.to.high <= 0.0;
        Patch {
            w,
            force: accel * formula.effective_mass_kg + air + Interval::point(standing_n),
            accel,
            speed_product: (!is_still).then(|| (cell.from.low * cell.to.low).sqrt()),
            length_m: self.road().length_m(),
            price_w: self.price_w,
            linear_in_w: self.linear_in_w(lines),
        }
    }

    fn lines(&self) -> Lines {
        let envelope = &self.problem.envelope;
        let speed_mps = mean_speed(self.at[0], self.at[1]);
        let (max, min) = (envelope.max_at(speed_mps), envelope.min_at(speed_mps));
        Lines {
            speed_mps,
            value: [max.accel_mps2, min.accel_mps2],
            per_s: [max.per_s, min.per_s],
        }
    }

    /// Cuts off what no acceleration of the cell reaches; `None` where nothing is left.
    fn within_accelerations(&self, cell: Cell) -> Option<Cell> {
        let reach = 2.0 * self.road().length_m();
        let w = self.mean(&cell);
        let (min, max) = self.problem.envelope.range(w.low, w.high);
        let (min, max) = (min.max(cell.accel.low), max.min(cell.accel.high));
        let slack = 1e-12 * (1.0 + cell.to.high);
        let to = Interval::new(
            cell.to.low.max(cell.from.low + reach * min - slack),
            cell.to.high.min(cell.from.high + reach * max + slack),
        );
        let from = Interval::new(
            cell.from.low.max(to.low - reach * max - slack),
            cell.from.high.min(to.high - reach * min + slack),
        );
        let cut = Cell {
            from,
            to,
            accel: Interval::new(
                min.max(self.accel(from.high, to.low)),
                max.min(self.accel(from.low, to.high)),
            ),
            ..cell
        };
        if to.low > to.high || from.low > from.high {
            return None;
        }
        let w = self.mean(&cut);
        (w.low <= w.high && cut.accel.low <= cut.accel.high).then_some(Cell { w, ..cut })
    }

    fn mean(&self, cell: &Cell) -> Interval {
        Interval::new(
            mean_speed(cell.from.low, cell.to.low).max(cell.w.low),
            mean_speed(cell.from.high, cell.to.high).min(cell.w.high),
        )
    }

    /// Halves the range of speeds of the end where it is wider.
    fn halves(&self, cell: Cell) -> [Cell; 2] {
        let wide = |range: Interval| range.high.sqrt() - range.low.sqrt();
        let halves = |range: Interval| {
            let speed = mean_speed(range.low, range.high);
            let middle = speed * speed;
            [
                Interval::new(range.low, middle),
                Interval::new(middle, range.high),
            ]
        };
        if wide(cell.from) >= wide(cell.to) {
            halves(cell.from).map(|from| Cell { from, ..cell })
        } else {
            halves(cell.to).map(|to| Cell { to, ..cell })
        }
    }

    /// A lower bound over a cell, and the least cost that was seen in it.
    fn bound(&self, cell: &Cell, lines: &Lines) -> (f64, f64) {
        let (w, accel) = (cell.w, cell.accel);
        if mean_speed(cell.from.low, cell.to.low) <= 0.0 {
            // Only a step from and to standstill: it is never driven.
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let sum = Interval::new(cell.from.low + cell.to.low, cell.from.high + cell.to.high);
        let flat = self.flat_bound(sum, w, accel);
        let is_plan = cell.from.contains(self.at[0]) && cell.to.contains(self.at[1]);
        let at = if is_plan { self.at } else { self.nearest(cell) };
        let patch = self.hull(cell, at, lines);
        let seen = if is_plan {
            f64::INFINITY
        } else {
            self.cost_j(at[0], at[1])
        };
        // On the plan's kink its shares balance the slopes of its branches at other speeds too.
        let on_kink = self.shares.iter().all(|share| *share < 1.0);
        let shares = if is_plan || on_kink {
            self.shares
        } else {
            self.shares_at(at)
        };
        let tangent = self.tangent_bound(cell, &patch, at, shares, lines);
        (flat.max(tangent), seen)
    }

    /// The point of a cell that is nearest to the plan, more or less.
    fn nearest(&self, cell: &Cell) -> [f64; 2] {
        let from = self.at[0].clamp(cell.from.low, cell.from.high);
        let reach = 2.0 * self.road().length_m();
        let (min, max) = (cell.accel.low, cell.accel.high);
        let to = self.at[1].clamp(cell.to.low, cell.to.high);
        let to = to.max(from + reach * min).min(from + reach * max);
        [from, to.clamp(cell.to.low, cell.to.high)]
    }

    fn shares_at(&self, at: [f64; 2]) -> [f64; 3] {
        let formula = self.formula;
        let w = mean_speed(at[0], at[1]);
        let force = formula.effective_mass_kg * self.accel(at[0], at[1])
            + formula.standing_force_n(self.road())
            + (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w;
        if force >= 0.0 {
            [1.0, 0.0, 0.0]
        } else if force >= -formula.regeneration_limit_n(w) {
            [0.0, 1.0, 0.0]
        } else {
            [0.0, 0.0, 1.0]
        }
    }

    fn linear_in_w(&self, lines: &Lines) -> f64 {
        let [upper, lower] = self.accel_multiplier;
        (lower * lines.per_s[1] - upper * lines.per_s[0]) / self.road().length_m()
    }

    /// What the multipliers of a table of accelerations add to the cost: at most 0 at every motion that is allowed, but for a rest
    /// where the table lies beyond its line; and that rest over a range of speeds.
    fn accel_terms(&self, at: [f64; 2], w: Interval, lines: &Lines) -> (Tangent, f64) {
        let [upper, lower] = self.accel_multiplier;
        if upper <= 0.0 && lower <= 0.0 {
            return (Tangent::default(), 0.0);
        }
        let line =
            |k: usize, speed: f64| lines.value[k] + lines.per_s[k] * (speed - lines.speed_mps);
        let speed = mean_speed(at[0], at[1]);
        let accel = self.accel(at[0], at[1]);
        let value = upper * (accel - line(0, speed)) + lower * (line(1, speed) - accel);
        let per_accel = (upper - lower) / (2.0 * self.road().length_m());
        let per_speed = lower * lines.per_s[1] - upper * lines.per_s[0];
        let by_z = |z: f64| if z > 0.0 { 0.25 / z.sqrt() } else { 0.0 };
        let gradient = [
            per_speed * by_z(at[0]) - per_accel,
            per_speed * by_z(at[1]) + per_accel,
        ];
        let envelope = &self.problem.envelope;
        let corners = envelope
            .points()
            .iter()
            .map(|point| point.speed_mps)
            .filter(|speed| w.low < *speed && *speed < w.high)
            .chain([w.low, w.high]);
        let rest = corners
            .map(|speed| {
                let above = (envelope.max_at(speed).accel_mps2 - line(0, speed)).max(0.0);
                let below = (line(1, speed) - envelope.min_at(speed).accel_mps2).max(0.0);
                upper * above + lower * below
            })
            .fold(0.0, f64::max);
        (Tangent { value, gradient }, rest)
    }

    /// By a tangent plane of the weighted branches, less what they may bend downwards.
    fn tangent_bound(
        &self,
        cell: &Cell,
        patch: &Patch,
        at: [f64; 2],
        shares: [f64; 3],
        lines: &Lines,
    ) -> f64 {
        if [cell.from, cell.to]
            .iter()
            .any(|end| end.low <= 0.0 && 0.0 < end.high)
        {
            // No slope at standstill.
            return f64::NEG_INFINITY;
        }
        let fades = patch.w.high > self.formula.fade_start_mps;
        let mut total = Bend::default();
        let mut tangent = Tangent::default();
        for (branch, share) in BRANCHES.into_iter().zip(shares) {
            if share <= 0.0 {
                continue;
            }
            if !is_below(self.formula, branch, patch) {
                return f64::NEG_INFINITY;
            }
            let Some(bend) = bend(self.formula, branch, patch) else {
                return f64::NEG_INFINITY;
            };
            total = total.plus(bend, share);
            tangent = tangent.plus(self.branch_tangent(branch, at, fades), share);
        }
        let (accel, rest) = self.accel_terms(at, patch.w, lines);
        tangent.value += accel.value + self.potential_j(at[0], at[1]) - rest;
        tangent.gradient[0] += accel.gradient[0] + self.potential[0];
        tangent.gradient[1] += accel.gradient[1] - self.potential[1];

        let defect = total.defect(self.formula, patch);
        let bent = if defect.is_none() {
            0.0
        } else {
            let far = |range: Interval, at: f64| (range.high - at).max(at - range.low);
            let per = |range: Interval| {
                if range.high > range.low {
                    0.25 / range.low.sqrt()
                } else {
                    0.0
                }
            };
            let (from, to) = (far(cell.from, at[0]), far(cell.to, at[1]));
            let s = from * per(cell.from) + to * per(cell.to);
            let length_m = self.road().length_m();
            let r = self.formula.effective_mass_kg * 0.5 / length_m * (from + to)
                + turn(self.formula, patch) * s;
            0.5 * length_m * (defect.w * s * s + defect.rho * r * r)
        };
        // Not a number is no bound.
        let bent = if bent.is_nan() {
            f64::NEG_INFINITY
        } else {
            bent
        };
        tangent.value + bent + self.lowest_linear(cell, patch.accel, at, tangent.gradient)
    }

    /// Least of a linear function of the distance from a point, over a cell within a range of accelerations.
    fn lowest_linear(&self, cell: &Cell, accel: Interval, at: [f64; 2], gradient: [f64; 2]) -> f64 {
        let reach = 2.0 * self.road().length_m();
        let (least, most) = (reach * accel.low, reach * accel.high);
        let corners = [
            cell.from.low,
            cell.from.high,
            cell.to.low - least,
            cell.to.low - most,
            cell.to.high - least,
            cell.to.high - most,
        ];
        let mut lowest = f64::INFINITY;
        for from in corners {
            let from = from.clamp(cell.from.low, cell.from.high);
            let low = cell.to.low.max(from + least);
            let high = cell.to.high.min(from + most);
            // Rounding may leave nothing between them; both ends then are beyond what can be.
            for to in [low, high] {
                let value = gradient[0] * (from - at[0]) + gradient[1] * (to - at[1]);
                lowest = lowest.min(value);
            }
        }
        lowest
    }

    /// Energy and price of time on one branch; where regeneration begins, of the speeds beyond if it `fades`, else of those before.
    fn branch_tangent(&self, branch: Branch, at: [f64; 2], fades: bool) -> Tangent {
        let formula = self.formula;
        let [from, to] = at;
        let (v0, v1) = (from.sqrt(), to.sqrt());
        let w = 0.5 * (v0 + v1);
        let length_m = self.road().length_m();
        let gamma = match branch {
            Branch::Propulsion => formula.propelling_nm_per_n,
            Branch::Regeneration | Branch::Friction => formula.braking_nm_per_n,
        };
        let (b, c) = (formula.linear_n_per_mps, formula.quadratic_n_per_mps2);
        let (force, force_w, force_a) = if branch == Branch::Friction {
            let (r, r_w) = self.regeneration(w, fades);
            (-r, -r_w, 0.0)
        } else {
            let force = formula.effective_mass_kg * self.accel(from, to)
                + formula.standing_force_n(self.road())
                + (b + c * w) * w;
            (force, b + 2.0 * c * w, formula.effective_mass_kg)
        };
        let gear = gamma * formula.motor_speed_per_mps;
        let copper = formula.copper_w_per_nm2 * gamma * gamma;
        let weak = (w > formula.weakening_from_mps && formula.weakening_w > 0.0)
            .then_some(formula.weakening_w * formula.weakening_from_mps);
        let idle = formula.constant_w
            + (formula.iron_w_per_mps + formula.windage_w_per_mps3 * w * w) * w
            + weak.map_or(0.0, |weak| formula.weakening_w - weak / w);
        let idle_w = formula.iron_w_per_mps
            + 3.0 * formula.windage_w_per_mps3 * w * w
            + weak.map_or(0.0, |weak| weak / (w * w));
        let power = (gear * w + copper * force) * force + idle;
        let by_force = gear * w + 2.0 * copper * force;
        let power_w = gear * force + by_force * force_w + idle_w;
        let power_a = by_force * force_a;
        let [cells, slope, _] = formula.cells_power(power);
        let dt = length_m / w;
        let total = cells + self.price_w;
        let by_w = slope * power_w * dt - total * dt / w;
        let by_a = slope * power_a * dt * 0.5 / length_m;
        let by_z = |v: f64| if v > 0.0 { 0.25 / v } else { 0.0 };
        Tangent {
            value: total * dt,
            gradient: [by_w * by_z(v0) - by_a, by_w * by_z(v1) + by_a],
        }
    }

    /// Limit of regeneration and its slope; where it begins, of the speeds beyond if it `fades`.
    fn regeneration(&self, w: f64, fades: bool) -> (f64, f64) {
        let formula = self.formula;
        let (start, end) = (formula.fade_start_mps, formula.fade_end_mps);
        let by_power = formula.regeneration_w / w;
        let (limit, limit_w) = if by_power < formula.regeneration_n {
            (by_power, -by_power / w)
        } else {
            (formula.regeneration_n, 0.0)
        };
        let per = 1.0 / (end - start);
        if w < start || w <= start && !fades {
            (0.0, 0.0)
        } else if w >= end {
            (limit, limit_w)
        } else {
            let fade = (w - start) * per;
            (fade * limit, per * limit + fade * limit_w)
        }
    }

    /// With every term at its least: the force costs no less than `η F`, `F/η` or regeneration at its limit gives.
    fn flat_bound(&self, sum: Interval, w: Interval, accel: Interval) -> f64 {
        let formula = self.formula;
        let (b, c2) = (formula.linear_n_per_mps, formula.quadratic_n_per_mps2);
        let air = (w * c2 + Interval::point(b)) * w;
        let resistance_n = formula.standing_force_n(self.road()) + air.low;
        let length_m = self.road().length_m();
        let c = formula.motor_speed_per_mps;
        let (up, down) = (
            c * formula.propelling_nm_per_n,
            c * formula.braking_nm_per_n,
        );
        let regeneration = largest_regeneration(formula, w);
        let constant = formula.constant_w + self.price_w;
        let idle = constant / if constant >= 0.0 { w.high } else { w.low }
            + formula.iron_w_per_mps
            + formula.windage_w_per_mps3 * w.low * w.low;
        let middle = 0.5 * (self.potential[0] + self.potential[1]);
        let difference = 0.5 * (self.potential[0] - self.potential[1]);
        let sum = if difference >= 0.0 { sum.low } else { sum.high };
        let mass_kg = formula.effective_mass_kg;
        let at = |accel: f64| {
            let force = mass_kg * accel + resistance_n;
            let spent = if force >= 0.0 {
                up * force
            } else {
                down * force.max(-regeneration)
            };
            length_m * (spent - 2.0 * middle * accel)
        };
        let kinks = [
            -resistance_n / mass_kg,
            (-regeneration - resistance_n) / mass_kg,
        ];
        // What copper and the resistance of the battery take at the weakest propulsion: D ≥ R P²/U0².
        let weakest = (mass_kg * accel.low + resistance_n).max(0.0);
        let torque = formula.propelling_nm_per_n * weakest;
        let copper_w = formula.copper_w_per_nm2 * torque * torque;
        let power_w = if weakest > 0.0 {
            up * weakest * w.low + copper_w
        } else {
            0.0
        };
        let battery_w =
            formula.resistance_ohm * (power_w / formula.voltage_v) * (power_w / formula.voltage_v);
        let lost = (copper_w + battery_w) / w.high;
        let least = kinks
            .into_iter()
            .filter(|kink| accel.low < *kink && *kink < accel.high)
            .chain([accel.low, accel.high])
            .map(at)
            .fold(f64::INFINITY, f64::min);
        let flat = length_m * (idle + lost) + difference * sum + least;
        let lines = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            self.shares,
        ];
        lines
            .map(|shares| self.line_bound(shares, w, accel, copper_w + battery_w))
            .into_iter()
            .fold(flat, f64::max)
    }

    /// With a line below the energy over the force, `s F − s_f R`: what is left depends on the speed alone, term by term above or on
    /// a line over a slice of speeds. `lost_w` is what losses take at least.
    fn line_bound(&self, shares: [f64; 3], w: Interval, accel: Interval, lost_w: f64) -> f64 {
        let formula = self.formula;
        let length_m = self.road().length_m();
        let c = formula.motor_speed_per_mps;
        let (up, down) = (
            c * formula.propelling_nm_per_n,
            c * formula.braking_nm_per_n,
        );
        let per_force = shares[0] * up + shares[1] * down;
        let braked = shares[2] * down * largest_regeneration(formula, w);
        let middle = 0.5 * (self.potential[0] + self.potential[1]);
        let difference = (self.potential[0] - self.potential[1]) / length_m;
        // By the acceleration.
        let per_accel = per_force * formula.effective_mass_kg - 2.0 * middle;
        let by_accel = (per_accel * accel.low).min(per_accel * accel.high);
        let apart = accel.magnitude() * length_m / (2.0 * w.low);
        let by_apart = difference.min(0.0) * apart * apart;
        // By the speed: k₂ w² + k₁ w + k₀/w.
        let square =
            per_force * formula.quadratic_n_per_mps2 + formula.windage_w_per_mps3 + difference;
        let slope = per_force * formula.linear_n_per_mps;
        let inverse = formula.constant_w + self.price_w + lost_w;
        let squares = below(square, w, |w| w * w, |w| 2.0 * w);
        let inverses = below(inverse, w, |w| 1.0 / w, |w| -1.0 / (w * w));
        let by_speed = |k: usize, w: f64| squares[k] + slope * w + inverses[k];
        let fixed =
            per_force * formula.standing_force_n(self.road()) + formula.iron_w_per_mps - braked;
        length_m * (fixed + by_accel + by_apart + by_speed(0, w.low).min(by_speed(1, w.high)))
    }
}

/// A line below a multiple of a convex function over a range, by its values at both ends: a tangent in the middle, or the chord where
/// the factor is below 0.
fn below(
    factor: f64,
    range: Interval,
    function: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let Interval { low, high } = range;
    if factor < 0.0 {
        return [low, high].map(|end| factor * function(end));
    }
    let middle = 0.5 * (low + high);
    [low, high].map(|end| factor * (function(middle) + slope(middle) * (end - middle)))
}

/// What the attacks of [`super::tests`] look at.
#[cfg(test)]
impl StepCost<'_> {
    /// Cost without potentials on one branch, and its gradient.
    pub(super) fn on_branch(&self, branch: Branch, at: [f64; 2]) -> [f64; 3] {
        let Tangent { value, gradient } = self.branch_tangent(branch, at, true);
        [value, gradient[0], gradient[1]]
    }

    /// Gradient of the weighted branches without potentials.
    pub(super) fn slope(&self, at: [f64; 2]) -> [f64; 2] {
        let branches = BRANCHES.into_iter().zip(self.shares);
        branches.fold([0.0; 2], |slope, (branch, share)| {
            let of_branch = self.branch_tangent(branch, at, true).gradient;
            [0, 1].map(|k| slope[k] + share * of_branch[k])
        })
    }

    /// What is claimed of a branch within ranges: how much it may bend downwards, and whether it is nowhere above the cost.
    pub(super) fn claims(
        &self,
        branch: Branch,
        [from, to]: [Interval; 2],
    ) -> Option<(super::curvature::Defect, bool)> {
        let cell = Cell {
            from,
            to,
            w: Interval::new(mean_speed(from.low, to.low), mean_speed(from.high, to.high)),
            accel: Interval::new(self.accel(from.high, to.low), self.accel(from.low, to.high)),
        };
        let patch = self.hull(&cell, [from.low, to.low], &self.lines());
        let below = is_below(self.formula, branch, &patch);
        // The friction branch bends as claimed only where it is below.
        let bend =
            bend(self.formula, branch, &patch).filter(|_| below || branch != Branch::Friction)?;
        Some((bend.defect(self.formula, &patch), below))
    }
}

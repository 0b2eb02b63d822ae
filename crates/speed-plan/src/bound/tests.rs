//! Attacks on the bound of one step: random cars, steps, boxes, prices and potentials against a search.

#![allow(clippy::unwrap_used, clippy::panic)]

use ev_energy::{RoadLoadSpec, StepModel, Vehicle, library};

use super::cells::StepCost;
use super::curvature::{Branch, Convexity, Ranges};
use super::interval::Interval;
use super::shares;
use crate::envelope::{Envelope, EnvelopePoint};
use crate::problem::{Columns, Problem, mean_speed};

/// Cases of every attack; more with `BOUND_CASES`.
fn cases(usual: u64) -> u64 {
    let asked = std::env::var("BOUND_CASES").ok();
    asked.and_then(|count| count.parse().ok()).unwrap_or(usual)
}

/// Random numbers (splitmix64).
struct Dice(u64);

impl Dice {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Even in the logarithm.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    fn chance(&mut self, share: f64) -> bool {
        self.share() < share
    }

    fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// A built-in car, mostly with other parameters.
    fn car(&mut self) -> Vehicle {
        let names: Vec<&str> = library::names().collect();
        let name = names[(self.share() * names.len() as f64) as usize];
        let mut spec = Vehicle::builtin(name).unwrap().spec().clone();
        spec.sources.clear();
        spec.calibration = None;
        if self.chance(0.6) {
            spec.regeneration.torque_fraction = if self.chance(0.1) { 0.0 } else { self.share() };
            spec.regeneration.max_power_w = self.scale(1e2, 2e5);
            spec.regeneration.max_decel_mps2 = self.scale(0.05, 8.0);
            spec.regeneration.fade_start_mps = self.within(0.0, 10.0);
            spec.regeneration.fade_end_mps =
                spec.regeneration.fade_start_mps + self.scale(0.05, 20.0);
        }
        if self.chance(0.5) {
            spec.mass_kg *= self.scale(0.3, 8.0);
        }
        if self.chance(0.5) {
            spec.gear_efficiency = self.within(0.7, 1.0);
        }
        if self.chance(0.5) {
            spec.auxiliary_power_w = self.scale(1.0, 1e4);
        }
        if self.chance(0.4) {
            spec.road_load = RoadLoadSpec::CoastDown {
                constant_n: self.within(0.0, 400.0),
                linear_n_per_mps: self.sign() * self.scale(0.1, 30.0),
                quadratic_n_per_mps2: self.within(0.0, 1.5),
            };
        }
        if self.chance(0.5) {
            let (copper, weakening, spin) = (self.chance(0.2), self.chance(0.5), self.chance(0.5));
            let loss = spec.motor.loss.as_mut().unwrap();
            loss.copper_w_per_nm2 *= if copper { 0.0 } else { self.scale(0.1, 30.0) };
            if weakening {
                loss.weakening_w = self.scale(100.0, 2e4);
                loss.weakening_from_share = self.within(0.05, 0.9);
            }
            if spin {
                loss.windage_w_per_rad3_s3 *= self.scale(0.1, 30.0);
                loss.constant_w *= self.scale(0.1, 10.0);
                loss.spin_share_in_road_load = self.share();
            }
        }
        if self.chance(0.4) {
            spec.battery.resistance_ohm = if self.chance(0.2) {
                0.0
            } else {
                self.scale(0.01, 2.0)
            };
        }
        Vehicle::new(spec).unwrap()
    }

    fn envelope(&mut self) -> Envelope {
        if self.chance(0.3) {
            return Envelope::default();
        }
        if self.chance(0.5) {
            return Envelope::constant(-self.scale(0.1, 8.0), self.scale(0.1, 6.0)).unwrap();
        }
        let mut speed_mps = 0.0;
        let points = (0..2 + (3.0 * self.share()) as usize).map(|_| {
            speed_mps += self.scale(0.5, 15.0);
            EnvelopePoint {
                speed_mps,
                min_mps2: -self.scale(0.3, 5.0),
                max_mps2: self.scale(0.2, 4.0),
            }
        });
        Envelope::new(points.collect()).unwrap()
    }

    /// Squared speeds between two that are not 0, or 0 alone.
    fn range(&mut self, still: bool) -> Interval {
        if still {
            return Interval::point(0.0);
        }
        let low = self.scale(0.5, 35.0);
        let wide = if self.chance(0.1) {
            0.0
        } else {
            self.scale(1e-3, 30.0)
        };
        Interval::new(low * low, (low + wide) * (low + wide))
    }

    /// Squared speeds of both ends, of which some can be driven, as a rule.
    fn boxes(&mut self, length_m: f64) -> [Interval; 2] {
        let still = self.chance(0.15);
        let from = self.range(still);
        let mut to = self.range(false);
        if self.chance(0.8) {
            let reach = 2.0 * length_m;
            let middle = self.within(from.low, from.high) + reach * self.within(-2.0, 2.0);
            let wide = reach * self.scale(1e-3, 3.0);
            to = Interval::new((middle - wide).max(0.25), (middle + wide).max(0.3));
        }
        if self.chance(0.5) {
            [from, to]
        } else {
            [to, from]
        }
    }

    fn point(&mut self, [from, to]: [Interval; 2]) -> [f64; 2] {
        [
            self.within(from.low, from.high),
            self.within(to.low, to.high),
        ]
    }

    fn price_w(&mut self) -> f64 {
        if self.chance(0.1) {
            0.0
        } else if self.chance(0.7) {
            self.scale(10.0, 5e4)
        } else {
            -self.scale(10.0, 1e4)
        }
    }
}

fn step_problem(car: &Vehicle, envelope: Envelope, length_m: f64, slope_rad: f64) -> Problem<'_> {
    let columns = Columns {
        position_m: vec![0.0, length_m],
        slope_rad: vec![slope_rad],
        min_mps: vec![1.0; 2],
        max_mps: vec![100.0; 2],
        dwell_s: vec![0.0; 2],
        signals: Vec::new(),
        earliest_s: Vec::new(),
    };
    Problem::new(StepModel::new(car), envelope, columns).unwrap()
}

fn random_problem<'a>(dice: &mut Dice, car: &'a Vehicle) -> Problem<'a> {
    let (length_m, slope_rad) = (dice.scale(0.5, 200.0), dice.within(-0.15, 0.15));
    let envelope = dice.envelope();
    step_problem(car, envelope, length_m, slope_rad)
}

fn ranges_of(problem: &Problem, top_mps: f64) -> Ranges {
    let formula = problem.model.formula().unwrap();
    let (min, max) = problem.envelope.range(0.0, top_mps);
    Ranges {
        top_mps,
        accel: Interval::new(min, max),
        standing_n: Interval::point(formula.standing_force_n(&problem.steps[0])),
        longest_m: problem.steps[0].length_m(),
    }
}

/// The lowest cost that a raster and its zooms find of motions that are allowed.
fn searched_j(cost: &StepCost, [from, to]: [Interval; 2], points: usize) -> f64 {
    let problem = cost.problem;
    let reach = 2.0 * problem.steps[0].length_m();
    let at = |z0: f64, z1: f64| {
        let w = mean_speed(z0, z1);
        let accel = (z1 - z0) / reach;
        let (min, max) = (problem.envelope.min_at(w), problem.envelope.max_at(w));
        if w <= 0.0 || accel < min.accel_mps2 || accel > max.accel_mps2 {
            f64::INFINITY
        } else {
            cost.cost_j(z0, z1)
        }
    };
    // In the speed of the start and in the squared speed of the end within what the acceleration leaves.
    let mut best = (f64::INFINITY, [from.low, to.low]);
    let see = |best: &mut (f64, [f64; 2]), z0: f64, z1: f64| {
        let value = at(z0, z1);
        if value < best.0 {
            *best = (value, [z0, z1]);
        }
    };
    see(&mut best, cost.at[0], cost.at[1]);
    let (mut middle, mut half) = ([0.5; 2], [0.5; 2]);
    for _ in 0..6 {
        let center = middle;
        let mut found = (f64::INFINITY, center);
        for i in 0..=points {
            for j in 0..=points {
                let share = |k: usize, i: usize| {
                    (center[k] + half[k] * (2.0 * i as f64 / points as f64 - 1.0)).clamp(0.0, 1.0)
                };
                let (s, t) = (share(0, i), share(1, j));
                let v0 = from.low.sqrt() + s * (from.high.sqrt() - from.low.sqrt());
                let z0 = (v0 * v0).clamp(from.low, from.high);
                let (min, max) = problem.envelope.range(0.0, 100.0);
                let low = to.low.max(z0 + reach * min);
                let high = to.high.min(z0 + reach * max);
                if low > high {
                    continue;
                }
                let z1 = (low + t * (high - low)).clamp(to.low, to.high);
                see(&mut best, z0, z1);
                let value = at(z0, z1);
                if value < found.0 {
                    found = (value, [s, t]);
                }
            }
        }
        middle = found.1;
        half = half.map(|half| half * 3.0 / points as f64);
    }
    // Around kinks: motions of no force, and at the limit of regeneration.
    let formula = cost.formula;
    for i in 0..=points {
        let v0 = from.low.sqrt() + (from.high.sqrt() - from.low.sqrt()) * i as f64 / points as f64;
        let z0 = (v0 * v0).clamp(from.low, from.high);
        for limited in [false, true] {
            let force = |z1: f64| {
                let w = mean_speed(z0, z1);
                let limit = if limited {
                    formula.regeneration_limit_n(w)
                } else {
                    0.0
                };
                formula.effective_mass_kg * (z1 - z0) / reach
                    + formula.standing_force_n(&problem.steps[0])
                    + (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w
                    + limit
            };
            let (mut low, mut high) = (to.low, to.high);
            if z0 + low <= 0.0 || force(low) > 0.0 || force(high) < 0.0 {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if force(middle) < 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            see(&mut best, z0, low);
            see(&mut best, z0, high);
        }
    }
    best.0
}

#[test]
fn no_motion_costs_less_than_the_least() {
    let count = cases(400);
    let mut tight = 0;
    for case in 0..count {
        let mut dice = Dice(case.wrapping_mul(0x1234_5677) + 1);
        let car = dice.car();
        let problem = random_problem(&mut dice, &car);
        let formula = problem.model.formula().unwrap();
        let length_m = problem.steps[0].length_m();
        let ends = dice.boxes(length_m);
        // A plan that can be driven, or any.
        let mut at = dice.point(ends);
        for _ in 0..40 {
            let w = mean_speed(at[0], at[1]);
            let accel = (at[1] - at[0]) / (2.0 * length_m);
            if problem.min_accel(w) <= accel && accel <= problem.max_accel(0, w) {
                break;
            }
            if dice.chance(0.02) {
                break;
            }
            at = dice.point(ends);
        }
        let price_w = dice.price_w();
        let top_mps = ends[0].high.max(ends[1].high).sqrt();
        let convexity = dice
            .chance(0.7)
            .then(|| Convexity::new(&formula, price_w, &ranges_of(&problem, top_mps)));
        let width_n = dice.scale(0.02, 300.0);
        let shares = if dice.chance(0.8) {
            shares(&problem, &formula, 0, at, width_n)
        } else {
            let parts = [dice.share(), dice.share(), dice.share()];
            let whole: f64 = parts.iter().sum();
            parts.map(|part| part / whole)
        };
        let mut cost = StepCost {
            problem: &problem,
            formula: &formula,
            step: 0,
            price_w,
            convexity: convexity.as_ref(),
            potential: [0.0; 2],
            accel_multiplier: if problem.envelope.is_constant() || dice.chance(0.3) {
                [0.0; 2]
            } else {
                [dice.scale(1.0, 1e5), dice.scale(1.0, 1e5)]
            },
            at,
            shares,
            tolerance_j: dice.scale(1e-6, 1.0),
            most_cells: 400,
        };
        // Potentials with which the plan is stationary, or nearly so.
        if dice.chance(0.7) {
            let slope = cost.slope(at);
            let off = if dice.chance(0.5) {
                0.0
            } else {
                dice.scale(1e-3, 300.0)
            };
            cost.potential = [
                -slope[0] + off * dice.within(-1.0, 1.0),
                slope[1] + off * dice.within(-1.0, 1.0),
            ];
        } else {
            cost.potential = [0, 1].map(|_| dice.within(-2.0, 2.0) * formula.effective_mass_kg);
        }
        let least_j = cost.least_j(ends[0], ends[1]);
        let searched_j = searched_j(&cost, ends, 40);
        if !searched_j.is_finite() {
            continue;
        }
        let magnitude = cost.potential[0].abs() * ends[0].high
            + cost.potential[1].abs() * ends[1].high
            + searched_j.abs();
        assert!(
            least_j <= searched_j + 1e-11 * magnitude,
            "case {case}: {least_j} J is not the least, {searched_j} J is less by {}; at {at:?}, {ends:?}, price {price_w}, {shares:?}, {:?}, {formula:?}, {length_m}",
            least_j - searched_j,
            problem.envelope
        );
        if least_j > searched_j - cost.tolerance_j - 1e-3 * searched_j.abs() {
            tight += 1;
        }
    }
    assert!(tight > count / 4, "only {tight} of {count} are tight");
}

#[test]
fn second_derivatives_are_no_lower_than_claimed() {
    let mut claims = 0;
    for case in 0..cases(2_000) {
        let mut dice = Dice(case.wrapping_mul(0x7654_3217) + 5);
        let car = dice.car();
        let problem = random_problem(&mut dice, &car);
        let formula = problem.model.formula().unwrap();
        let length_m = problem.steps[0].length_m();
        let v = [dice.scale(0.3, 35.0), dice.scale(0.3, 35.0)];
        let wide = dice.scale(1e-4, 1.0);
        let ends = v.map(|v| Interval::new(v * v, v * v * (1.0 + wide)));
        let price_w = dice.price_w();
        let cost = StepCost {
            problem: &problem,
            formula: &formula,
            step: 0,
            price_w,
            convexity: None,
            potential: [0.0; 2],
            accel_multiplier: [0.0; 2],
            at: ends.map(|end| end.low),
            shares: [1.0, 0.0, 0.0],
            tolerance_j: 1.0,
            most_cells: 0,
        };
        for branch in [Branch::Propulsion, Branch::Regeneration, Branch::Friction] {
            let Some((defect, below)) = cost.claims(branch, ends) else {
                continue;
            };
            for _ in 0..20 {
                let z = dice.point(ends);
                let allowed = cost.cost_j(z[0], z[1]);
                let [value, ..] = cost.on_branch(branch, z);
                let turned_over = (price_w.abs() + 1e4) * length_m / mean_speed(z[0], z[1]);
                if below {
                    assert!(
                        value <= allowed + 1e-11 * (allowed.abs() + turned_over),
                        "case {case}: {branch:?} is above the cost, {value} {allowed}"
                    );
                }
                if !(defect.rho + defect.w).is_finite() {
                    continue;
                }
                claims += 1;
                // Along a line through both ends of the range, by differences of slopes.
                let other = dice.point(ends);
                let direction = [other[0] - z[0], other[1] - z[1]];
                let slope = |share: f64| {
                    let at = [0, 1].map(|k| z[k] + share * direction[k]);
                    let [_, g0, g1] = cost.on_branch(branch, at);
                    g0 * direction[0] + g1 * direction[1]
                };
                let width = 1e-4;
                let (before, after) = (slope(0.5 - width), slope(0.5 + width));
                let bend = (after - before) / (2.0 * width);
                let middle = [0, 1].map(|k| z[k] + 0.5 * direction[k]);
                let w = mean_speed(middle[0], middle[1]);
                let s = 0.25 * (direction[0] / middle[0].sqrt() + direction[1] / middle[1].sqrt());
                let force_n = formula.effective_mass_kg * (middle[1] - middle[0])
                    / (2.0 * length_m)
                    + formula.standing_force_n(&problem.steps[0])
                    + (formula.linear_n_per_mps + formula.quadratic_n_per_mps2 * w) * w;
                let force_w = formula.linear_n_per_mps + 2.0 * formula.quadratic_n_per_mps2 * w;
                let r = formula.effective_mass_kg * (direction[1] - direction[0])
                    / (2.0 * length_m)
                    + (force_w - force_n / w) * s;
                let claimed = length_m * (defect.rho * r * r + defect.w * s * s);
                let rounding = 1e-11 * (before.abs() + after.abs()) / width
                    + 1e-4 * (bend.abs() + claimed.abs());
                assert!(
                    bend >= claimed - rounding,
                    "case {case}: {branch:?} bends by {bend}, claimed {claimed}, {s} {ends:?} {price_w} {formula:?}"
                );
            }
        }
    }
    assert!(claims > 1_000, "{claims}");
}

#[test]
fn what_is_called_convex_is() {
    let mut claims = 0;
    for case in 0..cases(300) {
        let mut dice = Dice(case.wrapping_mul(0x2468_1357) + 9);
        let car = dice.car();
        let envelope = Envelope::constant(-dice.scale(0.3, 5.0), dice.scale(0.3, 4.0)).unwrap();
        let (length_m, slope_rad) = (dice.scale(0.5, 100.0), dice.within(-0.1, 0.1));
        let problem = step_problem(&car, envelope, length_m, slope_rad);
        let formula = problem.model.formula().unwrap();
        let price_w = dice.price_w();
        let top_mps = dice.scale(2.0, 45.0);
        let ranges = ranges_of(&problem, top_mps);
        let convexity = Convexity::new(&formula, price_w, &ranges);
        let cost = StepCost {
            problem: &problem,
            formula: &formula,
            step: 0,
            price_w,
            convexity: None,
            potential: [0.0; 2],
            accel_multiplier: [0.0; 2],
            at: [1.0; 2],
            shares: [1.0, 0.0, 0.0],
            tolerance_j: 1.0,
            most_cells: 0,
        };
        for (branch, shares) in [
            (Branch::Propulsion, [1.0, 0.0, 0.0]),
            (Branch::Regeneration, [0.0, 1.0, 0.0]),
        ] {
            let accel = dice.within(ranges.accel.low, ranges.accel.high);
            let Some(part) = convexity.part(top_mps, shares, accel) else {
                continue;
            };
            let motion = |dice: &mut Dice| {
                for _ in 0..50 {
                    let w = dice.scale(part.from_mps, top_mps);
                    let accel = dice.within(part.accel.low, part.accel.high);
                    // v₁ − v₀ = a h/w
                    let apart = accel * length_m / (2.0 * w);
                    // No end is faster than all ends may be: σ alone has no upper bound that is convex.
                    if w > apart.abs() && w + apart.abs() <= top_mps {
                        return Some([(w - apart).powi(2), (w + apart).powi(2)]);
                    }
                }
                None
            };
            for _ in 0..40 {
                let (Some(a), Some(b)) = (motion(&mut dice), motion(&mut dice)) else {
                    continue;
                };
                let b = if dice.chance(0.5) {
                    let near = dice.scale(1e-3, 1.0);
                    [0, 1].map(|k| a[k] + near * (b[k] - a[k]))
                } else {
                    b
                };
                let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
                let [at_a, at_b, at_middle] = [a, b, middle].map(|z| cost.on_branch(branch, z)[0]);
                if !(at_a + at_b).is_finite() {
                    continue;
                }
                claims += 1;
                assert!(
                    at_middle <= 0.5 * (at_a + at_b) + 1e-13 * (at_a.abs() + at_b.abs()),
                    "case {case}: {branch:?} is not convex between {a:?} and {b:?}: {at_middle} {at_a} {at_b}; {part:?} {price_w} {length_m} {ranges:?} {formula:?}"
                );
            }
        }
    }
    assert!(claims > 1_000, "{claims}");
}

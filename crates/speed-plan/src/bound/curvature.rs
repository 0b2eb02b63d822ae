//! How a step's cost bends, in intervals.
//!
//! With `ρ = m_eff a + A cos θ + m g sin θ` and the mean speed `w`, a step of length `h` costs `h e(w, ρ)` whatever its slope, and
//! one of three smooth branches each bounds it from below where it is not the cost itself:
//!
//! ```text
//! e = (P_bat(P) + π)/w,    F = ρ + B w + C w²,    P = γ c w F + k F² + L(w),    k = k_c γ²
//! ```
//!
//! with the `γ` of propulsion or of regeneration; for friction brakes `F` is `−R(w)`.
//!
//! `ρ` is linear in the squared speeds, `σ = w²` is concave. So `h e` is convex in the squared speeds where `e` is convex in
//! `(ρ, σ)` and does not rise with `σ`. For a change by `r` of `ρ` and by `s` of `w`, and with `r' = r + (F_w − F/w) s`, the second
//! derivative of `e` along `(ρ, σ)` is
//!
//! ```text
//! 2k (1 + d₁)/w r'² + d₂/w (P_ρ r' + P_s s)² + X s²
//! X   = k (F²/w³ − 2BF/w²) − γcB/w + 3(K + π)/w³ + 3D/w³ − d₁/w² (3γcF + 2kF²/w + B P_ρ + 3L' − wL'')
//! P_ρ = γcw + 2kF,    P_s = 2γcF + 2kF²/w + L',    D = P_bat − P,  d₁, d₂ its derivatives by P
//! ```
//!
//! Where `e` rises with `w`, the bend of `σ` is taken off: `e_w⁺ h²/(4 w v₀ v₁) (2 a s/w − r/m_eff)²`.

use ev_energy::StepFormula;

use super::interval::Interval;

/// A smooth piece of the cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Branch {
    Propulsion,
    Regeneration,
    Friction,
}

/// Where a step's cost is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patch {
    /// Mean speed, above 0.
    pub(super) w: Interval,
    pub(super) force: Interval,
    pub(super) accel: Interval,
    /// Smallest product of both end speeds; `None` where one of them is given, so that `σ` is linear.
    pub(super) speed_product: Option<f64>,
    pub(super) length_m: f64,
    pub(super) price_w: f64,
    /// A cost of `slope · w` that bounds of the acceleration add, N/(m/s) of a step of a metre.
    pub(super) linear_in_w: f64,
}

/// `ζᵀHζ ≥ h (rho r'² + w s²)` within a patch, and the largest slope of the cost by the mean speed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bend {
    rho: f64,
    w: f64,
    slope: f64,
}

impl Bend {
    pub(super) fn plus(self, other: Self, weight: f64) -> Self {
        Self {
            rho: self.rho + weight * other.rho,
            w: self.w + weight * other.w,
            slope: self.slope + weight * other.slope,
        }
    }

    /// What is known to be missing to a convex cost, `ζᵀHζ ≥ h (κ_r r'² + κ_s s²)`.
    pub(super) fn defect(&self, formula: &StepFormula, patch: &Patch) -> Defect {
        let Some(product) = patch.speed_product.filter(|_| self.slope > 0.0) else {
            return Defect {
                rho: self.rho.min(0.0),
                w: self.w.min(0.0),
            };
        };
        // (u − v)² is at most twice the sum of the squares.
        let taken = self.slope * patch.length_m * patch.length_m / (2.0 * patch.w.low * product);
        let mass_kg = formula.effective_mass_kg;
        let turned = turn(formula, patch) / mass_kg + 2.0 * patch.accel.magnitude() / patch.w.low;
        Defect {
            rho: (self.rho - taken / (mass_kg * mass_kg)).min(0.0),
            w: (self.w - taken * turned * turned).min(0.0),
        }
    }
}

/// See [`Bend::defect`]; not a number where the bend of σ has no bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Defect {
    pub(super) rho: f64,
    pub(super) w: f64,
}

impl Defect {
    pub(super) fn is_none(&self) -> bool {
        self.rho >= 0.0 && self.w >= 0.0
    }
}

/// Largest `|F_w − F/w|` within a patch, N/(m/s).
pub(super) fn turn(formula: &StepFormula, patch: &Patch) -> f64 {
    formula.linear_n_per_mps.abs()
        + 2.0 * formula.quadratic_n_per_mps2 * patch.w.high
        + patch.force.magnitude() / patch.w.low
}

/// Whether a branch is nowhere above the cost within a patch.
///
/// With `θ = γ_b/(k_c γ_p (γ_p + γ_b))`, propulsion and regeneration are not where `F ≥ −θ c w`: the two parabolas of power over
/// force cross no earlier, and neither has turned so far that it is above its value at the limit of regeneration. Friction is not
/// where that limit is before the vertex of regeneration, `R ≤ c w/(2 k_c γ_b)`.
pub(super) fn is_below(formula: &StepFormula, branch: Branch, patch: &Patch) -> bool {
    let b = formula.braking_nm_per_n;
    let (c, copper) = (formula.motor_speed_per_mps, formula.copper_w_per_nm2);
    match branch {
        Branch::Propulsion | Branch::Regeneration => {
            -patch.force.low <= below_n_per_mps(formula) * patch.w.low
        }
        Branch::Friction => {
            largest_regeneration(formula, patch.w) * 2.0 * copper * b <= c * patch.w.low
        }
    }
}

/// `θ c`, the force in N per m/s down to which propulsion and regeneration are nowhere above the cost; see [`is_below`].
fn below_n_per_mps(formula: &StepFormula) -> f64 {
    let (p, b) = (formula.propelling_nm_per_n, formula.braking_nm_per_n);
    b * formula.motor_speed_per_mps / (formula.copper_w_per_nm2 * p * (p + b))
}

/// The mean speed in m/s from which on propulsion and regeneration are nowhere above the cost, in a step of a length in m with no less
/// than an acceleration in m/s² and a resistance in N.
///
/// Neither end of a step is below 0, so that `|a| ≤ 2w²/h`: the slower, the smaller the force.
pub(super) fn below_from(
    formula: &StepFormula,
    length_m: f64,
    least_mps2: f64,
    resistance_n: f64,
) -> f64 {
    let mass_kg = formula.effective_mass_kg;
    let per_mps = below_n_per_mps(formula);
    let braking_mps2 = (-least_mps2).max(0.0);
    let whole = (mass_kg * braking_mps2 - resistance_n) / per_mps;
    let knee = (0.5 * braking_mps2 * length_m).sqrt();
    if knee < whole {
        return whole;
    }
    if resistance_n >= 0.0 {
        return 0.0;
    }
    // θ c w ≥ 2 m w²/h − resistance from the lower root to the knee, and θ c w ≥ m |a| − resistance beyond.
    let square = 2.0 * mass_kg / length_m;
    let discriminant = per_mps * per_mps + 4.0 * square * resistance_n;
    if discriminant < 0.0 {
        return whole;
    }
    -2.0 * resistance_n / (per_mps + discriminant.sqrt())
}

pub(super) fn largest_regeneration(formula: &StepFormula, w: Interval) -> f64 {
    let fade = (w.high - formula.fade_start_mps) / (formula.fade_end_mps - formula.fade_start_mps);
    fade.clamp(0.0, 1.0) * formula.regeneration_n.min(formula.regeneration_w / w.low)
}

/// How a branch bends within a patch; `None` where battery power comes near its limit.
pub(super) fn bend(formula: &StepFormula, branch: Branch, patch: &Patch) -> Option<Bend> {
    let w = patch.w;
    let by_w = w.falling(|w| 1.0 / w);
    let gamma = match branch {
        Branch::Propulsion => formula.propelling_nm_per_n,
        Branch::Regeneration => formula.braking_nm_per_n,
        Branch::Friction => return friction(formula, patch),
    };
    let (b, c) = (formula.linear_n_per_mps, formula.quadratic_n_per_mps2);
    let f = patch.force;
    let by_w2 = by_w * by_w;
    let by_w3 = by_w2 * by_w;
    let f_w = w * (2.0 * c) + Interval::point(b);
    let gear = gamma * formula.motor_speed_per_mps;
    let copper = formula.copper_w_per_nm2 * gamma * gamma;
    let power = f * w * gear + f.squared() * copper + idle_power(formula, w);
    let battery = Battery::of(formula, power)?;
    let idle_w = idle_slope(formula, w);
    let p_rho = w * gear + f * (2.0 * copper);
    let by_gear = f * gear;
    let by_copper = f.squared() * by_w * copper;
    let p_s = (by_gear + by_copper) * 2.0 + idle_w;

    let inside =
        by_gear * 3.0 + by_copper * 2.0 + p_rho * b + idle_w * 3.0 - w * idle_bend(formula, w);
    let along = (f.squared() * by_w3 - f * by_w2 * (2.0 * b)) * copper
        - by_w * (gear * b + patch.linear_in_w)
        + idle(formula, w, patch.price_w)
        + battery.loss * by_w3 * 3.0
        - battery.first * by_w2 * inside;

    let rest =
        f.squared() * copper + Interval::point(formula.constant_w + patch.price_w) + battery.loss;
    let p_w = by_gear + p_rho * f_w + idle_w;
    let slope = f_w * gear
        + Interval::point(patch.linear_in_w)
        + w * (2.0 * formula.windage_w_per_mps3)
        + (f * f_w * (2.0 * copper) + battery.first * p_w) * by_w
        - rest * by_w2
        + weakening_slope(formula, w);

    // A tenth of the bend by force is kept for what the bend of σ may take.
    let whole = 2.0 * copper * (1.0 + battery.first.low);
    let kept = if slope.high > 0.0 { 0.1 } else { 0.0 };
    let by_force = (1.0 - kept) * whole;
    let steepest = p_rho.squared().high * battery.second.high;
    let shared = if by_force > 0.0 {
        by_force / (by_force + steepest)
    } else {
        0.0
    };
    Some(Bend {
        rho: kept * whole * by_w.low,
        w: along.low + battery.second.low * p_s.squared().low * shared * by_w.low,
        slope: slope.high,
    })
}

/// `L''(w)`, without the kink where field weakening begins: it bends upwards.
fn idle_bend(formula: &StepFormula, w: Interval) -> Interval {
    let spin = w * (6.0 * formula.windage_w_per_mps3);
    let from = formula.weakening_from_mps;
    if formula.weakening_w <= 0.0 || w.high <= from {
        return spin;
    }
    let slowest = w.low.max(from);
    let least = -2.0 * formula.weakening_w * from / (slowest * slowest * slowest);
    spin + Interval::new(least, 0.0)
}

/// Loss of the battery over a range of powers, and its first and second derivative.
struct Battery {
    loss: Interval,
    first: Interval,
    second: Interval,
}

impl Battery {
    /// `None` near the limit of the battery, where the derivatives have a pole.
    fn of(formula: &StepFormula, power: Interval) -> Option<Self> {
        let limit_w = formula.voltage_v * formula.voltage_v / (4.0 * formula.resistance_ohm);
        if power.high > 0.95 * limit_w {
            return None;
        }
        let [low_w, first_low, second_low] = formula.cells_power(power.low);
        let [high_w, first_high, second_high] = formula.cells_power(power.high);
        let (at_low, at_high) = (low_w - power.low, high_w - power.high);
        let least = if power.low > 0.0 {
            at_low
        } else if power.high < 0.0 {
            at_high
        } else {
            0.0
        };
        Some(Self {
            loss: Interval::new(least, at_low.max(at_high)),
            first: Interval::new(first_low - 1.0, first_high - 1.0),
            second: Interval::new(second_low, second_high),
        })
    }
}

/// `3 (K + π)/w³`, and what field weakening bends.
fn idle(formula: &StepFormula, w: Interval, price_w: f64) -> Interval {
    let by_w = w.falling(|w| 1.0 / w);
    let by_w3 = by_w * by_w * by_w;
    let constant = by_w3 * (3.0 * (formula.constant_w + price_w));
    if formula.weakening_w <= 0.0 || w.high <= formula.weakening_from_mps {
        return constant;
    }
    // k_f (3/w³ − 8 w_f/w⁴) beyond w_f, 0 before; the kink there bends upwards.
    let from = formula.weakening_from_mps;
    let least = |w: f64| (3.0 - 8.0 * from / w) / (w * w * w);
    // Its only minimum is at 32/9 w_f, beyond which it is above 0 soon; the value at the slow end is the lowest before.
    let low = least(w.low.max(from)).min(0.0);
    constant + Interval::new(low, 3.0 * by_w3.high) * formula.weakening_w
}

fn weakening_slope(formula: &StepFormula, w: Interval) -> Interval {
    let from = formula.weakening_from_mps;
    if formula.weakening_w <= 0.0 || w.high <= from {
        return Interval::point(0.0);
    }
    // d/dw (1/w − w_f/w²) = (2 w_f/w − 1)/w², from 1/w_f² at w_f falling to below 0
    let slope = |w: f64| (2.0 * from / w - 1.0) / (w * w);
    let (low, high) = (w.low.max(from), w.high);
    let least = slope(high)
        .min(slope(low))
        .min(0.0)
        .min(slope((3.0 * from).clamp(low, high)));
    Interval::new(least, slope(low).max(0.0)) * formula.weakening_w
}

/// `L(w)`.
fn idle_power(formula: &StepFormula, w: Interval) -> Interval {
    w.rising(|w| {
        formula.constant_w
            + (formula.iron_w_per_mps + formula.windage_w_per_mps3 * w * w) * w
            + formula.weakening_w * (1.0 - formula.weakening_from_mps / w).max(0.0)
    })
}

/// `L'(w)`.
fn idle_slope(formula: &StepFormula, w: Interval) -> Interval {
    let spin = w.rising(|w| formula.iron_w_per_mps + 3.0 * formula.windage_w_per_mps3 * w * w);
    let from = formula.weakening_from_mps;
    if formula.weakening_w <= 0.0 || w.high <= from {
        return spin;
    }
    let steepest = from / (w.low.max(from) * w.low.max(from));
    let least = if w.low < from {
        0.0
    } else {
        from / (w.high * w.high)
    };
    spin + Interval::new(least, steepest) * formula.weakening_w
}

/// Friction does not depend on the force: `e` bends with `w` alone.
///
/// Its kinks, where regeneration is full and where power limits it, bend upwards; where regeneration begins it bends downwards.
fn friction(formula: &StepFormula, patch: &Patch) -> Option<Bend> {
    let crossing_mps = formula.regeneration_w / formula.regeneration_n.max(1e-9);
    let w = patch.w;
    if w.low < formula.fade_start_mps && formula.fade_start_mps < w.high {
        return None;
    }
    let mut cuts = [formula.fade_end_mps, crossing_mps].map(|cut| cut.clamp(w.low, w.high));
    cuts.sort_by(f64::total_cmp);
    let pieces = [(w.low, cuts[0]), (cuts[0], cuts[1]), (cuts[1], w.high)];
    let mut whole: Option<Bend> = None;
    for (low, high) in pieces {
        if high <= low && w.high > w.low {
            continue;
        }
        let piece = friction_piece(formula, patch, Interval::new(low, high))?;
        whole = Some(whole.map_or(piece, |bend| Bend {
            rho: 0.0,
            w: bend.w.min(piece.w),
            slope: bend.slope.max(piece.slope),
        }));
    }
    whole
}

fn friction_piece(formula: &StepFormula, patch: &Patch, w: Interval) -> Option<Bend> {
    let (start, end) = (formula.fade_start_mps, formula.fade_end_mps);
    let by_w = w.falling(|w| 1.0 / w);
    let by_w2 = by_w * by_w;
    let by_power = formula.regeneration_w < formula.regeneration_n * 0.5 * (w.low + w.high);
    // N or W/w, with derivatives
    let limit = if by_power {
        [
            by_w * formula.regeneration_w,
            by_w2 * -formula.regeneration_w,
            by_w2 * by_w * (2.0 * formula.regeneration_w),
        ]
    } else {
        [formula.regeneration_n, 0.0, 0.0].map(Interval::point)
    };
    let middle = 0.5 * (w.low + w.high);
    let [r, r1, r2] = if middle <= start {
        [0.0; 3].map(Interval::point)
    } else if middle >= end {
        limit
    } else {
        let per = 1.0 / (end - start);
        let fade = w.rising(|w| (w - start) * per);
        [
            fade * limit[0],
            limit[0] * per + fade * limit[1],
            limit[1] * (2.0 * per) + fade * limit[2],
        ]
    };
    let gamma = formula.braking_nm_per_n;
    let gear = gamma * formula.motor_speed_per_mps;
    let copper = formula.copper_w_per_nm2 * gamma * gamma;
    // P = −γ_b c w R + k_c γ_b² R² + L
    let power = -(r * w * gear) + r.squared() * copper + idle_power(formula, w);
    let p_w = -((r + r1 * w) * gear) + r * r1 * (2.0 * copper) + idle_slope(formula, w);
    let p_ww = -((r1 * 2.0 + r2 * w) * gear)
        + (r1.squared() + r * r2) * (2.0 * copper)
        + idle_bend(formula, w);
    let battery = Battery::of(formula, power)?;
    // without battery: −γ_b c R + (k_c γ_b² R² + L + π)/w
    let square = r.squared() * copper;
    let square_w = r * r1 * (2.0 * copper);
    let square_ww = (r1.squared() + r * r2) * (2.0 * copper);
    let along = -((r2 - r1 * by_w) * gear) + square_ww * by_w - square_w * by_w2 * 3.0
        + square * by_w2 * by_w * 3.0
        + idle(formula, w, patch.price_w)
        + by_w * (-patch.linear_in_w)
        + (battery.first * p_ww + battery.second * p_w.squared()) * by_w
        - battery.first * p_w * by_w2 * 3.0
        + battery.loss * by_w2 * by_w * 3.0;
    let rest = square + Interval::point(formula.constant_w + patch.price_w) + battery.loss;
    let slope = -(r1 * gear)
        + Interval::point(patch.linear_in_w)
        + w * (2.0 * formula.windage_w_per_mps3)
        + (square_w + battery.first * p_w) * by_w
        - rest * by_w2
        + weakening_slope(formula, w);
    Some(Bend {
        rho: 0.0,
        w: along.low,
        slope: slope.high,
    })
}

/// Between which accelerations the cost is convex, by mean speed and branch.
#[derive(Debug, Clone)]
pub(super) struct Convexity {
    /// Ranges of speed from the top down: the lower end of each, and the accelerations for propulsion and for regeneration.
    ranges: Vec<(f64, [Interval; 2])>,
}

/// A convex set of motions of a step: no slower, and between two accelerations.
#[derive(Debug, Clone, Copy)]
pub(super) struct ConvexPart {
    pub(super) from_mps: f64,
    pub(super) accel: Interval,
}

/// What all steps of a road have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges {
    pub(super) top_mps: f64,
    pub(super) accel: Interval,
    /// `A cos θ + m g sin θ`, N.
    pub(super) standing_n: Interval,
    pub(super) longest_m: f64,
}

/// Ratio of the ends of the ranges of speed that are looked at, how often one is halved by force or speed at most, and the shares of
/// the strongest braking and acceleration that are tried.
const SPEED_RATIO: f64 = 1.15;
const DEEPEST: usize = 9;
const ACCEL_SHARES: [[f64; 2]; 11] = [
    [1.0, 1.0],
    [1.0, 0.8],
    [1.0, 0.6],
    [1.0, 0.4],
    [1.0, 0.2],
    [0.5, 1.0],
    [0.5, 0.6],
    [0.5, 0.2],
    [0.25, 1.0],
    [0.25, 0.6],
    [0.2, 0.2],
];
const SLOWEST_MPS: f64 = 0.3;

impl Convexity {
    /// At a price of time.
    pub(super) fn new(formula: &StepFormula, price_w: f64, ranges: &Ranges) -> Self {
        let mut found = Vec::new();
        let mut high = ranges.top_mps;
        while high > SLOWEST_MPS {
            let w = Interval::new(high / SPEED_RATIO, high);
            let between = |branch| {
                ACCEL_SHARES
                    .into_iter()
                    .map(|[braking, speeding]| {
                        let Interval { low, high } = ranges.accel;
                        Interval::new(braking * low, speeding * high)
                    })
                    .find(|accel| is_convex(formula, branch, price_w, w, *accel, ranges))
                    .unwrap_or(Interval::new(f64::INFINITY, f64::NEG_INFINITY))
            };
            found.push((
                w.low,
                [Branch::Propulsion, Branch::Regeneration].map(between),
            ));
            high = w.low;
        }
        Self { ranges: found }
    }

    /// The part that reaches down the furthest from a speed with an acceleration in it, for weighted branches; `None` where the cost
    /// is not known to be convex there.
    pub(super) fn part(
        &self,
        top_mps: f64,
        shares: [f64; 3],
        accel_mps2: f64,
    ) -> Option<ConvexPart> {
        if shares[2] > 0.0 {
            return None;
        }
        let mut part: Option<ConvexPart> = None;
        for (from_mps, between) in self.ranges.iter().filter(|range| range.0 < top_mps) {
            let mut accel = part.map_or(Interval::EVERYTHING, |part| part.accel);
            for (share, between) in shares.iter().zip(between) {
                if *share > 0.0 {
                    accel = Interval::new(accel.low.max(between.low), accel.high.min(between.high));
                }
            }
            if !accel.contains(accel_mps2) {
                break;
            }
            part = Some(ConvexPart {
                from_mps: *from_mps,
                accel,
            });
        }
        part
    }
}

fn is_convex(
    formula: &StepFormula,
    branch: Branch,
    price_w: f64,
    w: Interval,
    accel: Interval,
    ranges: &Ranges,
) -> bool {
    let Ranges {
        standing_n,
        longest_m: length_m,
        ..
    } = *ranges;
    let air = |w: Interval| {
        (w * formula.quadratic_n_per_mps2 + Interval::point(formula.linear_n_per_mps)) * w
    };
    let force = accel * formula.effective_mass_kg + standing_n + air(w);
    let mut stack = vec![(w, force, 0)];
    while let Some((w, force, depth)) = stack.pop() {
        // m a = F − standing force − air
        let inertia = force - standing_n - air(w);
        let accel = Interval::new(
            (inertia.low / formula.effective_mass_kg).max(accel.low),
            (inertia.high / formula.effective_mass_kg).min(accel.high),
        );
        if accel.low > accel.high {
            continue;
        }
        // v₀ v₁ = w² − (a h/2w)²
        let apart = accel.magnitude() * length_m / (2.0 * w.low);
        let patch = Patch {
            w,
            force,
            accel,
            speed_product: Some((w.low * w.low - apart * apart).max(0.0)),
            length_m,
            price_w,
            linear_in_w: 0.0,
        };
        let bend = bend(formula, branch, &patch);
        if bend.is_some_and(|bend| bend.defect(formula, &patch).is_none()) {
            continue;
        }
        if depth >= DEEPEST {
            return false;
        }
        let middle = |range: Interval| 0.5 * (range.low + range.high);
        if depth % 3 == 2 {
            stack.push((Interval::new(w.low, middle(w)), force, depth + 1));
            stack.push((Interval::new(middle(w), w.high), force, depth + 1));
        } else {
            stack.push((w, Interval::new(force.low, middle(force)), depth + 1));
            stack.push((w, Interval::new(middle(force), force.high), depth + 1));
        }
    }
    true
}

//! The optimum of a convex relaxation by another solver, Clarabel: an independent lower bound on the energy of every run.
//!
//! Per node the squared speed `z` and a speed `v`, per step with its length `Δs` the mean speed `w = (v₀ + v₁)/2`, its time `t`, the force
//! of the motor at the wheel as if the gear lost nothing `τ = T c` and the energy from the cells `e`. Every motion on the nodes fulfils
//! all of this, and the costs are its own:
//!
//! | in the model | here | exact where tight |
//! |---|---|---|
//! | `v = √z` | `v² ≤ z` and `v` above the chord of the root over the range of `z` | yes |
//! | `t = Δs/w` | `t w ≥ Δs` and `t` below the chord of the inverse | yes |
//! | `F = m_eff (z₁ − z₀)/2Δs + A cos θ + B w + C w² + m g sin θ` | the same with `s ≥ w²` in place of `w²` | yes |
//! | `T = γ max(F, −R(w))`, `γ` by its sign | `τ ≥ γ_p c F`, `τ ≥ γ_b c F`, `τ ≥ −γ_b c R̂(w)`, `τ Δs ≥ −γ_b c W t` | but for `R̂` |
//! | limit of regeneration `R(w)`: fade, force, power | `R̂`, the concave hull of the larger `min(N, W/w₁, N · fade, W/w)` | no: below the fade's end, beyond `W/N` |
//! | copper `k_c T² t` | `k_c Δs y/c²` with `y w ≥ τ²` | yes |
//! | iron, windage, constant, auxiliaries | linear in `1`, `s`, `t` | yes |
//! | weakened field, `k_f max(0, 1 − w_f/w) t` | a chord below its concave part | no |
//! | cells, `e − R_i e²/(U₀² t) = P t` | `e − R_i q/U₀² ≥ P t` with `q t ≥ e²` | yes |
//! | largest torque and power of the motor | `τ ≤ T_max c`, `τ Δs ≤ P_max t`; its highest speed is left out | yes |
//! | accelerations allowed over `w` | hulls of their tables over the range of `w` | where constant, or a hull itself |
//!
//! Ranges are those of the limits, narrowed by the accelerations of the envelope from node to node. Nothing is shared with the planner
//! but the car and the road.

mod hull;
mod program;

use ev_energy::{RoadStep, StepFormula};
use hull::{Line, concave_hull};
use program::{Affine, ConeProgram};

use crate::drive::Run;
use crate::error::Error;
use crate::plan::Demand;
use crate::problem::Problem;

/// What an independent solver says of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Optimum of the relaxation: no run takes less energy, J; at a price of time, none that arrives with this one. As exact as
    /// the solver, about 10⁻⁸; `None` where it [failed](Convergence::Failed).
    pub energy_j: Option<f64>,
    /// Energy of the run above it, % of [`Run::energy_scale_j`].
    pub gap_pct: Option<f64>,
    /// How the solver ended.
    pub convergence: Convergence,
    /// Its iterations.
    pub iterations: u32,
}

/// How an independent solver ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convergence {
    /// With an optimum.
    Solved,
    /// With an optimum within weaker tolerances, about 5·10⁻⁵.
    AlmostSolved,
    /// Without one.
    Failed,
}

/// Compares a run, as of a plan, with the optimum of a convex relaxation of its problem, found by Clarabel's interior point method.
///
/// # Errors
/// [`Error::NotConvex`] where there are signals or a leader or losses are a table.
pub fn certify(problem: &Problem, demand: Demand, run: &Run) -> Result<Certificate, Error> {
    let in_the_way = |what| Err(Error::NotConvex { what });
    if !problem.columns.signals.is_empty() {
        return in_the_way("signals");
    }
    if !problem.columns.earliest_s.is_empty() {
        return in_the_way("a leader");
    }
    let Some(car) = problem.model.formula() else {
        return in_the_way("losses by table");
    };
    let optimum = Relaxation::new(problem, &car).of(demand).solve();
    let spent_on_time_j = match demand {
        Demand::Price(price_w) => price_w * run.time_s,
        Demand::Arrival(_) => 0.0,
    };
    let found = optimum.convergence != Convergence::Failed;
    let energy_j = found.then_some(J_PER_KJ * optimum.bound - spent_on_time_j);
    Ok(Certificate {
        energy_j,
        gap_pct: energy_j.map(|least_j| 100.0 * (run.energy_j - least_j) / run.energy_scale_j()),
        convergence: optimum.convergence,
        iterations: optimum.iterations,
    })
}

/// Energies and forces of the program are in kJ and kN, so that its numbers are of one size.
const J_PER_KJ: f64 = 1e3;

struct Relaxation<'a> {
    problem: &'a Problem<'a>,
    car: &'a StepFormula,
    program: ConeProgram,
    /// Squared speed and speed at every node.
    z: Vec<Affine>,
    v: Vec<Affine>,
    /// Lowest and highest speed at every node, m/s.
    range_mps: Vec<[f64; 2]>,
}

/// The variables of a step.
struct Step<'a> {
    road: &'a RoadStep,
    w: Affine,
    /// Lowest and highest mean speed, m/s.
    range_mps: [f64; 2],
    time: Affine,
    /// `s ≥ w²`.
    square: Affine,
    /// `τ`, kN.
    force: Affine,
}

impl<'a> Relaxation<'a> {
    fn new(problem: &'a Problem, car: &'a StepFormula) -> Self {
        let range_mps = speed_ranges(problem);
        let mut program = ConeProgram::default();
        let (mut z, mut v) = (Vec::new(), Vec::new());
        for &[low, high] in &range_mps {
            if high <= low {
                z.push(Affine::from(high * high));
                v.push(Affine::from(high));
                continue;
            }
            let (square, speed) = (program.variable(), program.variable());
            program.product_at_least(&(square.clone() * (1.0 / high)), &high.into(), &speed);
            let chord = (square.clone() + low * high) * (1.0 / (low + high));
            program.at_least(&speed, &chord);
            z.push(square);
            v.push(speed);
        }
        Self {
            problem,
            car,
            program,
            z,
            v,
            range_mps,
        }
    }

    fn of(mut self, demand: Demand) -> ConeProgram {
        let mut total_s = Affine::default();
        for (k, road) in self.problem.steps.iter().enumerate() {
            total_s = total_s + self.step(k, road);
        }
        for node in 0..self.problem.nodes() {
            let dwell_s = self.problem.dwell_s(node);
            if dwell_s > 0.0 {
                total_s = total_s + dwell_s;
                let energy_j = self.problem.standing_power_w(node) * dwell_s;
                self.program.pay((energy_j / J_PER_KJ).into());
            }
        }
        match demand {
            Demand::Price(price_w) => self.program.pay(total_s * (price_w / J_PER_KJ)),
            Demand::Arrival(latest_s) => self.program.at_least(&latest_s.into(), &total_s),
        }
        self.program
    }

    /// Adds a step and gives its time.
    fn step(&mut self, k: usize, road: &RoadStep) -> Affine {
        let mean = |edge: usize| 0.5 * (self.range_mps[k][edge] + self.range_mps[k + 1][edge]);
        let step = Step {
            road,
            w: (self.v[k].clone() + self.v[k + 1].clone()) * 0.5,
            range_mps: [mean(0), mean(1)],
            time: self.program.variable(),
            square: self.program.variable(),
            force: self.program.variable(),
        };
        let top_mps = step.range_mps[1];
        self.program.product_at_least(
            &(step.square.clone() * (1.0 / top_mps)),
            &top_mps.into(),
            &step.w,
        );
        self.time(&step);
        let accel = (self.z[k + 1].clone() - self.z[k].clone()) * (0.5 / road.length_m());
        self.accelerations(&step, &accel);
        self.forces(&step, &accel);
        self.energy(&step);
        step.time
    }

    fn time(&mut self, step: &Step) {
        let length_m = step.road.length_m();
        let [low, high] = step.range_mps;
        let even = high / length_m.sqrt();
        self.program.product_at_least(
            &(step.time.clone() * even),
            &(step.w.clone() * (1.0 / even)),
            &length_m.sqrt().into(),
        );
        let chord = (-step.w.clone() + (low + high)) * (length_m / (low * high));
        self.program.at_least(&chord, &step.time);
    }

    fn accelerations(&mut self, step: &Step, accel: &Affine) {
        let [low, high] = step.range_mps;
        let envelope = &self.problem.envelope;
        let points = envelope.points().iter().map(|point| point.speed_mps);
        let mut places = vec![low];
        places.extend(points.filter(|mps| low < *mps && *mps < high));
        places.push(high);
        let hull = |limit: &dyn Fn(f64) -> f64| {
            concave_hull(&places.iter().map(|w| [*w, limit(*w)]).collect::<Vec<_>>())
        };
        for line in hull(&|w| envelope.max_at(w).accel_mps2) {
            self.program.at_least(&line.at(&step.w), accel);
        }
        for line in hull(&|w| -envelope.min_at(w).accel_mps2) {
            self.program.at_least(&line.at(&step.w), &-accel.clone());
        }
    }

    fn forces(&mut self, step: &Step, accel: &Affine) {
        let car = self.car;
        let needed = (accel.clone() * car.effective_mass_kg
            + step.w.clone() * car.linear_n_per_mps
            + step.square.clone() * car.quadratic_n_per_mps2
            + car.standing_force_n(step.road))
            * (1.0 / J_PER_KJ);
        let [propelling, braking] =
            [car.propelling_nm_per_n, car.braking_nm_per_n].map(|nm| nm * car.motor_speed_per_mps);
        let program = &mut self.program;
        for gear in [propelling, braking] {
            program.at_least(&step.force, &(needed.clone() * gear));
        }
        for line in regeneration_hull(car, step.range_mps) {
            let limit = line.at(&step.w) * (-braking / J_PER_KJ);
            program.at_least(&step.force, &limit);
        }
        let work = step.force.clone() * step.road.length_m();
        let regenerated = step.time.clone() * (-braking * car.regeneration_w / J_PER_KJ);
        program.at_least(&work, &regenerated);
        let motor = &self.problem.model.vehicle().spec().motor;
        let strongest = motor.max_torque_nm * car.motor_speed_per_mps / J_PER_KJ;
        program.at_least(&strongest.into(), &step.force);
        program.at_least(&(step.time.clone() * (motor.max_power_w / J_PER_KJ)), &work);
    }

    fn energy(&mut self, step: &Step) {
        let car = self.car;
        let length_m = step.road.length_m();
        let top_mps = step.range_mps[1];
        let program = &mut self.program;
        let idle_w = step.time.clone() * car.constant_w;
        let spin_j = step.square.clone() * (car.windage_w_per_mps3 * length_m)
            + car.iron_w_per_mps * length_m;
        let mut electric = step.force.clone() * length_m + (idle_w + spin_j) * (1.0 / J_PER_KJ);
        if car.copper_w_per_nm2 > 0.0 {
            let heat = program.variable();
            program.product_at_least(&heat, &(step.w.clone() * (1.0 / top_mps)), &step.force);
            let per_torque = J_PER_KJ / (car.motor_speed_per_mps * car.motor_speed_per_mps);
            let factor = car.copper_w_per_nm2 * per_torque * length_m / top_mps;
            electric = electric + heat * factor;
        }
        if let Some(line) = weakening_chord(car, step.range_mps) {
            let weakened = program.variable();
            program.at_least(&weakened, &0.0.into());
            program.at_least(&weakened, &line.at(&step.w));
            electric = electric + weakened * (car.weakening_w * length_m / J_PER_KJ);
        }
        let cells = program.variable();
        program.pay(cells.clone());
        if car.resistance_ohm > 0.0 {
            let square = program.variable();
            program.product_at_least(&square, &(step.time.clone() * top_mps), &cells);
            let loss = J_PER_KJ * car.resistance_ohm / (car.voltage_v * car.voltage_v);
            electric = electric + square * (loss * top_mps);
        }
        program.at_least(&cells, &electric);
    }
}

impl Line {
    fn at(self, w: &Affine) -> Affine {
        w.clone() * self.slope + self.at_zero
    }
}

/// Speeds at every node in m/s that limits and the accelerations of the envelope leave.
fn speed_ranges(problem: &Problem) -> Vec<[f64; 2]> {
    let points = problem.envelope.points();
    let strongest = points.iter().map(|p| p.max_mps2).fold(0.0, f64::max);
    let braking = points.iter().map(|p| -p.min_mps2).fold(0.0, f64::max);
    let (mut low, mut high) = (problem.min_z.clone(), problem.max_z.clone());
    let twice_m = |step: usize| 2.0 * problem.steps[step].length_m();
    for k in 0..problem.steps.len() {
        high[k + 1] = high[k + 1].min(high[k] + twice_m(k) * strongest);
        low[k + 1] = low[k + 1].max(low[k] - twice_m(k) * braking);
    }
    for k in (0..problem.steps.len()).rev() {
        high[k] = high[k].min(high[k + 1] + twice_m(k) * braking);
        low[k] = low[k].max(low[k + 1] - twice_m(k) * strongest);
    }
    let both = low.iter().zip(&high);
    both.map(|(low, high)| [low.sqrt().min(high.sqrt()), high.sqrt()])
        .collect()
}

/// Above the limit of regeneration in N over a range of mean speeds in m/s.
fn regeneration_hull(car: &StepFormula, [low, high]: [f64; 2]) -> Vec<Line> {
    // `R ≤ min(most, N · fade, W/w)`, where the last holds beyond the fade.
    let most_n = car
        .regeneration_n
        .min(car.regeneration_w / car.fade_end_mps);
    let fade_mps = car.fade_end_mps - car.fade_start_mps;
    let limit_n = |w: f64| {
        let faded_n = car.regeneration_n * (w - car.fade_start_mps) / fade_mps;
        faded_n.max(0.0).min(most_n).min(if w > car.fade_end_mps {
            car.regeneration_w / w
        } else {
            f64::INFINITY
        })
    };
    let corners = if most_n > 0.0 {
        vec![
            car.fade_start_mps,
            car.fade_start_mps + fade_mps * most_n / car.regeneration_n,
            car.regeneration_w / most_n,
        ]
    } else {
        Vec::new()
    };
    let mut places = vec![low];
    places.extend(corners.into_iter().filter(|w| low < *w && *w < high));
    places.push(high);
    concave_hull(&places.iter().map(|w| [*w, limit_n(*w)]).collect::<Vec<_>>())
}

/// Below `(1 − w_f/w)/w` over a range of mean speeds in m/s, where it is above 0: it rises up to `2w_f` and is concave up to `3w_f`.
fn weakening_chord(car: &StepFormula, [low, high]: [f64; 2]) -> Option<Line> {
    let from = car.weakening_from_mps;
    if car.weakening_w <= 0.0 || from <= 0.0 || high <= from {
        return None;
    }
    let value = |w: f64| (1.0 - from / w) / w;
    let start = low.max(from);
    let flat = |at_zero: f64| Line {
        at_zero,
        slope: 0.0,
    };
    if start > from && high > 3.0 * from || high - start < 1e-9 {
        return Some(flat(value(start).min(value(high))));
    }
    let slope = (value(high) - value(start)) / (high - start);
    Some(Line {
        at_zero: value(start) - slope * start,
        slope,
    })
}

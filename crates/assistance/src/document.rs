use ev_energy::{Budget, Error, JOULES_PER_KWH, OperatingPoint, RoadStep};
use serde::Serialize;
use speed_plan::{Arrival, Demand, Obstacle, Plan, Problem, Proof, Run};

use crate::in_words::Saving;
use crate::own::{Style, StyleDistance};
use crate::sampled::SampledPlan;

/// What came of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanOutcome {
    /// Nothing costs less by more than the gap.
    Optimal,
    /// Neither does anything, and it arrives before it had to.
    Early,
}

/// How far the bound can be trusted, the weaker the later.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Proven, but for rounding.
    #[default]
    Proven,
    /// Its minima were searched numerically.
    Numerical,
    /// There is none.
    #[serde(rename = "none")]
    Missing,
}

impl From<Proof> for Bound {
    fn from(proof: Proof) -> Self {
        match proof {
            Proof::Proven => Self::Proven,
            Proof::Numerical => Self::Numerical,
            Proof::Missing => Self::Missing,
        }
    }
}

/// One plan as `drivekit/plan/1` gives it.
#[derive(Debug, Clone, Serialize)]
pub struct PlanDocument {
    /// What came of it.
    pub outcome: PlanOutcome,
    /// How closely it keeps to a driver's own way; `None` without a driver.
    pub style: Option<Style>,
    /// How far it is from the driver's own way; `None` without a driver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub style_distance: Option<StyleDistance>,
    /// Where it saves most against the driver's own way.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub saves_most: Vec<Saving>,
    /// What another solver says of it; `None` where none was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<CertificateDocument>,
    /// Latest arrival that was asked for, s; `None` at a price of time.
    pub latest_arrival_s: Option<f64>,
    /// Earliest arrival within limits and accelerations, s.
    pub earliest_arrival_s: f64,
    /// Price of time, W; `None` where it is not known.
    pub price_w: Option<f64>,
    /// No plan that arrives no later takes less energy (for an arrival: by then), J; `null` in JSON where there is no bound.
    pub lower_bound_j: f64,
    /// Energy above the bound, % of the larger of |energy| and a tenth of the energy turned over; `null` in JSON where there is no bound.
    pub gap_pct: f64,
    /// Whether the bound was proven.
    pub bound: Bound,
    /// Time that planning took, ms; `None` without wall times.
    pub solve_ms: Option<f64>,
    /// What is driven.
    #[serde(flatten)]
    pub run: RunDocument,
}

/// One motion over the road as `drivekit/plan/1` gives it.
#[derive(Debug, Clone, Serialize)]
pub struct RunDocument {
    /// Energy from the cells, J.
    pub energy_j: f64,
    /// Energy at the terminals of the battery, J.
    pub terminal_energy_j: f64,
    /// Arrival, s.
    pub time_s: f64,
    /// Consumption at the terminals, kWh per 100 km.
    pub consumption_kwh_per_100km: f64,
    /// Where the energy goes.
    pub budget: Budget,
    /// Kinetic energy at the end less that at the start, J.
    pub kinetic_difference_j: f64,
    /// Energy of the same motion sampled at 10 Hz, J.
    pub sampled_energy_j: f64,
    /// Steps between nodes.
    pub steps: usize,
    /// 95th percentile of the jerk, m/s³.
    pub jerk_p95_mps3: f64,
    /// Largest jerk, m/s³.
    pub jerk_max_mps3: f64,
    /// Passages of the signals.
    pub signals: Vec<SignalPassage>,
    /// The motion itself.
    pub nodes: Nodes,
}

/// Optimum of a relaxed problem by another solver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CertificateDocument {
    /// Name of the solver.
    pub solver: &'static str,
    /// No plan that arrives no later takes less energy, J; `None` where the solver failed.
    pub energy_j: Option<f64>,
    /// Energy of the plan above it, % as [`PlanDocument::gap_pct`].
    pub gap_pct: Option<f64>,
    /// How the solver ended.
    pub status: CertificateStatus,
    /// Time that it took, ms; `None` without wall times.
    pub solve_ms: Option<f64>,
}

/// How another solver ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CertificateStatus {
    /// With an optimum.
    Solved,
    /// With an optimum, at a weaker tolerance.
    AlmostSolved,
    /// Without one.
    Failed,
}

/// How a signal is passed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalPassage {
    /// Its place, m.
    pub position_m: f64,
    /// When the car passes or leaves it, s.
    pub passage_s: f64,
    /// The green window of the passage, s.
    pub window_s: Option<[f64; 2]>,
    /// How long the car stood there, s.
    pub stood_s: f64,
    /// Green windows of the trip's time, s.
    pub green_s: Vec<[f64; 2]>,
}

/// What a car does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// The motor drives.
    Drives,
    /// Nothing pushes or holds.
    Coasts,
    /// The motor brakes.
    Regenerates,
    /// Friction brakes help.
    BrakesByFriction,
}

impl Effort {
    /// Forces that would change the speed by less are none, m/s².
    const NONE_MPS2: f64 = 0.02;

    pub(crate) fn of(point: &OperatingPoint, mass_kg: f64) -> Self {
        let none_n = Self::NONE_MPS2 * mass_kg;
        if point.friction_brake_n.abs() > none_n {
            Self::BrakesByFriction
        } else if point.wheel_force_n.abs() < none_n {
            Self::Coasts
        } else if point.wheel_force_n > 0.0 {
            Self::Drives
        } else {
            Self::Regenerates
        }
    }
}

/// A motion by columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nodes {
    /// Position of every node, m.
    pub position_m: Vec<f64>,
    /// Speed at every node, m/s.
    pub speed_mps: Vec<f64>,
    /// Arrival at every node, s.
    pub arrival_s: Vec<f64>,
    /// Time that the car stands at every node, s.
    pub stood_s: Vec<f64>,
    /// Limit at every node, m/s.
    pub limit_mps: Vec<f64>,
    /// Slope angle of every step, rad.
    pub slope_rad: Vec<f64>,
    /// Force at the wheels in every step, N.
    pub force_n: Vec<f64>,
    /// What the car does in every step.
    pub effort: Vec<Effort>,
    /// Energy from the cells in every step, J; standing is in none.
    pub energy_j: Vec<f64>,
}

impl PlanDocument {
    /// Describes a plan.
    ///
    /// # Errors
    /// As [`ev_energy::Vehicle::trip_energy`].
    pub fn new(
        problem: &Problem,
        plan: &Plan,
        demand: Demand,
        solve_ms: Option<f64>,
    ) -> Result<Self, Error> {
        Ok(Self {
            outcome: match plan.arrival {
                Arrival::AsAsked => PlanOutcome::Optimal,
                Arrival::Early => PlanOutcome::Early,
            },
            style: None,
            style_distance: None,
            saves_most: Vec::new(),
            certificate: None,
            latest_arrival_s: match demand {
                Demand::Arrival(latest_s) => Some(latest_s),
                Demand::Price(_) => None,
            },
            earliest_arrival_s: plan.earliest_arrival_s,
            price_w: plan.price_w,
            lower_bound_j: plan.lower_bound_j,
            gap_pct: plan.gap_pct,
            bound: plan.proof.into(),
            solve_ms,
            run: RunDocument::new(problem, &plan.run)?,
        })
    }
}

impl RunDocument {
    /// Describes a motion.
    ///
    /// # Errors
    /// As [`ev_energy::Vehicle::trip_energy`].
    pub fn new(problem: &Problem, run: &Run) -> Result<Self, Error> {
        let columns = problem.columns();
        let model = problem.model();
        let stands = run
            .stood_s
            .iter()
            .enumerate()
            .filter(|(_, stood_s)| **stood_s > 0.0)
            .map(|(node, stood_s)| (problem.node_slope_rad(node), *stood_s));
        let energy = model.drive_energy(problem.steps(), &run.speed_mps, stands);
        let sampled = SampledPlan::new(problem, run);
        let [jerk_p95_mps3, jerk_max_mps3] = sampled.jerk_mps3();
        let ends = problem.steps().iter().zip(run.speed_mps.windows(2));
        let points: Vec<OperatingPoint> = ends
            .map(|(step, ends)| model.operating_point(step, ends[0], ends[1]))
            .collect();
        let energy_of = |(step, point): (&RoadStep, &OperatingPoint)| {
            point.battery_power_w * step.length_m() / point.speed_mps
        };
        let kinetic_j =
            |v: Option<&f64>| 0.5 * model.vehicle().effective_mass_kg() * v.map_or(0.0, |v| v * v);
        let speeds = &run.speed_mps;
        Ok(Self {
            energy_j: run.energy_j,
            terminal_energy_j: energy.terminal_energy_j,
            time_s: run.time_s,
            consumption_kwh_per_100km: energy.terminal_energy_j
                / JOULES_PER_KWH
                / (energy.distance_m / 1e5),
            budget: energy.budget,
            kinetic_difference_j: kinetic_j(speeds.last()) - kinetic_j(speeds.first()),
            sampled_energy_j: sampled.energy_j(model)?,
            steps: problem.steps().len(),
            jerk_p95_mps3,
            jerk_max_mps3,
            signals: passages(problem, run),
            nodes: Nodes {
                position_m: columns.position_m.clone(),
                speed_mps: run.speed_mps.clone(),
                arrival_s: run.arrival_s.clone(),
                stood_s: run.stood_s.clone(),
                limit_mps: columns.max_mps.clone(),
                slope_rad: columns.slope_rad.clone(),
                force_n: points.iter().map(|point| point.wheel_force_n).collect(),
                effort: points
                    .iter()
                    .map(|point| Effort::of(point, model.vehicle().effective_mass_kg()))
                    .collect(),
                energy_j: problem.steps().iter().zip(&points).map(energy_of).collect(),
            },
        })
    }
}

fn passages(problem: &Problem, run: &Run) -> Vec<SignalPassage> {
    let columns = problem.columns();
    let passage = |signal: &speed_plan::Signal| {
        let passage_s = run.arrival_s[signal.node] + run.stood_s[signal.node];
        let holds =
            |window: &&[f64; 2]| window[0] - 1e-5 <= passage_s && passage_s <= window[1] + 1e-5;
        SignalPassage {
            position_m: columns.position_m[signal.node],
            passage_s,
            window_s: signal.green_s.iter().find(holds).copied(),
            stood_s: run.stood_s[signal.node],
            green_s: signal
                .green_s
                .iter()
                .filter(|window| window[1] > 0.0 && window[0] < run.time_s)
                .copied()
                .collect(),
        }
    };
    columns.signals.iter().map(passage).collect()
}

/// A road as documents list it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoadDocument {
    /// Length, m.
    pub length_m: f64,
    /// Nodes of the grid.
    pub nodes: usize,
    /// Stops on the way.
    pub stops: usize,
    /// Signals.
    pub signals: usize,
    /// Whether a leader is ahead.
    pub leader: bool,
}

impl RoadDocument {
    /// Describes the road of a problem.
    #[must_use]
    pub fn new(problem: &Problem) -> Self {
        let columns = problem.columns();
        let last = problem.nodes() - 1;
        Self {
            length_m: columns.position_m[last] - columns.position_m[0],
            nodes: problem.nodes(),
            stops: columns.max_mps[1..last]
                .iter()
                .filter(|max| **max <= 0.0)
                .count(),
            signals: columns.signals.len(),
            leader: !columns.earliest_s.is_empty(),
        }
    }
}

/// Why nothing can be driven.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObstacleDocument {
    /// `too_late`, `signals_unreachable`, `leader_blocks`, `cannot_stop`, `cannot_accelerate` or `too_steep`.
    pub outcome: &'static str,
    /// In words.
    pub words: String,
    /// Where, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_m: Option<f64>,
    /// Earliest arrival, or earliest passage of the signal, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub earliest_s: Option<f64>,
}

impl ObstacleDocument {
    /// Describes an obstacle of a problem.
    #[must_use]
    pub fn new(problem: &Problem, obstacle: &Obstacle) -> Self {
        let (outcome, position_m, earliest_s) = match *obstacle {
            Obstacle::TooLate { earliest_arrival_s } => {
                ("too_late", None, Some(earliest_arrival_s))
            }
            Obstacle::LeaderBlocks { earliest_arrival_s } => {
                ("leader_blocks", None, Some(earliest_arrival_s))
            }
            Obstacle::SignalsUnreachable {
                node, earliest_s, ..
            } => {
                let position_m = problem.columns().position_m[node];
                ("signals_unreachable", Some(position_m), Some(earliest_s))
            }
            Obstacle::CannotStop { position_m, .. } => ("cannot_stop", Some(position_m), None),
            Obstacle::CannotAccelerate { position_m, .. } => {
                ("cannot_accelerate", Some(position_m), None)
            }
            Obstacle::TooSteep { position_m, .. } => ("too_steep", Some(position_m), None),
        };
        Self {
            outcome,
            words: obstacle.words(problem),
            position_m,
            earliest_s,
        }
    }
}

/// A point of the frontier of energy over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontierPoint {
    /// Arrival, s.
    pub time_s: f64,
    /// Energy from the cells, J.
    pub energy_j: f64,
    /// Price of time, W; `None` where it is not known.
    pub price_w: Option<f64>,
    /// Gap to the bound, %.
    pub gap_pct: f64,
}

impl FrontierPoint {
    /// Of a plan.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        Self {
            time_s: plan.run.time_s,
            energy_j: plan.run.energy_j,
            price_w: plan.price_w,
            gap_pct: plan.gap_pct,
        }
    }
}

//! One state's rows, optimum and multipliers, as a document.

use serde::{Deserialize, Serialize};
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{
    Controller, Decision, Leader, Lie, Outcome, RowKind, Scenario, State, lateral::Deviation,
};

use crate::error::Error;

/// A turn and a little more: what is beyond is no heading in rad.
const MOST_HEADING_RAD: f64 = std::f64::consts::TAU + 0.3;

/// A state to decide for, with what differs from the scenario.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateSpec {
    follower: State,
    #[serde(default)]
    leader: Option<State>,
    desired_speed_mps: Option<f64>,
    lateral: Option<Deviation>,
    lane_barrier: Option<Barrier>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Barrier {
    Quadratic,
    Braking,
    Exponential,
}

/// A decision with all that it was computed from, rows by their indices.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explained {
    /// `V1, V2, V3`
    pub v: Option<[f64; 3]>,
    /// Their derivatives along the motion without input
    pub lf_v: Option<[f64; 3]>,
    /// And along force and torque
    pub lg_v: Option<[[f64; 2]; 3]>,
    /// Barrier of the distance to the robot ahead
    pub headway: Option<LieEntry>,
    /// Barriers of the lane
    pub lane: Vec<LieEntry>,
    /// Barrier of the direction of travel
    pub direction: Option<LieEntry>,
    /// From the path, in m
    pub deviation_m: Option<f64>,
    /// What the rows stand for
    pub rows: Vec<RowKind>,
    /// Rows `a·z ≤ b`
    pub a: Vec<[f64; 5]>,
    /// Their right sides
    pub b: Vec<f64>,
    /// `z`, unless the robot brakes
    pub optimum: Option<[f64; 5]>,
    /// Rows that hold with equality
    pub active: Vec<usize>,
    /// Of each row
    pub multipliers: Vec<f64>,
    /// The rung of the ladder
    pub outcome: &'static str,
    /// What gave way, if anything did
    pub relaxed: Option<Relaxed>,
    /// Why the robot brakes, if it does
    pub braking: Option<&'static str>,
    /// What the robot is to do
    pub command: WheelCommand,
}

/// The row that gave way most, and by how much `a·z` exceeds `b`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Relaxed {
    /// Which
    pub row: RowKind,
    /// In the units of the row
    pub by: f64,
}

/// Speeds of a robot and of its wheels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WheelCommand {
    /// In m/s
    pub speed_mps: f64,
    /// In rad/s
    pub turn_rate_rad_s: f64,
    /// In m/s
    pub left_wheel_mps: f64,
    /// In m/s
    pub right_wheel_mps: f64,
}

/// A function of the state with its Lie derivatives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LieEntry {
    /// Its value
    pub h: f64,
    /// Along the motion without input
    pub lf: f64,
    /// Along force and torque
    pub lg: [f64; 2],
}

impl From<Lie> for LieEntry {
    fn from(lie: Lie) -> Self {
        Self {
            h: lie.value,
            lf: lie.lf,
            lg: lie.lg,
        }
    }
}

impl StateSpec {
    /// What the last robot of a scenario decides in this state at its start.
    ///
    /// # Errors
    ///
    /// A desired speed that is not finite, a heading of more than a turn, or settings that do not go with the state's.
    pub fn explained(&self, scenario: &Scenario) -> Result<Explained, Error> {
        self.check_headings()?;
        let controller = self.controller(scenario)?;
        let follower = scenario.starts().len() - 1;
        let mut objectives = scenario.objectives(follower, 0.0);
        if let Some(speed_mps) = self.desired_speed_mps {
            if !speed_mps.is_finite() {
                return Err(Error::DesiredSpeed { speed_mps });
            }
            objectives.desired_speed_mps = speed_mps;
        }
        let leader = self.leader.map(Leader::known);
        let decision = controller.decide(&self.follower, leader.as_ref(), &objectives, 0.0);
        Ok(Explained::of(&decision))
    }

    fn check_headings(&self) -> Result<(), Error> {
        let states = [
            ("follower", Some(&self.follower)),
            ("leader", self.leader.as_ref()),
        ];
        for (robot, state) in states {
            let heading_rad = state.map_or(0.0, |state| state.heading_rad);
            if heading_rad.abs() > MOST_HEADING_RAD {
                return Err(Error::Heading { robot, heading_rad });
            }
        }
        Ok(())
    }

    fn controller(&self, scenario: &Scenario) -> Result<Controller, Error> {
        let given = scenario.controller();
        let mut settings = given.settings().clone();
        if let Some(deviation) = self.lateral {
            settings.lane.deviation = deviation;
        }
        if let Some(barrier) = self.lane_barrier {
            settings.lane = settings.lane.with(match barrier {
                Barrier::Quadratic => LaneBarrier::QUADRATIC,
                Barrier::Braking => LaneBarrier::BRAKING,
                Barrier::Exponential => LaneBarrier::EXPONENTIAL,
            });
        }
        let (path, body) = (given.path().clone(), *given.body());
        Controller::new(path, body, settings, given.hold_s()).map_err(Error::Controller)
    }
}

impl Explained {
    /// A decision, taken apart.
    #[must_use]
    pub fn of(decision: &Decision) -> Self {
        let terms = decision.terms.as_ref();
        let rows = terms.map_or(&[][..], |t| t.rows.as_slice());
        let lyapunov = terms.map(|t| t.lyapunov);
        let solution = terms.map(|t| t.solution);
        let solved = !matches!(decision.outcome, Outcome::Braking { .. });
        Self {
            v: lyapunov.map(|v| v.map(|lie| lie.value)),
            lf_v: lyapunov.map(|v| v.map(|lie| lie.lf)),
            lg_v: lyapunov.map(|v| v.map(|lie| lie.lg)),
            headway: terms.and_then(|t| t.headway).map(LieEntry::from),
            lane: terms.map_or_else(Vec::new, |t| {
                t.lane.iter().map(|(_, lie)| lie.into()).collect()
            }),
            direction: terms.and_then(|t| t.direction).map(LieEntry::from),
            deviation_m: terms.map(|t| t.lateral.deviation_m),
            rows: terms.map_or_else(Vec::new, |t| t.rows.kinds().to_vec()),
            a: rows.iter().map(|row| row.a).collect(),
            b: rows.iter().map(|row| row.b).collect(),
            optimum: solution.filter(|_| solved).map(|s| s.z),
            active: solution.map_or_else(Vec::new, |s| {
                (0..rows.len()).filter(|row| s.is_active(*row)).collect()
            }),
            multipliers: solution.map_or_else(Vec::new, |s| s.multipliers[..rows.len()].to_vec()),
            outcome: decision.outcome.name(),
            relaxed: match decision.outcome {
                Outcome::Relaxed { row, by } => Some(Relaxed { row, by }),
                _ => None,
            },
            braking: match decision.outcome {
                Outcome::Braking { reason } => Some(reason.name()),
                _ => None,
            },
            command: WheelCommand {
                speed_mps: decision.speeds.speed_mps,
                turn_rate_rad_s: decision.speeds.turn_rate_rad_s,
                left_wheel_mps: decision.wheels.left_mps,
                right_wheel_mps: decision.wheels.right_mps,
            },
        }
    }
}

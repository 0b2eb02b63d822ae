//! What the controller decided in one step, and why.

use strum::IntoStaticStr;

use crate::cbf::LaneBarriers;
use crate::lateral::Lateral;
use crate::lie::Lie;
use crate::pose::{Speeds, State};
use crate::qp::Solution;
use crate::rows::{RowKind, Rows};
use crate::unicycle::{Body, Input, WheelSpeeds};

/// The rung of the ladder on which a step ended.
#[derive(Debug, Clone, Copy, PartialEq, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
#[must_use]
pub enum Outcome {
    /// Every row holds
    Optimal,
    /// The rows of the lane or of the direction of travel had to give way; headway and wheel limits hold
    Relaxed {
        /// The row that gave way most
        row: RowKind,
        /// By how much `a·z` exceeds `b`, in the units of the row
        by: f64,
    },
    /// Zero speed, with wheel rows as soon as the wheels can
    Braking {
        /// Why
        reason: Brake,
    },
}

/// Why a robot is stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Brake {
    /// The scenario asks for it
    Asked,
    /// Rows contradict each other
    Infeasible,
    /// No pose was ever seen
    NoPose,
    /// The newest pose is too old
    StalePose,
    /// No pose of the robot ahead, or too old a one
    LeaderLost,
    /// Robots stand and wait for each other in a circle
    Deadlock,
    /// Whoever drives does not let it move
    Held,
    /// A number that is NaN or infinite
    NotFinite,
    /// The solver reached its iteration limit
    Solver,
}

impl Outcome {
    /// The rung in one word.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

impl Brake {
    /// As in documents.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Decision {
    /// How it ended
    pub outcome: Outcome,
    /// The state it was taken for, where there was one
    pub state: Option<State>,
    /// What it was computed from, where that could be computed
    pub terms: Option<Terms>,
    /// Force and torque
    pub input: Input,
    /// The speeds that the robot is told
    pub speeds: Speeds,
    /// The same as wheel speeds
    pub wheels: WheelSpeeds,
}

/// The functions of the state, the rows and the optimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    /// `V1, V2, V3`
    pub lyapunov: [Lie; 3],
    /// Headway, where there is a robot ahead, without margins
    pub headway: Option<Lie>,
    /// Lane, without margins
    pub lane: LaneBarriers,
    /// Direction of travel, where it is bounded
    pub direction: Option<Lie>,
    /// Motion across the path that the lane bounds
    pub lateral: Lateral,
    /// All rows
    pub rows: Rows,
    /// Optimum, multipliers and active rows
    pub solution: Solution<5>,
}

impl Decision {
    /// The same, stopped for another reason.
    pub fn stopped(self, reason: Brake) -> Self {
        Self {
            input: Input::default(),
            speeds: Speeds::ZERO,
            wheels: WheelSpeeds::default(),
            outcome: Outcome::Braking { reason },
            ..self
        }
    }

    /// The same with at most this speed, in m/s, on the same bend; at zero the robot stands.
    pub fn limited(self, most_mps: f64, body: &Body) -> Self {
        let speed_mps = self.speeds.speed_mps.abs();
        let braking = matches!(self.outcome, Outcome::Braking { .. });
        if most_mps <= 0.0 && !braking {
            return self.stopped(Brake::Held);
        }
        if braking || speed_mps <= most_mps {
            return self;
        }
        let share = most_mps / speed_mps;
        let wheels = WheelSpeeds {
            left_mps: share * self.wheels.left_mps,
            right_mps: share * self.wheels.right_mps,
        };
        Self {
            speeds: body.speeds_of(wheels),
            wheels,
            ..self
        }
    }

    /// Whether a row of this kind holds the robot.
    #[must_use]
    pub fn is_held_by(&self, kind: RowKind) -> bool {
        self.terms.as_ref().is_some_and(|terms| {
            let active = terms.solution.active;
            let mut kinds = terms.rows.kinds().iter().enumerate();
            kinds.any(|(row, own)| *own == kind && active & (1 << row) != 0)
        })
    }

    /// The first body whose row holds the robot, counted from the robot ahead if it has one.
    #[must_use]
    pub fn held_by_body(&self) -> Option<usize> {
        let terms = self.terms.as_ref()?;
        let mut body = 0;
        for (row, kind) in terms.rows.kinds().iter().enumerate() {
            let is_of_body = matches!(kind, RowKind::Apart | RowKind::Point);
            if is_of_body && terms.solution.is_active(row) {
                return Some(body);
            }
            // The row of the points stands before that of the bodies.
            body += usize::from(*kind == RowKind::Apart);
        }
        None
    }

    pub(crate) fn braking(reason: Brake, state: Option<State>, terms: Option<Terms>) -> Self {
        Self {
            outcome: Outcome::Braking { reason },
            state,
            terms,
            input: Input::default(),
            speeds: Speeds::ZERO,
            wheels: WheelSpeeds::default(),
        }
    }
}

//! From a state to a decision: rows, quadratic program, ladder, speeds.

use crate::cbf::LaneBarrier;
use crate::crossing::Crossing;
use crate::decision::{Brake, Decision, Outcome, Terms};
use crate::error::Error;
use crate::lateral::{Deviation, Lateral, radial};
use crate::limits::Limits;
use crate::located::Located;
use crate::path::{Path, PathPoint};
use crate::pose::State;
use crate::qp::{self, Status};
use crate::settings::{ControllerSettings, Literal};
use crate::unicycle::{Body, Input};

/// The part of the objectives that scenarios change over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objectives {
    /// `v_d`, in m/s
    pub desired_speed_mps: f64,
    /// How the path is tracked; `None` while the tracker is off
    pub tracking: Option<Tracking>,
    /// Weight of `δ1`
    pub speed_weight: f64,
    /// The robot stops at once and stands
    pub stop: bool,
}

/// Rate and weight of the row of `V3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// `c3`, in 1/s
    pub rate_1ps: f64,
    /// `p5`
    pub weight: f64,
}

/// The robot ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leader {
    /// As it moves now
    pub state: State,
    /// Its point of interest where it was last seen, in m
    pub last_seen_m: [f64; 2],
    /// Where it is along the path, in m, as far as that is known
    pub near_m: Option<f64>,
}

impl Leader {
    /// One whose state is known.
    #[must_use]
    pub fn known(state: State) -> Self {
        Self {
            state,
            last_seen_m: [state.x_m, state.y_m],
            near_m: None,
        }
    }

    /// With its place.
    #[must_use]
    pub fn located(&self) -> Located {
        let near_m = self.near_m;
        Located {
            state: self.state,
            near_m,
        }
    }
}

/// The robots around one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Around<'a> {
    /// Whom it follows
    pub leader: Option<&'a Leader>,
    /// Others whose bodies it must not touch, the nearest first; the first four are regarded
    pub others: &'a [Located],
    /// How far it may go along the path, in m, where it gives way
    pub stop_line_m: Option<f64>,
    /// The foot of the robot itself on the path, where it is known already; see [`Controller::foot`]
    pub foot: Option<PathPoint>,
}

/// The barriers at a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Safety {
    /// That of the lane in its own units; with exponential rows `d_max − |y|`, in m
    pub lane: f64,
    /// `D − D0 − τ v`, in m, behind another robot
    pub headway_m: Option<f64>,
    /// `y`, in m
    pub deviation_m: f64,
}

/// The quadratic program of (3.7) for one kind of robot on one path.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    path: Path,
    body: Body,
    pub(crate) settings: ControllerSettings,
    hold_s: f64,
    limits: Limits,
    pub(crate) crossings: Vec<Crossing>,
    /// Where a place of the lane belongs to two branches
    pub(crate) meetings: Vec<Crossing>,
    /// From how near on another robot has a row, squared
    pub(crate) reach_m2: f64,
}

impl Controller {
    /// A controller whose commands are held for `hold_s`.
    ///
    /// # Errors
    ///
    /// The first setting out of its range.
    pub fn new(
        path: Path,
        body: Body,
        mut settings: ControllerSettings,
        hold_s: f64,
    ) -> Result<Self, Error> {
        body.check()?;
        let body = body.completed();
        settings.check()?;
        Error::positive("hold_s", hold_s)?;
        let limits = Limits::new(&path, &body, &settings, hold_s)?;
        settings.lane = settings.lane.with_rates(limits.lane_rates_1ps);
        let mut controller = Self {
            path,
            body,
            settings,
            hold_s,
            limits,
            crossings: Vec::new(),
            meetings: Vec::new(),
            reach_m2: f64::INFINITY,
        };
        controller.find_crossings()?;
        controller.reach_m2 = controller.reach_m().powi(2);
        Ok(controller)
    }

    /// The path
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The robot
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// What fits the lane
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The settings, with rates of the lane that the period allows
    #[must_use]
    pub fn settings(&self) -> &ControllerSettings {
        &self.settings
    }

    /// How long a command is held, in s.
    #[must_use]
    pub fn hold_s(&self) -> f64 {
        self.hold_s
    }

    /// Objectives without a schedule: the desired speed, and the tracker on.
    #[must_use]
    pub fn objectives(&self, desired_speed_mps: f64) -> Objectives {
        Objectives {
            desired_speed_mps,
            tracking: Some(Tracking {
                rate_1ps: self.settings.convergence_1ps[2],
                weight: self.settings.weights[4],
            }),
            speed_weight: self.settings.weights[2],
            stop: false,
        }
    }

    /// The motion across the path that the lane bounds.
    #[must_use]
    pub fn lateral(&self, state: &State) -> Lateral {
        self.lateral_of(&(*state).into())
    }

    fn lateral_of(&self, robot: &Located) -> Lateral {
        match (&self.path, self.settings.lane.deviation) {
            (Path::Polar(path), Deviation::Radial) => {
                let unsigned = self.settings.is_literal(Literal::UnsignedAngleRate);
                radial(path, &self.body, &robot.state, unsigned)
            }
            _ => self.frenet(robot).lateral(),
        }
    }

    /// What has to stay at or above zero, without margins.
    #[must_use]
    pub fn safety(&self, state: &State, leader: Option<&State>) -> Safety {
        let leader = leader.map(|leader| Located::from(*leader));
        self.safety_of(&(*state).into(), leader.as_ref())
    }

    /// The same of robots that are followed along the path.
    #[must_use]
    pub fn safety_of(&self, robot: &Located, leader: Option<&Located>) -> Safety {
        let lateral = self.lateral_of(robot);
        let deviation_m = lateral.deviation_m;
        let lane = match self.settings.lane.barrier {
            LaneBarrier::Exponential { .. } => self.settings.lane.half_width_m - deviation_m.abs(),
            _ => self.lane_barriers(&lateral, 0.0).least(),
        };
        Safety {
            lane,
            headway_m: leader.map(|leader| self.headway_m(robot, leader)),
            deviation_m,
        }
    }

    /// `D − D0 − τ v`. Where every robot is regarded a chord across the loop is no headway: to a robot that is more than a quarter of
    /// a lap ahead the way along the path counts.
    fn headway_m(&self, robot: &Located, leader: &Located) -> f64 {
        let chord_m = self.headway(robot, leader, None).value;
        let lap_m = self.path.length_m().filter(|_| chord_m < 0.0);
        let every_robot = self.settings.hardening.regards_every_robot();
        let Some(lap_m) = lap_m.filter(|_| every_robot) else {
            return chord_m;
        };
        let along_m = self
            .path
            .distance_along_m(self.s_m(robot), self.s_m(leader));
        if along_m < 0.25 * lap_m {
            return chord_m;
        }
        along_m - self.standstill_m() - self.settings.headway.time_s * robot.state.speed_mps
    }

    /// Decides for a state whose newest pose is `age_s` old, with nobody around but the robot ahead.
    pub fn decide(
        &self,
        state: &State,
        leader: Option<&Leader>,
        objectives: &Objectives,
        age_s: f64,
    ) -> Decision {
        let around = Around {
            leader,
            ..Around::default()
        };
        self.decide_among(state, around, objectives, age_s)
    }

    /// Decides for a state whose newest pose is `age_s` old.
    pub fn decide_among(
        &self,
        state: &State,
        around: Around,
        objectives: &Objectives,
        age_s: f64,
    ) -> Decision {
        let leader = around.leader.map(|leader| &leader.state);
        let others = around.others.iter().map(|other| &other.state);
        let mut known = others.chain(leader);
        if !state.is_finite() || !known.all(State::is_finite) {
            return Decision::braking(Brake::NotFinite, Some(*state), None);
        }
        let mut terms = self.terms(state, around, objectives, age_s);
        let weights = self.weights(objectives);
        let solution = qp::solve(&weights, terms.rows.as_slice());
        terms.solution = solution;
        match solution.status {
            Status::Optimal => self.decided(Outcome::Optimal, state, terms),
            Status::NotFinite | Status::TooManyRows => {
                Decision::braking(Brake::NotFinite, Some(*state), Some(terms))
            }
            Status::Infeasible | Status::IterationLimit if self.is_to_stand(state, &terms) => {
                Decision::braking(Brake::Infeasible, Some(*state), Some(terms))
            }
            Status::Infeasible | Status::IterationLimit => self.relaxed(state, terms, &weights),
        }
    }

    fn weights(&self, objectives: &Objectives) -> [f64; 5] {
        let mut weights = self.settings.weights;
        weights[2] = objectives.speed_weight;
        if let Some(tracking) = objectives.tracking {
            weights[4] = tracking.weight;
        }
        weights
    }

    /// Wheels that are faster than they may be slow down as fast as they can, and not at once.
    fn clip_mps(&self, state: &State) -> f64 {
        let limit_mps = self.limits.wheel_speed_mps;
        if !self.settings.hardening.wheel_rows {
            return limit_mps;
        }
        let wheels = self.body.wheel_speeds(state.speeds());
        let fastest_mps = wheels.left_mps.abs().max(wheels.right_mps.abs());
        limit_mps.max(fastest_mps - self.body.wheel_acceleration_mps2() * self.hold_s)
    }

    pub(crate) fn decided(&self, outcome: Outcome, state: &State, terms: Terms) -> Decision {
        let [force_n, torque_nm, ..] = terms.solution.z;
        let input = Input { force_n, torque_nm };
        let speeds = self.body.speeds_after(state.speeds(), input, self.hold_s);
        let driven = Body {
            max_wheel_speed_mps: self.clip_mps(state),
            ..self.body
        };
        let wheels = driven.clipped(speeds);
        if !wheels.left_mps.is_finite() || !wheels.right_mps.is_finite() {
            return Decision::braking(Brake::NotFinite, Some(*state), Some(terms));
        }
        Decision {
            outcome,
            state: Some(*state),
            terms: Some(terms),
            input,
            speeds: self.body.speeds_of(wheels),
            wheels,
        }
    }
}

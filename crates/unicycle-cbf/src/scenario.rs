//! Experiments: what a file says, and what is checked and can be run.

use serde::{Deserialize, Serialize};

use crate::controller::{Controller, Objectives, Tracking};
use crate::error::Error;
use crate::lateral::Deviation;
use crate::path::{Path, PathPoint};
use crate::pose::{Pose, Speeds};
use crate::settings::{ControllerSettings, Literal};
use crate::unicycle::Body;

/// Decisions of all robots in a run.
const MOST_DECISIONS: f64 = 1e6;

/// What a scenario file says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSpec {
    /// For reports
    pub name: String,
    /// For reports: which robots these are
    pub testbed: String,
    /// Poses and commands per second
    pub rate_hz: f64,
    /// In s
    pub duration_s: f64,
    /// What is followed
    pub path: PathSpec,
    /// All robots
    pub body: Body,
    /// All controllers
    pub controller: ControllerSettings,
    /// From the front: the first has none ahead of it
    pub robots: Vec<RobotSpec>,
}

/// A path as a file says it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PathSpec {
    /// (2.23) `R + b sin(n φ)` about the origin
    Polar {
        /// `R`, in m
        radius_m: f64,
        /// `b`, in m
        amplitude_m: f64,
        /// `n`
        periods: u32,
    },
    /// A line without end
    Straight {
        /// A point of it, in m
        x_m: f64,
        /// A point of it, in m
        y_m: f64,
        /// Its direction, in rad
        heading_rad: f64,
    },
    /// A smooth loop through points in the order of travel
    Closed {
        /// `[x, y]`, in m
        points_m: Vec<[f64; 2]>,
    },
}

/// One robot: where it starts and what it wants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Place of its point of interest along the path: revolutions on closed paths, m on straight ones
    pub start: f64,
    /// How far to the right of the path it starts, in m
    #[serde(default)]
    pub start_deviation_m: f64,
    /// `v_d` from a time on: pairs of s and m/s, in order, the first at 0
    pub desired_speed_mps: Vec<[f64; 2]>,
    /// Whether and how it tracks the path
    pub tracker: Tracker,
    /// Spans in which it stops at once and stands, in s
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops_s: Vec<[f64; 2]>,
}

/// The tracker over time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Tracker {
    /// All the time
    On,
    /// Not between two times
    Off {
        /// In s
        from_s: f64,
        /// In s
        to_s: f64,
    },
    /// `c3` and `p5` decay exponentially (4.1, 4.2)
    Decay {
        /// In s
        from_s: f64,
        /// `c3` in the end, in 1/s
        rate_1ps: f64,
        /// `p5` in the end, above zero
        weight: f64,
    },
}

/// A scenario that can be run.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    spec: ScenarioSpec,
    controller: Controller,
    starts: Vec<Pose>,
}

impl Scenario {
    /// # Errors
    ///
    /// The first number out of its range, or robots that cannot start where they shall.
    pub fn new(mut spec: ScenarioSpec) -> Result<Self, Error> {
        spec.check_units()?;
        Error::within("rate_hz", spec.rate_hz, 1.0, 1000.0)?;
        Error::within("duration_s", spec.duration_s, 1.0 / spec.rate_hz, 86_400.0)?;
        let path = spec.path.path()?;
        let (body, settings) = (spec.body, spec.controller.clone());
        let controller = Controller::new(path, body, settings, 1.0 / spec.rate_hz)?;
        Error::within("number of robots", spec.robots.len() as f64, 1.0, 64.0)?;
        for (robot, own) in spec.robots.iter().enumerate() {
            own.check(robot)?;
        }
        spec.check_size()?;
        spec.body = spec.body.completed();
        let starts = spec
            .robots
            .iter()
            .map(|robot| robot.start_pose(&controller))
            .collect();
        let scenario = Self {
            spec,
            controller,
            starts,
        };
        scenario.check_order()?;
        scenario.check_room()?;
        Ok(scenario)
    }

    /// What it was made from, completed where something was left out.
    #[must_use]
    pub fn spec(&self) -> &ScenarioSpec {
        &self.spec
    }

    /// The controller that all robots share.
    #[must_use]
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Poses at the start, from the front.
    #[must_use]
    pub fn starts(&self) -> &[Pose] {
        &self.starts
    }

    /// Number of steps.
    #[must_use]
    pub fn steps(&self) -> usize {
        (self.spec.duration_s * self.spec.rate_hz).round() as usize
    }

    /// Time of a step, in s.
    #[must_use]
    pub fn time_s(&self, step: usize) -> f64 {
        step as f64 / self.spec.rate_hz
    }

    /// Speeds of a robot before its first step: the desired ones, or zero.
    #[must_use]
    pub fn initial_speeds(&self, robot: usize) -> Speeds {
        if !self.spec.controller.hardening.start_at_desired_speed {
            return Speeds::ZERO;
        }
        Speeds {
            speed_mps: self.objectives(robot, 0.0).desired_speed_mps,
            turn_rate_rad_s: 0.0,
        }
    }

    /// With rows for the wheels nobody wants more than they may do: a wish far beyond upsets the program's numbers.
    fn attainable_mps(&self, desired_mps: f64) -> f64 {
        let limit_mps = self.controller.limits().wheel_speed_mps;
        if self.spec.controller.hardening.wheel_rows {
            desired_mps.clamp(-limit_mps, limit_mps)
        } else {
            desired_mps
        }
    }

    /// What a robot wants at a time.
    #[must_use]
    pub fn objectives(&self, robot: usize, time_s: f64) -> Objectives {
        let spec = &self.spec.robots[robot];
        let due = spec.desired_speed_mps.iter().rev();
        let desired = due.clone().find(|[from_s, _]| *from_s <= time_s);
        let desired_mps = desired.map_or(0.0, |[_, speed]| *speed);
        let mut objectives = self.controller.objectives(self.attainable_mps(desired_mps));
        let within = |[from_s, to_s]: &[f64; 2]| (*from_s..*to_s).contains(&time_s);
        objectives.stop = spec.stops_s.iter().any(within);
        match spec.tracker {
            Tracker::On => {}
            Tracker::Off { from_s, to_s } => {
                if within(&[from_s, to_s]) {
                    objectives.tracking = None;
                }
            }
            Tracker::Decay {
                from_s,
                rate_1ps,
                weight,
            } => {
                if time_s >= from_s {
                    let share = (from_s - time_s).exp();
                    let decayed = |from: f64, to: f64| to + (from - to) * share;
                    let literal = self
                        .spec
                        .controller
                        .is_literal(Literal::DecayingSpeedWeight);
                    decay(
                        &mut objectives,
                        literal,
                        |from| decayed(from, rate_1ps),
                        |from| decayed(from, weight),
                    );
                }
            }
        }
        objectives
    }

    /// Radius of the path's tightest bend, in m, where the lane is wider than that: places at its inner edge then belong to several
    /// places of the path. Radial deviations of polar paths do not mind.
    #[must_use]
    pub fn tight_bend_m(&self) -> Option<f64> {
        let (path, lane) = (self.controller.path(), &self.spec.controller.lane);
        if matches!(path, Path::Polar(_)) && lane.deviation == Deviation::Radial {
            return None;
        }
        let bend_m = 1.0 / path.max_curvature_1pm();
        (lane.half_width_m >= bend_m).then_some(bend_m)
    }
}

impl ScenarioSpec {
    /// Runs are kept in memory, a kilobyte or two for a decision.
    fn check_size(&self) -> Result<(), Error> {
        let decisions = self.duration_s * self.rate_hz * self.robots.len() as f64;
        if decisions <= MOST_DECISIONS {
            return Ok(());
        }
        Err(Error::Contradiction {
            what: format!(
                "{} robots for {} s at {} Hz are {decisions:.0} decisions, and a run has at most {MOST_DECISIONS}; shorten `duration_s`",
                self.robots.len(),
                self.duration_s,
                self.rate_hz
            ),
        })
    }
}

/// (4.1) and (4.2); the literal form decays `p3` in place of `p5`.
fn decay(
    objectives: &mut Objectives,
    literal: bool,
    rate: impl Fn(f64) -> f64,
    weight: impl Fn(f64) -> f64,
) {
    let Some(tracking) = objectives.tracking else {
        return;
    };
    objectives.tracking = Some(Tracking {
        rate_1ps: rate(tracking.rate_1ps),
        weight: if literal {
            tracking.weight
        } else {
            weight(tracking.weight)
        },
    });
    if literal {
        objectives.speed_weight = weight(objectives.speed_weight);
    }
}

impl PathSpec {
    fn path(&self) -> Result<Path, Error> {
        Ok(match self {
            Self::Polar {
                radius_m,
                amplitude_m,
                periods,
            } => Path::polar(*radius_m, *amplitude_m, *periods)?,
            Self::Straight {
                x_m,
                y_m,
                heading_rad,
            } => Path::straight(*x_m, *y_m, *heading_rad)?,
            Self::Closed { points_m } => Path::closed(points_m)?,
        })
    }
}

impl RobotSpec {
    /// One that starts on the path and always tracks it at one speed.
    #[must_use]
    pub fn steady(start: f64, desired_speed_mps: f64) -> Self {
        Self {
            start,
            start_deviation_m: 0.0,
            desired_speed_mps: vec![[0.0, desired_speed_mps]],
            tracker: Tracker::On,
            stops_s: Vec::new(),
        }
    }

    fn check(&self, robot: usize) -> Result<(), Error> {
        let refuse = |what: String| Err(Error::Start { robot, what });
        if !self.start.is_finite() || !self.start_deviation_m.is_finite() {
            return refuse("starts at a place that is no number".into());
        }
        if self
            .desired_speed_mps
            .first()
            .is_none_or(|[from_s, _]| *from_s > 0.0)
        {
            return refuse(
                "has no desired speed at 0 s; begin `desired_speed_mps` with [0, …]".into(),
            );
        }
        let ordered = self.desired_speed_mps.is_sorted_by(|[a, _], [b, _]| a < b);
        let finite = |[from_s, to]: &[f64; 2]| from_s.is_finite() && to.is_finite();
        if !ordered || !self.desired_speed_mps.iter().all(finite) {
            return refuse("has desired speeds that are not in the order of time".into());
        }
        if !self.stops_s.iter().all(|[from_s, to_s]| from_s <= to_s) {
            return refuse("has a stop that ends before it begins".into());
        }
        match self.tracker {
            Tracker::On => Ok(()),
            Tracker::Off { from_s, to_s } if from_s <= to_s => Ok(()),
            Tracker::Off { .. } => refuse("has a tracker that is on again before it is off".into()),
            Tracker::Decay {
                from_s,
                rate_1ps,
                weight,
            } => {
                Error::within("tracker.from_s", from_s, 0.0, f64::MAX)?;
                Error::within("tracker.rate_1ps", rate_1ps, 0.0, f64::MAX)?;
                Error::positive("tracker.weight", weight)
            }
        }
    }

    /// Where its foot starts. On a polar path revolutions are angles.
    pub(crate) fn start_foot(&self, controller: &Controller) -> PathPoint {
        match controller.path() {
            Path::Polar(path) => path.at_angle(self.start * std::f64::consts::TAU),
            path => path.at(self.start * path.length_m().unwrap_or(1.0)),
        }
    }

    /// The pose of the axle whose point of interest starts on the path, or beside it, in the path's direction.
    fn start_pose(&self, controller: &Controller) -> Pose {
        let foot = self.start_foot(controller);
        let ([nx, ny], [tx, ty]) = (foot.normal(), foot.tangent);
        let back_m = controller.body().offset_m;
        Pose {
            x_m: foot.x_m + self.start_deviation_m * nx - back_m * tx,
            y_m: foot.y_m + self.start_deviation_m * ny - back_m * ty,
            heading_rad: foot.heading_rad(),
        }
    }
}

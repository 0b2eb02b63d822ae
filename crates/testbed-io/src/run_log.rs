//! A run as a table of columns: what was seen, what was decided and, in simulations, what was true.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Pose, Scenario, ScenarioSpec, StampedPose, State};

use crate::disturbances::Disturbances;
use crate::error::Error;
use crate::live::LinkSpec;
use crate::log_file::{Column, LogTable, Values};
use crate::simulation::Simulation;
use crate::summary::Summary;
use crate::tick::Tick;

/// Everything that makes a run; it stands in every run log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// Of all random numbers
    pub seed: u64,
    /// Robots, path, controller
    pub scenario: ScenarioSpec,
    /// What the simulated testbed does wrong
    #[serde(default)]
    pub disturbances: Disturbances,
    /// The real testbed, where it ran on one
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkSpec>,
}

/// A run with all its ticks, in the order in which they were decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What made it
    pub spec: RunSpec,
    /// All robots and steps
    pub ticks: Vec<Tick>,
    /// The wall clock at 0 s, in s since 1970; none where there is none
    pub started_unix_s: Option<f64>,
}

impl RunSpec {
    /// Runs it in simulation.
    ///
    /// # Errors
    ///
    /// A scenario or disturbance that cannot be.
    pub fn simulate(&self) -> Result<(Run, Summary), Error> {
        let scenario = Scenario::new(self.scenario.clone())?;
        let simulation = Simulation {
            scenario: &scenario,
            disturbances: self.disturbances,
            seed: self.seed,
        };
        let mut ticks = Vec::with_capacity(scenario.steps() * scenario.starts().len());
        let summary = simulation.run(|tick| ticks.push(*tick))?;
        let run = Run {
            spec: self.clone(),
            ticks,
            started_unix_s: None,
        };
        Ok((run, summary))
    }
}

/// The speed that a live session lets a robot have at most, where it limits it.
const ALLOWED: (&str, Read) = ("allowed_speed_mps", |t| {
    t.watched.and_then(|w| w.allowed_mps).unwrap_or(f64::NAN)
});

/// For how long poses of a robot have contradicted where a live session took it to be.
const DISBELIEVED: (&str, Read) = ("disbelieved_s", |t| {
    t.watched.and_then(|w| w.disbelieved_s).unwrap_or(f64::NAN)
});

/// How far the point of interest of a robot was found to be from where a live session took it to be.
const MISPLACED: (&str, Read) = ("misplaced_m", |t| {
    t.watched.and_then(|w| w.misplaced_m).unwrap_or(f64::NAN)
});

type Read = fn(&Tick) -> f64;

/// What arrived; together with the settings it determines every decision.
const SEEN: [(&str, Read); 4] = [
    ("pose_stamp_s", |t| t.seen.map_or(f64::NAN, |s| s.stamp_s)),
    ("pose_x_m", |t| t.seen.map_or(f64::NAN, |s| s.pose.x_m)),
    ("pose_y_m", |t| t.seen.map_or(f64::NAN, |s| s.pose.y_m)),
    ("pose_heading_rad", |t| {
        t.seen.map_or(f64::NAN, |s| s.pose.heading_rad)
    }),
];

/// The least lane barrier of a decision as it stands in its row: with exponential rows in m/s, or else in the barrier's own units.
const LANE_ROW: &str = "lane_row";
/// Its name in logs of before, in which it could be taken for the barrier of the true place.
const LANE_ROW_BEFORE: &str = "h_lane";

/// What was decided, and from what.
pub(crate) const DECIDED: [(&str, Read); 26] = [
    ("x_m", |t| t.decision.state.map_or(f64::NAN, |s| s.x_m)),
    ("y_m", |t| t.decision.state.map_or(f64::NAN, |s| s.y_m)),
    ("speed_mps", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.speed_mps)
    }),
    ("heading_rad", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.heading_rad)
    }),
    ("turn_rate_rad_s", |t| {
        t.decision.state.map_or(f64::NAN, |s| s.turn_rate_rad_s)
    }),
    ("v1", |t| t.lyapunov(0)),
    ("v2", |t| t.lyapunov(1)),
    ("v3", |t| t.lyapunov(2)),
    ("h_headway_m", |t| t.headway_m()),
    (LANE_ROW, |t| t.lane()),
    ("deviation_m", |t| t.deviation_m()),
    ("force_n", |t| t.decision.input.force_n),
    ("torque_nm", |t| t.decision.input.torque_nm),
    ("slack_v1", |t| t.slack(0)),
    ("slack_v2", |t| t.slack(1)),
    ("slack_v3", |t| t.slack(2)),
    ("relaxed_by", |t| t.relaxed_by()),
    ("multiplier_1", |t| t.multiplier(0)),
    ("multiplier_2", |t| t.multiplier(1)),
    ("multiplier_3", |t| t.multiplier(2)),
    ("multiplier_4", |t| t.multiplier(3)),
    ("multiplier_5", |t| t.multiplier(4)),
    ("command_speed_mps", |t| t.decision.speeds.speed_mps),
    ("command_turn_rate_rad_s", |t| {
        t.decision.speeds.turn_rate_rad_s
    }),
    ("left_wheel_mps", |t| t.decision.wheels.left_mps),
    ("right_wheel_mps", |t| t.decision.wheels.right_mps),
];

/// What a simulation knows besides, and the time that the decision took.
const KNOWN: [(&str, Read); 12] = [
    ("true_x_m", |t| t.true_pose(0)),
    ("true_y_m", |t| t.true_pose(1)),
    ("true_heading_rad", |t| t.true_pose(2)),
    ("true_speed_mps", |t| {
        t.truth.map_or(f64::NAN, |t| t.state.speed_mps)
    }),
    ("true_turn_rate_rad_s", |t| {
        t.truth.map_or(f64::NAN, |t| t.state.turn_rate_rad_s)
    }),
    ("true_h_headway_m", |t| {
        t.truth.and_then(|t| t.safety.headway_m).unwrap_or(f64::NAN)
    }),
    ("true_h_lane", |t| {
        t.truth.map_or(f64::NAN, |t| t.safety.lane)
    }),
    ("true_deviation_m", |t| {
        t.truth.map_or(f64::NAN, |t| t.safety.deviation_m)
    }),
    ("innovation_position_m", |t| {
        t.watched.map_or(f64::NAN, |w| w.innovation_position_m)
    }),
    ("innovation_heading_rad", |t| {
        t.watched.map_or(f64::NAN, |w| w.innovation_heading_rad)
    }),
    ("step_us", |t| t.step_us),
    ("late_us", |t| t.late_us),
];

impl Run {
    /// As columns for a file.
    ///
    /// # Errors
    ///
    /// None on runs of this crate.
    pub fn to_table(&self) -> Result<LogTable, Error> {
        let columns = Columns {
            half_width_m: self.spec.half_width_m(),
            started_unix_s: self.started_unix_s,
        };
        LogTable::new(&self.spec.to_json()?, columns.of(&self.ticks))
    }
}

impl RunSpec {
    pub(crate) fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string(self).map_err(|e| Error::Meta(e.to_string()))
    }

    pub(crate) fn half_width_m(&self) -> f64 {
        self.scenario.controller.lane.half_width_m
    }
}

/// What the columns of a run log need besides its ticks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns {
    pub(crate) half_width_m: f64,
    pub(crate) started_unix_s: Option<f64>,
}

impl Columns {
    /// The columns of a run log with a row for each tick.
    pub(crate) fn of(&self, ticks: &[Tick]) -> Vec<Column> {
        let integers = |read: fn(&Tick) -> usize| {
            Values::Integer(ticks.iter().map(|t| read(t) as i64).collect())
        };
        let floats = |read: &dyn Fn(&Tick) -> f64| Values::Float(ticks.iter().map(read).collect());
        let named = |(name, read): &(&str, Read)| column(name, floats(read));
        let mut columns = vec![
            column("tick", integers(|t| t.tick)),
            column("robot", integers(|t| t.robot)),
            column("time_s", floats(&|t| t.time_s)),
        ];
        if let Some(started_s) = self.started_unix_s {
            columns.push(column("unix_time_s", floats(&|t| started_s + t.time_s)));
        }
        let outcomes = ticks.iter().map(Tick::outcome_name);
        columns.push(column("outcome", Values::Text(outcomes.collect())));
        columns.extend(SEEN.iter().map(named));
        columns.push(named(&ALLOWED));
        columns.push(named(&DISBELIEVED));
        columns.push(named(&MISPLACED));
        columns.extend(DECIDED.iter().map(named));
        columns.extend(KNOWN.iter().map(named));
        let clearance = |t: &Tick| t.lane_clearance_m(self.half_width_m).unwrap_or(f64::NAN);
        columns.push(column("lane_clearance_m", floats(&clearance)));
        columns
    }
}

fn column(name: &str, values: Values) -> Column {
    Column {
        name: name.to_owned(),
        values,
    }
}

/// A run log as far as a replay needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLog {
    /// What made it
    pub spec: RunSpec,
    /// One entry per tick, in the order of the file
    pub rows: Vec<LoggedTick>,
    /// Whether the end of the file was missing
    pub truncated: bool,
    /// Whether the file says where it ends
    pub states_its_end: bool,
}

/// A row of a run log.
#[derive(Debug, Clone, PartialEq)]
pub struct LoggedTick {
    /// Index of the step
    pub tick: usize,
    /// Index of the robot
    pub robot: usize,
    /// In s from the start
    pub time_s: f64,
    /// The pose that arrived
    pub seen: Option<StampedPose>,
    /// What a live session let it drive at most, in m/s
    pub allowed_mps: Option<f64>,
    /// For how long its poses contradicted where a live session took it to be, in s
    pub disbelieved_s: Option<f64>,
    /// How far its point of interest was found to be from where a live session took it to be, in m
    pub misplaced_m: Option<f64>,
    /// Where its point of interest truly was, or was measured
    pub place: Option<State>,
    /// Outcome as text
    pub outcome: String,
    /// The columns of decisions, in their order
    pub decided: [f64; DECIDED.len()],
}

impl RunLog {
    /// # Errors
    ///
    /// Columns that are missing or of another type, or settings that cannot be read.
    pub fn from_table(table: &LogTable) -> Result<Self, Error> {
        let spec = serde_json::from_str(table.meta()).map_err(|e| Error::Meta(e.to_string()))?;
        let ticks = integers(table, "tick")?;
        let robots = integers(table, "robot")?;
        let times_s = floats(table, "time_s")?;
        let outcomes = texts(table, "outcome")?;
        let allowed = if_there(table, ALLOWED.0)?;
        let disbelieved = if_there(table, DISBELIEVED.0)?;
        let misplaced = if_there(table, MISPLACED.0)?;
        let seen: Vec<&[f64]> = SEEN
            .iter()
            .map(|(name, _)| floats(table, name))
            .collect::<Result<_, _>>()?;
        let decided: Vec<&[f64]> = DECIDED
            .iter()
            .map(|(name, _)| decided(table, name))
            .collect::<Result<_, _>>()?;
        let places = places(table);
        let index = |value: i64, what: &str| {
            usize::try_from(value).map_err(|_| Error::Meta(format!("{what} {value} is negative")))
        };
        let rows = (0..ticks.len())
            .map(|row| {
                let [stamp_s, x_m, y_m, heading_rad] = [0, 1, 2, 3].map(|i: usize| seen[i][row]);
                let pose = Pose {
                    x_m,
                    y_m,
                    heading_rad,
                };
                Ok(LoggedTick {
                    tick: index(ticks[row], "tick")?,
                    robot: index(robots[row], "robot")?,
                    time_s: times_s[row],
                    seen: (!stamp_s.is_nan()).then_some(StampedPose { stamp_s, pose }),
                    allowed_mps: value(allowed, row),
                    disbelieved_s: value(disbelieved, row),
                    misplaced_m: value(misplaced, row),
                    place: places.as_ref().and_then(|columns| place(columns, row)),
                    outcome: outcomes[row].clone(),
                    decided: std::array::from_fn(|i| decided[i][row]),
                })
            })
            .collect::<Result<_, Error>>()?;
        Ok(Self {
            spec,
            rows,
            truncated: table.truncated(),
            states_its_end: table.states_its_end(),
        })
    }
}

/// A column that logs of before or of simulations do not have.
fn if_there<'a>(table: &'a LogTable, name: &'static str) -> Result<Option<&'a [f64]>, Error> {
    let column = table.column(name);
    column.map(|_| floats(table, name)).transpose()
}

fn value(column: Option<&[f64]>, row: usize) -> Option<f64> {
    column
        .map(|column| column[row])
        .filter(|value| !value.is_nan())
}

fn floats<'a>(table: &'a LogTable, name: &'static str) -> Result<&'a [f64], Error> {
    match table.column(name) {
        Some(Values::Float(values)) => Ok(values),
        _ => Err(Error::MissingColumn {
            name,
            kind: "numbers",
        }),
    }
}

fn decided<'a>(table: &'a LogTable, name: &'static str) -> Result<&'a [f64], Error> {
    floats(table, name).or_else(|error| match name {
        LANE_ROW => floats(table, LANE_ROW_BEFORE).map_err(|_| error),
        _ => Err(error),
    })
}

fn integers<'a>(table: &'a LogTable, name: &'static str) -> Result<&'a [i64], Error> {
    match table.column(name) {
        Some(Values::Integer(values)) => Ok(values),
        _ => Err(Error::MissingColumn {
            name,
            kind: "whole numbers",
        }),
    }
}

fn texts<'a>(table: &'a LogTable, name: &'static str) -> Result<&'a [String], Error> {
    match table.column(name) {
        Some(Values::Text(values)) => Ok(values),
        _ => Err(Error::MissingColumn {
            name,
            kind: "texts",
        }),
    }
}

/// The columns of true or measured places: x, y, heading and speed.
fn places(table: &LogTable) -> Option<[&[f64]; 4]> {
    let column = |name| floats(table, name).ok();
    Some([
        column("true_x_m")?,
        column("true_y_m")?,
        column("true_heading_rad")?,
        column("true_speed_mps")?,
    ])
}

fn place(columns: &[&[f64]; 4], row: usize) -> Option<State> {
    let [x_m, y_m, heading_rad, speed_mps] = columns.map(|column| column[row]);
    let state = State {
        x_m,
        y_m,
        heading_rad,
        speed_mps,
        turn_rate_rad_s: 0.0,
    };
    state.is_finite().then_some(state)
}

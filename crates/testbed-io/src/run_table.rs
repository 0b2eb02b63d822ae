//! A run as a table of columns: what was seen, what was decided and, in simulations, what was true; and such a table as a run log.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use testbed_sim::columns::{ALLOWED, DECIDED, DISBELIEVED, KNOWN, LANE_ROW, MISPLACED, Read, SEEN};
use testbed_sim::run_log::{LoggedTick, RealRobots};
use testbed_sim::{RunLog, Tick};
use unicycle_cbf::{Pose, StampedPose, State};

use crate::error::Error;
use crate::log_file::{Column, LogTable, Values};
use crate::run_file::{Judged, LoggedRun, RunFile};

/// Its name in logs of before, in which it could be taken for the barrier of the true place.
const LANE_ROW_BEFORE: &str = "h_lane";

/// Its key among the settings of a log.
const JUDGED: &str = "judged";

impl LoggedRun {
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
        let mut meta = self.spec.to_json()?;
        if let Some(judged) = &self.judged {
            meta = with_judged(&meta, judged)?;
        }
        LogTable::new(&meta, columns.of(&self.ticks))
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

impl LogTable {
    /// How the session was judged that it is of, if it says so.
    ///
    /// # Errors
    ///
    /// A log that holds no settings.
    pub fn judged(&self) -> Result<Option<Judged>, Error> {
        let judged = object(self.meta())?.remove(JUDGED);
        judged.map(from_value).transpose()
    }

    /// The run log that it is, ready to be replayed.
    ///
    /// # Errors
    ///
    /// Columns that are missing or of another type, or settings that cannot be read.
    pub fn run_log(&self) -> Result<RunLog, Error> {
        let table = self;
        let mut meta = object(table.meta())?;
        meta.remove(JUDGED);
        let spec: RunFile = from_value(Value::Object(meta))?;
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
        Ok(RunLog {
            scenario: spec.scenario,
            session: spec.link.map(|link| RealRobots {
                hear_commands: link.is_told(),
                ids: link.robots,
            }),
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

fn with_judged(meta: &str, judged: &Judged) -> Result<String, Error> {
    let error = |e: serde_json::Error| Error::Meta(e.to_string());
    let mut meta = object(meta)?;
    let judged = serde_json::to_value(judged).map_err(error)?;
    meta.insert(JUDGED.to_owned(), judged);
    serde_json::to_string(&meta).map_err(error)
}

fn object(meta: &str) -> Result<Map<String, Value>, Error> {
    serde_json::from_str(meta).map_err(|e| Error::Meta(e.to_string()))
}

fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, Error> {
    serde_json::from_value(value).map_err(|e| Error::Meta(e.to_string()))
}

//! A run log in memory.

use unicycle_cbf::{ScenarioSpec, StampedPose, State};

use crate::columns::DECIDED;

/// A run log as far as a replay needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLog {
    /// Robots, path, controller
    pub scenario: ScenarioSpec,
    /// The real robots, where it ran on some
    pub session: Option<RealRobots>,
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

/// Who the robots of a live session were.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RealRobots {
    /// How the tracker calls them, from the front
    pub ids: Vec<u32>,
    /// Whether those that were seen heard the commands
    pub hear_commands: bool,
}

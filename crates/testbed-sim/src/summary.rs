//! What a run comes to.

use std::collections::BTreeMap;

use serde::Serialize;
use unicycle_cbf::{Brake, Outcome, RowKind, Safety, Scenario, State};

use crate::tick::Tick;
use crate::verdict::{Judge, LeastDistance, Verdict};

/// Seconds at the end over which the final speed is averaged.
const FINAL_S: f64 = 5.0;

/// Bounds, means and counts over a run, on true states where there are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Steps of each robot
    pub steps: usize,
    /// Least `D − D0 − τ v` over all robots with one ahead; `None` without
    pub min_h_headway_m: Option<f64>,
    /// Least lane barrier, in its own units
    pub min_h_lane: f64,
    /// Half width of the lane less the largest deviation
    pub lane_clearance_m: f64,
    /// Largest deviation
    pub max_abs_lateral_m: f64,
    /// Mean speed of the robots with one ahead, or of all
    pub mean_speed_mps: f64,
    /// The same over the last 5 s
    pub final_speed_mps: f64,
    /// How the steps ended
    pub outcomes: Outcomes,
    /// Largest violation of a row that was relaxed, in its units
    pub max_slack: f64,
    /// Whether it was safe; none where that is not known
    pub safe: Option<bool>,
    /// The same in a word
    pub verdict: Verdict,
    /// Where two robots were nearest to each other; none of one robot
    pub least_distance: Option<LeastDistance>,
    /// Whether two bodies were nearer to each other than the clearance
    pub bodies_were_near: bool,
    /// First time at which it was not, in s
    pub first_unsafe_s: Option<f64>,
}

/// Steps by their outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Outcomes {
    /// All rows held
    pub optimal: usize,
    /// Rows of the lane or direction gave way
    pub relaxed: usize,
    /// The robot was told to stand
    pub braking: usize,
    /// Of all these: it gave way at a crossing
    pub waiting: usize,
    /// Of those of braking: robots wait for each other in a circle
    pub deadlock: usize,
}

/// Steps of one robot by outcome and, where it brakes, the reason.
#[must_use]
pub fn outcomes_of(ticks: &[Tick], robot: usize) -> BTreeMap<String, usize> {
    let mut outcomes = BTreeMap::new();
    for tick in ticks.iter().filter(|tick| tick.robot == robot) {
        *outcomes.entry(tick.outcome_name()).or_default() += 1;
    }
    outcomes
}

/// Collects a [`Summary`].
#[derive(Debug, Clone)]
pub struct Summarising {
    summary: Summary,
    judge: Judge,
    is_seen: bool,
    is_doubted: bool,
    half_width_m: f64,
    followers_only: bool,
    final_from_s: f64,
    speed: Mean,
    final_speed: Mean,
}

#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn value(self) -> f64 {
        self.sum / self.count as f64
    }
}

impl Summarising {
    /// Nothing yet.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let spec = scenario.spec();
        Self {
            summary: Summary {
                steps: 0,
                min_h_headway_m: None,
                min_h_lane: f64::INFINITY,
                lane_clearance_m: spec.controller.lane.half_width_m,
                max_abs_lateral_m: 0.0,
                mean_speed_mps: 0.0,
                final_speed_mps: 0.0,
                outcomes: Outcomes::default(),
                max_slack: 0.0,
                safe: None,
                verdict: Verdict::NotKnown,
                least_distance: None,
                bodies_were_near: false,
                first_unsafe_s: None,
            },
            judge: Judge::new(scenario.controller()),
            is_seen: false,
            is_doubted: false,
            half_width_m: spec.controller.lane.half_width_m,
            followers_only: spec.robots.len() > 1,
            final_from_s: spec.duration_s - FINAL_S,
            speed: Mean::default(),
            final_speed: Mean::default(),
        }
    }

    /// Takes a tick in.
    pub fn add(&mut self, tick: &Tick) {
        let summary = &mut self.summary;
        summary.steps = tick.tick + 1;
        match tick.decision.outcome {
            Outcome::Optimal => summary.outcomes.optimal += 1,
            Outcome::Relaxed { by, .. } => {
                summary.outcomes.relaxed += 1;
                summary.max_slack = summary.max_slack.max(by);
            }
            Outcome::Braking { reason } => {
                summary.outcomes.braking += 1;
                summary.outcomes.deadlock += usize::from(reason == Brake::Deadlock);
            }
        }
        let waits = tick.decision.is_held_by(RowKind::GiveWay);
        summary.outcomes.waiting += usize::from(waits);
        let Some(truth) = &tick.truth else { return };
        self.add_measured(tick.time_s, &truth.safety);
        if self.followers_only && tick.robot == 0 {
            return;
        }
        self.speed.add(truth.state.speed_mps);
        if tick.time_s >= self.final_from_s {
            self.final_speed.add(truth.state.speed_mps);
        }
    }

    /// Takes in how safe a robot was at one time.
    pub fn add_measured(&mut self, time_s: f64, safety: &Safety) {
        let summary = &mut self.summary;
        self.is_seen = true;
        summary.min_h_lane = summary.min_h_lane.min(safety.lane);
        let lateral_m = safety.deviation_m.abs();
        summary.max_abs_lateral_m = summary.max_abs_lateral_m.max(lateral_m);
        if let Some(headway_m) = safety.headway_m {
            let least = summary.min_h_headway_m.unwrap_or(f64::INFINITY);
            summary.min_h_headway_m = Some(least.min(headway_m));
        }
        let safe = lateral_m <= self.half_width_m && safety.headway_m.is_none_or(|h| h >= 0.0);
        if !safe && summary.first_unsafe_s.is_none() {
            summary.first_unsafe_s = Some(time_s);
        }
    }

    /// Takes in where the points of interest of all robots were at one time, from the front; none of robots that were not seen.
    pub fn add_places(&mut self, time_s: f64, states: &[Option<State>]) {
        self.judge.add(time_s, states);
    }

    /// Too little was seen to call it safe.
    pub fn doubt(&mut self) {
        self.is_doubted = true;
    }

    /// The whole.
    #[must_use]
    pub fn finished(self) -> Summary {
        let mut summary = self.summary;
        summary.least_distance = self.judge.least();
        summary.bodies_were_near = self.judge.first_near_s().is_some();
        let unsafe_s = [summary.first_unsafe_s, self.judge.first_near_s()];
        summary.first_unsafe_s = unsafe_s.into_iter().flatten().reduce(f64::min);
        summary.verdict = match summary.first_unsafe_s {
            Some(_) => Verdict::Unsafe,
            None if self.is_seen && !self.is_doubted => Verdict::Safe,
            None => Verdict::NotKnown,
        };
        summary.safe = match summary.verdict {
            Verdict::Safe => Some(true),
            Verdict::Unsafe => Some(false),
            Verdict::NotKnown => None,
        };
        summary.lane_clearance_m = self.half_width_m - summary.max_abs_lateral_m;
        summary.mean_speed_mps = self.speed.value();
        summary.final_speed_mps = self.final_speed.value();
        summary
    }
}

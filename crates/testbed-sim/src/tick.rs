//! One robot at one step, as it goes into the run log.

use unicycle_cbf::{Decision, Outcome, Safety, StampedPose, State};

/// All that is recorded of a robot at a step. What is not known is NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// Index of the step
    pub tick: usize,
    /// Index of the robot, from the front
    pub robot: usize,
    /// In s from the start
    pub time_s: f64,
    /// The pose that arrived since the last step
    pub seen: Option<StampedPose>,
    /// What was decided
    pub decision: Decision,
    /// Where the robot really was and what that means for safety, in simulations
    pub truth: Option<Truth>,
    /// What a live session held against it
    pub watched: Option<Watched>,
    /// Time that the decision took, in µs
    pub step_us: f64,
    /// How long after its deadline the step began, in µs; NaN in simulations
    pub late_us: f64,
}

/// What a simulation knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// The true state of the point of interest
    pub state: State,
    /// The smallest barriers over the period that follows
    pub safety: Safety,
}

/// Whether a real robot does what it is told; NaN where too little was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watched {
    /// From where half a second of commands would have led it to where it was measured, in m
    pub innovation_position_m: f64,
    /// The same of its heading, measured less predicted, in rad
    pub innovation_heading_rad: f64,
    /// What it may drive at most, in m/s: less of a robot that differs, 0 of one that stands for it or waits for its turn
    pub allowed_mps: Option<f64>,
    /// For how long its poses have said that it is where it cannot be, in s, if they do
    pub disbelieved_s: Option<f64>,
    /// How far its point of interest was found to be from where it is taken to be, in m, if it was
    pub misplaced_m: Option<f64>,
}

/// What figures and columns of the run log are read from; NaN where there is nothing.
impl Tick {
    /// The rung of the ladder, and why the robot brakes.
    #[must_use]
    pub fn outcome_name(&self) -> String {
        match self.decision.outcome {
            Outcome::Braking { reason } => format!("braking-{}", reason.name()),
            outcome => outcome.name().to_owned(),
        }
    }

    pub(crate) fn lyapunov(&self, index: usize) -> f64 {
        let terms = self.decision.terms;
        terms.map_or(f64::NAN, |terms| terms.lyapunov[index].value)
    }

    pub(crate) fn headway_m(&self) -> f64 {
        let headway = self.decision.terms.and_then(|terms| terms.headway);
        headway.map_or(f64::NAN, |lie| lie.value)
    }

    pub(crate) fn lane(&self) -> f64 {
        self.decision
            .terms
            .map_or(f64::NAN, |terms| terms.lane.least())
    }

    pub(crate) fn deviation_m(&self) -> f64 {
        let terms = self.decision.terms;
        terms.map_or(f64::NAN, |terms| terms.lateral.deviation_m)
    }

    pub(crate) fn slack(&self, index: usize) -> f64 {
        let terms = self.decision.terms;
        terms.map_or(f64::NAN, |terms| terms.solution.z[2 + index])
    }

    pub(crate) fn multiplier(&self, index: usize) -> f64 {
        let terms = self.decision.terms;
        terms.map_or(f64::NAN, |terms| terms.solution.multipliers[index])
    }

    pub(crate) fn relaxed_by(&self) -> f64 {
        match self.decision.outcome {
            Outcome::Relaxed { by, .. } => by,
            _ => 0.0,
        }
    }

    /// The true state where it is known, or the one that was decided for.
    #[must_use]
    pub fn known_state(&self) -> Option<State> {
        self.truth.map(|truth| truth.state).or(self.decision.state)
    }

    pub(crate) fn place(&self) -> Option<(f64, f64)> {
        self.known_state().map(|state| (state.x_m, state.y_m))
    }

    /// What is left of the lane beside the true or measured place, in m; none where that is not known.
    #[must_use]
    pub fn lane_clearance_m(&self, half_width_m: f64) -> Option<f64> {
        let safety = self.truth?.safety;
        Some(half_width_m - safety.deviation_m.abs())
    }

    /// x, y and heading of the point of interest.
    pub(crate) fn true_pose(&self, index: usize) -> f64 {
        let state = self.truth.map(|truth| truth.state);
        state.map_or(f64::NAN, |s| [s.x_m, s.y_m, s.heading_rad][index])
    }
}

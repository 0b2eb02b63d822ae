//! The controllers of all robots of a scenario, run in step by one computer.

use unicycle_cbf::{Ahead, Decision, Pilot, Scenario, Speeds, StampedPose};

/// One controller per robot, from the front.
#[derive(Debug, Clone)]
pub struct Convoy<'a> {
    scenario: &'a Scenario,
    pilots: Vec<Pilot>,
}

impl<'a> Convoy<'a> {
    /// All robots at the start of the scenario.
    #[must_use]
    pub fn new(scenario: &'a Scenario) -> Self {
        let robots = 0..scenario.starts().len();
        let pilot = |robot| Pilot::new(0.0, scenario.initial_speeds(robot));
        Self {
            scenario,
            pilots: robots.map(pilot).collect(),
        }
    }

    /// Number of robots.
    #[must_use]
    pub fn robots(&self) -> usize {
        self.pilots.len()
    }

    /// Takes the pose of a robot in.
    pub fn observe(&mut self, robot: usize, seen: StampedPose) {
        self.pilots[robot].observe(self.scenario.controller(), seen);
    }

    /// Decides for one robot at `now_s`, and takes the speeds as sent. Robots are to be stepped from the back, so that each sees
    /// the one ahead as it was before this time's decision.
    pub fn step(&mut self, robot: usize, now_s: f64) -> Decision {
        let decision = self.decide(robot, now_s);
        self.sent(robot, now_s, decision.speeds);
        decision
    }

    /// Decides for a robot that does something else.
    pub fn decide(&self, robot: usize, now_s: f64) -> Decision {
        let controller = self.scenario.controller();
        let ahead = match robot.checked_sub(1) {
            Some(ahead) => self.pilots[ahead].sighting(controller, now_s).into(),
            None => Ahead::Nobody,
        };
        let objectives = self.scenario.objectives(robot, now_s);
        self.pilots[robot].decide(controller, now_s, ahead, &objectives)
    }

    /// What a robot does from `now_s` on.
    pub fn sent(&mut self, robot: usize, now_s: f64, speeds: Speeds) {
        self.pilots[robot].sent(now_s, speeds);
    }
}

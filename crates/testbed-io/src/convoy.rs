//! The controllers of all robots of a scenario, run in step by one computer.

use unicycle_cbf::{Ahead, Decision, Pilot, Scenario, Sighting, Speeds, StampedPose, State};

/// Others beside the robot ahead that one regards.
const MOST_OTHERS: usize = 4;

/// One controller per robot, from the front.
#[derive(Debug, Clone)]
pub struct Convoy<'a> {
    scenario: &'a Scenario,
    pilots: Vec<Pilot>,
    /// All robots as they were before anybody's decision at a time
    sight: Vec<Option<Sighted>>,
    sight_at_s: f64,
}

#[derive(Debug, Clone, Copy)]
struct Sighted {
    sighting: Sighting,
    /// Along the path, where that matters
    s_m: f64,
}

impl Sighted {
    fn state(&self) -> &State {
        &self.sighting.leader.state
    }

    fn square_m2(&self, other: &Self) -> f64 {
        let (own, other) = (self.state(), other.state());
        (own.x_m - other.x_m).powi(2) + (own.y_m - other.y_m).powi(2)
    }
}

impl<'a> Convoy<'a> {
    /// All robots at the start of the scenario.
    #[must_use]
    pub fn new(scenario: &'a Scenario) -> Self {
        let robots = 0..scenario.starts().len();
        let pilot = |robot| Pilot::new(0.0, scenario.initial_speeds(robot));
        Self {
            scenario,
            sight: vec![None; robots.len()],
            pilots: robots.map(pilot).collect(),
            sight_at_s: f64::NAN,
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
        self.sight_at_s = f64::NAN;
    }

    /// Decides for one robot at `now_s`, and takes the speeds as sent. Each sees the others as they were before this time's decisions.
    pub fn step(&mut self, robot: usize, now_s: f64) -> Decision {
        let decision = self.decide(robot, now_s);
        self.sent(robot, now_s, decision.speeds);
        decision
    }

    /// Decides for a robot that does something else.
    pub fn decide(&mut self, robot: usize, now_s: f64) -> Decision {
        self.look(now_s);
        let controller = self.scenario.controller();
        let objectives = self.scenario.objectives(robot, now_s);
        let pilot = &self.pilots[robot];
        if !controller.settings().hardening.regards_every_robot() {
            let ahead = self.named_ahead(robot);
            return pilot.decide(controller, now_s, ahead, &objectives);
        }
        let leader = self.leader(robot);
        let ahead = leader.map_or_else(
            || self.nobody_or_unseen(robot),
            |leader| self.sight[leader].map(|seen| seen.sighting).into(),
        );
        let others = self.nearest(robot, leader);
        let count = others.iter().flatten().count();
        let others = others.map(|state| state.unwrap_or(NOWHERE));
        pilot.decide_among(controller, now_s, ahead, &others[..count], &objectives)
    }

    /// What a robot does from `now_s` on.
    pub fn sent(&mut self, robot: usize, now_s: f64, speeds: Speeds) {
        self.pilots[robot].sent(now_s, speeds);
    }

    /// Looks at all robots, once at a time.
    fn look(&mut self, now_s: f64) {
        if self.sight_at_s.to_bits() == now_s.to_bits() {
            return;
        }
        self.sight_at_s = now_s;
        let controller = self.scenario.controller();
        let along = controller.settings().hardening.regards_every_robot() && self.robots() > 1;
        for (pilot, sight) in self.pilots.iter().zip(&mut self.sight) {
            *sight = pilot.sighting(controller, now_s).map(|sighting| {
                let State { x_m, y_m, .. } = sighting.leader.state;
                let s_m = if along {
                    controller.path().nearest(x_m, y_m).s_m
                } else {
                    f64::NAN
                };
                Sighted { sighting, s_m }
            });
        }
    }

    fn named_ahead(&self, robot: usize) -> Ahead {
        match robot.checked_sub(1) {
            Some(ahead) => self.sight[ahead].map(|seen| seen.sighting).into(),
            None => Ahead::Nobody,
        }
    }

    /// Of a robot before which nobody was found: one that was never seen may be there.
    fn nobody_or_unseen(&self, robot: usize) -> Ahead {
        let mut others = self.sight.iter().enumerate();
        if others.any(|(other, seen)| other != robot && seen.is_none()) {
            Ahead::Unseen
        } else {
            Ahead::Nobody
        }
    }

    /// The nearest robot ahead along the path, on a loop by less than half a lap.
    fn leader(&self, robot: usize) -> Option<usize> {
        let own = self.sight[robot]?;
        let path = self.scenario.controller().path();
        let most_m = path.length_m().map_or(f64::INFINITY, |length| 0.5 * length);
        let mut nearest = (most_m, None);
        for (other, seen) in self.sight.iter().enumerate() {
            let Some(seen) = seen else { continue };
            let ahead_m = path.distance_along_m(own.s_m, seen.s_m);
            if other != robot && ahead_m > 0.0 && ahead_m < nearest.0 {
                nearest = (ahead_m, Some(other));
            }
        }
        nearest.1
    }

    /// The nearest other robots, without the one that is followed, in front those that there are.
    fn nearest(&self, robot: usize, leader: Option<usize>) -> [Option<State>; MOST_OTHERS] {
        let mut found = [None; MOST_OTHERS];
        let Some(own) = self.sight[robot] else {
            return found;
        };
        let mut squares_m2 = [f64::INFINITY; MOST_OTHERS];
        for (other, seen) in self.sight.iter().enumerate() {
            let Some(seen) = seen.filter(|_| other != robot && Some(other) != leader) else {
                continue;
            };
            let square_m2 = own.square_m2(&seen);
            let place = squares_m2.iter().position(|known| square_m2 < *known);
            if let Some(place) = place {
                squares_m2[place..].rotate_right(1);
                found[place..].rotate_right(1);
                squares_m2[place] = square_m2;
                found[place] = Some(*seen.state());
            }
        }
        found
    }
}

/// Fills places that are not looked at.
const NOWHERE: State = State {
    x_m: 0.0,
    y_m: 0.0,
    speed_mps: 0.0,
    heading_rad: 0.0,
    turn_rate_rad_s: 0.0,
};

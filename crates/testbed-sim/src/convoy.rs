//! The controllers of all robots of a scenario, run in step by one computer.

use unicycle_cbf::{
    Brake, Decision, Located, Pilot, RowKind, Scenario, Speeds, StampedPose, State, Tracks,
    WheelSpeeds,
    pilot::{Ahead, Place, Surroundings},
};

use crate::holds::Holds;
use crate::right_of_way::{Places, RightOfWay, Wait};

/// Others beside the robot ahead that one regards.
const MOST_OTHERS: usize = 4;
/// Slower wheels stand, in m/s.
const STANDING_MPS: f64 = 5e-3;

/// One controller per robot, from the front.
#[derive(Debug, Clone)]
pub struct Convoy<'a> {
    scenario: &'a Scenario,
    pilots: Vec<Pilot>,
    tracks: Tracks,
    /// All robots as they were before anybody's decision at a time
    sight: Vec<Option<Place>>,
    /// Where each is, or where the scenario lets one start that was never seen: it may stand before one that was
    located: Vec<Located>,
    sight_at_s: f64,
    /// Along the path, and from there to the next robot ahead, in m
    along_m: Vec<f64>,
    room_m: Vec<f64>,
    right_of_way: RightOfWay,
    holds: Holds,
}

/// Of one robot.
struct Neighbours {
    leader: Option<usize>,
    /// Others, in front those that there are
    nearest: [Option<usize>; MOST_OTHERS],
    wait: Option<Wait>,
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
            located: robots
                .clone()
                .map(|robot| at_start(scenario, robot))
                .collect(),
            along_m: vec![f64::NAN; robots.len()],
            room_m: vec![f64::INFINITY; robots.len()],
            right_of_way: RightOfWay::new(scenario.controller(), robots.len()),
            holds: Holds::new(robots.len()),
            pilots: robots.map(pilot).collect(),
            tracks: Tracks::new(scenario),
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
            let around = Surroundings {
                own: self.sight[robot],
                ..self.named_ahead(robot).into()
            };
            return pilot.decide_among(controller, now_s, around, &objectives);
        }
        let around = self.neighbours(robot);
        let ahead = match around.leader {
            _ if self.is_near_unseen(robot) => Ahead::Unseen,
            Some(leader) => self.sight[leader].map(|seen| seen.sighting).into(),
            None => self.nobody_or_unseen(robot),
        };
        let count = around.nearest.iter().flatten().count();
        let others = around.nearest.map(|other| {
            let seen = other.and_then(|other| self.sight[other]);
            seen.map_or(State::ORIGIN.into(), |seen| seen.sighting.leader.located())
        });
        let surroundings = Surroundings {
            own: self.sight[robot],
            ahead,
            others: &others[..count],
            stop_line_m: around.wait.map(|wait| wait.line_m),
        };
        let decision = pilot.decide_among(controller, now_s, surroundings, &objectives);
        let holder = self.holder(robot, &decision, &around);
        self.holds.add(robot, now_s, holder);
        if self.holds.is_in_a_circle(robot, now_s) {
            return decision.stopped(Brake::Deadlock);
        }
        decision
    }

    fn neighbours(&self, robot: usize) -> Neighbours {
        let leader = self.leader(robot);
        Neighbours {
            leader,
            nearest: self.nearest(robot, leader),
            wait: self.right_of_way.wait(&self.places(), robot),
        }
    }

    fn state(&self, robot: usize) -> Option<State> {
        Some(self.sight[robot]?.sighting.leader.state)
    }

    /// Because of whom a robot stands.
    fn holder(&self, robot: usize, decision: &Decision, around: &Neighbours) -> Option<usize> {
        let WheelSpeeds {
            left_mps,
            right_mps,
        } = decision.wheels;
        if left_mps.abs().max(right_mps.abs()) >= STANDING_MPS {
            return None;
        }
        if decision.is_held_by(RowKind::GiveWay) {
            let by = around.wait.map(|wait| wait.robot);
            return by.filter(|by| *by != robot);
        }
        let by_headway = [RowKind::Headway, RowKind::HeadwayStopped];
        if by_headway.into_iter().any(|kind| decision.is_held_by(kind)) {
            return around.leader;
        }
        let own = self.state(robot)?;
        let controller = self.scenario.controller();
        let is_in_reach = |other: &usize| {
            self.state(*other)
                .is_some_and(|other| controller.reaches(&own, &other))
        };
        let bodies = around
            .leader
            .into_iter()
            .chain(around.nearest.into_iter().flatten());
        bodies.filter(is_in_reach).nth(decision.held_by_body()?)
    }

    fn places(&self) -> Places<'_> {
        Places {
            controller: self.scenario.controller(),
            along_m: &self.along_m,
            room_m: &self.room_m,
        }
    }

    /// What a robot does from `now_s` on.
    pub fn sent(&mut self, robot: usize, now_s: f64, speeds: Speeds) {
        self.pilots[robot].sent(now_s, speeds);
    }

    /// Looks at all robots, once at a time. A step does it where nobody did.
    pub fn look(&mut self, now_s: f64) {
        if self.sight_at_s.to_bits() == now_s.to_bits() {
            return;
        }
        self.sight_at_s = now_s;
        let controller = self.scenario.controller();
        let needs_foot = controller.needs_foot();
        let robots = self.pilots.iter().zip(&mut self.sight);
        for (robot, (pilot, sight)) in robots.enumerate() {
            *sight = pilot.sighting(controller, now_s).map(|mut sighting| {
                let leader = &mut sighting.leader;
                let foot = needs_foot.then(|| self.tracks.foot(controller, robot, &leader.state));
                leader.near_m = foot.map(|foot| foot.s_m);
                self.located[robot] = leader.located();
                Place { sighting, foot }
            });
        }
        if self.robots() > 1 && !controller.crossings().is_empty() {
            self.give_way(now_s);
        }
    }

    fn give_way(&mut self, now_s: f64) {
        for robot in 0..self.robots() {
            self.along_m[robot] = self.along_m_of(robot).unwrap_or(f64::NAN);
            self.room_m[robot] = self
                .ahead(robot)
                .map_or(f64::INFINITY, |(room_m, _)| room_m);
        }
        let places = Places {
            controller: self.scenario.controller(),
            along_m: &self.along_m,
            room_m: &self.room_m,
        };
        self.right_of_way.update(now_s, &places);
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

    /// Whether one that was never seen may be in reach: nobody drives towards it, forward or back.
    fn is_near_unseen(&self, robot: usize) -> bool {
        let controller = self.scenario.controller();
        let own = &self.located[robot].state;
        let mut others = self.sight.iter().zip(&self.located);
        others.any(|(seen, other)| seen.is_none() && controller.reaches(own, &other.state))
    }

    /// Whom a robot follows.
    fn leader(&self, robot: usize) -> Option<usize> {
        self.sight[robot].as_ref()?;
        let others = self.located.iter().enumerate();
        let others = others.filter(|(other, _)| *other != robot);
        let controller = self.scenario.controller();
        controller.leader(
            &self.located[robot],
            others.map(|(other, at)| (other, Some(*at))),
        )
    }

    /// Where a robot was seen along the path, in m.
    fn along_m_of(&self, robot: usize) -> Option<f64> {
        Some(self.sight[robot]?.foot?.s_m)
    }

    /// How far ahead along the path the nearest robot is, in m, and which.
    fn ahead(&self, robot: usize) -> Option<(f64, usize)> {
        let own_m = self.along_m_of(robot)?;
        let path = self.scenario.controller().path();
        let ahead = (0..self.robots()).filter_map(|other| {
            let ahead_m = path.distance_along_m(own_m, self.along_m_of(other)?);
            (other != robot && ahead_m > 0.0).then_some((ahead_m, other))
        });
        ahead.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The nearest other robots, without the one that is followed, in front those that there are.
    fn nearest(&self, robot: usize, leader: Option<usize>) -> [Option<usize>; MOST_OTHERS] {
        let mut found = [None; MOST_OTHERS];
        let Some(own) = &self.sight[robot] else {
            return found;
        };
        let own = &own.sighting.leader.state;
        let mut squares_m2 = [f64::INFINITY; MOST_OTHERS];
        for (other, seen) in self.sight.iter().enumerate() {
            let Some(seen) = seen.filter(|_| other != robot && Some(other) != leader) else {
                continue;
            };
            let square_m2 = own.square_m2(&seen.sighting.leader.state);
            let place = squares_m2.iter().position(|known| square_m2 < *known);
            if let Some(place) = place {
                squares_m2[place..].rotate_right(1);
                found[place..].rotate_right(1);
                squares_m2[place] = square_m2;
                found[place] = Some(other);
            }
        }
        found
    }
}

fn at_start(scenario: &Scenario, robot: usize) -> Located {
    let offset_m = scenario.controller().body().offset_m;
    Located {
        state: scenario.starts()[robot].state(offset_m, Speeds::ZERO),
        near_m: Some(scenario.start_m(robot)),
    }
}

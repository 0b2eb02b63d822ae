//! A scenario on simulated robots under seeded disturbances.

use std::time::Instant;

use unicycle_cbf::{Decision, Located, Safety, Scenario, StampedPose, State, Tracks, WheelSpeeds};

use crate::convoy::Convoy;
use crate::delay::{Delay, outages};
use crate::disturbances::{Disturbances, Random};
use crate::error::Error;
use crate::plant::Plant;
use crate::summary::{Summarising, Summary};
use crate::tick::{Tick, Truth};

/// Parts of a period after each of which the true barriers are looked at.
const SUBSTEPS: usize = 2;
/// The longest part, in s: 3 mm at the speed of a small robot.
const LONGEST_PART_S: f64 = 0.01;

/// A run that can be repeated: same scenario, disturbances and seed, same poses and decisions.
#[derive(Debug, Clone)]
pub struct Simulation<'a> {
    /// What is run
    pub scenario: &'a Scenario,
    /// Under what
    pub disturbances: Disturbances,
    /// Of all random numbers
    pub seed: u64,
}

impl Simulation<'_> {
    /// Runs all steps and gives each tick to `record`, for each step the robots from the back.
    ///
    /// # Errors
    ///
    /// A disturbance out of its range.
    pub fn run(&self, mut record: impl FnMut(&Tick)) -> Result<Summary, Error> {
        self.disturbances.check()?;
        let mut robots = self.robots();
        let mut convoy = Convoy::new(self.scenario);
        let mut tracks = Tracks::new(self.scenario);
        let mut summary = Summarising::new(self.scenario);
        for step in 0..self.scenario.steps() {
            let now_s = self.scenario.time_s(step);
            for (index, robot) in robots.iter_mut().enumerate() {
                robot.see(now_s, &self.disturbances);
                if let Some(seen) = robot.seen {
                    convoy.observe(index, seen);
                }
            }
            let start = Instant::now();
            convoy.look(now_s);
            let share_us = start.elapsed().as_secs_f64() * 1e6 / robots.len() as f64;
            for (index, robot) in robots.iter_mut().enumerate().rev() {
                robot.decide(&mut convoy, index, now_s, share_us);
            }
            advance(&mut robots, &mut tracks, self.scenario, now_s, &mut summary);
            for (index, robot) in robots.iter().enumerate().rev() {
                if let Some(tick) = robot.tick(step, index, now_s) {
                    summary.add(&tick);
                    record(&tick);
                }
            }
        }
        Ok(summary.finished())
    }

    fn robots(&self) -> Vec<Robot> {
        let (scenario, disturbances) = (self.scenario, &self.disturbances);
        let starts = scenario.starts();
        let mut random = Random::new(self.seed);
        let duration_s = scenario.spec().duration_s;
        let spans = outages(starts.len(), duration_s, disturbances, &mut random);
        let robots = starts.iter().zip(spans).enumerate();
        robots
            .map(|(index, (start, spans))| {
                let body = *scenario.controller().body();
                let speeds = scenario.initial_speeds(index);
                let mut random = Random::new(self.seed ^ ((index as u64 + 1) << 48));
                Robot {
                    plant: Plant::new(body, *start, speeds, disturbances, &mut random),
                    delay: Delay::new(spans),
                    random,
                    seen: None,
                    decision: None,
                    step_us: 0.0,
                    target: WheelSpeeds::default(),
                    truth: None,
                }
            })
            .collect()
    }
}

/// One simulated robot, and what happened to it in the present step.
struct Robot {
    plant: Plant,
    delay: Delay,
    random: Random,
    seen: Option<StampedPose>,
    decision: Option<Decision>,
    step_us: f64,
    target: WheelSpeeds,
    truth: Option<Truth>,
}

impl Robot {
    fn see(&mut self, now_s: f64, disturbances: &Disturbances) {
        let pose = self.plant.pose();
        self.delay.see(now_s, pose, disturbances, &mut self.random);
        self.seen = self.delay.newest(now_s);
    }

    /// Each bears its share of the time for looking around.
    fn decide(&mut self, convoy: &mut Convoy, index: usize, now_s: f64, share_us: f64) {
        let start = Instant::now();
        let decision = convoy.step(index, now_s);
        self.step_us = share_us + start.elapsed().as_secs_f64() * 1e6;
        self.target = self.plant.command(decision.wheels);
        self.decision = Some(decision);
    }

    fn tick(&self, step: usize, robot: usize, time_s: f64) -> Option<Tick> {
        Some(Tick {
            tick: step,
            robot,
            time_s,
            seen: self.seen,
            decision: self.decision?,
            truth: self.truth,
            watched: None,
            step_us: self.step_us,
            late_us: f64::NAN,
        })
    }
}

/// One period of all robots, from the front. A truth is the state at its start, after the command, and the least barriers over it.
fn advance(
    robots: &mut [Robot],
    tracks: &mut Tracks,
    scenario: &Scenario,
    now_s: f64,
    summary: &mut Summarising,
) {
    let controller = scenario.controller();
    let parts = SUBSTEPS.max((controller.hold_s() / LONGEST_PART_S).ceil() as usize);
    let part_s = controller.hold_s() / parts as f64;
    let states = robots.iter().map(|robot| robot.plant.state());
    let starts: Vec<Located> = states
        .enumerate()
        .map(|(robot, state)| tracks.located(controller, robot, state))
        .collect();
    for (ahead, pair) in starts.windows(2).enumerate() {
        tracks.follow(controller, ahead + 1, &pair[1], &pair[0]);
    }
    let mut places: Vec<Option<State>> = Vec::with_capacity(robots.len());
    for part in 0..=parts {
        places.clear();
        let mut ahead: Option<Located> = None;
        for (index, robot) in robots.iter_mut().enumerate() {
            if part > 0 {
                robot.plant.advance(robot.target, part_s);
            }
            let state = robot.plant.state();
            let own = tracks.located(controller, index, state);
            let safety = tracks.safety(controller, index, &own, ahead.as_ref());
            robot.truth = Some(match robot.truth {
                Some(truth) if part > 0 => Truth {
                    safety: worse(truth.safety, safety),
                    ..truth
                },
                _ => Truth { state, safety },
            });
            ahead = Some(own);
            places.push(Some(state));
        }
        summary.add_places(now_s + part as f64 * part_s, &places);
    }
}

fn worse(a: Safety, b: Safety) -> Safety {
    Safety {
        lane: a.lane.min(b.lane),
        headway_m: match (a.headway_m, b.headway_m) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        },
        deviation_m: if b.deviation_m.abs() > a.deviation_m.abs() {
            b.deviation_m
        } else {
            a.deviation_m
        },
    }
}

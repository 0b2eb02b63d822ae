//! A scenario on simulated robots under seeded disturbances.

use std::time::Instant;

use unicycle_cbf::{Decision, Safety, Scenario, State, WheelSpeeds};

use crate::convoy::Convoy;
use crate::disturbances::{Disturbances, Random};
use crate::error::Error;
use crate::link::{Link, outages};
use crate::plant::Plant;
use crate::summary::{Summarising, Summary};
use crate::tick::{Tick, Truth};

/// Parts of a period after each of which the true barriers are looked at.
const SUBSTEPS: usize = 2;

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

struct Robot {
    plant: Plant,
    link: Link,
    random: Random,
}

impl Simulation<'_> {
    /// Runs all steps and gives each tick to `record`, for each step the robots from the back.
    ///
    /// # Errors
    ///
    /// A disturbance out of its range.
    pub fn run(&self, mut record: impl FnMut(&Tick)) -> Result<Summary, Error> {
        self.disturbances.check()?;
        let scenario = self.scenario;
        let mut robots = self.robots();
        let mut convoy = Convoy::new(scenario);
        let mut summary = Summarising::new(scenario);
        let mut decided: Vec<(Option<Decision>, f64)> = vec![(None, 0.0); robots.len()];
        let mut truths = vec![None; robots.len()];
        let mut targets = vec![WheelSpeeds::default(); robots.len()];
        for step in 0..scenario.steps() {
            let now_s = scenario.time_s(step);
            let mut seen = [None; MAX_ROBOTS];
            for (robot, own) in robots.iter_mut().enumerate() {
                let pose = own.plant.pose();
                own.link.see(now_s, pose, &self.disturbances, &mut own.random);
                seen[robot] = own.link.newest(now_s);
                if let Some(pose) = seen[robot] {
                    convoy.observe(robot, pose);
                }
            }
            for robot in (0..robots.len()).rev() {
                let start = Instant::now();
                let decision = convoy.step(robot, now_s);
                decided[robot] = (Some(decision), start.elapsed().as_secs_f64() * 1e6);
            }
            for (robot, own) in robots.iter_mut().enumerate() {
                if let Some(decision) = &decided[robot].0 {
                    targets[robot] = own.plant.command(decision.wheels);
                }
            }
            self.advance(&mut robots, &targets, &mut truths);
            for robot in (0..robots.len()).rev() {
                let (Some(decision), step_us) = decided[robot] else {
                    continue;
                };
                let tick = Tick {
                    tick: step,
                    robot,
                    time_s: now_s,
                    seen: seen[robot],
                    decision,
                    truth: truths[robot],
                    step_us,
                };
                summary.add(&tick);
                record(&tick);
            }
        }
        Ok(summary.finished())
    }

    fn robots(&self) -> Vec<Robot> {
        let scenario = self.scenario;
        let disturbances = &self.disturbances;
        let mut random = Random::new(self.seed);
        let starts = scenario.starts();
        let spans = outages(starts.len(), scenario.spec().duration_s, disturbances, &mut random);
        let robots = starts.iter().zip(spans).enumerate();
        robots
            .map(|(robot, (start, spans))| {
                let body = *scenario.controller().body();
                let speeds = scenario.initial_speeds(robot);
                let mut own = Random::new(self.seed ^ ((robot as u64 + 1) << 48));
                Robot {
                    plant: Plant::new(body, *start, speeds, disturbances, &mut own),
                    link: Link::new(spans),
                    random: own,
                }
            })
            .collect()
    }

    /// One period of all robots; the truths are the states at its start, after the commands, and the least barriers over it.
    fn advance(&self, robots: &mut [Robot], targets: &[WheelSpeeds], truths: &mut [Option<Truth>]) {
        let controller = self.scenario.controller();
        let part_s = controller.hold_s() / SUBSTEPS as f64;
        for part in 0..=SUBSTEPS {
            let mut ahead: Option<State> = None;
            for (robot, own) in robots.iter_mut().enumerate() {
                if part > 0 {
                    own.plant.advance(targets[robot], part_s);
                }
                let state = own.plant.state();
                let safety = controller.safety(&state, ahead.as_ref());
                truths[robot] = Some(match truths[robot] {
                    Some(truth) if part > 0 => Truth {
                        safety: worse(truth.safety, safety),
                        ..truth
                    },
                    _ => Truth { state, safety },
                });
                ahead = Some(state);
            }
        }
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

/// As many robots as a scenario may have.
const MAX_ROBOTS: usize = 64;

//! The loop: poses in, decisions out, at a fixed rate.

use std::time::{Duration, Instant};

use unicycle_cbf::{Scenario, Speeds, StampedPose, State};

use super::commands::Command;
use super::counts::Counts;
use super::hurry::hurry;
use super::link::Link;
use super::pacer::Pacer;
use super::session::{Ending, LiveReport, StopSwitch, Update};
use crate::convoy::Convoy;
use crate::error::Error;
use crate::summary::{Summarising, Summary};
use crate::tick::{Tick, Truth};

/// How long robots have to appear before the start, and how long while the other side says that they are getting ready.
const APPEAR: Duration = Duration::from_secs(60);
const GETTING_READY: Duration = Duration::from_secs(300);
/// The user is told whom the session waits for after this time.
const WAITING: Duration = Duration::from_secs(2);
/// Poses in a row that agree, after which a robot is where they say.
const AGREEING: u32 = 5;
/// The user is told of a robot without a pose for this long, in s.
const UNSEEN_S: f64 = 1.0;
/// Poses of two robots that are farther apart than this in time are not compared, in s.
const BESIDE_S: f64 = 0.3;

pub(super) struct Drive<'a> {
    scenario: &'a Scenario,
    link: Link,
    convoy: Convoy<'a>,
    pacer: Pacer,
    /// Arrived since the last step
    seen: Vec<Option<StampedPose>>,
    /// The newest of all, as measured
    measured: Vec<Option<StampedPose>>,
    /// Of the points of interest, of poses that are fresh
    places: Vec<Option<State>>,
    /// Of which the user was told that they are out of sight
    unseen: Vec<bool>,
    summary: Summarising,
}

impl<'a> Drive<'a> {
    pub(super) fn new(scenario: &'a Scenario, link: Link) -> Self {
        let robots = scenario.starts().len();
        let period_s = scenario.controller().hold_s();
        Self {
            scenario,
            pacer: Pacer::new(link.inbox.clock(), period_s, link.is_fast()),
            link,
            convoy: Convoy::new(scenario),
            seen: vec![None; robots],
            measured: vec![None; robots],
            places: Vec::with_capacity(robots),
            unseen: vec![false; robots],
            summary: Summarising::new(scenario),
        }
    }

    /// Waits until every robot is seen where it can start; false if asked to stop meanwhile.
    pub(super) fn appear(
        &mut self,
        lost_after_s: f64,
        stop: &StopSwitch,
        update: &mut impl FnMut(Update),
    ) -> Result<bool, Error> {
        let start = Instant::now();
        self.link.play_until_seen(self.pacer.start_s());
        let needed = if self.link.is_recording() {
            1
        } else {
            AGREEING
        };
        let mut told = false;
        loop {
            self.pass_notes(update);
            if stop.is_on() {
                return Ok(false);
            }
            let missing = self.link.inbox.start_if_steady(needed);
            if missing.is_empty() {
                break;
            }
            let waited = start.elapsed();
            self.link.is_there(waited.as_secs_f64(), lost_after_s)?;
            let ready_told = self.link.inbox.getting_ready_told();
            if is_too_long(waited, ready_told) || self.link.has_ended() {
                return Err(not_seen(&missing, &self.link.inbox.counts()));
            }
            if !told && start.elapsed() > WAITING {
                told = true;
                update(Update::Note(&format!(
                    "waiting for poses of {}",
                    names(&missing)
                )));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        if !self.link.is_recording() {
            self.pacer.restart();
        }
        self.take_poses();
        self.check_starts()?;
        Ok(true)
    }

    pub(super) fn run(
        &mut self,
        lost_after_s: f64,
        stop: &StopSwitch,
        update: &mut impl FnMut(Update),
    ) -> Ending {
        if !self.link.is_fast() && !hurry() {
            update(Update::Note(
                "no permission for real-time priority: on a busy computer steps may be late; see the page on testbeds",
            ));
        }
        let period_s = self.scenario.controller().hold_s();
        let mut ticks = Vec::with_capacity(self.convoy.robots());
        let mut last_pose_s = 0.0;
        for step in 0.. {
            let (time_s, late_s) = self.pacer.wait();
            if stop.is_on() {
                return Ending::Stopped;
            }
            if time_s >= self.scenario.spec().duration_s {
                return Ending::Finished;
            }
            self.link
                .play(time_s + 0.5 * period_s, self.pacer.start_s());
            self.take_poses();
            self.decide(step, time_s, late_s, &mut ticks);
            let commands: Vec<Command> = ticks.iter().map(command).collect();
            self.link.commands.send(&commands);
            self.pacer.done();
            for tick in &ticks {
                self.summary.add(tick);
            }
            self.judge_distances(time_s);
            let counts = &self.link.inbox.counts();
            let missed = self.pacer.missed();
            let pose_ages_s = &self.pose_ages_s(time_s);
            update(Update::Step {
                ticks: &ticks,
                pose_ages_s,
                counts,
                missed,
            });
            self.tell_unseen(pose_ages_s, update);
            self.pass_notes(update);
            if ticks.iter().any(|tick| tick.seen.is_some()) {
                last_pose_s = time_s;
            }
            if self.link.is_recording() && self.link.has_ended() {
                return Ending::Finished;
            }
            if let Some(what) = self.lost(time_s, time_s - last_pose_s, lost_after_s) {
                return Ending::Lost(what);
            }
        }
        Ending::Finished
    }

    pub(super) fn stopped(
        mut self,
        ending: Ending,
        update: &mut impl FnMut(Update),
    ) -> (Summary, LiveReport) {
        let untold = self.link.stop();
        self.pass_notes(update);
        let report = LiveReport {
            ending,
            untold,
            deadlines: self.pacer.deadlines(),
            received: self.link.inbox.counts(),
            commands: self.link.commands.counts(),
        };
        (self.summary.finished(), report)
    }

    fn pass_notes(&self, update: &mut impl FnMut(Update)) {
        for note in self.link.inbox.notes() {
            update(Update::Note(&note));
        }
    }

    fn tell_unseen(&mut self, pose_ages_s: &[f64], update: &mut impl FnMut(Update)) {
        for (robot, age_s) in pose_ages_s.iter().enumerate() {
            let id = self.link.ids[robot];
            if *age_s > UNSEEN_S && !self.unseen[robot] {
                self.unseen[robot] = true;
                update(Update::Note(&format!(
                    "robot {id} is out of sight: it and those behind it stand; if it was moved by hand, start anew"
                )));
            } else if *age_s < BESIDE_S && self.unseen[robot] {
                self.unseen[robot] = false;
                update(Update::Note(&format!("robot {id} is seen again")));
            }
        }
    }

    /// Stamps become times since the start.
    fn take_poses(&mut self) {
        let arrived = self.link.inbox.newest();
        for (robot, seen) in arrived.into_iter().enumerate() {
            let Some(mut seen) = seen else { continue };
            seen.stamp_s -= self.pacer.start_s();
            self.seen[robot] = Some(seen);
            self.measured[robot] = Some(seen);
        }
    }

    /// From the back, so that each robot sees the one ahead as it was before this step.
    fn decide(&mut self, step: usize, time_s: f64, late_s: f64, ticks: &mut Vec<Tick>) {
        ticks.clear();
        // What is observed is what the run log has: of several poses the newest.
        for (robot, seen) in self.seen.iter().enumerate() {
            if let Some(seen) = seen {
                self.convoy.observe(robot, *seen);
            }
        }
        for robot in (0..self.convoy.robots()).rev() {
            let start = Instant::now();
            let decision = self.convoy.step(robot, time_s);
            let step_us = start.elapsed().as_secs_f64() * 1e6;
            ticks.push(Tick {
                tick: step,
                robot,
                time_s,
                seen: self.seen[robot],
                decision,
                truth: self.measured_truth(robot, decision.speeds),
                step_us,
                late_us: late_s * 1e6,
            });
        }
        self.seen.fill(None);
    }

    fn pose_ages_s(&self, time_s: f64) -> Vec<f64> {
        let stamps_s = self.measured.iter();
        let age_s = |seen: &StampedPose| time_s - seen.stamp_s;
        stamps_s
            .map(|seen| seen.as_ref().map_or(f64::NAN, age_s))
            .collect()
    }

    /// The pose that has just arrived counts as the truth, with the speeds that the robot was told.
    fn measured_truth(&self, robot: usize, speeds: Speeds) -> Option<Truth> {
        let own = self.seen[robot]?;
        let offset_m = self.scenario.controller().body().offset_m;
        let ahead = robot.checked_sub(1).and_then(|ahead| self.measured[ahead]);
        let ahead = ahead.filter(|ahead| own.stamp_s - ahead.stamp_s <= BESIDE_S);
        let ahead = ahead.map(|ahead| ahead.pose.state(offset_m, Speeds::ZERO));
        let state = own.pose.state(offset_m, speeds);
        let safety = self.scenario.controller().safety(&state, ahead.as_ref());
        Some(Truth { state, safety })
    }

    /// Of poses that are about as old as each other.
    fn judge_distances(&mut self, time_s: f64) {
        let offset_m = self.scenario.controller().body().offset_m;
        let fresh = |seen: &StampedPose| time_s - seen.stamp_s <= BESIDE_S;
        let places = self.measured.iter().map(|seen| {
            let seen = seen.filter(fresh)?;
            Some(seen.pose.state(offset_m, Speeds::ZERO))
        });
        self.places.clear();
        self.places.extend(places);
        self.summary.add_places(time_s, &self.places);
    }

    fn check_starts(&self) -> Result<(), Error> {
        let half_width_m = self.scenario.spec().controller.lane.half_width_m;
        for robot in 0..self.convoy.robots() {
            let Some(truth) = self.measured_truth(robot, Speeds::ZERO) else {
                continue;
            };
            let deviation_m = truth.safety.deviation_m;
            let (problem, help) = if deviation_m.abs() > half_width_m {
                let problem = format!(
                    "{:.3} m off the path, and the lane reaches {half_width_m} m to each side",
                    deviation_m.abs()
                );
                (problem, "place it within")
            } else if truth
                .safety
                .headway_m
                .is_some_and(|headway_m| headway_m < 0.0)
            {
                let ahead = self.link.ids[robot - 1];
                let problem = format!("too near to robot {ahead}");
                (problem, "place it farther back")
            } else {
                continue;
            };
            return Err(Error::Link {
                peer: format!("robot {}", self.link.ids[robot]),
                problem,
                help: help.to_owned(),
            });
        }
        Ok(())
    }

    /// Before the start nobody was told anything that could be answered.
    fn lost(&self, time_s: f64, without_poses_s: f64, lost_after_s: f64) -> Option<String> {
        if self.link.has_ended() {
            return Some("no more poses come: the tracker's side has ended".to_owned());
        }
        if without_poses_s > lost_after_s {
            return Some(format!("no pose for {without_poses_s:.1} s"));
        }
        let silence = self.link.lost(time_s, lost_after_s)?;
        Some(format!(
            "{} has been silent for {:.1} s",
            silence.peer, silence.for_s
        ))
    }
}

fn command(tick: &Tick) -> Command {
    Command {
        robot: tick.robot,
        speeds: tick.decision.speeds,
        wheels: tick.decision.wheels,
    }
}

/// `ready_told` is how long ago the other side said last that robots are getting ready.
fn is_too_long(waited: Duration, ready_told: Option<Duration>) -> bool {
    let getting_ready = ready_told.is_some_and(|told| told < APPEAR);
    waited > if getting_ready { GETTING_READY } else { APPEAR }
}

fn not_seen(ids: &[u32], counts: &Counts) -> Error {
    Error::Link {
        peer: "tracker".to_owned(),
        problem: format!(
            "not seen, or not steadily: {}; {}",
            names(ids),
            counts.text()
        ),
        help: "are these their ids at the tracker, are they in the arena?".to_owned(),
    }
}

fn names(ids: &[u32]) -> String {
    let names: Vec<String> = ids.iter().map(|id| format!("robot {id}")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::{Duration, is_too_long};

    #[test]
    fn robots_that_get_ready_have_more_time_but_not_for_ever() {
        let seconds = Duration::from_secs;
        for (waited_s, told_s, too_long) in [
            (59, None, false),
            (61, None, true),
            (61, Some(1), false),
            (299, Some(1), false),
            (301, Some(1), true),
            // It said so once, and then no more.
            (59, Some(50), false),
            (70, Some(65), true),
        ] {
            let found = is_too_long(seconds(waited_s), told_s.map(seconds));
            assert_eq!(found, too_long, "{waited_s} s, told {told_s:?} s ago");
        }
    }
}

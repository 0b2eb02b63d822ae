//! The loop: poses in, decisions out, at a fixed rate.

use std::time::{Duration, Instant};

use testbed_sim::measured::Measured;
use testbed_sim::sight::Doubt;
use testbed_sim::summary::Summarising;
use testbed_sim::tick::Watched;
use testbed_sim::{Convoy, Summary, Tick};
use unicycle_cbf::{Scenario, Speeds, StampedPose};

use super::commands::{Command, Silence};
use super::disbelieved::Contradictions;
use super::link::Link;
use super::lookout::Lookout;
use super::note::{Loss, Note};
use super::pacer::Pacer;
use super::real_time::into_real_time_class;
use super::report::{Ending, LiveReport, StopSwitch, Update};
use super::starts;
use super::watch::Watch;
use crate::error::Error;

/// The user is told whom the session waits for after this time.
const WAITING: Duration = Duration::from_secs(2);
/// Poses in a row that agree, after which a robot is where they say.
const AGREEING: u32 = 5;
/// A recording that lacks less than this of the scenario is whole, in s.
const SHORT_S: f64 = 0.5;
/// After the command to stand robots are watched for this time, and stand after this part of it, in s.
const WATCHED_S: f64 = 0.9;
const STANDS_AFTER_S: f64 = 0.45;
/// Farther than this, in m, nobody who stands is measured from where he was.
const STANDING_M: f64 = 0.015;

/// The loop of one session.
pub(super) struct ControlLoop<'a> {
    scenario: &'a Scenario,
    link: Link,
    convoy: Convoy<'a>,
    pacer: Pacer,
    /// Arrived since the last step
    seen: Vec<Option<StampedPose>>,
    /// The newest of all, as measured
    measured: Vec<Option<StampedPose>>,
    /// All since the last step, as [`super::inbox::Inbox::arrived`] gives them
    arrived: Vec<(usize, StampedPose)>,
    judge: Measured<'a>,
    contradictions: Contradictions,
    lookout: Lookout,
    watch: Watch,
    /// In s since the start; none before
    now_s: f64,
    summary: Summarising,
}

impl<'a> ControlLoop<'a> {
    pub(super) fn new(scenario: &'a Scenario, link: Link) -> Self {
        let robots = scenario.starts().len();
        let period_s = scenario.controller().hold_s();
        let max_age_s = scenario.controller().settings().hardening.max_pose_age_s;
        let lookout = Lookout::new(&link.ids, max_age_s.unwrap_or(f64::INFINITY));
        let watch = Watch::new(scenario, &link.ids, link.is_told());
        let contradictions = Contradictions::new(scenario, &link.ids);
        let judge = Measured::new(scenario, link.is_told());
        Self {
            scenario,
            watch,
            pacer: Pacer::new(link.inbox.clock(), period_s, link.is_fast()),
            link,
            convoy: Convoy::new(scenario),
            seen: vec![None; robots],
            measured: vec![None; robots],
            arrived: Vec::new(),
            judge,
            contradictions,
            lookout,
            now_s: 0.0,
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
            if starts::is_too_long(waited, ready_told) || self.link.has_ended() {
                return Err(starts::not_seen(&missing, &self.link.inbox.counts()));
            }
            if !told && start.elapsed() > WAITING {
                told = true;
                update(Update::Note(&Note::WaitingForPoses { ids: missing }));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        if !self.link.is_recording() {
            self.pacer.restart();
        }
        self.take_poses(0.0);
        self.judge_arrived();
        starts::check(self.scenario, &self.link.ids, &self.measured)?;
        Ok(true)
    }

    pub(super) fn run(
        &mut self,
        lost_after_s: f64,
        stop: &StopSwitch,
        update: &mut impl FnMut(Update),
    ) -> Ending {
        if !self.link.is_fast() && !into_real_time_class() {
            update(Update::Note(&Note::NoRealTimePriority));
        }
        let period_s = self.scenario.controller().hold_s();
        let mut ticks = Vec::with_capacity(self.convoy.robots());
        let mut last_pose_s = 0.0;
        for step in 0.. {
            let (time_s, late_s) = self.pacer.wait();
            self.now_s = time_s;
            if stop.is_on() {
                return Ending::Stopped;
            }
            if time_s >= self.scenario.spec().duration_s {
                return Ending::Finished;
            }
            self.link
                .play(time_s + 0.5 * period_s, self.pacer.start_s());
            self.take_poses(time_s);
            self.judge_arrived();
            self.look_for_contradictions(update);
            self.decide(step, time_s, late_s, &mut ticks);
            let commands: Vec<Command> = ticks.iter().map(command).collect();
            self.link.commands.send(&commands);
            self.remember(time_s, &ticks);
            self.pacer.done();
            for tick in &ticks {
                self.summary.add(tick);
            }
            let counts = &self.link.inbox.counts();
            let missed = self.pacer.missed();
            let pose_ages_s = &self.pose_ages_s(time_s);
            update(Update::Step {
                ticks: &ticks,
                pose_ages_s,
                counts,
                missed,
            });
            for note in self.watch.look(step, time_s) {
                update(Update::Note(&note));
            }
            self.report_unseen(time_s, pose_ages_s, update);
            self.pass_notes(update);
            if ticks.iter().any(|tick| tick.seen.is_some()) {
                last_pose_s = time_s;
            }
            if self.link.is_recording() && self.link.has_ended() {
                self.report_short(time_s, update);
                return Ending::Finished;
            }
            if let Some(loss) = self.lost(time_s, time_s - last_pose_s, lost_after_s) {
                return Ending::Lost(loss);
            }
        }
        Ending::Finished
    }

    pub(super) fn stopped(
        mut self,
        ending: Ending,
        update: &mut impl FnMut(Update),
    ) -> (Summary, LiveReport) {
        let stopped_s = self.pacer.now_s();
        let watches = self.is_watched();
        if watches {
            self.judge.sights().stopped(stopped_s);
        }
        let untold = self.link.stop();
        if watches {
            self.watch_stand(stopped_s);
        }
        self.pass_notes(update);
        self.judge_arrived();
        for robot in 0..self.convoy.robots() {
            self.judge.misplaced(robot, self.watch.misplaced_m(robot));
            if self.watch.were_held(robot) {
                self.judge.sights().doubt(Doubt::Held(robot));
            }
            if self.doubted_s(robot).is_some() {
                self.judge.sights().doubt(Doubt::Disbelieved(robot));
            }
        }
        let watch = &self.watch;
        let told_m = |robot: usize, time_s: f64| watch.told_m(robot, time_s);
        self.judge.over(self.now_s, told_m);
        let sights = self.judge.sights();
        let texts = sights
            .doubts()
            .iter()
            .map(|doubt| doubt.text(&self.link.ids));
        let mut doubts: Vec<String> = texts.collect();
        let seen_enough = doubts.is_empty();
        doubts.extend(
            untold
                .iter()
                .map(|id| format!("robot {id} may not have got the command to stand")),
        );
        if let Ending::Lost(loss) = &ending {
            doubts.push(format!("the link was lost: {loss}"));
        }
        if !doubts.is_empty() {
            self.summary.doubt();
        }
        let report = LiveReport {
            ending,
            untold,
            deadlines: self.pacer.deadlines(),
            received: self.link.inbox.counts(),
            commands: self.link.commands.counts(),
            robots: self.link.ids.clone(),
            unseen_s: sights.unseen_s(),
            longest_unseen_s: sights.longest_s(),
            seen_enough,
            doubts,
        };
        (self.summary.finished(), report)
    }

    /// Whether real robots were driven, that can be seen to stand.
    fn is_watched(&self) -> bool {
        self.link.is_told() && !self.link.is_recording() && self.pacer.has_begun()
    }

    /// Whether robots stand once they are told to, as far as it is seen.
    fn watch_stand(&mut self, stopped_s: f64) {
        for robot in 0..self.convoy.robots() {
            self.watch.told(robot, stopped_s, Speeds::ZERO);
        }
        let mut from: Vec<Option<StampedPose>> = Vec::new();
        while self.now_s < stopped_s + WATCHED_S && !self.link.has_ended() {
            std::thread::sleep(Duration::from_millis(10));
            self.now_s = self.pacer.now_s();
            self.judge_arrived();
            if from.is_empty() && self.now_s >= stopped_s + STANDS_AFTER_S {
                from = self.judge.poses().to_vec();
            }
        }
        let noise_m = self.scenario.spec().controller.hardening.position_noise_m;
        let still_m = STANDING_M + 4.0 * noise_m;
        for (robot, from) in from.into_iter().enumerate() {
            let seen = from.zip(self.judge.poses()[robot]);
            let moved = seen.is_some_and(|(from, to)| {
                from.stamp_s >= stopped_s
                    && (to.pose.x_m - from.pose.x_m).hypot(to.pose.y_m - from.pose.y_m) > still_m
            });
            if moved {
                self.judge.sights().doubt(Doubt::GoesOn(robot));
            }
        }
    }

    fn pass_notes(&self, update: &mut impl FnMut(Update)) {
        for note in self.link.inbox.notes() {
            update(Update::Note(&Note::Receiver(note)));
        }
    }

    fn report_short(&self, at_s: f64, update: &mut impl FnMut(Update)) {
        let duration_s = self.scenario.spec().duration_s;
        if at_s + SHORT_S < duration_s {
            update(Update::Note(&Note::RecordingEnds { at_s, duration_s }));
        }
    }

    fn report_unseen(&mut self, time_s: f64, ages_s: &[f64], update: &mut impl FnMut(Update)) {
        let why = |robot: usize| self.link.inbox.why_dropped(robot);
        for note in self.lookout.notes(time_s, ages_s, why) {
            update(Update::Note(&note));
        }
    }

    /// Stamps become times since the start.
    fn take_poses(&mut self, now_s: f64) {
        let arrived = self.link.inbox.newest();
        for (robot, seen) in arrived.into_iter().enumerate() {
            let Some(mut seen) = seen else { continue };
            seen.stamp_s -= self.pacer.start_s();
            self.lookout.hears(robot, now_s);
            self.judge.sights().has(robot, seen.stamp_s, now_s);
            self.seen[robot] = Some(seen);
            self.measured[robot] = Some(seen);
        }
    }

    /// Every pose that is believed counts, also one that came too late to act on.
    fn judge_arrived(&mut self) {
        let mut arrived = std::mem::take(&mut self.arrived);
        self.link.inbox.arrived(&mut arrived);
        for (robot, mut seen) in arrived.drain(..) {
            seen.stamp_s -= self.pacer.start_s();
            let watch = &self.watch;
            let told_m = |robot: usize, time_s: f64| watch.told_m(robot, time_s);
            let deviation_m = self.judge.saw(robot, seen, told_m, &mut self.summary);
            // Before the start robots may be carried about.
            if let Some(deviation_m) = deviation_m
                && seen.stamp_s >= 0.0
            {
                self.watch.saw(robot, seen, deviation_m);
            }
        }
        self.arrived = arrived;
    }

    fn look_for_contradictions(&mut self, update: &mut impl FnMut(Update)) {
        self.link.inbox.disbelieved(&mut self.contradictions.now);
        for robot in 0..self.convoy.robots() {
            if let Some(disbelieved) = &self.contradictions.now[robot] {
                let mut newest = disbelieved.newest();
                newest.stamp_s -= self.pacer.start_s();
                self.watch.strayed(robot, newest);
            }
            if let Some(note) = self.contradictions.note(robot) {
                update(Update::Note(&note));
            }
        }
    }

    /// For how long poses of a robot have contradicted where its commands led it, in s.
    fn doubted_s(&self, robot: usize) -> Option<f64> {
        let lasted_s = self.contradictions.lasted_s(robot);
        lasted_s.or_else(|| self.watch.displaced_s(robot, self.now_s))
    }

    fn watched(&self, robot: usize) -> Watched {
        let watched = self.watch.watched(robot);
        let newest = &self.measured[robot];
        let is_near = |seen: &StampedPose| {
            self.contradictions.is_near(robot, &seen.pose)
                || self.watch.is_near_displaced(robot, &seen.pose)
        };
        let must_stand = newest.as_ref().is_some_and(is_near);
        Watched {
            allowed_mps: if must_stand {
                Some(0.0)
            } else {
                watched.allowed_mps
            },
            disbelieved_s: self.doubted_s(robot),
            ..watched
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
        let start = Instant::now();
        self.convoy.look(time_s);
        let share_us = start.elapsed().as_secs_f64() * 1e6 / self.convoy.robots() as f64;
        for robot in (0..self.convoy.robots()).rev() {
            let start = Instant::now();
            let watched = self.watched(robot);
            let body = self.scenario.controller().body();
            let decision = self.convoy.decide(robot, time_s);
            let most_mps = watched.allowed_mps.unwrap_or(f64::INFINITY);
            let decision = decision.limited(most_mps, body);
            self.convoy.sent(robot, time_s, decision.speeds);
            let step_us = share_us + start.elapsed().as_secs_f64() * 1e6;
            ticks.push(Tick {
                tick: step,
                robot,
                time_s,
                seen: self.seen[robot],
                decision,
                truth: self.seen[robot]
                    .and_then(|_| self.judge.truth_of(robot, decision.speeds, &self.measured)),
                watched: Some(watched),
                step_us,
                late_us: late_s * 1e6,
            });
        }
        self.seen.fill(None);
    }

    /// What robots were told, where it is for them.
    fn remember(&mut self, time_s: f64, ticks: &[Tick]) {
        if !self.link.is_told() {
            return;
        }
        for tick in ticks {
            let speeds = tick.decision.speeds;
            let clock_s = self.pacer.start_s() + time_s;
            self.link.inbox.told(tick.robot, clock_s, speeds);
            self.watch.told(tick.robot, time_s, speeds);
        }
    }

    fn pose_ages_s(&self, time_s: f64) -> Vec<f64> {
        let stamps_s = self.measured.iter();
        let age_s = |seen: &StampedPose| time_s - seen.stamp_s;
        stamps_s
            .map(|seen| seen.as_ref().map_or(f64::NAN, age_s))
            .collect()
    }

    /// Before the start nobody was told anything that could be answered.
    fn lost(&self, time_s: f64, without_poses_s: f64, lost_after_s: f64) -> Option<Loss> {
        if self.link.has_ended() {
            return Some(Loss::Ended);
        }
        if without_poses_s > lost_after_s {
            let for_s = without_poses_s;
            return Some(Loss::NoPose { for_s });
        }
        let Silence { peer, for_s } = self.link.lost(time_s, lost_after_s)?;
        Some(Loss::Silent { peer, for_s })
    }
}

fn command(tick: &Tick) -> Command {
    Command {
        robot: tick.robot,
        speeds: tick.decision.speeds,
        wheels: tick.decision.wheels,
    }
}

//! A session from its beginning to its end, with zero speed on every way out.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;
use unicycle_cbf::{Predictor, Scenario};

use super::commands::CommandCounts;
use super::counts::Counts;
use super::drive::Drive;
use super::link::Link;
use super::pacer::Deadlines;
use super::spec::LinkSpec;
use crate::error::Error;
use crate::summary::Summary;
use crate::tick::Tick;

/// Steps that the predictor has room for, with some to spare for those of a late loop.
const REMEMBERED: f64 = Predictor::REMEMBERED as f64 - 4.0;

/// Ends a session from another thread: a signal, a button.
#[derive(Debug, Clone, Default)]
pub struct StopSwitch(Arc<AtomicBool>);

impl StopSwitch {
    /// The robots stop within a period.
    pub fn stop(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// What signal handlers set.
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }

    /// Whether someone has.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// What happens in a session, as it happens.
#[derive(Debug, Clone, Copy)]
pub enum Update<'a> {
    /// Something to know
    Note(&'a str),
    /// A step of all robots, from the back, after its commands were sent
    Step {
        /// One per robot
        ticks: &'a [Tick],
        /// Of the newest pose of each robot from the front, in s
        pose_ages_s: &'a [f64],
        /// Packets and poses so far
        counts: &'a Counts,
        /// Deadlines missed so far
        missed: u64,
    },
}

/// Why a session ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The scenario was over
    Finished,
    /// Asked to, by a signal or a button
    Stopped,
    /// The tracker or a robot was silent for too long
    Lost(String),
}

/// A session that is over; the robots stand, but for those named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LiveReport {
    /// Why it ended
    pub ending: Ending,
    /// Robots by their ids that may not have got the command to stand
    pub untold: Vec<u32>,
    /// How punctual the loop was
    pub deadlines: Deadlines,
    /// Packets and poses
    pub received: Counts,
    /// Commands
    pub commands: CommandCounts,
    /// All robots by their ids, from the front
    pub robots: Vec<u32>,
    /// Seconds of each without a usable pose, those over 0.3 s at a time
    pub unseen_s: Vec<f64>,
    /// The longest of them at one time, for each robot
    pub longest_unseen_s: Vec<f64>,
    /// Whether no robot can have left its lane or touched another one unseen, by what they were told
    pub seen_enough: bool,
    /// Why it is not known whether the session was safe, unless it was unsafe: too little was seen, or robots may still move
    pub doubts: Vec<String>,
}

/// A scenario on a link.
#[derive(Debug, Clone, Copy)]
pub struct Session<'a> {
    /// What is run; it needs a watchdog
    pub scenario: &'a Scenario,
    /// On what
    pub link: &'a LinkSpec,
}

impl Session<'_> {
    /// Runs until the scenario is over, the switch is on, or the link is lost, and tells every robot to stand, also if `update`
    /// panics. The summary is by the poses that were measured.
    ///
    /// # Errors
    ///
    /// A scenario without a watchdog, a link that cannot be opened, or robots that do not appear or are not where they can start.
    pub fn run(
        &self,
        stop: &StopSwitch,
        update: impl FnMut(Update) + Send,
    ) -> Result<(Summary, LiveReport), Error> {
        std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().name("control loop".to_owned());
            let thread = thread.spawn_scoped(scope, || self.run_here(stop, update));
            let thread = thread.map_err(|source| Error::no_thread("control loop", &source))?;
            thread.join().unwrap_or_else(|panic| resume_unwind(panic))
        })
    }

    fn run_here(
        &self,
        stop: &StopSwitch,
        mut update: impl FnMut(Update),
    ) -> Result<(Summary, LiveReport), Error> {
        self.check()?;
        let link = Link::open(self.link, self.scenario)?;
        let mut drive = Drive::new(self.scenario, link);
        let lost_after_s = self.link.lost_after_s;
        let ending = if drive.appear(lost_after_s, stop, &mut update)? {
            drive.run(lost_after_s, stop, &mut update)
        } else {
            Ending::Stopped
        };
        Ok(drive.stopped(ending, &mut update))
    }
}

impl Session<'_> {
    fn check(&self) -> Result<(), Error> {
        let spec = self.scenario.spec();
        let age_s = spec.controller.hardening.max_pose_age_s;
        let problem = match age_s {
            None => "without `max_pose_age_s` it would drive on old poses".to_owned(),
            Some(age_s) if age_s * spec.rate_hz > REMEMBERED => format!(
                "it remembers the last {} commands, not those of {age_s} s",
                Predictor::REMEMBERED
            ),
            Some(age_s) if age_s < self.link.latency_s() + spec.rate_hz.recip() => format!(
                "poses are {} s old by `latency_s`, and with `max_pose_age_s` = {age_s} robots would never move",
                self.link.latency_s()
            ),
            Some(_) => return Ok(()),
        };
        Err(Error::Link {
            peer: "controller".to_owned(),
            problem,
            help: "set `max_pose_age_s` under [scenario.controller.hardening], 0.3 and the latency of poses for example"
                .to_owned(),
        })
    }
}

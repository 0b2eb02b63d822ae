//! A session from its beginning to its end, with zero speed on every way out.

use std::panic::resume_unwind;

use testbed_sim::Summary;
use unicycle_cbf::{Predictor, Scenario};

use super::control_loop::ControlLoop;
use super::link::Link;
use super::report::{Ending, LiveReport, StopSwitch, Update};
use super::spec::LinkSpec;
use crate::error::Error;

/// Steps that the predictor has room for, with some to spare for those of a late loop.
const REMEMBERED: f64 = Predictor::REMEMBERED as f64 - 4.0;

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
        let mut control = ControlLoop::new(self.scenario, link);
        let lost_after_s = self.link.lost_after_s;
        let ending = if control.appear(lost_after_s, stop, &mut update)? {
            control.run(lost_after_s, stop, &mut update)
        } else {
            Ending::Stopped
        };
        Ok(control.stopped(ending, &mut update))
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

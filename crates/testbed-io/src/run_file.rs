//! A run as files have it, and with its ticks as it goes into a run log.

use std::path::Path;

use serde::{Deserialize, Serialize};
use testbed_sim::{Disturbances, Replay, RunFigures, RunSpec, Summary, Tick, Verdict};
use unicycle_cbf::{Scenario, ScenarioSpec};

use crate::error::Error;
use crate::live::LinkSpec;

/// Everything that makes a run, in simulation or on real robots. Scenario files hold it, and it stands in every run log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunFile {
    /// Of all random numbers
    pub seed: u64,
    /// Robots, path, controller
    pub scenario: ScenarioSpec,
    /// What the simulated testbed does wrong
    #[serde(default)]
    pub disturbances: Disturbances,
    /// The real testbed, where it ran on one
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkSpec>,
}

/// A run with all its ticks, in the order in which they were decided.
#[derive(Debug, Clone, PartialEq)]
pub struct LoggedRun {
    /// What made it
    pub spec: RunFile,
    /// All robots and steps
    pub ticks: Vec<Tick>,
    /// The wall clock at 0 s, in s since 1970; none where there is none
    pub started_unix_s: Option<f64>,
    /// How a session on real robots was judged; none where there was none
    pub judged: Option<Judged>,
}

/// Whether a session on real robots was safe, by all that was seen: also poses that came late, and what robots did after the last command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// What is known
    pub verdict: Verdict,
    /// Why it is not known
    #[serde(default)]
    pub doubts: Vec<String>,
}

impl Judged {
    /// A replay knows less than the session: what that did not call safe is not safe by its log either.
    pub fn apply(&self, replay: &mut Replay) {
        if replay.verdict == Verdict::Safe {
            replay.verdict = self.verdict;
            replay.doubts.clone_from(&self.doubts);
        }
    }
}

impl RunFile {
    /// Reads a scenario file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, or that holds no scenario.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::ReadScenario {
            path: path.to_owned(),
            source,
        })?;
        toml::from_str(&text).map_err(|source| Error::ScenarioFile {
            path: path.to_owned(),
            source: Box::new(source),
        })
    }

    /// Runs it in simulation, on whatever testbed it was.
    ///
    /// # Errors
    ///
    /// A scenario or disturbance that cannot be.
    pub fn simulate(&self) -> Result<(LoggedRun, Summary), Error> {
        let spec = RunSpec {
            seed: self.seed,
            scenario: self.scenario.clone(),
            disturbances: self.disturbances,
        };
        let (run, summary) = spec.simulate()?;
        let run = LoggedRun {
            spec: self.clone(),
            ticks: run.ticks,
            started_unix_s: None,
            judged: None,
        };
        Ok((run, summary))
    }

    pub(crate) fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string(self).map_err(|e| Error::Meta(e.to_string()))
    }

    pub(crate) fn half_width_m(&self) -> f64 {
        self.scenario.controller.lane.half_width_m
    }
}

impl LoggedRun {
    /// What its pictures are drawn from, with the same run without disturbances where it had some.
    ///
    /// # Errors
    ///
    /// None of a run that was made of its specification.
    pub fn figures(&self, scenario: &Scenario) -> Result<RunFigures, Error> {
        let undisturbed = if self.spec.disturbances.is_none() {
            None
        } else {
            let spec = RunFile {
                disturbances: Disturbances::default(),
                ..self.spec.clone()
            };
            Some(spec.simulate()?.0)
        };
        let undisturbed = undisturbed.as_ref().map(|run| run.ticks.as_slice());
        Ok(RunFigures::new(scenario, &self.ticks, undisturbed))
    }
}

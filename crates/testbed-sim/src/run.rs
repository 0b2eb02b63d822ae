//! What makes a run, and the run with all its ticks.

use serde::{Deserialize, Serialize};
use unicycle_cbf::{Scenario, ScenarioSpec};

use crate::disturbances::Disturbances;
use crate::error::Error;
use crate::simulation::Simulation;
use crate::summary::Summary;
use crate::tick::Tick;

/// Everything that makes a simulated run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// Of all random numbers
    pub seed: u64,
    /// Robots, path, controller
    pub scenario: ScenarioSpec,
    /// What the simulated testbed does wrong
    #[serde(default)]
    pub disturbances: Disturbances,
}

/// A run with all its ticks.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What made it
    pub spec: RunSpec,
    /// All robots and steps, in the order in which they were decided
    pub ticks: Vec<Tick>,
}

impl RunSpec {
    /// Runs it in simulation.
    ///
    /// # Errors
    ///
    /// A scenario or disturbance that cannot be.
    pub fn simulate(&self) -> Result<(Run, Summary), Error> {
        let scenario = Scenario::new(self.scenario.clone())?;
        let simulation = Simulation {
            scenario: &scenario,
            disturbances: self.disturbances,
            seed: self.seed,
        };
        let mut ticks = Vec::with_capacity(scenario.steps() * scenario.starts().len());
        let summary = simulation.run(|tick| ticks.push(*tick))?;
        let spec = self.clone();
        Ok((Run { spec, ticks }, summary))
    }
}

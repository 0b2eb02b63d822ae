//! Thousands of seeded runs in parallel, and which of them were unsafe.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;
use unicycle_cbf::{Preset, Scenario, ScenarioSpec, Testbed};

use crate::disturbances::{Disturbances, Group};
use crate::error::Error;
use crate::simulation::Simulation;
use crate::summary::Summary;
use crate::verdict::{LeastDistance, Verdict};

pub use crate::tally::{Histogram, Tally};

/// Violations that are listed for each preset and group of disturbances; all are counted.
const LISTED: usize = 20;

/// Whose settings the controllers of a scenario have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(into = "&'static str")]
pub enum SettingsOf {
    /// A preset
    Preset(Preset),
    /// A scenario file, as it is
    File,
}

impl SettingsOf {
    /// As in documents.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Preset(preset) => preset.name(),
            Self::File => "file",
        }
    }
}

impl From<SettingsOf> for &'static str {
    fn from(settings: SettingsOf) -> Self {
        settings.name()
    }
}

/// A scenario of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedScenario {
    /// A built-in scenario's name, or a file
    pub name: String,
    /// Its controllers
    pub preset: SettingsOf,
    /// The scenario itself, with the length of each run
    pub spec: ScenarioSpec,
}

/// What a campaign runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// Scenarios, each with its controllers
    pub scenarios: Vec<NamedScenario>,
    /// Which disturbances
    pub groups: Vec<Group>,
    /// Runs for each preset and group, spread over the scenarios
    pub runs: usize,
    /// Seed of the first run; the next ones count up, the same for each preset and group
    pub seed: u64,
    /// Bounds of the disturbances
    pub disturbances: Disturbances,
}

/// What a campaign found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CampaignReport {
    /// Runs in all
    pub runs: usize,
    /// Simulated time, in s
    pub simulated_s: f64,
    /// Time that it took, in s
    pub seconds: f64,
    /// Simulated time per second
    pub simulated_s_per_s: f64,
    /// By preset and disturbance
    pub totals: Vec<Total>,
    /// By preset, disturbance and scenario
    pub rows: Vec<Row>,
    /// Distributions of the least barriers
    pub histograms: Vec<Histograms>,
    /// Unsafe runs, at most twenty for each preset and disturbance
    pub violations: Vec<Violation>,
}

/// Runs of one preset under one group of disturbances.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Total {
    /// Which controllers
    pub preset: SettingsOf,
    /// Which disturbances
    pub disturbance: Group,
    /// What they came to
    #[serde(flatten)]
    pub tally: Tally,
}

/// The same for one scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Which controllers
    pub preset: SettingsOf,
    /// Which disturbances
    pub disturbance: Group,
    /// Which robots
    pub testbed: String,
    /// Which scenario
    pub scenario: String,
    /// What they came to
    #[serde(flatten)]
    pub tally: Tally,
}

/// Distributions over the runs of one preset under one group of disturbances.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Histograms {
    /// Which controllers
    pub preset: SettingsOf,
    /// Which disturbances
    pub disturbance: Group,
    /// Least headway barrier of each run
    pub headway_mm: Histogram,
    /// Least distance to the edge of the lane of each run
    pub clearance_mm: Histogram,
}

/// An unsafe run; scenario, preset, disturbance and seed repeat it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Violation {
    /// Which controllers
    pub preset: SettingsOf,
    /// Which robots
    pub testbed: String,
    /// Which scenario
    pub scenario: String,
    /// Which disturbances
    pub disturbance: Group,
    /// Of the run
    pub seed: u64,
    /// When it became unsafe, in s
    pub first_unsafe_s: Option<f64>,
    /// Least headway barrier, in m
    pub min_h_headway_m: Option<f64>,
    /// Where two robots were nearest to each other
    pub least_distance: Option<LeastDistance>,
    /// Least distance to the edge of the lane, in m
    pub lane_clearance_m: f64,
}

impl NamedScenario {
    /// Built-in scenarios of some testbeds with one of some names, or all where none is given.
    ///
    /// # Errors
    ///
    /// A name that none of the testbeds has.
    pub fn built_in(
        testbeds: &[Testbed],
        names: &[String],
        preset: Preset,
    ) -> Result<Vec<Self>, Error> {
        let mut found = Vec::new();
        for testbed in testbeds {
            let wanted = |name: &&&str| names.is_empty() || names.iter().any(|n| n == **name);
            for name in testbed.scenarios().iter().filter(wanted) {
                found.push(Self {
                    name: (*name).to_owned(),
                    preset: SettingsOf::Preset(preset),
                    spec: testbed.scenario(name, preset)?,
                });
            }
        }
        for name in names {
            if !found.iter().any(|known| known.name == *name) {
                for testbed in testbeds {
                    testbed.scenario(name, Preset::Thesis)?;
                }
            }
        }
        Ok(found)
    }
}

impl Campaign {
    /// Runs everything, `done` being called after each run from any thread.
    ///
    /// # Errors
    ///
    /// A scenario or disturbance that cannot be.
    pub fn run(&self, done: &(dyn Fn() + Sync)) -> Result<CampaignReport, Error> {
        let start = Instant::now();
        let mut report = CampaignReport {
            runs: 0,
            simulated_s: 0.0,
            seconds: 0.0,
            simulated_s_per_s: 0.0,
            totals: Vec::new(),
            rows: Vec::new(),
            histograms: Vec::new(),
            violations: Vec::new(),
        };
        for preset in self.presets() {
            let own: Vec<&NamedScenario> = self.of(preset).collect();
            let scenarios = scenarios(&own)?;
            for &group in &self.groups {
                let summaries = self.summaries(&scenarios, group, done)?;
                report.runs += summaries.len();
                report.simulated_s += simulated_s(&scenarios, self.runs);
                self.add(&mut report, preset, &own, group, &summaries);
            }
        }
        report.seconds = start.elapsed().as_secs_f64();
        report.simulated_s_per_s = report.simulated_s / report.seconds;
        Ok(report)
    }

    /// Number of runs in all.
    #[must_use]
    pub fn work(&self) -> usize {
        self.runs * self.presets().len() * self.groups.len()
    }

    /// Scenarios that are not run because there are more of them than runs.
    #[must_use]
    pub fn idle(&self) -> usize {
        let presets = self.presets().into_iter();
        let idle = presets.map(|preset| self.of(preset).count().saturating_sub(self.runs));
        idle.sum()
    }

    /// Length of each run in s, if all are as long.
    #[must_use]
    pub fn common_duration_s(&self) -> Option<f64> {
        let mut durations_s = self.scenarios.iter().map(|named| named.spec.duration_s);
        let first_s = durations_s.next()?;
        durations_s
            .all(|duration_s| duration_s.total_cmp(&first_s).is_eq())
            .then_some(first_s)
    }

    /// In the order in which they first occur.
    fn presets(&self) -> Vec<SettingsOf> {
        let mut presets = Vec::new();
        for scenario in &self.scenarios {
            if !presets.contains(&scenario.preset) {
                presets.push(scenario.preset);
            }
        }
        presets
    }

    fn of(&self, preset: SettingsOf) -> impl Iterator<Item = &NamedScenario> {
        let scenarios = self.scenarios.iter();
        scenarios.filter(move |scenario| scenario.preset == preset)
    }

    fn summaries(
        &self,
        scenarios: &[Scenario],
        group: Group,
        done: &(dyn Fn() + Sync),
    ) -> Result<Vec<Summary>, Error> {
        let disturbances = self.disturbances.only(group);
        let run = |index: usize| {
            let simulation = Simulation {
                scenario: &scenarios[index % scenarios.len()],
                disturbances,
                seed: self.seed + index as u64,
            };
            let summary = simulation.run(|_| {});
            done();
            summary
        };
        (0..self.runs).into_par_iter().map(run).collect()
    }

    fn add(
        &self,
        report: &mut CampaignReport,
        preset: SettingsOf,
        scenarios: &[&NamedScenario],
        disturbance: Group,
        summaries: &[Summary],
    ) {
        report.totals.push(Total {
            preset,
            disturbance,
            tally: Tally::new(&summaries.iter().collect::<Vec<_>>()),
        });
        for (index, scenario) in scenarios.iter().enumerate() {
            let own = summaries.iter().skip(index).step_by(scenarios.len());
            report.rows.push(Row {
                preset,
                disturbance,
                testbed: scenario.spec.testbed.clone(),
                scenario: scenario.name.clone(),
                tally: Tally::new(&own.collect::<Vec<_>>()),
            });
        }
        report.histograms.push(Histograms {
            preset,
            disturbance,
            headway_mm: Histogram::new(summaries.iter().filter_map(|s| s.min_h_headway_m)),
            clearance_mm: Histogram::new(summaries.iter().map(|s| s.lane_clearance_m)),
        });
        let unsafe_runs = summaries
            .iter()
            .enumerate()
            .filter(|(_, s)| s.verdict != Verdict::Safe);
        let violations = unsafe_runs.take(LISTED).map(|(index, summary)| {
            let scenario = scenarios[index % scenarios.len()];
            Violation {
                preset,
                testbed: scenario.spec.testbed.clone(),
                scenario: scenario.name.clone(),
                disturbance,
                seed: self.seed + index as u64,
                first_unsafe_s: summary.first_unsafe_s,
                min_h_headway_m: summary.min_h_headway_m,
                least_distance: summary.least_distance,
                lane_clearance_m: summary.lane_clearance_m,
            }
        });
        report.violations.extend(violations);
    }
}

fn scenarios(named: &[&NamedScenario]) -> Result<Vec<Scenario>, Error> {
    let scenario = |named: &&NamedScenario| {
        Scenario::new(named.spec.clone()).map_err(|source| Error::NamedScenario {
            name: named.name.clone(),
            source,
        })
    };
    named.iter().map(scenario).collect()
}

/// Of runs that go round the scenarios, in s.
fn simulated_s(scenarios: &[Scenario], runs: usize) -> f64 {
    let durations_s = scenarios.iter().map(|scenario| scenario.spec().duration_s);
    durations_s.cycle().take(runs).sum()
}

//! Which scenario: flags that run, explain and replay share.

use std::path::{Path, PathBuf};

use crate::names::named;
use anyhow::bail;
use clap::Args;
use serde::Serialize;
use testbed_io::{PathFile, RunFile};
use testbed_sim::Disturbances;
use unicycle_cbf::{PathSpec, Preset, ScenarioSpec, Testbed};

/// A built-in scenario or a file.
#[derive(Debug, Args, Serialize)]
#[command(next_help_heading = "Scenario")]
pub(crate) struct ScenarioArgs {
    /// Which robots [default: khepera]
    #[arg(long, value_parser = named::<Testbed>())]
    pub(crate) testbed: Option<Testbed>,
    /// on-off, decay, track (Robotarium), straight, chain, brake, stop, or a TOML file as `ctrl run --show-config` prints it
    #[arg(long, default_value = "on-off", value_name = "NAME|FILE.toml")]
    pub(crate) scenario: String,
    /// Settings of the controllers: the thesis's, or with every guard [default: thesis; with --live hardened; a file as it is]
    #[arg(long, value_parser = named::<Preset>())]
    pub(crate) preset: Option<Preset>,
    /// Closed path in place of the scenario's: CSV with columns x_m and y_m (or mm, cm, km), in the order of travel
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) path: Option<PathBuf>,
    /// Close a path whose ends are apart, by a curve from the last point to the first
    #[arg(long, requires = "path")]
    pub(crate) close_path: bool,
}

/// What a run was asked for by name, for titles and figures.
pub(crate) struct Named {
    pub(crate) spec: RunFile,
    pub(crate) preset: Option<Preset>,
    /// Figures of the thesis that the scenario shows
    pub(crate) figures: &'static [&'static str],
    /// What was taken for granted
    pub(crate) notes: Vec<String>,
}

impl ScenarioArgs {
    /// The files that the flags name.
    pub(crate) fn files(&self) -> impl Iterator<Item = PathBuf> {
        let scenario = self.is_file().then(|| PathBuf::from(&self.scenario));
        scenario.into_iter().chain(self.path.clone())
    }

    fn is_file(&self) -> bool {
        let extension = Path::new(&self.scenario).extension();
        extension.is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
    }

    /// The scenario without disturbances, or what the file says.
    pub(crate) fn named(&self, default: Preset) -> anyhow::Result<Named> {
        let mut named = if self.is_file() {
            self.file()?
        } else {
            self.built_in(default)?
        };
        if let Some(path) = &self.path {
            let (points_m, notes) = self.points_m(path)?;
            named.notes = notes;
            named.spec.scenario.path = PathSpec::Closed { points_m };
            named.figures = &[];
        }
        Ok(named)
    }

    /// Points of a path that is closed or is to be, and what to know of them.
    fn points_m(&self, file: &Path) -> anyhow::Result<(Vec<[f64; 2]>, Vec<String>)> {
        let path = PathFile::read(file)?;
        let mut notes = path.notes.clone();
        if let Some(gap_m) = path.gap_m() {
            if !self.close_path {
                bail!(
                    "{}: the path is open, its ends are {gap_m:.3} m apart, and robots drive round and round; give points all around, or close it with --close-path",
                    file.display()
                );
            }
            notes.push(format!(
                "the path was open by {gap_m:.3} m and is closed by a curve"
            ));
        }
        Ok((path.points_m, notes))
    }

    fn built_in(&self, default: Preset) -> anyhow::Result<Named> {
        let testbed = self.testbed.unwrap_or(Testbed::Khepera);
        let preset = self.preset.unwrap_or(default);
        Ok(Named {
            spec: RunFile {
                seed: 1,
                scenario: testbed.scenario(&self.scenario, preset)?,
                disturbances: Disturbances::default(),
                link: None,
            },
            preset: Some(preset),
            figures: testbed.figures(&self.scenario),
            notes: Vec::new(),
        })
    }

    fn file(&self) -> anyhow::Result<Named> {
        if self.testbed.is_some() {
            bail!(
                "`{}` says which robots; leave --testbed out, or name a built-in scenario",
                self.scenario
            );
        }
        let mut spec = RunFile::read(Path::new(&self.scenario))?;
        if let Some(preset) = self.preset {
            apply(preset, &mut spec.scenario);
        }
        Ok(Named {
            spec,
            preset: self.preset,
            figures: &[],
            notes: Vec::new(),
        })
    }
}

/// Gives a scenario the settings of a preset.
pub(crate) fn apply(preset: Preset, scenario: &mut ScenarioSpec) {
    scenario.controller = preset.applied_to(&scenario.controller, &scenario.body);
}

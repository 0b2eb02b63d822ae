//! Many scenarios at once: built-in ones by name, files, and folders of files.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use testbed_io::RunFile;
use testbed_sim::{NamedScenario, SettingsOf};
use unicycle_cbf::{Preset, Testbed};

use super::scenario::apply;
use crate::flags::Context;
use crate::output;
use drive_log::collection::files_below;

/// What scenarios are asked for, and with which controllers.
pub(crate) struct Wanted<'a> {
    /// Names, files and folders; all built-in scenarios where there are none
    pub(crate) scenarios: &'a [String],
    /// Of built-in scenarios; all where there are none
    pub(crate) testbeds: &'a [Testbed],
    /// Without any, built-in scenarios are hardened and files are taken as they are
    pub(crate) presets: &'a [Preset],
    /// In place of each scenario's own, in s
    pub(crate) duration_s: Option<f64>,
}

impl Wanted<'_> {
    /// Built-in scenarios first, then files, each with every preset.
    pub(crate) fn named(&self, context: &Context) -> anyhow::Result<Vec<NamedScenario>> {
        let (files, names): (Vec<&String>, Vec<&String>) =
            self.scenarios.iter().partition(|text| is_path(text));
        let names: Vec<String> = names.into_iter().cloned().collect();
        let mut found = Vec::new();
        if files.is_empty() || !names.is_empty() {
            found.extend(self.built_in(&names)?);
        } else if !self.testbeds.is_empty() {
            bail!("files say which robots; leave --testbed out, or name built-in scenarios too");
        }
        for file in files_of(&files, context)? {
            found.extend(self.of_file(&file)?);
        }
        if let Some(duration_s) = self.duration_s {
            for scenario in &mut found {
                scenario.spec.duration_s = duration_s;
            }
        }
        Ok(found)
    }

    fn built_in(&self, names: &[String]) -> anyhow::Result<Vec<NamedScenario>> {
        let testbeds = match self.testbeds {
            [] => Testbed::ALL,
            some => some,
        };
        let presets = match self.presets {
            [] => &[Preset::Hardened],
            some => some,
        };
        let mut found = Vec::new();
        for preset in presets {
            found.extend(NamedScenario::built_in(testbeds, names, *preset)?);
        }
        Ok(found)
    }

    fn of_file(&self, file: &Path) -> anyhow::Result<Vec<NamedScenario>> {
        let run = RunFile::read(file)?;
        ensure!(
            run.link.is_none(),
            "`{}` was run on real robots: take [link] out of the file",
            file.display()
        );
        let as_it_is = NamedScenario {
            name: file.display().to_string(),
            preset: SettingsOf::File,
            spec: run.scenario,
        };
        if self.presets.is_empty() {
            return Ok(vec![as_it_is]);
        }
        let with = self.presets.iter().map(|preset| {
            let mut scenario = as_it_is.clone();
            apply(*preset, &mut scenario.spec);
            scenario.preset = SettingsOf::Preset(*preset);
            scenario
        });
        Ok(with.collect())
    }
}

/// Whether an argument is a file or a folder, and not the name of a built-in scenario.
pub(crate) fn is_path(text: &str) -> bool {
    let path = Path::new(text);
    is_toml(path) || path.is_dir() || text.contains(['/', '\\'])
}

fn is_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// In the order of the arguments, those of a folder sorted; each file once.
fn files_of(arguments: &[&String], context: &Context) -> anyhow::Result<Vec<PathBuf>> {
    let (mut files, mut known) = (Vec::new(), HashSet::new());
    for argument in arguments {
        let path = Path::new(argument);
        let found = if path.is_dir() {
            scenarios_in(path, context)?
        } else {
            vec![path.to_owned()]
        };
        let itself = |file: &PathBuf| file.canonicalize().unwrap_or_else(|_| file.clone());
        files.extend(found.into_iter().filter(|file| known.insert(itself(file))));
    }
    Ok(files)
}

/// A folder may hold other files of settings, those of links for example, which are named.
fn scenarios_in(folder: &Path, context: &Context) -> anyhow::Result<Vec<PathBuf>> {
    let mut scenarios = Vec::new();
    let files = files_below(folder)?;
    for file in files.into_iter().filter(|file| is_toml(file)) {
        if is_scenario(&file)? {
            scenarios.push(file);
        } else {
            let text = format!("left out, without [scenario]: {}", file.display());
            output::note(context, &text);
        }
    }
    ensure!(
        !scenarios.is_empty(),
        "no scenario in the folder `{}`; looked for files ending in .toml, to the bottom",
        folder.display()
    );
    Ok(scenarios)
}

/// What cannot be read as TOML is meant to be one, and its error is the user's to see.
fn is_scenario(file: &Path) -> anyhow::Result<bool> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("cannot read the scenario `{}`", file.display()))?;
    let table = text.parse::<toml::Table>();
    Ok(table.map_or(true, |table| table.contains_key("scenario")))
}

/// A word of a command that a shell takes as it is.
pub(crate) fn shell_word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=+,@".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}

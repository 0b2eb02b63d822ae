//! What is held out at a time: drives, files, or the drives of a driver.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::flags::Context;
use crate::inputs::Input;
use crate::output;

/// Units that a note names; the document lists all.
const NAMED: usize = 8;

#[derive(Debug, Clone, Args, Serialize)]
pub(super) struct HoldOutArgs {
    /// What is held out at a time
    #[arg(long, value_enum, default_value_t = HoldOut::Trip, value_name = "UNIT")]
    pub(super) hold_out: HoldOut,
    /// Folder that is a driver, counted from the file up: 1 is the folder of the file [default: the topmost in which the logs
    /// differ]
    #[arg(long, value_parser = level, value_name = "N")]
    driver_level: Option<usize>,
    /// Column of the logs that names the driver, in place of folders
    #[arg(long, conflicts_with = "driver_level", value_name = "HEADER")]
    driver_column: Option<String>,
}

/// What is held out at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum HoldOut {
    /// One drive
    Trip,
    /// All drives of one file
    File,
    /// All drives of one driver: keep each driver's logs in a folder of its own
    Driver,
}

impl HoldOut {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Trip => "trip",
            Self::File => "file",
            Self::Driver => "driver",
        }
    }
}

fn level(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(level) if level > 0 => Ok(level),
        _ => Err("expected a number of folders, at least 1".to_owned()),
    }
}

/// The unit of every drive.
pub(super) struct Units {
    /// In the order of the drives.
    pub(super) of_drives: Vec<String>,
    /// Where the names are from, in words.
    taken_from: String,
}

/// Units as the document lists them.
#[derive(Serialize)]
pub(super) struct UnitsEntry {
    taken_from: String,
    /// Drives of each unit.
    drives: BTreeMap<String, usize>,
}

impl HoldOutArgs {
    /// Names the unit of every drive, and says what was taken for a driver.
    pub(super) fn units(&self, inputs: &[Input], context: &Context) -> anyhow::Result<Units> {
        let says_driver = self.driver_level.is_some() || self.driver_column.is_some();
        ensure!(
            !says_driver || self.hold_out == HoldOut::Driver,
            "--driver-level and --driver-column say what a driver is; give --hold-out driver with them"
        );
        let units = match self.hold_out {
            HoldOut::Trip => Units {
                of_drives: drive_names(inputs),
                taken_from: "drives".to_owned(),
            },
            HoldOut::File => Units {
                of_drives: inputs.iter().map(|input| input.path.clone()).collect(),
                taken_from: "files".to_owned(),
            },
            HoldOut::Driver => match &self.driver_column {
                Some(column) => drivers_of_column(inputs, column)?,
                None => self.drivers_of_folders(inputs)?,
            },
        };
        if self.hold_out == HoldOut::Driver {
            units.check_drivers()?;
            output::note(context, &units.said());
        }
        Ok(units)
    }

    fn drivers_of_folders(&self, inputs: &[Input]) -> anyhow::Result<Units> {
        let folders: Vec<PathBuf> = inputs.iter().map(|i| folder_of(&i.path)).collect();
        let drivers: Vec<PathBuf> = match self.driver_level {
            Some(level) => folders.iter().map(|f| above(f, level - 1)).collect(),
            None => {
                let common = common(&folders);
                folders.iter().map(|f| first_below(f, &common)).collect()
            }
        };
        let above_all = common(&drivers);
        let of_drives: Vec<String> = drivers.iter().map(|d| shown(d, &above_all)).collect();
        let taken_from = match self.driver_level {
            Some(1) => "the folder of each file".to_owned(),
            Some(level) => format!("the folder {level} above each file"),
            None => format!("the folders in `{}`", above_all.display()),
        };
        Ok(Units {
            of_drives,
            taken_from,
        })
    }
}

impl Units {
    pub(super) fn entry(&self) -> UnitsEntry {
        let mut drives = BTreeMap::new();
        for unit in &self.of_drives {
            *drives.entry(unit.clone()).or_default() += 1;
        }
        UnitsEntry {
            taken_from: self.taken_from.clone(),
            drives,
        }
    }

    fn check_drivers(&self) -> anyhow::Result<()> {
        let several = self.of_drives.windows(2).any(|two| two[0] != two[1]);
        ensure!(
            several,
            "--hold-out driver: all logs are of one driver, by {}; keep each driver's logs in a folder of its own, \
             or say with --driver-level which folder, or with --driver-column which column, names the driver",
            self.taken_from
        );
        Ok(())
    }

    fn said(&self) -> String {
        let drives = self.entry().drives;
        let named = drives.iter().take(NAMED);
        let mut names: Vec<String> = named.map(|(name, n)| format!("{name} ({n})")).collect();
        if drives.len() > NAMED {
            names.push(format!("and {} more", drives.len() - NAMED));
        }
        format!(
            "drivers are {}, {} of them, with their drives: {}",
            self.taken_from,
            drives.len(),
            names.join(", ")
        )
    }
}

/// The value that a column has throughout each drive.
fn drivers_of_column(inputs: &[Input], column: &str) -> anyhow::Result<Units> {
    let of_drive = |input: &Input| {
        let origin = &input.drive.origin;
        let named = origin
            .iter()
            .find(|(header, _)| header.eq_ignore_ascii_case(column));
        named.map(|(_, driver)| driver.clone()).with_context(|| {
            let known: Vec<&str> = origin.keys().map(String::as_str).collect();
            format!(
                "{}: no column `{column}` that names a driver; there are: {}",
                input.label(),
                if known.is_empty() {
                    "none".to_owned()
                } else {
                    known.join(", ")
                }
            )
        })
    };
    Ok(Units {
        of_drives: inputs.iter().map(of_drive).collect::<anyhow::Result<_>>()?,
        taken_from: format!("the values of the column `{column}`"),
    })
}

/// Names of drives, with their files where a name is that of several.
fn drive_names(inputs: &[Input]) -> Vec<String> {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for input in inputs {
        *count.entry(&input.drive.name).or_default() += 1;
    }
    let named = inputs
        .iter()
        .map(|input| match count[input.drive.name.as_str()] {
            1 => input.drive.name.clone(),
            _ => input.place(),
        });
    named.collect()
}

/// The true folder of a file, as far as it is on the disk.
fn folder_of(path: &str) -> PathBuf {
    let path = Path::new(path);
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    path.parent().unwrap_or(&path).to_owned()
}

fn above(folder: &Path, levels: usize) -> PathBuf {
    folder.ancestors().nth(levels).unwrap_or(folder).to_owned()
}

/// The folder that holds all of them.
fn common(folders: &[PathBuf]) -> PathBuf {
    let mut common = folders.first().cloned().unwrap_or_default();
    for folder in folders {
        while !folder.starts_with(&common) && common.pop() {}
    }
    common
}

fn first_below(folder: &Path, above: &Path) -> PathBuf {
    let below = folder.strip_prefix(above).ok();
    let first = below.and_then(|below| below.components().next());
    first.map_or_else(|| above.to_owned(), |first| above.join(first))
}

/// A folder without what all have in common.
fn shown(folder: &Path, above_all: &Path) -> String {
    match folder.strip_prefix(above_all) {
        Ok(rest) if !rest.as_os_str().is_empty() => rest.display().to_string(),
        _ => ".".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_is_the_topmost_folder_in_which_logs_differ() {
        let folders = ["/x/anna/1", "/x/anna/2", "/x/ben"].map(PathBuf::from);
        let above_all = common(&folders);
        assert_eq!(above_all, Path::new("/x"));
        let drivers = folders.map(|folder| first_below(&folder, &above_all));
        assert_eq!(drivers, ["/x/anna", "/x/anna", "/x/ben"].map(PathBuf::from));
        assert_eq!(shown(&drivers[2], &above_all), "ben");
    }

    #[test]
    fn a_driver_is_the_folder_at_a_level() {
        assert_eq!(above(Path::new("/x/anna/1"), 1), Path::new("/x/anna"));
        assert_eq!(above(Path::new("/x"), 5), Path::new("/x"));
    }
}

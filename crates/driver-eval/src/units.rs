//! What is held out at a time: drives, files, or the drives of a driver.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::Error;

/// Drivers that a sentence names; the document lists all.
const NAMED: usize = 8;

/// What is held out at a time.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Serialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "lowercase")]
#[strum(serialize_all = "lowercase")]
pub enum UnitKind {
    /// One drive
    Trip,
    /// All drives of one file
    File,
    /// All drives of one driver: keep each driver's logs in a folder of its own
    Driver,
}

impl UnitKind {
    /// As in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Where a drive comes from.
#[derive(Debug, Clone, Copy)]
pub struct DriveSource<'a> {
    /// Its file.
    pub path: &'a str,
    /// Name of the drive.
    pub name: &'a str,
    /// The file, with the drive where there are several.
    pub place: &'a str,
    /// What the file says of the whole recording, by header.
    pub origin: &'a BTreeMap<String, String>,
}

/// What names the driver of a drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DriverBy {
    /// The topmost folder in which the files differ.
    TopmostFolder,
    /// So many folders up from the file; 1 is the folder that it is in.
    FolderAbove(usize),
    /// The value of this column.
    Column(String),
}

/// The unit of every drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units {
    /// What they are.
    pub kind: UnitKind,
    /// In the order of the drives.
    pub of_drives: Vec<String>,
    /// Where the names are from, in words.
    taken_from: String,
}

/// Units as a document lists them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UnitsEntry {
    taken_from: String,
    /// Drives of each unit.
    drives: BTreeMap<String, usize>,
}

impl Units {
    /// Every drive is a unit, by its name, or by its place where others have the same name.
    #[must_use]
    pub fn by_drive(sources: &[DriveSource<'_>]) -> Self {
        let mut count: BTreeMap<&str, usize> = BTreeMap::new();
        for source in sources {
            *count.entry(source.name).or_default() += 1;
        }
        let named = sources.iter().map(|source| match count[source.name] {
            1 => source.name.to_owned(),
            _ => source.place.to_owned(),
        });
        Self {
            kind: UnitKind::Trip,
            of_drives: named.collect(),
            taken_from: "drives".to_owned(),
        }
    }

    /// All drives of a file are a unit.
    #[must_use]
    pub fn by_file(sources: &[DriveSource<'_>]) -> Self {
        Self {
            kind: UnitKind::File,
            of_drives: sources
                .iter()
                .map(|source| source.path.to_owned())
                .collect(),
            taken_from: "files".to_owned(),
        }
    }

    /// All drives of a driver are a unit. Folders are looked up on the disk.
    ///
    /// # Errors
    /// [`Error::NoDriver`] for a drive without the column, [`Error::NoFolder`] for one that is not in so many folders,
    /// [`Error::OneDriver`] where all are of one.
    pub fn by_driver(sources: &[DriveSource<'_>], by: &DriverBy) -> Result<Self, Error> {
        let (of_drives, taken_from) = match by {
            DriverBy::Column(column) => of_column(sources, column)?,
            DriverBy::TopmostFolder => of_folders(sources, None)?,
            DriverBy::FolderAbove(level) => of_folders(sources, Some(*level))?,
        };
        if of_drives.windows(2).all(|two| two[0] == two[1]) {
            return Err(Error::OneDriver { taken_from });
        }
        Ok(Self {
            kind: UnitKind::Driver,
            of_drives,
            taken_from,
        })
    }

    /// As a document lists them.
    #[must_use]
    pub fn entry(&self) -> UnitsEntry {
        let mut drives = BTreeMap::new();
        for unit in &self.of_drives {
            *drives.entry(unit.clone()).or_default() += 1;
        }
        UnitsEntry {
            taken_from: self.taken_from.clone(),
            drives,
        }
    }

    /// What was taken for a driver, in words.
    #[must_use]
    pub fn drivers_in_words(&self) -> String {
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

/// Names of units, and where they are from.
type Named = (Vec<String>, String);

/// The value that a column has throughout each drive.
fn of_column(sources: &[DriveSource<'_>], column: &str) -> Result<Named, Error> {
    let of_drive = |source: &DriveSource<'_>| {
        let mut origin = source.origin.iter();
        let named = origin.find(|(header, _)| header.eq_ignore_ascii_case(column));
        named
            .map(|(_, driver)| driver.clone())
            .ok_or_else(|| Error::NoDriver {
                drive: source.place.to_owned(),
                column: column.to_owned(),
                known: source.origin.keys().cloned().collect(),
            })
    };
    let of_drives = sources.iter().map(of_drive).collect::<Result<_, _>>()?;
    Ok((of_drives, format!("the values of the column `{column}`")))
}

fn of_folders(sources: &[DriveSource<'_>], level: Option<usize>) -> Result<Named, Error> {
    let folders: Vec<PathBuf> = sources.iter().map(|s| folder_of(s.path)).collect();
    let drivers: Vec<PathBuf> = match level {
        Some(level) => {
            let named = folders.iter().zip(sources);
            let driver = |(folder, source): (&PathBuf, &DriveSource<'_>)| {
                above(folder, level.max(1) - 1).ok_or_else(|| Error::NoFolder {
                    drive: source.place.to_owned(),
                    level,
                })
            };
            named.map(driver).collect::<Result<_, _>>()?
        }
        None => {
            let common = common(&folders);
            folders.iter().map(|f| first_below(f, &common)).collect()
        }
    };
    let above_all = common(&drivers);
    let of_drives = drivers.iter().map(|d| shown(d, &above_all)).collect();
    let taken_from = match level {
        Some(1) => "the folder of each file".to_owned(),
        Some(level) => format!("the folder {level} above each file"),
        None => format!("the folders in `{}`", above_all.display()),
    };
    Ok((of_drives, taken_from))
}

/// The true folder of a file, as far as it is on the disk.
fn folder_of(path: &str) -> PathBuf {
    let path = Path::new(path);
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    path.parent().unwrap_or(&path).to_owned()
}

/// `None` where there is none with a name.
fn above(folder: &Path, levels: usize) -> Option<PathBuf> {
    let above = folder.ancestors().nth(levels)?;
    above.file_name().map(|_| above.to_owned())
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
        assert_eq!(above(Path::new("/x/anna/1"), 1), Some("/x/anna".into()));
        assert_eq!(
            [above(Path::new("/x"), 5), above(Path::new("/x"), 1)],
            [None, None]
        );
    }
}

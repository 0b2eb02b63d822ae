//! Many recordings at once: files, folders and globs, each drive once.

mod again;
mod folders;
mod paths;
mod repeated;
mod sourced_drive;
mod threads;

use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use crate::error::NoLog;
use crate::limit_map::LimitMapUse;
use crate::{Error, LayoutChoice, LogFile, Preparation, prepare, read_file, read_from};
pub use folders::files_below;
use paths::{Expanded, Named, expand};
pub use repeated::{Repeated, SameBy};
pub use sourced_drive::{DriveEntry, SourcedDrive};
use threads::in_order;

/// What was read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Collection {
    drives: Vec<SourcedDrive>,
    beside: Beside,
}

/// What the arguments name and the drives do not show, as a document lists it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Beside {
    /// Files of folders that are no logs.
    pub left_out: Vec<NoLog>,
    /// Broken logs that were skipped.
    pub skipped: Vec<Skipped>,
    /// Files and drives that were there already.
    pub twice: Vec<Repeated>,
    /// The map that speed limits are from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_map: Option<LimitMapUse>,
}

/// A log that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// The file.
    pub path: String,
    /// What is wrong with it, in words.
    pub error: String,
}

/// How files are read.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Which column is what.
    pub layout: LayoutChoice,
    /// How recordings become drives.
    pub preparation: Preparation,
    /// Whether a broken log is skipped and listed; otherwise it is an error.
    pub skip_broken: bool,
    /// A map in GeoJSON whose speed limits count where the drives have a position, see [`crate::limit_map`].
    pub limit_map: Option<PathBuf>,
    /// Files that are read at a time, at least one.
    pub threads: usize,
}

impl Deref for Collection {
    type Target = [SourcedDrive];

    fn deref(&self) -> &[SourcedDrive] {
        &self.drives
    }
}

impl Collection {
    /// Reads, checks and prepares all logs that the paths stand for: files, folders to the bottom, globs, and `-` for the standard
    /// input. Several logs of one file stay in its order. `started` is told the number of files, `finished` is called after each, from any
    /// thread.
    ///
    /// # Errors
    /// [`Error::Unusable`] for broken logs, unless they are skipped and there are others; [`Error::OnlyOtherFiles`] where no file is a log,
    /// and what finding the files refuses.
    pub fn read(
        paths: &[PathBuf],
        reading: &Reading,
        started: impl FnOnce(usize),
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self, Error> {
        let Expanded {
            files,
            left_out,
            twice,
        } = expand(paths)?;
        started(files.len());
        let read = in_order(&files, reading.threads, |file| {
            let logs = load_file(&file.path, reading);
            finished();
            logs
        })?;
        let mut sorted = Sorted::default();
        (sorted.beside.left_out, sorted.beside.twice) = (left_out, twice);
        for (file, logs) in files.iter().zip(read) {
            sorted.add(file, logs);
        }
        let mut collection = sorted.collection(reading.skip_broken)?;
        if let Some(map) = &reading.limit_map {
            let used = LimitMapUse::of_file(map, &mut collection.drives)?;
            collection.beside.limit_map = Some(used);
        }
        Ok(collection)
    }

    /// Of files in memory, with their names.
    ///
    /// # Errors
    /// What reading or preparing the first broken one refuses.
    pub fn of_bytes<'a>(
        files: impl IntoIterator<Item = (&'a Path, &'a [u8])>,
        preparation: &Preparation,
    ) -> Result<Self, Error> {
        let mut drives = Vec::new();
        for (path, bytes) in files {
            let file = crate::read_bytes(path, bytes, &LayoutChoice::Auto)?;
            for drive in prepared(file, preparation) {
                drives.push(drive?);
            }
        }
        Ok(Self {
            drives,
            beside: Beside::default(),
        })
    }

    /// What the drives do not show.
    #[must_use]
    pub fn beside(&self) -> &Beside {
        &self.beside
    }
}

impl Beside {
    /// With what was beside other logs, those of other drivers for example.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        self.left_out.extend_from_slice(&other.left_out);
        self.skipped.extend_from_slice(&other.skipped);
        self.twice.extend_from_slice(&other.twice);
        self
    }
}

/// The files that paths stand for.
///
/// # Errors
/// Those of finding them.
pub fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let files = expand(paths)?.files.into_iter();
    Ok(files.map(|named| named.path).collect())
}

/// The logs of a file, each prepared or not; or why there are none.
type OfFile = Result<Vec<Result<SourcedDrive, Error>>, Error>;

fn load_file(path: &Path, reading: &Reading) -> OfFile {
    let file = if path == Path::new("-") {
        read_from(Path::new("stdin"), std::io::stdin().lock(), &reading.layout)?
    } else {
        read_file(path, &reading.layout)?
    };
    Ok(prepared(file, &reading.preparation).collect())
}

fn prepared(
    file: LogFile,
    preparation: &Preparation,
) -> impl Iterator<Item = Result<SourcedDrive, Error>> {
    let path = file.path.display().to_string();
    file.logs.into_iter().map(move |log| {
        let drive = prepare(log, preparation).map_err(|cause| Error::InFile {
            path: path.clone(),
            cause: Box::new(cause),
        })?;
        Ok(SourcedDrive {
            path: path.clone(),
            sha256: file.sha256.clone(),
            layout: file.layout.clone(),
            drive,
        })
    })
}

/// Drives, files that are no logs, and logs that are broken.
#[derive(Default)]
struct Sorted {
    drives: Vec<SourcedDrive>,
    beside: Beside,
    broken: Vec<(String, Error)>,
}

impl Sorted {
    fn add(&mut self, file: &Named, logs: OfFile) {
        let path = file.path.display().to_string();
        match logs {
            Ok(logs) => {
                for log in logs {
                    match log {
                        Ok(drive) => self.drives.push(drive),
                        Err(error) => self.broken.push((path.clone(), error)),
                    }
                }
            }
            Err(error) if file.in_folder && error.is_no_log() => {
                let what_and_cure = without_path(&error, &path);
                let what = what_and_cure.split(';').next();
                let why = what.unwrap_or(&what_and_cure).to_owned();
                self.beside.left_out.push(NoLog { path, why });
            }
            Err(error) => self.broken.push((path, error)),
        }
    }

    fn collection(mut self, skip_broken: bool) -> Result<Collection, Error> {
        if self.broken.is_empty() && self.drives.is_empty() {
            return Err(Error::OnlyOtherFiles {
                left_out: self.beside.left_out,
            });
        }
        if !self.broken.is_empty() && (self.drives.is_empty() || !skip_broken) {
            return Err(Error::Unusable {
                usable: self.drives.len(),
                left_out: self.beside.left_out,
                broken: self.broken.into_iter().map(|(_, error)| error).collect(),
            });
        }
        let skipped = self.broken.into_iter().map(|(path, error)| Skipped {
            error: without_path(&error, &path),
            path,
        });
        self.beside.skipped = skipped.collect();
        Ok(Collection {
            drives: self.drives,
            beside: self.beside,
        })
    }
}

/// What is wrong, where the path is said already.
fn without_path(error: &Error, path: &str) -> String {
    let text = error.to_string();
    let rest = [format!("{path}: "), format!("`{path}`: ")]
        .iter()
        .find_map(|prefix| text.strip_prefix(prefix).map(str::to_owned));
    rest.unwrap_or(text)
}

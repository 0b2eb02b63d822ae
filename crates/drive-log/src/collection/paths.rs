//! From arguments to files: each once, in their order.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use super::folders::{files_below, is_hidden};
use super::repeated::Repeated;
use crate::Error;
use crate::error::NoLog;

const LOG_SUFFIXES: [&str; 4] = ["csv", "tsv", "txt", "parquet"];
const COMPRESSION_SUFFIXES: [&str; 2] = ["gz", "zst"];

/// A file to read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Named {
    pub(super) path: PathBuf,
    /// Found in a folder, not named itself.
    pub(super) in_folder: bool,
}

/// What the arguments stand for.
#[derive(Debug, Default)]
pub(super) struct Expanded {
    pub(super) files: Vec<Named>,
    pub(super) left_out: Vec<NoLog>,
    pub(super) twice: Vec<Repeated>,
}

/// Files stay in the order given; a folder's and a glob's come sorted by name. `./a` and `a` are one file, as are a link
/// and what it leads to.
pub(super) fn expand(arguments: &[PathBuf]) -> Result<Expanded, Error> {
    let mut found = Expanded::default();
    for argument in arguments {
        let path = tidy(argument);
        if path.is_dir() {
            found.add_folder(&path)?;
        } else if argument == Path::new("-") || argument.exists() {
            found.files.push(Named {
                path,
                in_folder: false,
            });
        } else {
            let files = matching(argument)?.into_iter();
            found.files.extend(files.map(|path| Named {
                path: tidy(&path),
                in_folder: false,
            }));
        }
    }
    found.keep_each_once();
    Ok(found)
}

/// A path without `.`, as far as it can be told without the disk: `./a//b/` is `a/b`.
fn tidy(path: &Path) -> PathBuf {
    let tidy: PathBuf = path
        .components()
        .filter(|component| *component != Component::CurDir)
        .collect();
    if tidy.as_os_str().is_empty() {
        return PathBuf::from(".");
    }
    tidy
}

impl Expanded {
    fn add_folder(&mut self, folder: &Path) -> Result<(), Error> {
        let files = files_below(folder)?;
        let (logs, others): (Vec<PathBuf>, Vec<PathBuf>) = files
            .iter()
            .map(|path| tidy(path))
            .partition(|path| may_be_a_log(path));
        if logs.is_empty() {
            return Err(Error::NoLogsInFolder {
                folder: folder.to_owned(),
                suffixes: LOG_SUFFIXES.join(", ."),
            });
        }
        self.left_out.extend(others.iter().map(|path| {
            NoLog {
                path: path.display().to_string(),
                why: if path.is_file() {
                    "not by the name of a log"
                } else {
                    "not a file"
                }
                .to_owned(),
            }
        }));
        self.files.extend(logs.into_iter().map(|path| Named {
            path,
            in_folder: true,
        }));
        Ok(())
    }

    fn keep_each_once(&mut self) {
        let mut first: BTreeMap<PathBuf, String> = BTreeMap::new();
        let twice = &mut self.twice;
        self.files.retain(|file| {
            let shown = file.path.display().to_string();
            let itself = file.path.canonicalize().unwrap_or(file.path.clone());
            match first.get(&itself) {
                None => {
                    first.insert(itself, shown);
                    true
                }
                Some(known) => {
                    twice.push(Repeated::file(shown, known.clone()));
                    false
                }
            }
        });
    }
}

fn may_be_a_log(path: &Path) -> bool {
    let suffix = |path: &Path| {
        path.extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default()
    };
    if is_hidden(path) || !path.is_file() {
        return false;
    }
    let last = suffix(path);
    if COMPRESSION_SUFFIXES.contains(&last.as_str()) {
        let stem = path.file_stem().map(Path::new);
        return stem.is_some_and(|stem| LOG_SUFFIXES.contains(&suffix(stem).as_str()));
    }
    LOG_SUFFIXES.contains(&last.as_str())
}

fn matching(pattern: &Path) -> Result<Vec<PathBuf>, Error> {
    let text = pattern.to_string_lossy();
    let mut paths = Vec::new();
    let no_glob = |problem: glob::PatternError| Error::Glob {
        pattern: text.clone().into_owned(),
        problem: problem.to_string(),
    };
    for path in glob::glob(&text).map_err(no_glob)? {
        let path = path.map_err(|error| Error::List {
            folder: error.path().to_owned(),
            problem: error.into(),
        })?;
        if path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(Error::NoMatch {
            pattern: text.into_owned(),
        });
    }
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_one_however_it_is_written() {
        for (path, same) in [
            ("./a", "a"),
            ("a/./b//c/", "a/b/c"),
            ("/x/./y", "/x/y"),
            ("../a", "../a"),
            (".", "."),
            ("./", "."),
            ("-", "-"),
        ] {
            assert_eq!(tidy(Path::new(path)).to_str(), Some(same));
        }
    }
}

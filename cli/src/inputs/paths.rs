//! From arguments to files: each once, in their order.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context as _, bail};

use super::{LeftOut, Twice};
use crate::folders::{files_below, is_hidden};

pub(super) const LOG_SUFFIXES: [&str; 4] = ["csv", "tsv", "txt", "parquet"];
const COMPRESSION_SUFFIXES: [&str; 2] = ["gz", "zst"];

/// A file to read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Named {
    pub(super) path: PathBuf,
    /// The folder in which it was found; `None` where it was named itself.
    pub(super) folder: Option<PathBuf>,
}

/// What the arguments stand for.
#[derive(Debug, Default)]
pub(super) struct Expanded {
    pub(super) files: Vec<Named>,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) twice: Vec<Twice>,
}

/// Files stay in the order given; a folder's and a glob's come sorted by name. `./a` and `a` are one file, as are a link
/// and what it leads to.
pub(super) fn expand(arguments: &[PathBuf]) -> anyhow::Result<Expanded> {
    let mut found = Expanded::default();
    for argument in arguments {
        let path = tidy(argument);
        if path.is_dir() {
            found.add_folder(&path)?;
        } else if argument == Path::new("-") || argument.exists() {
            found.files.push(Named { path, folder: None });
        } else {
            let files = matching(argument)?.into_iter();
            found.files.extend(files.map(|path| Named {
                path: tidy(&path),
                folder: None,
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
    fn add_folder(&mut self, folder: &Path) -> anyhow::Result<()> {
        let files = files_below(folder)?;
        let (logs, others): (Vec<PathBuf>, Vec<PathBuf>) = files
            .iter()
            .map(|path| tidy(path))
            .partition(|path| may_be_a_log(path));
        if logs.is_empty() {
            bail!(
                "no logs in the folder `{}`; looked to the bottom for files ending in .{}, also with .gz or .zst",
                folder.display(),
                LOG_SUFFIXES.join(", .")
            );
        }
        self.left_out.extend(others.iter().map(|path| {
            LeftOut {
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
            folder: Some(folder.to_owned()),
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
                    twice.push(Twice::file(shown, known.clone()));
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

fn matching(pattern: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let text = pattern.to_string_lossy();
    let mut paths = Vec::new();
    for path in
        glob::glob(&text).with_context(|| format!("`{text}` is neither a file nor a glob"))?
    {
        let path = path?;
        if path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        bail!("no such file, folder or match: `{text}`");
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

//! Folders searched to the bottom.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::Error;

/// What lies below a folder, sorted by path. Each folder is entered once, whatever links lead to it, and by a link only
/// where nothing else leads there; hidden folders are not entered.
///
/// # Errors
/// [`Error::List`] for a folder that cannot be listed.
pub fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut search = Search::default();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        folders.extend(search.enter(&folder)?);
        if folders.is_empty() {
            folders.extend(search.links.pop_first());
        }
    }
    search.files.sort();
    Ok(search.files)
}

#[derive(Default)]
struct Search {
    /// Folders that were entered, by their true paths.
    entered: BTreeSet<PathBuf>,
    /// Links to folders, which wait until there is nothing else.
    links: BTreeSet<PathBuf>,
    files: Vec<PathBuf>,
}

impl Search {
    /// The folders in a folder.
    fn enter(&mut self, folder: &Path) -> Result<Vec<PathBuf>, Error> {
        let failed = |problem| Error::List {
            folder: folder.to_owned(),
            problem,
        };
        let mut folders = Vec::new();
        if !self.entered.insert(folder.canonicalize().map_err(failed)?) {
            return Ok(folders);
        }
        for entry in folder.read_dir().map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if !path.is_dir() {
                self.files.push(path);
            } else if path.is_symlink() {
                self.links.insert(path);
            } else if !is_hidden(&path) {
                folders.push(path);
            }
        }
        Ok(folders)
    }
}

/// Whether a name starts with a point, as those of programs do.
pub(super) fn is_hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

#[cfg(all(test, unix))]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fs;
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn each_folder_is_entered_once_and_by_its_own_name() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir_all(root.join("z/deep/er")).unwrap();
        fs::create_dir_all(root.join(".git")).unwrap();
        for file in ["z/deep/er/a", "z/b", "c", ".git/d"] {
            fs::write(root.join(file), "").unwrap();
        }
        symlink(root, root.join("z/deep/back")).unwrap();
        symlink(root.join("z"), root.join("a link")).unwrap();
        let found = files_below(root).unwrap();
        let names: Vec<_> = found
            .iter()
            .map(|path| path.strip_prefix(root).unwrap().to_str().unwrap())
            .collect();
        assert_eq!(names, ["c", "z/b", "z/deep/er/a"]);
    }

    #[test]
    fn a_folder_behind_a_link_is_searched() {
        let folder = tempfile::tempdir().unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        fs::write(elsewhere.path().join("a"), "").unwrap();
        symlink(elsewhere.path(), folder.path().join("link")).unwrap();
        let found = files_below(folder.path()).unwrap();
        assert_eq!(found, [folder.path().join("link/a")]);
    }
}

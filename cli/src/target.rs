//! Where a path that is written to leads.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::bail;

pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Links in a row that are followed.
const MOST_LINKS: usize = 40;

/// The end of a chain of links, whether or not there is a file.
pub(crate) fn resolved(path: &Path) -> anyhow::Result<PathBuf> {
    let mut end = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&end) {
            Ok(target) => end = folder_of(&end).join(target),
            Err(_) => return Ok(end),
        }
    }
    bail!(
        "cannot write `{}`: its links lead to no file",
        path.display()
    )
}

/// Whether a path is written to as it stands: a device, a pipe, or what the shell has opened already.
pub(crate) fn is_stream(path: &Path) -> bool {
    let is_opened = ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"]
        .iter()
        .any(|opened| path.starts_with(opened));
    is_opened || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

//! Files that are no logs of drives, such as scenarios, as documents list them.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::Serialize;

use drive_log::collection::files_below;

/// Scenarios, paths, links, run logs and poses.
#[derive(Debug, Default)]
pub(crate) struct FileInputs(Vec<FileInput>);

/// One of them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FileInput {
    path: String,
    sha256: String,
}

impl FileInputs {
    /// Of files, and of folders all that is in them.
    pub(crate) fn read(paths: impl IntoIterator<Item = PathBuf>) -> anyhow::Result<Self> {
        let mut inputs = Vec::new();
        for path in paths {
            if path.is_dir() {
                for file in files_below(&path)? {
                    inputs.push(FileInput::read(&file)?);
                }
            } else {
                inputs.push(FileInput::read(&path)?);
            }
        }
        Ok(Self(inputs))
    }

    pub(crate) fn entries(&self) -> &[FileInput] {
        &self.0
    }
}

impl FileInput {
    fn read(path: &Path) -> anyhow::Result<Self> {
        let bytes =
            std::fs::read(path).with_context(|| format!("cannot read `{}`", path.display()))?;
        Ok(Self {
            path: path.display().to_string(),
            sha256: drive_log::sha256(&bytes),
        })
    }
}

//! Files and drives that were there already.

use std::fmt;

use serde::Serialize;

use super::sourced_drive::SourcedDrive;
use crate::Kinship;

/// A file or drive that is left out, since another is the same or holds it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Repeated {
    path: String,
    /// The drive, where it is not the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    same_as: String,
    why: SameBy,
}

/// SameBy two files or drives are one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SameBy {
    /// One file by two paths.
    SameFile,
    /// Byte for byte.
    SameBytes,
    /// Second by second.
    SameSpeed,
    /// Of a longer drive.
    PartOf,
    /// A model has learnt from it already.
    Learnt,
}

impl fmt::Display for Repeated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, other) = (&self.path, &self.same_as);
        match self.why {
            _ if path == other => write!(f, "`{path}` is named again, counted once"),
            SameBy::SameFile => write!(f, "`{path}` is the file `{other}`, counted once"),
            SameBy::SameBytes => write!(f, "`{path}` is a copy of `{other}`, counted once"),
            SameBy::SameSpeed => write!(
                f,
                "`{path}` is the same drive as `{other}`, second by second, counted once"
            ),
            SameBy::Learnt => write!(
                f,
                "`{path}` is left out, `{other}` has learnt from it already"
            ),
            SameBy::PartOf => write!(f, "`{path}` is a part of the drive `{other}`, counted once"),
        }
    }
}

impl Repeated {
    pub(super) fn file(path: String, same_as: String) -> Self {
        Self {
            path,
            name: None,
            same_as,
            why: SameBy::SameFile,
        }
    }

    pub(super) fn learnt(input: &SourcedDrive, model: &str) -> Self {
        Self {
            path: input.place(),
            name: Some(input.drive.name.clone()),
            same_as: model.to_owned(),
            why: SameBy::Learnt,
        }
    }

    pub(super) fn drive(input: &SourcedDrive, of: &SourcedDrive, why: SameBy) -> Self {
        Self {
            path: input.place(),
            name: Some(input.drive.name.clone()),
            same_as: of.place(),
            why,
        }
    }
}

impl From<Kinship> for SameBy {
    fn from(kinship: Kinship) -> Self {
        match kinship {
            Kinship::Same => Self::SameSpeed,
            Kinship::PartOf | Kinship::Holds => Self::PartOf,
        }
    }
}

//! Files beside logs.

use serde::Serialize;

/// A file of a folder that is no log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NoLog {
    /// The file.
    pub path: String,
    /// What it is instead, in words.
    pub why: String,
}

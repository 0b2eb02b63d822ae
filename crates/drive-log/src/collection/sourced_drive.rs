//! A drive with the file that it comes from.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{Drive, Finding};

/// A prepared drive with where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct SourcedDrive {
    /// The file, as it was named.
    pub path: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Layout that the file was read with.
    pub layout: String,
    /// The drive.
    pub drive: Drive,
}

/// A drive as a document lists it.
#[derive(Debug, Serialize)]
pub struct DriveEntry<'a> {
    path: &'a str,
    name: &'a str,
    sha256: &'a str,
    layout: &'a str,
    /// Trip, vehicle and driver, where the file says them, by header.
    origin: &'a BTreeMap<String, String>,
    samples: usize,
    step_s: f64,
    findings: &'a [Finding],
}

impl SourcedDrive {
    /// As a document lists it.
    #[must_use]
    pub fn entry(&self) -> DriveEntry<'_> {
        DriveEntry {
            path: &self.path,
            name: &self.drive.name,
            sha256: &self.sha256,
            layout: &self.layout,
            origin: &self.drive.origin,
            samples: self.drive.samples,
            step_s: self.drive.step_s,
            findings: &self.drive.findings,
        }
    }

    /// Which of the logs of its file it is, where there are several.
    fn part(&self) -> Option<&str> {
        self.drive.name.split_once('#').map(|(_, part)| part)
    }

    /// The file, with the log where there are several: `a/day.csv#trip=3`.
    #[must_use]
    pub fn place(&self) -> String {
        match self.part() {
            Some(part) => format!("{}#{part}", self.path),
            None => self.path.clone(),
        }
    }

    /// The same for messages.
    #[must_use]
    pub fn label(&self) -> String {
        match self.part() {
            Some(part) => format!("`{}`, {part}", self.path),
            None => format!("`{}`", self.path),
        }
    }
}

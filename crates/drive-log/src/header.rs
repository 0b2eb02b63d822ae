//! How a table begins: its form and its headers.

use std::path::Path;

use crate::Error;

/// How a text file is laid out; what is `None` is sniffed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Form {
    pub(crate) delimiter: Option<u8>,
    pub(crate) decimal_comma: Option<bool>,
    pub(crate) skip_lines: usize,
    pub(crate) no_header: bool,
}

/// What stands before the data.
#[derive(Debug, Clone, Default)]
pub(crate) struct Head {
    /// Lines before the header.
    pub(crate) preamble: Vec<String>,
    /// One per column; numbers where the file has no header.
    pub(crate) headers: Vec<String>,
    pub(crate) has_header: bool,
    /// Line of the header, from 1.
    pub(crate) line: usize,
}

impl Head {
    /// The headers for a message: quoted, the first twenty.
    pub(crate) fn listed(&self) -> String {
        list(&self.headers)
    }
}

/// Headers for a message: quoted, the first twenty, cut at sixty characters.
pub(crate) fn list(headers: &[String]) -> String {
    let mut text: Vec<String> = headers
        .iter()
        .take(20)
        .map(|h| format!("{:?}", h.chars().take(60).collect::<String>()))
        .collect();
    if headers.len() > 20 {
        text.push(format!("… ({} in all)", headers.len()));
    }
    text.join(", ")
}

/// A header without case, blanks and brackets, as real ones are dirty: `max. SoC [%)`.
pub(crate) fn normalised(header: &str) -> String {
    header
        .chars()
        .filter(|c| !c.is_whitespace() && !"[](){}<>\"".contains(*c))
        .flat_map(char::to_lowercase)
        .collect()
}

/// Headers of a speed that do not say its unit.
const SPEEDS: [&str; 10] = [
    "speed",
    "velocity",
    "vel",
    "gpsspeed",
    "gps_speed",
    "vehiclespeed",
    "vehicle_speed",
    "speed_obd",
    "speed_gps",
    "obd_speed",
];

/// The error where a header names a speed without its unit, which no layout guesses.
pub(crate) fn speed_without_unit(path: &Path, headers: &[String]) -> Option<Error> {
    let names_speed = |h: &&String| SPEEDS.contains(&normalised(h).as_str());
    let header = headers.iter().find(names_speed)?;
    Some(Error::UnstatedUnit {
        path: path.to_owned(),
        header: header.clone(),
    })
}

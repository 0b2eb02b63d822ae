//! Run logs: a table of named columns with one text of metadata, in three formats.
//!
//! | format  | for | metadata | NaN | infinities | cut short |
//! |---------|-----|----------|-----|------------|-----------|
//! | CSV     | reading by eye and anywhere | column `about` | empty | `inf`, `-inf` | whole lines |
//! | Parquet | notebooks | key `drivekit` of the footer | null | kept | nothing |
//! | MCAP    | Foxglove, robot tools | record `drivekit` | left out | `"inf"`, `"-inf"`, apart | whole chunks |
//!
//! What is written reads back to the same bits, except the payload of NaNs.
//! A CSV file marks its last row, so that a cut between two lines is known too; one that is written while the run goes on does not.
//! Damage is found by checks, and told apart from a cut.

mod check;
mod csv;
mod csv_old;
mod journal;
mod mcap;
mod mcap_read;
mod parquet;
mod records;

use std::collections::HashSet;
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::Error;

pub use journal::Journal;
pub use parquet_table::{Column, Values};

/// The most that is read into memory, in bytes, as a file and after decompression.
const MAX_BYTES: u64 = 1 << 30;
const MAX_COLUMNS: usize = 10_000;
const DAMAGED: &str = "copy the file again, or log the run again";

/// Which type of values a column has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Float,
    Integer,
    Text,
}

impl Kind {
    fn of(values: &Values) -> Kind {
        match values {
            Values::Float(_) => Kind::Float,
            Values::Integer(_) => Kind::Integer,
            Values::Text(_) => Kind::Text,
        }
    }

    fn column(self, name: String) -> Column {
        let values = match self {
            Kind::Float => Values::Float(Vec::new()),
            Kind::Integer => Values::Integer(Vec::new()),
            Kind::Text => Values::Text(Vec::new()),
        };
        Column { name, values }
    }
}

/// A table of columns of the same length, with metadata.
#[derive(Debug, Clone, PartialEq)]
pub struct LogTable {
    meta: String,
    columns: Vec<Column>,
    truncated: bool,
    states_its_end: bool,
}

impl LogTable {
    /// Makes a table. `meta` is JSON: the scenario and configuration that made the run; line breaks
    /// in it become blanks.
    ///
    /// # Errors
    ///
    /// [`Error::Table`] if `meta` is not JSON, a name is empty, begins with a byte order mark or appears twice, the columns differ
    /// in length, or there are more than 10,000 of them.
    pub fn new(meta: &str, columns: Vec<Column>) -> Result<LogTable, Error> {
        let problem = |problem: String| Err(Error::Table { problem });
        if let Err(error) = serde_json::from_str::<serde::de::IgnoredAny>(meta) {
            return problem(format!("the metadata is not JSON: {error}"));
        }
        if columns.len() > MAX_COLUMNS {
            let count = columns.len();
            return problem(format!("{count} columns, at most {MAX_COLUMNS} are logged"));
        }
        let mut names = HashSet::new();
        for column in &columns {
            let name = &column.name;
            if name.is_empty() {
                return problem("a column without a name; name every column".to_owned());
            }
            if name.starts_with('\u{feff}') {
                return problem(format!("column {name:?} begins with a byte order mark"));
            }
            if !names.insert(name) {
                return problem(format!("two columns {name:?}; give each its own name"));
            }
            let (len, first) = (column.values.len(), columns[0].values.len());
            if len != first {
                return problem(format!(
                    "column {name:?} has {len} values and the first column {first}; \
                     give every column one value per row"
                ));
            }
        }
        Ok(LogTable {
            meta: meta.replace(['\r', '\n'], " "),
            columns,
            truncated: false,
            states_its_end: true,
        })
    }

    /// The metadata, JSON on one line.
    #[must_use]
    pub fn meta(&self) -> &str {
        &self.meta
    }

    /// The columns, in the order of the file.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Takes the columns out.
    #[must_use]
    pub fn into_columns(self) -> Vec<Column> {
        self.columns
    }

    /// The values of the column with this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        let column = self.columns.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether the end of the file was missing, so that rows may be missing here.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.truncated
    }

    /// Whether the file says where it ends. CSV files of before and those of sessions that go on or were killed do not.
    #[must_use]
    pub fn states_its_end(&self) -> bool {
        self.states_its_end
    }
}

/// A format of run logs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogFormat {
    /// Comma-separated values, a line with the names and a line per row
    Csv,
    /// Apache Parquet
    Parquet,
    /// MCAP, a container for the messages of robots
    Mcap,
}

impl LogFormat {
    /// The format by the extension, in any case.
    ///
    /// # Errors
    ///
    /// [`Error::LogFormat`] if it is none of `.csv`, `.parquet` and `.mcap`.
    pub fn from_path(path: &Path) -> Result<LogFormat, Error> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("csv") => Ok(LogFormat::Csv),
            Some("parquet") => Ok(LogFormat::Parquet),
            Some("mcap") => Ok(LogFormat::Mcap),
            _ => Err(Error::LogFormat {
                path: path.to_owned(),
            }),
        }
    }
}

/// Writes a run log. Infinities and the sign of zero survive in every format.
///
/// MCAP needs the integer columns `tick` (from 0) and `robot` and the float column `time_s` (from
/// 0), which become the sequence, the topic and the time of the messages; a float column `unix_time_s` makes the times those of
/// the wall clock. With the float columns `pose_x_m`, `pose_y_m` and `pose_heading_rad` each robot also gets a topic of measured
/// poses, and with `true_x_m`, `true_y_m` and `true_heading_rad` one of true places.
///
/// # Errors
///
/// [`Error::Write`] if `out` takes no more, [`Error::Table`] for MCAP without these columns or with
/// a time that is not one.
pub fn write(table: &LogTable, format: LogFormat, out: &mut dyn Write) -> Result<(), Error> {
    match format {
        LogFormat::Csv => csv::write(table, out).map_err(|source| Error::Write { source }),
        LogFormat::Parquet => parquet::write(table, out).map_err(|source| Error::Write { source }),
        LogFormat::Mcap => mcap::write(table, out),
    }
}

/// Reads a run log, in the format that its extension names.
///
/// # Errors
///
/// [`Error::LogFormat`], [`Error::Read`], [`Error::TooLarge`] above 1 GiB, and those of
/// [`read_bytes`].
pub fn read(path: &Path) -> Result<LogTable, Error> {
    let format = LogFormat::from_path(path)?;
    let bytes = file_bytes(path)?;
    read_named(path, &bytes, format)
}

/// Reads a run log from memory.
///
/// # Errors
///
/// [`Error::Content`] if it is not a run log, or one that is damaged. One that was only cut off is read as far as it is whole.
pub fn read_bytes(bytes: &[u8], format: LogFormat) -> Result<LogTable, Error> {
    read_named(Path::new("run log"), bytes, format)
}

pub(crate) fn file_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    let failed = |source| Error::Read {
        path: path.to_owned(),
        source,
    };
    if std::fs::metadata(path).map_err(failed)?.len() > MAX_BYTES {
        return Err(Error::TooLarge {
            path: path.to_owned(),
            limit_bytes: MAX_BYTES,
        });
    }
    std::fs::read(path).map_err(failed)
}

fn read_named(path: &Path, bytes: &[u8], format: LogFormat) -> Result<LogTable, Error> {
    let table = match format {
        LogFormat::Csv => csv::read(bytes),
        LogFormat::Parquet => parquet::read(bytes),
        LogFormat::Mcap => mcap_read::read(bytes),
    };
    table.map_err(|flaw| Error::Content {
        path: path.to_owned(),
        place: flaw.place,
        found: flaw.found,
        help: flaw.help.to_owned(),
    })
}

/// What is wrong with a file.
struct Flaw {
    place: String,
    found: String,
    help: &'static str,
}

impl Flaw {
    /// Of the file as a whole.
    fn new(found: impl Into<String>, help: &'static str) -> Flaw {
        Flaw {
            place: String::new(),
            found: found.into(),
            help,
        }
    }

    fn at(place: String, found: impl Into<String>, help: &'static str) -> Flaw {
        Flaw {
            place,
            ..Flaw::new(found, help)
        }
    }

    fn too_large() -> Flaw {
        Flaw::new(
            format!("more than {MAX_BYTES} bytes of values"),
            "split the run log",
        )
    }
}

/// The table of a file.
fn table(meta: &str, columns: Vec<Column>, truncated: bool) -> Result<LogTable, Flaw> {
    match LogTable::new(meta, columns) {
        Ok(table) => Ok(LogTable { truncated, ..table }),
        Err(error) => Err(Flaw::new(error.to_string(), DAMAGED)),
    }
}

/// The beginning of a text from a file, for messages.
fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

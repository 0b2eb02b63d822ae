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
mod flaw;
mod journal;
mod kind;
mod limits;
mod mcap;
mod mcap_read;
mod parquet;
mod records;
mod table;

use std::io::Write;
use std::path::Path;

use crate::Error;

pub use journal::Journal;
use limits::MAX_BYTES;
pub use parquet_table::{Column, Values};
pub use table::LogTable;

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

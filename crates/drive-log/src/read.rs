//! From a file to its logs.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::head::{PARQUET, names_a_speed};
use crate::header::{Form, Head, speed_without_unit};
use crate::layout::{Layout, LayoutChoice};
use crate::lines::{checked_text, with_line_feeds};
use crate::note::Note;
use crate::plan::Plan;
use crate::source::Source;
use crate::text::Table;
use crate::tidy::tidied;
use crate::{Channel, Error, RawLog, agreement, assemble, compressed, parquet, text};

/// What was read from a file.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct LogFile {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of its bytes as they are on disk, hexadecimal.
    pub sha256: String,
    /// Name of the layout it was read with.
    pub layout: String,
    /// Its logs, at least one: a file may hold the cars of a platoon, or several cycles.
    pub logs: Vec<RawLog>,
}

/// Reads a file: CSV with any of `, ; tab space` as delimiter and a decimal comma or point, in
/// UTF-8 or Latin-1, or Parquet; each as it is, or compressed with gzip or zstd.
///
/// # Errors
/// [`Error::Read`] if the file cannot be read, else those of [`read_from`].
pub fn read_file(path: &Path, layout: &LayoutChoice) -> Result<LogFile, Error> {
    let failed = |problem| read_error(path, problem);
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.len() > compressed::LIMIT_BYTES {
        return Err(compressed::too_large(path, compressed::LIMIT_BYTES));
    }
    read_from(path, file, layout)
}

/// Reads what may have no end, a pipe for example, as [`read_file`] does; `path` is for names and messages only.
///
/// # Errors
/// [`Error::NotALog`] as soon as the first 64 KiB show that it is none, [`Error::TooLarge`] for more than 4 GiB,
/// [`Error::Read`] if reading fails, else those of [`read_bytes`].
pub fn read_from(path: &Path, input: impl Read, layout: &LayoutChoice) -> Result<LogFile, Error> {
    let failed = |problem| read_error(path, problem);
    let bytes = compressed::whole(path, input, compressed::LIMIT_BYTES, failed)?;
    read_bytes(path, &bytes, layout)
}

fn read_error(path: &Path, problem: std::io::Error) -> Error {
    Error::Read {
        path: path.to_owned(),
        problem,
    }
}

/// Reads the bytes of a file as [`read_file`] does; `path` is for names and messages only.
///
/// Empty cells, `NaN`, `NA`, `N/A`, `null`, `-` and the like, and infinities are missing values.
/// Columns that the layout does not use are not looked at, but for those that name a trip, a vehicle
/// or a driver: they divide the file into logs.
///
/// # Errors
/// An [`Error`] for whatever is not a log: it names the line, the column and what was found. Never
/// panics, whatever the bytes.
pub fn read_bytes(path: &Path, bytes: &[u8], layout: &LayoutChoice) -> Result<LogFile, Error> {
    with_source(path, bytes, layout, |opened| {
        let logs = assemble::logs(path, &opened.source, &opened.plan, opened.notes)?;
        if opened.layout_is_recognised {
            check_derivative(path, opened.source.head(), &opened.plan, &logs)?;
        }
        Ok(LogFile {
            path: path.to_owned(),
            sha256: sha256(bytes),
            layout: opened.layout.name().to_owned(),
            logs,
        })
    })
}

/// The value that any column of a file has throughout each of its logs, by the names of the logs. Logs in which it has several
/// values, or none, are not there. The header is compared without regard to case, blanks and brackets.
///
/// # Errors
/// Those of [`read_file`].
pub fn constants_of_column(
    path: &Path,
    layout: &LayoutChoice,
    header: &str,
) -> Result<BTreeMap<String, String>, Error> {
    let bytes = std::fs::read(path).map_err(|problem| read_error(path, problem))?;
    with_source(path, &bytes, layout, |opened| {
        let Opened { source, plan, .. } = &opened;
        assemble::constants(path, source, plan, header)
    })
}

/// A file whose columns are known.
struct Opened<'a> {
    layout: &'a Layout,
    layout_is_recognised: bool,
    plan: Plan,
    source: Source<'a>,
    notes: Vec<Note>,
}

fn with_source<T>(
    path: &Path,
    bytes: &[u8],
    layout: &LayoutChoice,
    read: impl FnOnce(Opened<'_>) -> Result<T, Error>,
) -> Result<T, Error> {
    let layouts = Layout::candidates(layout)?;
    let content = compressed::decompressed(path, bytes, compressed::LIMIT_BYTES)?;
    let text;
    let (layout, plan, source, notes) = if content.starts_with(PARQUET) {
        let file = parquet::File::open(path, &content)?;
        let layout = chosen(path, &layouts, &file.head)?;
        let plan = layout.plan(path, &file.head)?;
        (layout, plan, Source::Parquet(file), Vec::new())
    } else {
        text = with_line_feeds(checked_text(path, &content)?);
        let (layout, table) = recognised(path, &text, &layouts)?;
        let plan = layout.plan(path, &table.head)?;
        let (table, notes) = tidied(path, table, &plan)?;
        (layout, plan, Source::Text(table), notes)
    };
    read(Opened {
        layout,
        layout_is_recognised: layouts.len() > 1,
        plan,
        source,
        notes,
    })
}

/// SHA-256 in hexadecimal digits, by which documents name what was read.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The layout that claims the headers, or the only one there is.
fn chosen<'l>(path: &Path, layouts: &'l [Layout], head: &Head) -> Result<&'l Layout, Error> {
    match layouts {
        [layout] => Ok(layout),
        _ => layouts
            .iter()
            .find(|layout| layout.claims(head))
            .ok_or_else(|| unknown(path, head)),
    }
}

fn unknown(path: &Path, head: &Head) -> Error {
    if let Some(error) = speed_without_unit(path, &head.headers) {
        return error;
    }
    let found = if head.has_header {
        head.listed()
    } else {
        format!("none, {} columns of numbers", head.headers.len())
    };
    let names = |header: &String| names_a_speed(header);
    // words of a sentence, divided at its blanks
    let is_prose = |header: &String| header.ends_with([',', ':', ';']);
    Error::UnknownLayout {
        path: path.to_owned(),
        found,
        may_be_a_log: !head.has_header
            || head.headers.iter().any(names) && !head.headers.iter().any(is_prose),
    }
}

/// The layout of a text, and the text as a table. Layouts may differ in how much stands before the
/// header.
fn recognised<'l, 't>(
    path: &Path,
    text: &'t [u8],
    layouts: &'l [Layout],
) -> Result<(&'l Layout, Table<'t>), Error> {
    if let [layout] = layouts {
        return Ok((layout, text::table(path, text, layout.form())?));
    }
    for layout in layouts {
        // what fails here as one layout may be well as another, and only the text can tell whether
        // it has a header
        let form = Form {
            no_header: false,
            ..layout.form()
        };
        if let Ok(table) = text::table(path, text, form)
            && layout.claims(&table.head)
        {
            return Ok((layout, table));
        }
    }
    let table = text::table(path, text, Form::default())?;
    Err(unknown(path, &table.head))
}

/// Columns that nobody named a speed and an acceleration are checked against each other: three
/// without a header must be just that, and `v` and `a` must not be volts and amps.
fn check_derivative(path: &Path, head: &Head, plan: &Plan, logs: &[RawLog]) -> Result<(), Error> {
    let columns = plan.logs.first().map_or(&[][..], |log| &log.columns);
    let column = |channel| columns.iter().find(|c| c.channel == channel);
    let (Some(speed), Some(accel)) = (column(Channel::Speed), column(Channel::Accel)) else {
        return Ok(());
    };
    let named = |column: usize, name| head.headers[column].trim() == name;
    let short = named(speed.column, "v") && named(accel.column, "a");
    if head.has_header && !short {
        return Ok(());
    }
    for log in logs {
        let [v, a] = [Channel::Speed, Channel::Accel].map(|c| log.channel(c).unwrap_or_default());
        let agreement = agreement::of_speed_and_accel(log.time_s(), v, a);
        let fails = match agreement {
            None => !head.has_header,
            Some(found) if head.has_header => found.is_excluded(),
            Some(found) => !found.holds(),
        };
        if fails {
            return Err(Error::NoDerivative {
                path: path.to_owned(),
                speed: head.headers[speed.column].clone(),
                accel: head.headers[accel.column].clone(),
                unit: speed.unit.to_string(),
                found: agreement.map_or_else(
                    || "too few samples, or too little motion, to tell".to_owned(),
                    |found| found.to_string(),
                ),
            });
        }
    }
    Ok(())
}

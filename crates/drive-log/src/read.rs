//! From a file to its logs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::layout::{Form, Head, Layout, LayoutChoice, LogPlan, Plan, TimeColumns};
use crate::text::Table;
use crate::{Action, Error, Finding, FindingKind, RawLog, body, clock, compressed, parquet, text};

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
/// [`Error::Read`] if the file cannot be read, else those of [`read_bytes`].
pub fn read_file(path: &Path, layout: &LayoutChoice) -> Result<LogFile, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    read_bytes(path, &bytes, layout)
}

/// Reads the bytes of a file as [`read_file`] does; `path` is for names and messages only.
///
/// Empty cells, `NaN`, `NA`, `N/A`, `null`, `-` and infinities are missing values. Columns that the
/// layout does not use are not looked at.
///
/// # Errors
/// An [`Error`] for whatever is not a log: it names the line, the column and what was found. Never
/// panics, whatever the bytes.
pub fn read_bytes(path: &Path, bytes: &[u8], layout: &LayoutChoice) -> Result<LogFile, Error> {
    let layouts = Layout::candidates(layout)?;
    let content = compressed::decompressed(path, bytes, compressed::LIMIT_BYTES)?;
    let (layout, logs) = if content.starts_with(parquet::MAGIC) {
        let file = parquet::File::open(path, &content)?;
        let layout = chosen(path, &layouts, &file.head)?;
        let plan = layout.plan(path, &file.head)?;
        (
            layout.name().to_owned(),
            logs(path, &Source::Parquet(&file), &plan)?,
        )
    } else {
        let text = text::checked_text(path, &content)?;
        let (layout, table) = recognised(path, text, &layouts)?;
        let plan = layout.plan(path, &table.head)?;
        (
            layout.name().to_owned(),
            logs(path, &Source::Text(&table), &plan)?,
        )
    };
    let sha256 = Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    Ok(LogFile {
        path: path.to_owned(),
        sha256,
        layout,
        logs,
    })
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
    let found = if head.has_header {
        head.listed()
    } else {
        format!("none, {} columns of numbers", head.headers.len())
    };
    Error::UnknownLayout {
        path: path.to_owned(),
        found,
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

/// Where columns come from.
enum Source<'a> {
    Text(&'a Table<'a>),
    Parquet(&'a parquet::File<'a>),
}

impl Source<'_> {
    fn numbers(&self, path: &Path, columns: &[usize]) -> Result<Vec<Vec<f64>>, Error> {
        match self {
            Source::Text(table) => body::numbers(path, table, columns),
            Source::Parquet(file) => file.numbers(columns),
        }
    }

    fn headers(&self) -> &[String] {
        match self {
            Source::Text(table) => &table.head.headers,
            Source::Parquet(file) => &file.head.headers,
        }
    }

    /// The finding that the file ends in the middle of a row.
    fn cut_off(&self, time_s: &[f64]) -> Option<Finding> {
        let last_s = *time_s.last()?;
        let cut_off = matches!(self, Source::Text(table) if table.cut_off);
        cut_off.then(|| {
            let detail = "the file ends in the middle of the row after this one".to_owned();
            Finding::of_time(
                FindingKind::CutOff,
                (last_s, last_s),
                Action::Dropped,
                detail,
            )
        })
    }

    /// Time of each row in s, and what had to be repaired for it.
    fn time_s(
        &self,
        path: &Path,
        columns: TimeColumns,
        first: Vec<f64>,
    ) -> Result<(Vec<f64>, Option<Finding>), Error> {
        match (columns, self) {
            (TimeColumns::Number { unit, .. }, _) => {
                let mut time_s = first;
                unit.convert(&mut time_s, 1.0);
                Ok((time_s, None))
            }
            (TimeColumns::DateAndClock { date, clock }, Source::Text(table)) => {
                let headers = (
                    self.headers()[date].as_str(),
                    self.headers()[clock].as_str(),
                );
                let dates = body::texts(path, table, date)?;
                clock::seconds(path, headers, &dates, &body::texts(path, table, clock)?)
            }
            (TimeColumns::DateAndClock { date, .. }, Source::Parquet(_)) => {
                Err(Error::ColumnType {
                    path: path.to_owned(),
                    header: self.headers()[date].clone(),
                    found: "a date as text".to_owned(),
                })
            }
        }
    }
}

/// Carries out a plan: reads every column once and builds the logs from them.
fn logs(path: &Path, source: &Source<'_>, plan: &Plan) -> Result<Vec<RawLog>, Error> {
    let mut columns: Vec<usize> = plan
        .logs
        .iter()
        .flat_map(|log| &log.columns)
        .map(|c| c.column)
        .collect();
    let time_column = match plan.time {
        TimeColumns::Number { column, .. } => Some(column),
        TimeColumns::DateAndClock { .. } => None,
    };
    columns.extend(time_column);
    columns.sort_unstable();
    columns.dedup();
    let values: BTreeMap<usize, Vec<f64>> = columns
        .iter()
        .copied()
        .zip(source.numbers(path, &columns)?)
        .collect();
    let first = time_column
        .and_then(|column| values.get(&column).cloned())
        .unwrap_or_default();
    let (time_s, repaired) = source.time_s(path, plan.time, first)?;
    check_direction(
        path,
        time_column.map_or("", |c| &source.headers()[c]),
        &time_s,
    )?;

    let mut logs = Vec::new();
    for log in &plan.logs {
        // a car that was not there, a cycle of another file; all of them is an error below
        match raw_log(path, &time_s, &values, log) {
            Err(Error::NoSpeed { .. }) => {}
            log => logs.push(log?),
        }
    }
    for log in &mut logs {
        log.findings.extend(repaired.clone());
        log.findings.extend(source.cut_off(log.time_s()));
    }
    if logs.is_empty() {
        return Err(Error::NoSpeed {
            log: path.display().to_string(),
            channel: crate::Channel::Speed.name(),
            samples: time_s.len(),
        });
    }
    Ok(logs)
}

fn raw_log(
    path: &Path,
    time_s: &[f64],
    values: &BTreeMap<usize, Vec<f64>>,
    plan: &LogPlan,
) -> Result<RawLog, Error> {
    let mut channels = BTreeMap::new();
    let mut len = 0;
    for column in &plan.columns {
        let mut si = values.get(&column.column).cloned().unwrap_or_default();
        column.unit.convert(&mut si, column.sign);
        len = len.max(
            si.iter()
                .rposition(|v| !v.is_nan())
                .map_or(0, |last| last + 1),
        );
        channels.insert(column.channel, si);
    }
    if plan.part.is_none() {
        len = time_s.len();
    }
    // where a file holds several logs, one may end before the others
    channels
        .values_mut()
        .for_each(|values| values.truncate(len));
    let name = plan
        .part
        .as_ref()
        .map_or_else(|| stem(path), |part| format!("{}#{part}", stem(path)));
    RawLog::new(name, time_s[..len].to_vec(), channels)
}

/// Most of the steps backward: sorting would make a drive of what is none.
fn check_direction(path: &Path, header: &str, time_s: &[f64]) -> Result<(), Error> {
    let backward: Vec<f64> = time_s
        .windows(2)
        .filter(|pair| pair[1] < pair[0])
        .map(|pair| pair[1])
        .collect();
    match backward.first() {
        Some(&at_s) if 2 * backward.len() > time_s.len() - 1 => Err(Error::BackwardTime {
            path: path.to_owned(),
            header: header.to_owned(),
            backward: backward.len(),
            samples: time_s.len(),
            at_s,
        }),
        _ => Ok(()),
    }
}

/// The file's name without its endings: `TripA01` of `TripA01.csv.gz`.
fn stem(path: &Path) -> String {
    let mut name = PathBuf::from(path.file_name().unwrap_or_default());
    for ending in ["gz", "zst", "csv", "txt", "tsv", "dat", "parquet"] {
        if name
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
        {
            name.set_extension("");
        }
    }
    name.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stem_has_no_endings() {
        for (path, name) in [
            ("a/TripA01.csv.gz", "TripA01"),
            ("D01.txt", "D01"),
            ("x.1.parquet", "x.1"),
            ("-", "-"),
            ("", ""),
        ] {
            assert_eq!(stem(Path::new(path)), name);
        }
    }
}

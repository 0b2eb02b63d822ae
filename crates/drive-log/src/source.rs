//! Where columns come from, and the times among them.

use std::path::Path;

use crate::body;
use crate::clock::Clock;
use crate::columns::Wanted;
use crate::header::Head;
use crate::lines::{decoded, fields};
use crate::note::{Note, excerpt};
use crate::number::{is_missing, number};
use crate::origin::Kinds;
use crate::plan::{Plan, TimeColumns};
use crate::stamp::stamp;
use crate::text::Table;
use crate::time_unit::{certain, unpacked};
use crate::unit::Unit;
use crate::{Action, Error, Finding, FindingKind, parquet};

pub(crate) enum Source<'a> {
    Text(Table<'a>),
    Parquet(parquet::File<'a>),
}

impl Source<'_> {
    pub(crate) fn head(&self) -> &Head {
        match self {
            Source::Text(table) => &table.head,
            Source::Parquet(file) => &file.head,
        }
    }

    pub(crate) fn numbers(
        &self,
        path: &Path,
        columns: &[Wanted],
        missing: &[String],
    ) -> Result<(Vec<Vec<f64>>, Vec<Note>), Error> {
        match self {
            Source::Text(table) => body::numbers(path, table, columns, missing),
            Source::Parquet(file) => Ok((file.numbers(columns)?, Vec::new())),
        }
    }

    pub(crate) fn kinds(&self, path: &Path, column: usize) -> Result<Kinds, Error> {
        match self {
            Source::Text(table) => body::kinds(path, table, column),
            Source::Parquet(file) => {
                let mut kinds = Kinds::default();
                file.texts(column)?.iter().for_each(|text| kinds.push(text));
                Ok(kinds)
            }
        }
    }

    /// The texts of a column with their lines; rows for Parquet.
    fn texts(&self, path: &Path, column: usize) -> Result<Vec<(usize, String)>, Error> {
        match self {
            Source::Text(table) => body::texts(path, table, column),
            Source::Parquet(file) => {
                let texts = file.texts(column)?.into_iter().enumerate();
                Ok(texts.map(|(row, text)| (row + 1, text)).collect())
            }
        }
    }

    /// Whether the times of a column are text: dates or clocks, and whatever is no number where the
    /// header says no unit.
    fn has_stamps(&self, column: usize, unit: Option<Unit>) -> bool {
        match self {
            Source::Text(table) => table.rows().find_map(|(_, row)| {
                let row = decoded(row);
                let cells = fields(&row, table.delimiter);
                let cell = cells.get(column).filter(|cell| !is_missing(cell))?;
                Some(number(cell).is_none() && (unit.is_none() || stamp(cell).is_some()))
            }),
            Source::Parquet(file) => Some(file.is_text(column)),
        }
        .unwrap_or(false)
    }

    /// The finding that the file ends in the middle of a row.
    pub(crate) fn cut_off(&self, time_s: &[f64]) -> Option<Finding> {
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
}

/// How the times of a file are read.
pub(crate) enum Reading {
    /// From a column of numbers, in this unit if the header says it.
    Numbers { column: usize, unit: Option<Unit> },
    /// From text.
    Clock(Clock),
}

impl Reading {
    /// Reads the times that are text; those in numbers come with the other columns.
    pub(crate) fn of(
        path: &Path,
        source: &Source<'_>,
        plan: &Plan,
    ) -> Result<(Reading, Option<Note>), Error> {
        let header = |column: usize| source.head().headers[column].clone();
        let (column, unit) = match plan.time {
            TimeColumns::Number { column, unit } => (column, Some(unit)),
            TimeColumns::Open { column } => (column, None),
            TimeColumns::DateAndClock { date, clock } => {
                let dates = source.texts(path, date)?;
                let texts = dates.into_iter().zip(source.texts(path, clock)?);
                let joined = texts.map(|((line, date), (_, clock))| (line, joined(&date, &clock)));
                let name = format!("{} {}", header(date), header(clock));
                let clock = Clock::read(path, name, joined.collect(), plan.date_order)?;
                return Ok((Reading::Clock(clock), None));
            }
        };
        if !source.has_stamps(column, unit) {
            return Ok((Reading::Numbers { column, unit }, None));
        }
        let texts = source.texts(path, column)?;
        let note = unit.map(|unit| {
            let text = texts.first().map_or("", |(_, text)| text);
            let detail = format!(
                "the column {:?} holds no times in {unit}, but text such as {:?}, and is read as that",
                header(column),
                excerpt(text)
            );
            Note::of_file(FindingKind::TimeFormat, Action::Converted, detail)
        });
        let clock = Clock::read(path, header(column), texts, plan.date_order)?;
        Ok((Reading::Clock(clock), note))
    }

    /// The column of numbers that is needed for the times.
    pub(crate) fn wanted(&self) -> Option<Wanted> {
        match self {
            Reading::Numbers { column, unit } => Some(Wanted {
                column: *column,
                unit: unit.unwrap_or(Unit::SECOND),
                channel: None,
            }),
            Reading::Clock(_) => None,
        }
    }
}

fn joined(date: &str, clock: &str) -> String {
    if is_missing(clock) {
        return String::new();
    }
    format!("{date} {clock}")
}

/// Times in numbers as seconds, and what was taken for granted.
pub(crate) fn seconds(
    path: &Path,
    header: &str,
    unit: Option<Unit>,
    mut values: Vec<f64>,
) -> Result<(Vec<f64>, Option<Note>), Error> {
    let converted = |detail: String| {
        Some(Note::of_file(
            FindingKind::TimeFormat,
            Action::Converted,
            detail,
        ))
    };
    if unit.is_none_or(|unit| unit == Unit::SECOND)
        && let Some(unpacked_s) = unpacked(&values)
    {
        let detail = format!(
            "the column {header:?} holds times of day as HHMMSS: its seconds never run over 59"
        );
        return Ok((unpacked_s, converted(detail)));
    }
    let known = unit.map(|unit| (unit, ""));
    let Some((unit, words)) = known.or_else(|| certain(&values)) else {
        let fold = |of: fn(f64, f64) -> f64| values.iter().copied().fold(f64::NAN, of);
        return Err(Error::TimeUnit {
            path: path.to_owned(),
            header: header.to_owned(),
            from: fold(f64::min),
            to: fold(f64::max),
        });
    };
    unit.convert(&mut values, 1.0);
    let note = (!words.is_empty()).then(|| format!("the column {header:?} is read as {words}"));
    Ok((values, note.and_then(converted)))
}

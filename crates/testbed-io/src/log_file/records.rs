//! Records of CSV files, whole ones apart from what is left of one that was cut.

use ::csv::{ByteRecord, Reader, ReaderBuilder};
use parquet_table::{Column, Values};

use super::flaw::{DAMAGED, Flaw, shortened};
use super::kind::Kind;
use super::limits::MAX_COLUMNS;

/// The whole records of a file.
pub(super) struct Records<'a> {
    reader: Reader<&'a [u8]>,
    /// Of the first of them
    line: u64,
    /// After the last of them
    tail: &'a [u8],
    tail_line: u64,
}

impl<'a> Records<'a> {
    /// Of what begins at a line of the file.
    pub(super) fn new(bytes: &'a [u8], line: u64) -> Self {
        let (whole, tail) = bytes.split_at(whole_bytes(bytes));
        let lines = whole.iter().filter(|byte| **byte == b'\n').count();
        Self {
            reader: reader(whole),
            line,
            tail,
            tail_line: line + lines as u64,
        }
    }

    /// The next, false at the end.
    pub(super) fn next(&mut self, record: &mut ByteRecord) -> Result<bool, Flaw> {
        let read = self.reader.read_byte_record(record);
        let more = read.map_err(|error| Flaw::new(error.to_string(), DAMAGED))?;
        if let Some(mut position) = record.position().cloned() {
            position.set_line(position.line() + self.line - 1);
            record.set_position(Some(position));
        }
        Ok(more)
    }

    /// Whether the file ends within a record. A record that goes on over whole ones was not cut but damaged.
    pub(super) fn is_cut(&self, fields: usize) -> Result<bool, Flaw> {
        let lines: Vec<&[u8]> = self.tail.split(|byte| *byte == b'\n').collect();
        let later = lines.iter().skip(1).rev().skip(1);
        if later.into_iter().any(|line| is_whole(line, fields)) {
            let place = format!(", line {}", self.tail_line);
            return Err(Flaw::at(
                place,
                "a quotation mark that is not closed",
                DAMAGED,
            ));
        }
        Ok(!self.tail.is_empty())
    }
}

fn reader(bytes: &[u8]) -> Reader<&[u8]> {
    let mut reader = ReaderBuilder::new();
    reader.has_headers(false).flexible(true).from_reader(bytes)
}

/// Up to the last line end that is not within quotation marks.
fn whole_bytes(bytes: &[u8]) -> usize {
    let mut is_quoted = false;
    let mut whole = 0;
    for (index, byte) in bytes.iter().enumerate() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b'\n' if !is_quoted => whole = index + 1,
            _ => {}
        }
    }
    whole
}

fn is_whole(line: &[u8], fields: usize) -> bool {
    let mut record = ByteRecord::new();
    let read = reader(line).read_byte_record(&mut record);
    matches!(read, Ok(true)) && record.len() == fields
}

pub(super) fn header(record: &ByteRecord, kinds: &[Kind]) -> Result<Vec<Column>, Flaw> {
    if kinds.len() > MAX_COLUMNS {
        let found = format!("{} columns", kinds.len());
        return Err(Flaw::at(line(record), found, DAMAGED));
    }
    check_fields(record, kinds.len())?;
    let names = record.iter().zip(kinds);
    names
        .map(|(name, kind)| Ok(kind.column(text(record, name)?)))
        .collect()
}

pub(super) fn push(columns: &mut [Column], record: &ByteRecord) -> Result<(), Flaw> {
    for (column, field) in columns.iter_mut().zip(record) {
        let pushed = match &mut column.values {
            Values::Float(values) if field.is_empty() => {
                values.push(f64::NAN);
                Some(())
            }
            Values::Float(values) => number(field).map(|value| values.push(value)),
            Values::Integer(values) => number(field).map(|value| values.push(value)),
            Values::Text(values) => {
                values.push(text(record, field)?);
                Some(())
            }
        };
        if pushed.is_none() {
            return Err(Flaw::at(
                format!("{}, column {:?}", line(record), column.name),
                format!(
                    "{:?} is no number",
                    shortened(&String::from_utf8_lossy(field))
                ),
                "correct the value, or leave it empty if the column has a decimal point elsewhere",
            ));
        }
    }
    Ok(())
}

fn number<T: std::str::FromStr>(field: &[u8]) -> Option<T> {
    str::from_utf8(field).ok()?.trim().parse().ok()
}

pub(super) fn text(record: &ByteRecord, field: &[u8]) -> Result<String, Flaw> {
    let text = str::from_utf8(field).map(ToOwned::to_owned);
    text.map_err(|_| {
        let found = shortened(&String::from_utf8_lossy(field));
        Flaw::at(line(record), format!("{found:?} is not UTF-8"), DAMAGED)
    })
}

pub(super) fn check_fields(record: &ByteRecord, expected: usize) -> Result<(), Flaw> {
    if record.len() == expected {
        return Ok(());
    }
    Err(Flaw::at(
        line(record),
        format!("{} fields where {expected} are expected", record.len()),
        "complete or delete the line",
    ))
}

/// Where a record starts.
pub(super) fn line(record: &ByteRecord) -> String {
    let line = record.position().map_or(0, ::csv::Position::line);
    format!(", line {line}")
}

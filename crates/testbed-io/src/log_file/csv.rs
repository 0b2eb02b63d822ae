//! Run logs as comma-separated values.
//!
//! The first line is `# drivekit run log 1 ` and the metadata, the second `# types ` and a letter
//! per column (f, i or t), the third the names; then a line per row.

use std::fmt::Write as _;
use std::io::{self, Write};

use ::csv::{ByteRecord, ReaderBuilder};

use super::{Column, DAMAGED, Flaw, Kind, LogTable, MAX_COLUMNS, Values, shortened, table};

const MAGIC: &str = "# drivekit run log 1 ";
const TYPES: &str = "# types ";
const FOREIGN: &str = "only CSV files that drivekit logged are read, with their first two lines";

pub(super) fn write(table: &LogTable, out: &mut dyn Write) -> io::Result<()> {
    write_header(table.meta(), table.columns(), out)?;
    write_rows(table.columns(), out)
}

pub(super) fn write_header(meta: &str, columns: &[Column], out: &mut dyn Write) -> io::Result<()> {
    let letters: Vec<&str> = columns.iter().map(|c| letter(c.values.kind())).collect();
    writeln!(out, "{MAGIC}{meta}")?;
    writeln!(out, "{TYPES}{}", letters.join(","))?;
    if columns.is_empty() {
        return out.flush();
    }
    let mut writer = ::csv::Writer::from_writer(out);
    writer.write_record(columns.iter().map(|column| &column.name))?;
    writer.flush()
}

pub(super) fn write_rows(columns: &[Column], out: &mut dyn Write) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.values.len());
    let mut writer = ::csv::Writer::from_writer(out);
    let mut text = String::new();
    for row in 0..rows {
        for column in columns {
            text.clear();
            let field = match &column.values {
                Values::Float(values) => float_text(values[row], &mut text),
                Values::Integer(values) => {
                    let _ = write!(text, "{}", values[row]);
                    &text
                }
                Values::Text(values) => &values[row],
            };
            writer.write_field(field)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()
}

fn letter(kind: Kind) -> &'static str {
    match kind {
        Kind::Float => "f",
        Kind::Integer => "i",
        Kind::Text => "t",
    }
}

/// The shortest text that reads back to the same bits, empty for NaN.
fn float_text(value: f64, text: &mut String) -> &str {
    if value.is_nan() {
        return "";
    }
    // writing to a string cannot fail; unlike `{}`, `{:?}` writes 1e300 with an exponent
    let _ = write!(text, "{value:?}");
    text.strip_suffix(".0").unwrap_or(text)
}

pub(super) fn read(bytes: &[u8]) -> Result<LogTable, Flaw> {
    let end = bytes.iter().position(|b| *b == b'\n');
    let (first, rest) = bytes.split_at(end.map_or(bytes.len(), |end| end + 1));
    let meta = str::from_utf8(first).ok().and_then(|line| {
        let line = line.strip_prefix('\u{feff}').unwrap_or(line);
        line.strip_prefix(MAGIC)
    });
    let Some(meta) = meta else {
        let found = shortened(String::from_utf8_lossy(first).trim_end());
        return Err(Flaw::at(
            ", line 1".to_owned(),
            format!("{found:?}"),
            FOREIGN,
        ));
    };

    // the comment with the types is a record of as many fields as the rest
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(rest);
    let mut next = |record: &mut ByteRecord| {
        let read = reader.read_byte_record(record);
        read.map_err(|error| Flaw::new(error.to_string(), DAMAGED))
    };
    let mut record = ByteRecord::new();
    next(&mut record)?;
    let kinds = kinds(&record)?;
    let cut = !rest.ends_with(b"\n") || rest.iter().filter(|b| **b == b'"').count() % 2 == 1;
    let mut columns = Vec::new();
    let mut more = false;
    if !kinds.is_empty() {
        next(&mut record)?;
        columns = header(&record, &kinds)?;
        more = next(&mut record)?;
    }
    if cut && !more {
        return Err(Flaw::new("it ends in its header", DAMAGED));
    }
    let mut following = ByteRecord::new();
    while more {
        more = next(&mut following)?;
        if more || !cut {
            push(&mut columns, &record)?;
        }
        std::mem::swap(&mut record, &mut following);
    }
    table(meta.trim_end_matches(['\r', '\n']), columns, cut)
}

fn kinds(record: &ByteRecord) -> Result<Vec<Kind>, Flaw> {
    let wrong = |found: &[u8]| {
        let found = shortened(&String::from_utf8_lossy(found));
        Flaw::at(", line 2".to_owned(), format!("{found:?}"), FOREIGN)
    };
    let first = record.get(0).unwrap_or_default();
    let first = first
        .strip_prefix(TYPES.as_bytes())
        .ok_or_else(|| wrong(first))?;
    if record.len() > MAX_COLUMNS {
        return Err(wrong(format!("{} columns", record.len()).as_bytes()));
    }
    if record.len() == 1 && first.is_empty() {
        return Ok(Vec::new());
    }
    std::iter::once(first)
        .chain(record.iter().skip(1))
        .map(|field| match field {
            b"f" => Ok(Kind::Float),
            b"i" => Ok(Kind::Integer),
            b"t" => Ok(Kind::Text),
            _ => Err(wrong(field)),
        })
        .collect()
}

fn header(record: &ByteRecord, kinds: &[Kind]) -> Result<Vec<Column>, Flaw> {
    check_fields(record, kinds.len())?;
    let names = record.iter().zip(kinds);
    names
        .map(|(name, kind)| Ok(kind.column(text(record, name)?)))
        .collect()
}

fn push(columns: &mut [Column], record: &ByteRecord) -> Result<(), Flaw> {
    check_fields(record, columns.len())?;
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

fn text(record: &ByteRecord, field: &[u8]) -> Result<String, Flaw> {
    let text = str::from_utf8(field).map(ToOwned::to_owned);
    text.map_err(|_| {
        let found = shortened(&String::from_utf8_lossy(field));
        Flaw::at(line(record), format!("{found:?} is not UTF-8"), DAMAGED)
    })
}

fn check_fields(record: &ByteRecord, expected: usize) -> Result<(), Flaw> {
    if record.len() == expected {
        return Ok(());
    }
    Err(Flaw::at(
        line(record),
        format!("{} fields where {expected} are expected", record.len()),
        "complete or delete the line",
    ))
}

/// Where a record starts; the reader began at line 2.
fn line(record: &ByteRecord) -> String {
    let line = record.position().map_or(0, ::csv::Position::line);
    format!(", line {}", line + 1)
}

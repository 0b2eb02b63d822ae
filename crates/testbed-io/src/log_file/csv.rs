//! Run logs as comma-separated values: a line with the names, then a line per row.
//!
//! The last column is `about`. In the first row it says what the run is, as JSON: types of the columns (f, i or t), a check, and
//! the metadata. In every other row it is `crc ` and a check: the CRC-32 of all fields from the first name up to this row, so
//! that the first line that was changed or lost is known. A log without rows has one row in which nothing but `about` stands. After the check of
//! the last row stands ` end`, unless the log was written while the run went on.
//!
//! Logs of before begin with `# drivekit run log 1 ` and the metadata and `# types ` and the types; they are still read.

use std::fmt::Write as _;
use std::io::{self, Write};

use ::csv::{ByteRecord, Writer};
use parquet_table::{Column, Values};

use super::check::Check;
use super::csv_old;
use super::flaw::{DAMAGED, Flaw, shortened};
use super::kind::{Kind, kind, letter};
use super::records::{Records, check_fields, header, line, push, text};
use super::table::{LogTable, table};

const ABOUT: &str = "about";
const END: &str = " end";
const FOREIGN: &str = "only CSV files that drivekit logged are read, with their column `about`";

pub(super) fn write(table: &LogTable, out: &mut dyn Write) -> io::Result<()> {
    let mut sheet = Sheet::start(table.meta(), table.columns(), out)?;
    sheet.add_rows(table.columns(), true)?;
    sheet.finish().map(|_| ())
}

/// A file under way.
pub(super) struct Sheet<W: Write> {
    writer: Writer<W>,
    check: Check,
    types: String,
    meta: String,
    is_begun: bool,
}

impl<W: Write> Sheet<W> {
    /// Writes the names.
    pub(super) fn start(meta: &str, columns: &[Column], out: W) -> io::Result<Self> {
        let mut sheet = Self {
            writer: Writer::from_writer(out),
            check: Check::default(),
            types: columns
                .iter()
                .map(|c| letter(Kind::of(&c.values)))
                .collect(),
            meta: meta.to_owned(),
            is_begun: false,
        };
        for column in columns {
            sheet.field(column.name.as_bytes())?;
        }
        sheet.writer.write_field(ABOUT)?;
        sheet.end_row()?;
        Ok(sheet)
    }

    /// Adds rows, and hands them on.
    pub(super) fn add(&mut self, columns: &[Column]) -> io::Result<()> {
        self.add_rows(columns, false)
    }

    fn add_rows(&mut self, columns: &[Column], are_last: bool) -> io::Result<()> {
        let rows = columns.first().map_or(0, |column| column.values.len());
        let mut text = String::new();
        for row in 0..rows {
            for column in columns {
                text.clear();
                self.field(field(&column.values, row, &mut text).as_bytes())?;
            }
            let mark = if are_last && row + 1 == rows { END } else { "" };
            self.about(false, mark)?;
        }
        self.writer.flush()
    }

    /// What is said of the run is in the file also without rows.
    pub(super) fn finish(mut self) -> io::Result<W> {
        if !self.is_begun {
            for _ in 0..self.types.len() {
                self.field(b"")?;
            }
            self.about(true, "")?;
        }
        self.writer
            .into_inner()
            .map_err(|error| io::Error::other(error.to_string()))
    }

    fn about(&mut self, is_empty: bool, mark: &str) -> io::Result<()> {
        let text = if self.is_begun {
            format!("{}{mark}", self.check.text())
        } else {
            self.is_begun = true;
            About::text(&self.types, &mut self.check, is_empty, &self.meta)
        };
        self.writer.write_field(text)?;
        self.end_row()
    }

    fn field(&mut self, field: &[u8]) -> io::Result<()> {
        self.check.add(field);
        Ok(self.writer.write_field(field)?)
    }

    fn end_row(&mut self) -> io::Result<()> {
        Ok(self.writer.write_record(None::<&[u8]>)?)
    }
}

fn field<'a>(values: &'a Values, row: usize, text: &'a mut String) -> &'a str {
    match values {
        Values::Float(values) => float_text(values[row], text),
        Values::Integer(values) => {
            let _ = write!(text, "{}", values[row]);
            text
        }
        Values::Text(values) => &values[row],
    }
}

/// What the first row says of the run.
struct About<'a> {
    types: &'a str,
    kinds: Vec<Kind>,
    check: &'a str,
    is_empty: bool,
    meta: &'a str,
}

impl<'a> About<'a> {
    const START: &'static str = r#"{"log":"drivekit run log 2","types":""#;
    const CHECK: &'static str = r#"","check":""#;
    const EMPTY: &'static str = r#","empty":true"#;
    const RUN: &'static str = r#","run":"#;

    fn text(types: &str, check: &mut Check, is_empty: bool, meta: &str) -> String {
        check.add(types.as_bytes());
        check.add(meta.as_bytes());
        let empty = if is_empty { Self::EMPTY } else { "" };
        let (start, before, run) = (Self::START, Self::CHECK, Self::RUN);
        format!(
            "{start}{types}{before}{}\"{empty}{run}{meta}}}",
            check.text()
        )
    }

    /// Bit for bit what was written; none of another text.
    fn of(text: &'a str) -> Option<Self> {
        let rest = text.strip_prefix(Self::START)?;
        let (types, rest) = rest.split_once(Self::CHECK)?;
        let (check, rest) = rest.split_once('"')?;
        let short = rest.strip_prefix(Self::EMPTY);
        let meta = short.unwrap_or(rest).strip_prefix(Self::RUN)?;
        Some(Self {
            types,
            kinds: types.chars().map(kind).collect::<Option<_>>()?,
            check,
            is_empty: short.is_some(),
            meta: meta.strip_suffix('}')?,
        })
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
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.starts_with(csv_old::MAGIC.as_bytes()) {
        return csv_old::read(bytes);
    }
    let mut records = Records::new(bytes, 1);
    let mut record = ByteRecord::new();
    records.next(&mut record)?;
    let names = names_before_about(&record).ok_or_else(|| foreign(bytes))?;
    let is_cut = records.is_cut(record.len())?;
    if !records.next(&mut record)? {
        return Err(Flaw::new("it ends before its first row is whole", DAMAGED));
    }
    check_fields(&record, names.len() + 1)?;
    let mut check = Check::default();
    names.iter().for_each(|name| check.add(name));
    let about = text(&record, last(&record))?;
    let about = begun(&about, &record, &mut check)?;
    let mut columns = header(&names, &about.kinds)?;
    let mut more = !about.is_empty || records.next(&mut record)?;
    let mut is_end = false;
    while more {
        push(&mut columns, &record)?;
        more = records.next(&mut record)?;
        if more {
            check_fields(&record, names.len() + 1)?;
            add_fields(&mut check, &record);
            if is_end {
                let found = "a row after the last one";
                return Err(Flaw::at(line(&record), found, DAMAGED));
            }
            let written = last(&record);
            let unmarked = written.strip_suffix(END.as_bytes());
            is_end = unmarked.is_some();
            agree(&check, &record, unmarked.unwrap_or(written))?;
        }
    }
    let table = table(about.meta, columns, is_cut)?;
    Ok(LogTable {
        states_its_end: is_end,
        ..table
    })
}

/// None if the last is another.
fn names_before_about(record: &ByteRecord) -> Option<ByteRecord> {
    let count = record.len().checked_sub(1)?;
    let mut names = record.clone();
    names.truncate(count);
    (record.get(count)? == ABOUT.as_bytes()).then_some(names)
}

fn foreign(bytes: &[u8]) -> Flaw {
    let first = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    let found = shortened(String::from_utf8_lossy(first).trim_end());
    Flaw::at(", line 1".to_owned(), format!("{found:?}"), FOREIGN)
}

fn last(record: &ByteRecord) -> &[u8] {
    let index = record.len().saturating_sub(1);
    record.get(index).unwrap_or_default()
}

fn add_fields(check: &mut Check, record: &ByteRecord) {
    let fields = record.iter().take(record.len().saturating_sub(1));
    fields.for_each(|field| check.add(field));
}

/// What the first row says, if that agrees with its check.
fn begun<'a>(text: &'a str, first: &ByteRecord, check: &mut Check) -> Result<About<'a>, Flaw> {
    let about = About::of(text);
    let about = about.filter(|about| about.kinds.len() + 1 == first.len());
    let about = about.ok_or_else(|| {
        let place = format!("{}, column {ABOUT:?}", line(first));
        Flaw::at(place, format!("{:?}", shortened(text)), FOREIGN)
    })?;
    add_fields(check, first);
    check.add(about.types.as_bytes());
    check.add(about.meta.as_bytes());
    agree(check, first, about.check.as_bytes())?;
    Ok(about)
}

fn agree(check: &Check, record: &ByteRecord, written: &[u8]) -> Result<(), Flaw> {
    if check.text().as_bytes() == written {
        return Ok(());
    }
    let written = shortened(&String::from_utf8_lossy(written));
    let found = format!(
        "damaged or changed: its check is {written:?} and would be {:?}",
        check.text()
    );
    Err(Flaw::at(line(record), found, DAMAGED))
}

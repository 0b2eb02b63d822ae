//! Rows of a text table that are no samples: comments, a header again, a row of units, a footer.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::path::Path;

use crate::lines::{decoded, fields, is_comment};
use crate::note::{About, Note, excerpt};
use crate::number::{is_missing, number};
use crate::plan::{Plan, TimeColumns};
use crate::text::Table;
use crate::top::names;
use crate::unit::Unit;
use crate::{Action, Error, FindingKind, TableError};

/// Rows under the header that may describe the columns, and rows that a footer may have.
const DESCRIPTIONS: usize = 3;
const FOOTER_ROWS: usize = 5;

/// What a row is that is no sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Other {
    Comment,
    HeaderAgain,
    Description,
    Footer,
}

impl Other {
    const ALL: [Other; 4] = [
        Other::Comment,
        Other::HeaderAgain,
        Other::Description,
        Other::Footer,
    ];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Other::Comment => ("comment", "comments"),
            Other::HeaderAgain => ("repeated header", "repeated headers"),
            Other::Description => (
                "row that describes the columns",
                "rows that describe the columns",
            ),
            Other::Footer => ("row of a footer", "rows of a footer"),
        }
    }
}

struct LeftOut {
    other: Other,
    line: usize,
    /// The sample before it.
    row: usize,
    text: String,
}

/// The table without the rows that are certainly no samples, and what was left out.
pub(crate) fn tidied<'a>(
    path: &Path,
    mut table: Table<'a>,
    plan: &Plan,
) -> Result<(Table<'a>, Vec<Note>), Error> {
    let columns = Columns::of(plan);
    let left_out = left_out(path, &table, &columns)?;
    if !left_out.is_empty() {
        leave_out(&mut table, &left_out);
    }
    let above = table.comments.as_ref().map(|(count, line, text)| {
        let lines = if *count == 1 { "comment" } else { "comments" };
        let detail = format!("{count} {lines} above the header, first {text:?} in line {line}");
        Note::of_file(FindingKind::NoSample, Action::Dropped, detail)
    });
    let notes = Other::ALL
        .iter()
        .filter_map(|other| note(*other, &left_out));
    Ok((table, above.into_iter().chain(notes).collect()))
}

fn note(other: Other, left_out: &[LeftOut]) -> Option<Note> {
    let rows: Vec<&LeftOut> = left_out.iter().filter(|row| row.other == other).collect();
    let first = rows.first()?;
    Some(Note {
        kind: FindingKind::NoSample,
        channel: None,
        action: Action::Dropped,
        about: About::Rows {
            names: other.names(),
            rest: format!(", first {:?} in line {}", first.text, first.line),
            rows: rows.iter().map(|row| row.row).collect(),
        },
    })
}

/// The columns that the plan reads.
struct Columns {
    time: Vec<usize>,
    used: Vec<(usize, Unit)>,
}

impl Columns {
    fn of(plan: &Plan) -> Columns {
        let mut used: Vec<(usize, Unit)> = plan
            .logs
            .iter()
            .flat_map(|log| &log.columns)
            .map(|c| (c.column, c.unit))
            .collect();
        let time = match plan.time {
            TimeColumns::Number { column, unit } => {
                used.push((column, unit));
                vec![column]
            }
            TimeColumns::Open { column } => vec![column],
            TimeColumns::DateAndClock { date, clock } => vec![date, clock],
        };
        Columns { time, used }
    }

    /// Whether a row has a time, or a place for one that is empty.
    fn has_time(&self, cells: &[&str]) -> bool {
        let no_mark = |cell: &str| cell.is_empty() || cell.chars().any(|c| !"#/%".contains(c));
        self.time.iter().all(|column| {
            cells
                .get(*column)
                .is_some_and(|cell| is_missing(cell) && no_mark(cell) || is_value(cell))
        })
    }

    /// Whether a word stands where a time should.
    fn has_word_for_time(&self, cells: &[&str]) -> bool {
        let words = |cell: &&str| !is_missing(cell) && !is_value(cell);
        self.time
            .iter()
            .any(|column| cells.get(*column).is_some_and(words))
    }

    /// Whether a row stands for no sample but says what the columns are.
    fn describe(&self, cells: &[&str]) -> bool {
        let number = |column: &usize| {
            cells
                .get(*column)
                .is_some_and(|cell| number(cell).is_some())
        };
        let timed = |column: &usize| cells.get(*column).is_some_and(|cell| is_value(cell));
        let words = cells.iter().any(|cell| !is_missing(cell));
        let used: Vec<usize> = self.used.iter().map(|(column, _)| *column).collect();
        words && !used.iter().any(number) && !self.time.iter().any(timed)
    }
}

/// Whether a cell begins as numbers, dates and clocks do.
fn is_value(cell: &str) -> bool {
    let digits = cell.trim_start_matches(['+', '-', '.', ',', '\'']);
    digits.starts_with(|c: char| c.is_ascii_digit()) || crate::stamp::stamp(cell).is_some()
}

fn left_out(path: &Path, table: &Table<'_>, columns: &Columns) -> Result<Vec<LeftOut>, Error> {
    let mut left_out: Vec<LeftOut> = Vec::new();
    let mut last: VecDeque<(usize, usize, &[u8])> = VecDeque::with_capacity(FOOTER_ROWS + 1);
    let mut samples: usize = 0;
    // descriptions so far under a header, `None` once a sample has come
    let mut under_header = Some(0);
    for (line, text) in table.rows() {
        let near_header = under_header.is_some_and(|rows| rows < DESCRIPTIONS);
        let other = other(path, table, columns, (line, text), near_header)?;
        under_header = match other {
            None => None,
            Some(Other::HeaderAgain) => Some(0),
            Some(Other::Description) => under_header.map(|rows| rows + 1),
            Some(_) => under_header,
        };
        if let Some(other) = other {
            left_out.push(LeftOut {
                other,
                line,
                row: samples.saturating_sub(1),
                text: excerpt(&decoded(text)),
            });
            continue;
        }
        last.push_back((line, samples, text));
        samples += 1;
        if last.len() > FOOTER_ROWS + 1 {
            last.pop_front();
        }
    }
    left_out.extend(footer(table, columns, &last));
    left_out.sort_by_key(|row| row.line);
    Ok(left_out)
}

fn other(
    path: &Path,
    table: &Table<'_>,
    columns: &Columns,
    (line, text): (usize, &[u8]),
    near_header: bool,
) -> Result<Option<Other>, Error> {
    if is_header(table, text) {
        return Ok(Some(Other::HeaderAgain));
    }
    let comment = is_comment(text);
    if !comment && !near_header {
        return Ok(None);
    }
    let row = decoded(text);
    let cells = fields(&row, table.delimiter);
    if comment && !columns.has_time(&cells) {
        return Ok(Some(Other::Comment));
    }
    if near_header && table.head.has_header && columns.describe(&cells) {
        check_units(path, table, columns, line, &cells)?;
        return Ok(Some(Other::Description));
    }
    Ok(None)
}

/// Whether a row has the header's names. Rows of numbers are told by their first byte.
fn is_header(table: &Table<'_>, text: &[u8]) -> bool {
    let Some(header) = table.header_line else {
        return false;
    };
    header == text
        || header.first() == text.first()
            && header.len().abs_diff(text.len()) < 4
            && names(&fields(&decoded(text), table.delimiter)) == table.head.headers
}

/// A unit under the header must be that of the header.
fn check_units(
    path: &Path,
    table: &Table<'_>,
    columns: &Columns,
    line: usize,
    cells: &[&str],
) -> Result<(), Error> {
    for (column, unit) in &columns.used {
        let text = cells.get(*column).copied().unwrap_or_default();
        let text = text.trim_matches(['[', ']', '(', ')']);
        let said = Unit::parse(unit.quantity(), text);
        if said.is_some_and(|said| said != *unit) {
            return Err(TableError::UnitAtOdds {
                path: path.to_owned(),
                line,
                header: table.head.headers[*column].clone(),
                found: text.to_owned(),
                unit: unit.to_string(),
            }
            .into());
        }
    }
    Ok(())
}

/// The rows at the end that have no time and nothing after them that has.
fn footer(
    table: &Table<'_>,
    columns: &Columns,
    last: &VecDeque<(usize, usize, &[u8])>,
) -> Vec<LeftOut> {
    let foots = |text: &[u8]| {
        let row = decoded(text);
        let cells = fields(&row, table.delimiter);
        let short = cells.len() < table.head.headers.len() && !columns.has_time(&cells);
        let begins_with_word = cells.first().is_some_and(|cell| !is_value(cell));
        (short && begins_with_word) || columns.has_word_for_time(&cells)
    };
    let rows: Vec<&(usize, usize, &[u8])> = last
        .iter()
        .rev()
        .take_while(|(_, _, text)| foots(text))
        .collect();
    if rows.len() > FOOTER_ROWS || rows.len() == last.len() {
        return Vec::new();
    }
    let before = rows.last().map_or(0, |(_, row, _)| row.saturating_sub(1));
    let left_out = rows.iter().map(|(line, _, text)| LeftOut {
        other: Other::Footer,
        line: *line,
        row: before,
        text: excerpt(&decoded(text)),
    });
    left_out.collect()
}

fn leave_out(table: &mut Table<'_>, left_out: &[LeftOut]) {
    let mut body = Vec::with_capacity(table.body.len());
    let mut lines = Vec::new();
    let mut skipped = left_out.iter().map(|row| row.line).peekable();
    for (line, text) in table.rows() {
        if skipped.next_if_eq(&line).is_some() {
            continue;
        }
        body.extend_from_slice(text);
        body.push(b'\n');
        lines.push(line);
    }
    table.body = Cow::Owned(body);
    table.lines = Some(lines);
}

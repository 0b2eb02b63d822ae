//! Text tables: encoding, delimiter, decimal mark and header.

use std::borrow::Cow;
use std::path::Path;

use crate::Error;
use crate::header::{Form, Head};
use crate::lines::{decoded, fields, line_len, lines};
use crate::number::{decided_mark, decimal_mark, number};
use crate::top::Top;

/// A text table whose form is known.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    pub(crate) head: Head,
    pub(crate) delimiter: u8,
    /// `None` if no number seen so far has a decimal mark.
    pub(crate) decimal_comma: Option<bool>,
    /// Whether that is certain: `1.234` may be a thousand.
    pub(crate) mark_decided: bool,
    /// The line of the header, if there is one.
    pub(crate) header_line: Option<&'a [u8]>,
    /// Comments above the header: how many, and the first with its line.
    pub(crate) comments: Option<(usize, usize, String)>,
    /// The rows.
    pub(crate) body: Cow<'a, [u8]>,
    /// Line of the first row, from 1.
    pub(crate) first_line: usize,
    /// The line of each row, where lines between them were left out of the body.
    pub(crate) lines: Option<Vec<usize>>,
    /// Whether the file ended in the middle of a row, which is left out of the body.
    pub(crate) cut_off: bool,
}

impl Table<'_> {
    /// The rows with their line in the file.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let before = self.first_line - 1;
        lines(&self.body)
            .enumerate()
            .map(move |(row, (line, text))| {
                let known = self.lines.as_ref().and_then(|lines| lines.get(row));
                (known.copied().unwrap_or(line + before), text)
            })
    }
}

/// Finds delimiter, decimal mark and header, as far as the layout's `form` leaves them open.
pub(crate) fn table<'a>(path: &Path, text: &'a [u8], form: Form) -> Result<Table<'a>, Error> {
    let top = Top::read(path, text, form)?;
    let rows: Vec<Cow<'_, str>> = top.rows.iter().map(|(_, row)| decoded(row)).collect();
    let delimiter = top.delimiter.unwrap_or_else(|| sniffed_delimiter(&rows));
    let (decimal_comma, mark_decided) = match form.decimal_comma {
        Some(comma) => (Some(comma), true),
        None => sniffed_decimal_comma(&rows, delimiter),
    };
    let header = top.header(&rows, delimiter, form.no_header);
    let skipped = header
        .as_ref()
        .map_or(top.rows[0].0 - 1, |header| header.line);
    let comments = top.comments_above(header.as_ref().map(|header| header.line));
    let header_line = header.as_ref().map(|header| header.text);
    let head = Head {
        preamble: preamble(text, form.skip_lines),
        has_header: header.is_some(),
        line: header.as_ref().map_or(0, |header| header.line),
        headers: header.map_or_else(
            || numbered(fields(&rows[0], delimiter).len()),
            |header| header.names,
        ),
    };
    let (body, cut_off) = whole_rows(after_lines(text, skipped), delimiter, head.headers.len());
    if body.is_empty() {
        return Err(Error::NoData {
            path: path.to_owned(),
            found: "a header without rows",
        });
    }
    Ok(Table {
        head,
        delimiter,
        decimal_comma,
        mark_decided,
        header_line,
        comments,
        body: Cow::Borrowed(body),
        first_line: skipped + 1,
        lines: None,
        cut_off,
    })
}

/// Names of columns without a header.
fn numbered(columns: usize) -> Vec<String> {
    let name = |column: usize| format!("column {column}");
    (1..=columns).map(name).collect()
}

fn preamble(text: &[u8], lines_before: usize) -> Vec<String> {
    lines(text)
        .take_while(|(line, _)| *line <= lines_before)
        .map(|(_, line)| decoded(line).into_owned())
        .collect()
}

/// The rows without blank lines at the end, and without a last row that has too few fields and no end of line: a logger
/// that lost power leaves one.
fn whole_rows(rows: &[u8], delimiter: u8, expected: usize) -> (&[u8], bool) {
    let blank = |byte: &u8| byte.is_ascii_whitespace() && *byte != delimiter || *byte == b' ';
    let kept = rows.len() - rows.iter().rev().take_while(|byte| blank(byte)).count();
    let body = &rows[..kept];
    let ended = rows[kept..].contains(&b'\n') || rows[kept..].contains(&b'\r');
    match body.iter().rposition(|byte| *byte == b'\n') {
        Some(end) if !ended && fields(&decoded(&body[end + 1..]), delimiter).len() < expected => {
            (&body[..end], true)
        }
        _ => (body, false),
    }
}

/// The text after its first `count` lines.
fn after_lines(text: &[u8], count: usize) -> &[u8] {
    (0..count).fold(text, |rest, _| &rest[line_len(rest)..])
}

/// The delimiter that gives every sniffed row as many fields as the header; the comma comes after
/// `;` and tab since it may be the decimal mark. Where none fits, the one that cuts the header into
/// the most fields: reading then names the odd row.
fn sniffed_delimiter(rows: &[Cow<'_, str>]) -> u8 {
    let candidates = [b';', b'\t', b',', b' '];
    let count =
        |row: &str, delimiter| fields(row.trim_end_matches(char::from(delimiter)), delimiter).len();
    let fits = |delimiter: u8| {
        let columns = count(&rows[0], delimiter);
        columns > 1
            && rows[1..].iter().all(|row| {
                fields(row, delimiter).len() == columns || count(row, delimiter) == columns
            })
    };
    candidates
        .into_iter()
        .find(|d| fits(*d))
        .unwrap_or_else(|| {
            candidates
                .into_iter()
                .rev()
                .max_by_key(|d| count(&rows[0], *d))
                .unwrap_or(b',')
        })
}

/// The decimal mark of the first number that tells it, and whether that is certain.
fn sniffed_decimal_comma(rows: &[Cow<'_, str>], delimiter: u8) -> (Option<bool>, bool) {
    let numbers = || {
        let fields = rows.iter().skip(1).flat_map(|row| fields(row, delimiter));
        fields.filter(|field| number(field).is_some())
    };
    match numbers().find_map(decided_mark) {
        Some(comma) => (Some(comma), true),
        None => (numbers().find_map(decimal_mark), false),
    }
}

//! The first lines of a text table, up to its header and the rows by which it is recognised.

use std::borrow::Cow;
use std::path::Path;

use crate::Error;
use crate::header::Form;
use crate::lines::{decoded, fields, is_comment, lines};
use crate::note::excerpt;
use crate::number::number;

/// Columns of a file at most. Real logs have tens; a row per channel instead of a row per sample
/// has millions.
pub(crate) const MAX_COLUMNS: usize = 10_000;

/// Rows that decide on delimiter and decimal mark.
pub(crate) const SNIFFED_ROWS: usize = 20;

/// Longest line among those that decide on header, delimiter and decimal mark, in bytes: more than
/// the most columns need.
const LONGEST_LINE: usize = 1 << 20;

/// The first lines of a table.
pub(crate) struct Top<'a> {
    /// Named by the layout, or by a line `sep=;` as spreadsheets write.
    pub(crate) delimiter: Option<u8>,
    /// Comments before the first row.
    comments: Vec<(usize, &'a [u8])>,
    /// The header, if there is one, and the rows that are sniffed; at least one.
    pub(crate) rows: Vec<(usize, &'a [u8])>,
}

/// The header of a table.
pub(crate) struct HeaderLine<'a> {
    pub(crate) line: usize,
    pub(crate) text: &'a [u8],
    pub(crate) names: Vec<String>,
}

impl<'a> Top<'a> {
    pub(crate) fn read(path: &Path, text: &'a [u8], form: Form) -> Result<Top<'a>, Error> {
        let mut top = Top {
            delimiter: form.delimiter,
            comments: Vec::new(),
            rows: Vec::new(),
        };
        for (line, row) in lines(text).skip_while(|(line, _)| *line <= form.skip_lines) {
            if row.len() > LONGEST_LINE {
                check_columns(path, row, top.delimiter)?;
                return Err(Error::LongLine {
                    path: path.to_owned(),
                    line,
                    limit_bytes: LONGEST_LINE as u64,
                });
            }
            let separator = separator(row).filter(|_| top.rows.is_empty());
            if let Some(separator) = separator {
                top.delimiter = form.delimiter.or(Some(separator));
            } else if !is_comment(row) {
                top.rows.push((line, row));
            } else if top.rows.is_empty() {
                top.comments.push((line, row));
            }
            if top.rows.len() > SNIFFED_ROWS {
                break;
            }
        }
        match top.rows.first() {
            None => Err(Error::NoData {
                path: path.to_owned(),
                found: "no header",
            }),
            Some((_, first)) => check_columns(path, first, top.delimiter).map(|()| top),
        }
    }

    /// The header: the first row unless it is numbers, or the comment above numbers that has as many
    /// fields.
    pub(crate) fn header(
        &self,
        rows: &[Cow<'_, str>],
        delimiter: u8,
        no_header: bool,
    ) -> Option<HeaderLine<'a>> {
        let first = fields(&rows[0], delimiter);
        if no_header {
            return None;
        }
        self.commented_header(&first, delimiter).or_else(|| {
            let (line, text) = self.rows[0];
            let numbers = first.iter().all(|field| number(field).is_some());
            (!numbers).then(|| HeaderLine {
                line,
                text,
                names: names(&first),
            })
        })
    }

    fn commented_header(&self, first: &[&str], delimiter: u8) -> Option<HeaderLine<'a>> {
        let (line, text) = *self.comments.last()?;
        let comment = decoded(text);
        let comment = comment.trim_start_matches(['#', '/', '%', '"', ' ']);
        let fields = fields(comment, delimiter);
        let heads = fields.len() > 1
            && fields.len() == first.len()
            && first.iter().any(|field| number(field).is_some())
            && !fields.iter().any(|field| number(field).is_some());
        heads.then(|| HeaderLine {
            line,
            text,
            names: names(&fields),
        })
    }

    pub(crate) fn comments_above(&self, header: Option<usize>) -> Option<(usize, usize, String)> {
        let comments = self
            .comments
            .iter()
            .filter(|(line, _)| Some(*line) != header);
        let (line, first) = comments.clone().next()?;
        Some((comments.count(), *line, excerpt(&decoded(first))))
    }
}

/// Headers without the empty ones at the end.
pub(crate) fn names(fields: &[&str]) -> Vec<String> {
    let mut names: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
    while names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    names
}

/// The delimiter that a line such as `sep=;` names.
fn separator(line: &[u8]) -> Option<u8> {
    let line = line.strip_prefix(b"\"").unwrap_or(line);
    let line = line.strip_suffix(b"\"").unwrap_or(line);
    match line
        .get(..4)?
        .eq_ignore_ascii_case(b"sep=")
        .then(|| &line[4..])?
    {
        [delimiter @ (b',' | b';' | b'\t' | b' ')] => Some(*delimiter),
        _ => None,
    }
}

/// Counts before anything is built, so that a file with a row per channel fails at once.
fn check_columns(path: &Path, line: &[u8], delimiter: Option<u8>) -> Result<(), Error> {
    for candidate in delimiter.map_or(vec![b',', b';', b'\t', b' '], |d| vec![d]) {
        let columns = line.iter().filter(|b| **b == candidate).count() + 1;
        if columns > MAX_COLUMNS {
            return Err(Error::TooManyColumns {
                path: path.to_owned(),
                columns,
                limit: MAX_COLUMNS,
            });
        }
    }
    Ok(())
}

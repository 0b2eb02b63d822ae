//! Rows have as many fields as the header.

use std::path::Path;

use crate::lines::{decoded, fields};
use crate::text::Table;
use crate::top::SNIFFED_ROWS;
use crate::{Error, TableError};

const CURE: &str = "complete or delete the line, begin it with # where it is a comment, and use one delimiter throughout";

/// The fields of a row: as many as headers, or more if the surplus is empty.
pub(crate) fn checked_row<'r>(
    path: &Path,
    table: &Table<'_>,
    line: usize,
    row: &'r str,
) -> Result<Vec<&'r str>, Error> {
    let expected = table.head.headers.len();
    checked_fields(path, table.delimiter, expected, line, row, CURE)
        .map_err(|ragged| width_of_all(path, table).unwrap_or(ragged))
}

/// The error where the rows are of one width and the header is of another.
fn width_of_all(path: &Path, table: &Table<'_>) -> Option<Error> {
    let expected = table.head.headers.len();
    let mut widths = table.rows().take(SNIFFED_ROWS).map(|(line, row)| {
        let width = fields(&decoded(row), table.delimiter).len();
        (line, width)
    });
    let (line, found) = widths.next()?;
    let (count, same) = widths.fold((1, true), |(count, same), (_, width)| {
        (count + 1, same && width == found)
    });
    let header_line = table.head.line;
    (same && count > 2 && found > 1 && found != expected && header_line > 0).then(|| {
        TableError::HeaderWidth {
            path: path.to_owned(),
            line,
            found,
            expected,
            header_line,
        }
        .into()
    })
}

pub(crate) fn checked_fields<'r>(
    path: &Path,
    delimiter: u8,
    expected: usize,
    line: usize,
    row: &'r str,
    cure: &'static str,
) -> Result<Vec<&'r str>, Error> {
    let line_text = row;
    let row = fields(row, delimiter);
    if row.len() < expected || row[expected..].iter().any(|field| !field.is_empty()) {
        return Err(TableError::Ragged {
            path: path.to_owned(),
            line,
            found: row.len(),
            expected,
            delimiter: char::from(delimiter),
            other: [b',', b';', b'\t']
                .into_iter()
                .find(|other| fields(line_text, *other).len() == expected && expected > 1)
                .map(char::from),
            cure,
        }
        .into());
    }
    Ok(row)
}

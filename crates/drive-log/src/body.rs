//! The rows of a text table.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use polars::prelude::*;

use crate::Error;
use crate::text::{Table, decimal_mark, decoded, fields, lines, number};

/// Words for a value that is not there, in lower case.
const MISSING: [&str; 12] = [
    "", "na", "n/a", "nan", "-nan", "null", "none", "-", "inf", "+inf", "-inf", "infinity",
];

/// Reads columns of numbers: one vector per entry of `columns`, one value per row, NaN where
/// missing.
///
/// Polars reads what is plain numbers, at several hundred MB/s. Whatever it does not take is read
/// again row by row, which either understands it (quotes, `NA`, blanks as delimiter) or names the
/// cell that nobody understands.
pub(crate) fn numbers(
    path: &Path,
    table: &Table<'_>,
    columns: &[usize],
) -> Result<Vec<Vec<f64>>, Error> {
    // polars takes a point for a comma too
    let mixed_marks = table.decimal_comma == Some(true) && table.body.contains(&b'.');
    if table.delimiter != b' ' && !mixed_marks && !table.body.contains(&b'"') {
        let rows = count_rows(path, table)?;
        if let Ok(values) = fast(table, columns)
            && values.iter().all(|column| column.len() == rows)
        {
            return Ok(values);
        }
    }
    slow(path, table, columns)
}

/// The texts of one column, one per row.
pub(crate) fn texts(
    path: &Path,
    table: &Table<'_>,
    column: usize,
) -> Result<Vec<(usize, String)>, Error> {
    let mut texts = Vec::new();
    for (line, row) in rows(table) {
        let row = decoded(row);
        let row = checked_row(path, table, line, &row)?;
        texts.push((line, row[column].to_owned()));
    }
    Ok(texts)
}

/// The rows with their line in the file.
fn rows<'a>(table: &Table<'a>) -> impl Iterator<Item = (usize, &'a [u8])> {
    let before = table.first_line - 1;
    lines(table.body).map(move |(line, row)| (line + before, row))
}

/// Counts the rows and checks that each has as many fields as the header.
fn count_rows(path: &Path, table: &Table<'_>) -> Result<usize, Error> {
    let expected = table.head.headers.len();
    let mut count = 0;
    for (line, row) in rows(table) {
        count += 1;
        if row.iter().filter(|b| **b == table.delimiter).count() + 1 != expected {
            checked_row(path, table, line, &decoded(row))?;
        }
    }
    Ok(count)
}

/// The fields of a row: as many as headers, or more if the surplus is empty.
fn checked_row<'r>(
    path: &Path,
    table: &Table<'_>,
    line: usize,
    row: &'r str,
) -> Result<Vec<&'r str>, Error> {
    let expected = table.head.headers.len();
    checked_fields(path, table.delimiter, expected, line, row)
}

pub(crate) fn checked_fields<'r>(
    path: &Path,
    delimiter: u8,
    expected: usize,
    line: usize,
    row: &'r str,
) -> Result<Vec<&'r str>, Error> {
    let row = fields(row, delimiter);
    if row.len() < expected || row[expected..].iter().any(|field| !field.is_empty()) {
        return Err(Error::Ragged {
            path: path.to_owned(),
            line,
            found: row.len(),
            expected,
            delimiter: char::from(delimiter),
        });
    }
    Ok(row)
}

fn fast(table: &Table<'_>, columns: &[usize]) -> PolarsResult<Vec<Vec<f64>>> {
    let name = |column: usize| PlSmallStr::from(column.to_string());
    let width = table.head.headers.len();
    let schema: Schema = (0..width)
        .map(|column| Field::new(name(column), DataType::Float64))
        .collect();
    let mut projection = columns.to_vec();
    projection.sort_unstable();
    projection.dedup();
    let frame = CsvReadOptions::default()
        .with_has_header(false)
        .with_schema(Some(Arc::new(schema)))
        .with_projection(Some(Arc::new(projection)))
        .with_n_threads(Some(1))
        .map_parse_options(|options| {
            options
                .with_separator(table.delimiter)
                .with_quote_char(None)
                .with_encoding(CsvEncoding::LossyUtf8)
                .with_decimal_comma(table.decimal_comma == Some(true))
                .with_truncate_ragged_lines(true)
        })
        .into_reader_with_file_handle(Cursor::new(table.body))
        .finish()?;
    columns
        .iter()
        .map(|column| floats(frame.column(&name(*column))?))
        .collect()
}

/// The values of a column of floats, NaN for null.
pub(crate) fn floats(column: &Column) -> PolarsResult<Vec<f64>> {
    let values = column.f64()?;
    let mut floats = Vec::with_capacity(values.len());
    for chunk in values.downcast_iter() {
        match chunk.validity() {
            None => floats.extend_from_slice(chunk.values()),
            Some(_) => floats.extend(chunk.iter().map(|value| value.copied().unwrap_or(f64::NAN))),
        }
    }
    Ok(floats)
}

fn slow(path: &Path, table: &Table<'_>, columns: &[usize]) -> Result<Vec<Vec<f64>>, Error> {
    let mut values = vec![Vec::new(); columns.len()];
    let mut decimal_comma = table.decimal_comma;
    for (line, row) in rows(table) {
        let row = decoded(row);
        let row = checked_row(path, table, line, &row)?;
        for (column, values) in columns.iter().zip(&mut values) {
            let text = row[*column];
            let value =
                cell(text, table.delimiter, &mut decimal_comma).ok_or_else(|| Error::Cell {
                    path: path.to_owned(),
                    line,
                    header: table.head.headers[*column].clone(),
                    text: text.chars().take(60).collect(),
                })?;
            values.push(value);
        }
    }
    Ok(values)
}

/// A number or a missing value. The first decimal mark of a file decides for the rest: in `1.5` and
/// `1,234` only one is a mark.
pub(crate) fn cell(text: &str, delimiter: u8, decimal_comma: &mut Option<bool>) -> Option<f64> {
    if MISSING.iter().any(|word| word.eq_ignore_ascii_case(text)) {
        return Some(f64::NAN);
    }
    let value = number(text, delimiter)?;
    if let Some(mark) = decimal_mark(text)
        && *decimal_comma.get_or_insert(mark) != mark
    {
        return None;
    }
    Some(value)
}

//! The rows of a text table.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use polars_core::prelude::{Column, DataType, Field, PlSmallStr, PolarsResult, Schema};
use polars_io::SerReader;
use polars_io::csv::read::{CsvEncoding, CsvReadOptions};

use crate::cells::RowByRow;
use crate::columns::{Columns, Wanted};
use crate::lines::{decoded, fields};
use crate::number::{decided_mark, decimal_mark, number};
use crate::origin::Kinds;
use crate::row_width::checked_row;
use crate::text::Table;
use crate::{Error, TableError};

/// Reads columns of numbers: one vector per entry of `columns`, one value per row, NaN where
/// missing. `missing` are the layout's words for that.
///
/// Polars reads what is plain numbers, at several hundred MB/s. Whatever it does not take is read
/// again row by row, which either understands it (quotes, `NA`, blanks as delimiter) or names the
/// cell that nobody understands.
pub(crate) fn numbers(
    path: &Path,
    table: &Table<'_>,
    columns: &[Wanted],
    missing: &[String],
) -> Result<Columns, Error> {
    let decimal_comma = settled_mark(path, table, columns)?;
    // polars takes a point for a comma too
    let mixed_marks = decimal_comma == Some(true) && table.body.contains(&b'.');
    if table.delimiter != b' ' && !mixed_marks && !table.body.contains(&b'"') {
        let rows = count_rows(path, table)?;
        if let Ok(values) = fast(table, columns, decimal_comma)
            && values.iter().all(|column| column.len() == rows)
        {
            return Ok((values, Vec::new()));
        }
    }
    RowByRow::new(path, table, columns, missing, decimal_comma).read()
}

/// The decimal mark. In `1.234` it may separate thousands: then another number must tell, since a
/// wrong guess is wrong by a thousand. Where a comma delimits, a point without quotes is decimal.
fn settled_mark(path: &Path, table: &Table<'_>, columns: &[Wanted]) -> Result<Option<bool>, Error> {
    let delimited_by_comma = table.delimiter == b',' && !table.body.contains(&b'"');
    if table.mark_decided || delimited_by_comma {
        return Ok(table.decimal_comma);
    }
    let marked = |byte: &u8| matches!(byte, b'.' | b',') && *byte != table.delimiter;
    if table.delimiter != b',' && !table.body.iter().any(marked) {
        return Ok(None);
    }
    let mut open = None;
    for (line, row) in table.rows() {
        let row = decoded(row);
        let cells = fields(&row, table.delimiter);
        let numbers = cells.iter().filter(|cell| number(cell).is_some());
        if let Some(comma) = numbers.clone().find_map(|cell| decided_mark(cell)) {
            return Ok(Some(comma));
        }
        open = open.or_else(|| {
            let open = columns.iter().find(|wanted| {
                let cell = cells.get(wanted.column).copied().unwrap_or_default();
                decimal_mark(cell).is_some() && number(cell).is_some()
            })?;
            Some((line, open.column, cells[open.column].to_owned()))
        });
    }
    open.map_or(Ok(None), |(line, column, text)| {
        Err(TableError::DecimalMark {
            path: path.to_owned(),
            line,
            header: table.head.headers[column].clone(),
            text,
        }
        .into())
    })
}

/// The texts of one column, one per row.
pub(crate) fn texts(
    path: &Path,
    table: &Table<'_>,
    column: usize,
) -> Result<Vec<(usize, String)>, Error> {
    let mut texts = Vec::new();
    for (line, row) in table.rows() {
        let row = decoded(row);
        let row = checked_row(path, table, line, &row)?;
        texts.push((line, row[column].to_owned()));
    }
    Ok(texts)
}

/// The values of one column as texts without repetition, in the order in which they come, and
/// which of them each row has; `None` where it has none.
pub(crate) fn kinds(path: &Path, table: &Table<'_>, column: usize) -> Result<Kinds, Error> {
    let mut kinds = Kinds::default();
    for (line, row) in table.rows() {
        let row = decoded(row);
        let cells = checked_row(path, table, line, &row)?;
        kinds.push(cells[column]);
    }
    Ok(kinds)
}

/// Counts the rows and checks that each has as many fields as the header.
fn count_rows(path: &Path, table: &Table<'_>) -> Result<usize, Error> {
    let expected = table.head.headers.len();
    let mut count = 0;
    for (line, row) in table.rows() {
        count += 1;
        if row.iter().filter(|b| **b == table.delimiter).count() + 1 != expected {
            checked_row(path, table, line, &decoded(row))?;
        }
    }
    Ok(count)
}

fn fast(
    table: &Table<'_>,
    columns: &[Wanted],
    decimal_comma: Option<bool>,
) -> PolarsResult<Vec<Vec<f64>>> {
    let name = |column: usize| PlSmallStr::from(column.to_string());
    let width = table.head.headers.len();
    let schema: Schema = (0..width)
        .map(|column| Field::new(name(column), DataType::Float64))
        .collect();
    let mut projection: Vec<usize> = columns.iter().map(|wanted| wanted.column).collect();
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
                .with_decimal_comma(decimal_comma == Some(true))
                .with_truncate_ragged_lines(true)
        })
        .into_reader_with_file_handle(Cursor::new(table.body.as_ref()))
        .finish()?;
    columns
        .iter()
        .map(|wanted| floats(frame.column(&name(wanted.column))?))
        .collect()
}

/// The values of a column of floats, NaN for null.
fn floats(column: &Column) -> PolarsResult<Vec<f64>> {
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

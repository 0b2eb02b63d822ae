//! Cells that are read one by one: words for missing values, marks between thousands, units.

use std::collections::BTreeMap;
use std::path::Path;

use crate::columns::{Columns, Wanted};
use crate::lines::{decoded, fields};
use crate::note::{About, Note, excerpt};
use crate::number::{decimal_mark, is_missing, is_range, number, number_and_rest, thousands};
use crate::row_width::checked_row;
use crate::text::Table;
use crate::unit::Unit;
use crate::{Action, Channel, Error, FindingKind, TableError};

/// Words in place of numbers in a column: how often each is there, and in which rows.
#[derive(Default)]
struct Words {
    first: Option<(usize, String)>,
    kinds: BTreeMap<String, usize>,
    rows: Vec<usize>,
}

/// Reads row by row.
pub(crate) struct RowByRow<'a> {
    path: &'a Path,
    table: &'a Table<'a>,
    columns: &'a [Wanted],
    missing: &'a [String],
    decimal_comma: Option<bool>,
    /// Per column, whether its whole numbers have marks between thousands, once that was asked.
    grouped: Vec<Option<bool>>,
    words: Vec<Words>,
}

impl<'a> RowByRow<'a> {
    pub(crate) fn new(
        path: &'a Path,
        table: &'a Table<'a>,
        columns: &'a [Wanted],
        missing: &'a [String],
        decimal_comma: Option<bool>,
    ) -> Self {
        RowByRow {
            path,
            table,
            columns,
            missing,
            decimal_comma,
            grouped: vec![None; columns.len()],
            words: columns.iter().map(|_| Words::default()).collect(),
        }
    }

    pub(crate) fn read(mut self) -> Result<Columns, Error> {
        let mut values = vec![Vec::new(); self.columns.len()];
        for (row, (line, text)) in self.table.rows().enumerate() {
            let text = decoded(text);
            let cells = checked_row(self.path, self.table, line, &text)?;
            for (k, values) in values.iter_mut().enumerate() {
                let text = cells[self.columns[k].column];
                let value = match cell(text, &mut self.decimal_comma) {
                    Some(value) => value,
                    None => self.odd_cell(k, (row, line), text)?,
                };
                values.push(value);
            }
        }
        let notes = self.columns.iter().zip(&self.words);
        let notes = notes.filter_map(|(wanted, words)| words.note(wanted.channel?));
        let notes = notes.collect();
        Ok((values, notes))
    }

    /// The value of a cell that is no plain number.
    fn odd_cell(
        &mut self,
        k: usize,
        (row, line): (usize, usize),
        text: &str,
    ) -> Result<f64, Error> {
        let wanted = self.columns[k];
        if self
            .missing
            .iter()
            .any(|word| word.eq_ignore_ascii_case(text))
        {
            return Ok(f64::NAN);
        }
        let mark = if self.decimal_comma == Some(true) {
            '.'
        } else {
            ','
        };
        if let Some(value) = thousands(text, mark)
            && self.decimal_comma.is_some()
            && self.is_grouped(k, mark)
        {
            return Ok(value);
        }
        if let Some((value, rest)) = number_and_rest(text)
            && let Some(unit) = Unit::parse(wanted.unit.quantity(), rest)
        {
            return self.in_unit(wanted, line, (value, unit), rest);
        }
        let wordy = !text.chars().any(|c| c.is_ascii_digit()) || is_range(text);
        if wordy && !wanted.is_needed() {
            self.words[k].take(row, line, text);
            return Ok(f64::NAN);
        }
        Err(TableError::Cell {
            path: self.path.to_owned(),
            line,
            header: self.table.head.headers[wanted.column].clone(),
            text: excerpt(text),
        }
        .into())
    }

    /// A value with its unit behind it, which must be that of the column.
    fn in_unit(
        &self,
        wanted: Wanted,
        line: usize,
        (value, unit): (f64, Unit),
        found: &str,
    ) -> Result<f64, Error> {
        if unit == wanted.unit {
            return Ok(value);
        }
        Err(TableError::UnitAtOdds {
            path: self.path.to_owned(),
            line,
            header: self.table.head.headers[wanted.column].clone(),
            found: found.to_owned(),
            unit: wanted.unit.to_string(),
        }
        .into())
    }

    /// Whether `mark` stands between the thousands of all numbers of a column: none has it
    /// elsewhere, and none over a thousand is without. Where numbers have decimals, one must have
    /// both marks.
    fn is_grouped(&mut self, k: usize, mark: char) -> bool {
        let column = self.columns[k].column;
        let decimal_mark = if mark == ',' { '.' } else { ',' };
        *self.grouped[k].get_or_insert_with(|| {
            let (mut decimals, mut both) = (false, false);
            let grouped = self.table.rows().all(|(_, row)| {
                let row = decoded(row);
                let cells = fields(&row, self.table.delimiter);
                let cell = cells.get(column).copied().unwrap_or_default();
                let (whole, decimal) = match cell.split_once(decimal_mark) {
                    Some((whole, _)) => (whole, true),
                    None => (cell, false),
                };
                let small = whole.trim_start_matches(['+', '-']);
                let small = small.len() <= 3 && small.bytes().all(|b| b.is_ascii_digit());
                let large = thousands(whole, mark).is_some();
                decimals |= decimal;
                both |= decimal && large;
                small || large || number(cell).is_none()
            });
            grouped && (both || !decimals)
        })
    }
}

impl Words {
    fn take(&mut self, row: usize, line: usize, text: &str) {
        self.first.get_or_insert_with(|| (line, excerpt(text)));
        if self.kinds.len() < 10 || self.kinds.contains_key(text) {
            *self.kinds.entry(excerpt(text)).or_default() += 1;
        }
        self.rows.push(row);
    }

    fn note(&self, channel: Channel) -> Option<Note> {
        let (line, first) = self.first.as_ref()?;
        let others: Vec<String> = self
            .kinds
            .keys()
            .filter(|word| *word != first)
            .map(|word| format!("{word:?}"))
            .collect();
        let others = if others.is_empty() {
            String::new()
        } else {
            format!(", also {}", others.join(", "))
        };
        Some(Note {
            kind: FindingKind::NoNumber,
            channel: Some(channel),
            action: Action::Removed,
            about: About::Rows {
                rows: self.rows.clone(),
                names: ("cell is no number", "cells are no numbers"),
                rest: format!(", first {first:?} in line {line}{others}"),
            },
        })
    }
}

/// A number or a missing value. The first decimal mark of a file decides for the rest: in `1.5` and
/// `1,234` only one is a mark.
pub(crate) fn cell(text: &str, decimal_comma: &mut Option<bool>) -> Option<f64> {
    if is_missing(text) {
        return Some(f64::NAN);
    }
    let value = number(text)?;
    if let Some(mark) = decimal_mark(text)
        && *decimal_comma.get_or_insert(mark) != mark
    {
        return None;
    }
    Some(value)
}

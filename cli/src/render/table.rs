//! Aligned tables for people.

use std::fmt::Write as _;

const BOLD: &str = "\u{1b}[1m";
const DIM: &str = "\u{1b}[2m";
const RESET: &str = "\u{1b}[0m";

/// The first column is text, aligned left; the others are aligned right.
pub(crate) struct Table {
    header: Vec<String>,
    rows: Vec<Row>,
}

enum Row {
    Cells(Vec<String>),
    Heading(String),
}

impl Table {
    pub(crate) fn new<const N: usize>(header: [&str; N]) -> Self {
        Self {
            header: header.map(str::to_owned).to_vec(),
            rows: Vec::new(),
        }
    }

    pub(crate) fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(Row::Cells(cells.to_vec()));
    }

    /// A line of its own between rows.
    pub(crate) fn heading(&mut self, text: &str) {
        self.rows.push(Row::Heading(text.to_owned()));
    }

    pub(crate) fn render(&self) -> String {
        let widths: Vec<usize> = (0..self.header.len())
            .map(|column| self.width(column))
            .collect();
        let mut text = format!("{BOLD}{}{RESET}\n", line(&self.header, &widths));
        for row in &self.rows {
            let _ = match row {
                Row::Cells(cells) => writeln!(text, "{}", line(cells, &widths)),
                Row::Heading(heading) => writeln!(text, "{DIM}{heading}{RESET}"),
            };
        }
        text
    }

    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| match row {
            Row::Cells(cells) => cells.get(column),
            Row::Heading(_) => None,
        });
        cells
            .chain(self.header.get(column))
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
    }
}

fn line(cells: &[String], widths: &[usize]) -> String {
    let mut text = String::new();
    for (column, (cell, width)) in cells.iter().zip(widths).enumerate() {
        let _ = match column {
            0 => write!(text, "{cell:<width$}"),
            _ => write!(text, "  {cell:>width$}"),
        };
    }
    text.truncate(text.trim_end().len());
    text
}

/// A number with some decimals, or `–` where it is not defined.
pub(crate) fn number(value: impl Into<Option<f64>>, decimals: usize) -> String {
    match value.into() {
        Some(value) if value.is_finite() => {
            let text = format!("{value:.decimals$}");
            let zero = text
                .trim_start_matches('-')
                .chars()
                .all(|c| matches!(c, '0' | '.'));
            if zero {
                text.trim_start_matches('-').to_owned()
            } else {
                text
            }
        }
        _ => "–".to_owned(),
    }
}

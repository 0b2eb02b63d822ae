//! Aligned tables for people.

use std::fmt::Write as _;

const BOLD: &str = "\u{1b}[1m";
const DIM: &str = "\u{1b}[2m";
const RESET: &str = "\u{1b}[0m";

/// Columns of numbers are aligned right, others left.
#[derive(Debug)]
pub struct Table {
    header: Vec<String>,
    rows: Vec<Row>,
}

#[derive(Debug)]
enum Row {
    Cells(Vec<String>),
    Heading(String),
}

impl Table {
    /// Without rows.
    #[must_use]
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Self {
            header: header.map(str::to_owned).to_vec(),
            rows: Vec::new(),
        }
    }

    /// As [`Self::new`], where the number of columns is only known at run time.
    #[must_use]
    pub fn with_columns(header: Vec<String>) -> Self {
        Self {
            header,
            rows: Vec::new(),
        }
    }

    /// A row of a table [`Self::with_columns`].
    pub fn add(&mut self, cells: Vec<String>) {
        self.rows.push(Row::Cells(cells));
    }

    /// A row with a cell per column.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(Row::Cells(cells.into()));
    }

    /// A line of its own between rows.
    pub fn heading(&mut self, text: &str) {
        self.rows.push(Row::Heading(text.to_owned()));
    }

    /// Whether there is no row yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Lines with the escape codes of a terminal: the header is bold.
    #[must_use]
    pub fn render(&self) -> String {
        let columns: Vec<Column> = (0..self.header.len())
            .map(|index| self.column(index))
            .collect();
        let mut text = format!("{BOLD}{}{RESET}\n", line(&self.header, &columns));
        for row in &self.rows {
            let _ = match row {
                Row::Cells(cells) => writeln!(text, "{}", line(cells, &columns)),
                Row::Heading(heading) => writeln!(text, "{DIM}{heading}{RESET}"),
            };
        }
        text
    }

    fn column(&self, index: usize) -> Column {
        let cells = || {
            self.rows.iter().filter_map(|row| match row {
                Row::Cells(cells) => cells.get(index).map(String::as_str),
                Row::Heading(_) => None,
            })
        };
        let header = self.header.get(index).map(String::as_str);
        Column {
            width: cells()
                .chain(header)
                .map(|cell| cell.chars().count())
                .max()
                .unwrap_or(0),
            numbers: cells().all(|cell| matches!(cell, "" | "–") || cell.parse::<f64>().is_ok()),
        }
    }
}

struct Column {
    width: usize,
    numbers: bool,
}

fn line(cells: &[String], columns: &[Column]) -> String {
    let mut text = String::new();
    for (cell, &Column { width, numbers }) in cells.iter().zip(columns) {
        let _ = match numbers {
            true => write!(text, "{cell:>width$}  "),
            false => write!(text, "{cell:<width$}  "),
        };
    }
    text.truncate(text.trim_end().len());
    text
}

/// A number with some decimals, or `–` where it is not defined.
#[must_use]
pub fn number(value: impl Into<Option<f64>>, decimals: usize) -> String {
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

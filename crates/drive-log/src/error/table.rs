//! What can be wrong with the rows and cells of a table.

use std::path::PathBuf;

/// Why a row or a cell could not be read. Every message names its line and says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A row has another number of fields than the header, or another delimiter.
    #[error(
        "{}, line {line}: {} where {expected} are expected with the delimiter {delimiter:?}{}; {cure}",
        path.display(),
        if *found == 1 { "1 field".to_owned() } else { format!("{found} fields") },
        other.map_or(String::new(), |other| format!(" ({expected} with {other:?})"))
    )]
    Ragged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Fields found.
        found: usize,
        /// Fields of the header.
        expected: usize,
        /// The delimiter.
        delimiter: char,
        /// A delimiter with which the row has as many fields as expected.
        other: Option<char>,
        /// What to do, in words.
        cure: &'static str,
    },
    /// All rows have another number of fields than the header.
    #[error(
        "{}, line {line}: this row and those after it have {found} fields, the header has {expected}: which column is which? \
         Correct the header, or name the columns by number in a layout: no_header = true, skip_lines = {header_line}, \
         time = {{ column = 1, unit = \"s\" }}",
        path.display()
    )]
    HeaderWidth {
        /// The file.
        path: PathBuf,
        /// Line of the first row, from 1.
        line: usize,
        /// Fields of the rows.
        found: usize,
        /// Fields of the header.
        expected: usize,
        /// Line of the header.
        header_line: usize,
    },
    /// A cell of a used column is not a number.
    #[error(
        "{}, line {line}, column {header:?}: {text:?} is not a number; {}",
        path.display(),
        cure_of_cell(text)
    )]
    Cell {
        /// The file.
        path: PathBuf,
        /// Line, from 1; row for Parquet.
        line: usize,
        /// Header of the column.
        header: String,
        /// What is in the cell.
        text: String,
    },
    /// A cell or a row under the header gives another unit than the header or the layout.
    #[error(
        "{}, line {line}, column {header:?}: the unit is {found:?} there, and {unit} by the header or the layout; correct one of them",
        path.display()
    )]
    UnitAtOdds {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Header of the column.
        header: String,
        /// The unit in the row.
        found: String,
        /// The unit of the header or the layout.
        unit: String,
    },
    /// No number of the file tells its decimal mark from one between thousands.
    #[error(
        "{}, line {line}, column {header:?}: {text:?} may be a thousand times as much, since no other number tells the decimal mark; \
         say it in a layout: decimal = \".\" or decimal = \",\", or write thousands without a mark",
        path.display()
    )]
    DecimalMark {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Header of the column.
        header: String,
        /// The first such number.
        text: String,
    },
    /// A clock time is not a time.
    #[error("{}, line {line}, column {header:?}: {text:?} is not a time; write it as 2026-03-29T01:55:00, with Z or +01:00 in all rows or in none, or as HH:MM:SS, or leave the cell empty; of 29/3/2026 a layout says with date_order = \"dmy\" or \"mdy\" what is the day", path.display())]
    Clock {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Header of the column.
        header: String,
        /// What is in the cell.
        text: String,
    },
    /// Nothing tells the day from the month.
    #[error(
        "{}, line {line}, column {header:?}: is {text:?} D/M/Y or M/D/Y? The file does not tell; \
         say it in a layout: date_order = \"dmy\" or \"mdy\", or write YYYY-MM-DD",
        path.display()
    )]
    DateOrder {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Header of the column.
        header: String,
        /// What is in the cell.
        text: String,
    },
}

/// What to do about a cell that is no number.
fn cure_of_cell(text: &str) -> String {
    if text.chars().any(|c| c.is_ascii_digit()) {
        "correct it (one decimal mark throughout, nothing between thousands), or leave the cell empty where the value is missing".to_owned()
    } else {
        format!(
            "correct it, or leave the cell empty where the value is missing, or say in a layout that the word means so: missing = [{text:?}]"
        )
    }
}

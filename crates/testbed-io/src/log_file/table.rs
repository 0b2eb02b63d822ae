//! Named columns with one text of metadata.

use std::collections::HashSet;

use parquet_table::{Column, Values};

use super::flaw::{DAMAGED, Flaw};
use super::limits::MAX_COLUMNS;
use crate::Error;

/// A table of columns of the same length, with metadata.
#[derive(Debug, Clone, PartialEq)]
pub struct LogTable {
    pub(super) meta: String,
    pub(super) columns: Vec<Column>,
    pub(super) truncated: bool,
    pub(super) states_its_end: bool,
}

impl LogTable {
    /// Makes a table. `meta` is JSON: the scenario and configuration that made the run; line breaks
    /// in it become blanks.
    ///
    /// # Errors
    ///
    /// [`Error::Table`] if `meta` is not JSON, a name is empty, begins with a byte order mark or appears twice, the columns differ
    /// in length, or there are more than 10,000 of them.
    pub fn new(meta: &str, columns: Vec<Column>) -> Result<LogTable, Error> {
        let problem = |problem: String| Err(Error::Table { problem });
        if let Err(error) = serde_json::from_str::<serde::de::IgnoredAny>(meta) {
            return problem(format!("the metadata is not JSON: {error}"));
        }
        if columns.len() > MAX_COLUMNS {
            let count = columns.len();
            return problem(format!("{count} columns, at most {MAX_COLUMNS} are logged"));
        }
        let mut names = HashSet::new();
        for column in &columns {
            let name = &column.name;
            if name.is_empty() {
                return problem("a column without a name; name every column".to_owned());
            }
            if name.starts_with('\u{feff}') {
                return problem(format!("column {name:?} begins with a byte order mark"));
            }
            if !names.insert(name) {
                return problem(format!("two columns {name:?}; give each its own name"));
            }
            let (len, first) = (column.values.len(), columns[0].values.len());
            if len != first {
                return problem(format!(
                    "column {name:?} has {len} values and the first column {first}; \
                     give every column one value per row"
                ));
            }
        }
        Ok(LogTable {
            meta: meta.replace(['\r', '\n'], " "),
            columns,
            truncated: false,
            states_its_end: true,
        })
    }

    /// The metadata, JSON on one line.
    #[must_use]
    pub fn meta(&self) -> &str {
        &self.meta
    }

    /// The columns, in the order of the file.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Takes the columns out.
    #[must_use]
    pub fn into_columns(self) -> Vec<Column> {
        self.columns
    }

    /// The values of the column with this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        let column = self.columns.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether the end of the file was missing, so that rows may be missing here.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.truncated
    }

    /// Whether the file says where it ends. CSV files of before and those of sessions that go on or were killed do not.
    #[must_use]
    pub fn states_its_end(&self) -> bool {
        self.states_its_end
    }
}

/// The table of a file.
pub(super) fn table(meta: &str, columns: Vec<Column>, truncated: bool) -> Result<LogTable, Flaw> {
    match LogTable::new(meta, columns) {
        Ok(table) => Ok(LogTable { truncated, ..table }),
        Err(error) => Err(Flaw::new(error.to_string(), DAMAGED)),
    }
}

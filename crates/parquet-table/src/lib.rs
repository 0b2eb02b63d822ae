//! Named columns to Apache Parquet and back, from files that need not be whole.
//!
//! A table is a list of [`Column`]s of one length: numbers, whole numbers or texts. [`write()`] makes a file of them;
//! [`File::open`] reads the footer and checks the page headers of all columns against what the footer and the file hold,
//! so that a damaged file of a few bytes can neither end the program nor make it allocate what it promises; then columns
//! are decoded one kind at a time.
//!
//! # Example
//!
//! ```
//! use parquet_table::{Column, File, Values};
//!
//! let columns = [
//!     Column::new("time_s", Values::Float(vec![0.0, 0.1])),
//!     Column::new("robot", Values::Text(vec!["a".into(), "b".into()])),
//! ];
//! let mut bytes = Vec::new();
//! parquet_table::write(&columns, &[("by", "example")], &mut bytes)?;
//!
//! let file = File::open(&bytes)?;
//! assert_eq!((file.rows(), file.columns().len()), (2, 2));
//! assert_eq!(file.metadata("by"), Some("example"));
//! assert_eq!(file.floats(&[0])?, [[0.0, 0.1]]);
//! assert_eq!(file.texts(1, 1000)?[1].as_deref(), Some("b"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//!
//! - Apache Parquet format, `parquet.thrift`; Apache Thrift, compact protocol.

mod pages;
mod read;
mod write;

pub use read::{ColumnHead, File, Kind};
pub use write::write;

/// A column with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The column's name
    pub name: String,
    /// Its values, one per row
    pub values: Values,
}

impl Column {
    /// A column of these values.
    #[must_use]
    pub fn new(name: impl Into<String>, values: Values) -> Self {
        let name = name.into();
        Self { name, values }
    }
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers, NaN where there is none; written as null
    Float(Vec<f64>),
    /// Whole numbers
    Integer(Vec<i64>),
    /// Texts
    Text(Vec<String>),
}

impl Values {
    /// The number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Float(values) => values.len(),
            Self::Integer(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// Whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Why a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The decoder's words
    #[error("{0}")]
    Decoder(String),
    /// The footer, the page headers and the file do not agree
    #[error("{0}")]
    Damaged(&'static str),
    /// Texts take more bytes than the caller allows
    #[error("texts of more than {limit_bytes} bytes")]
    TooLarge {
        /// What the caller allows
        limit_bytes: u64,
    },
}

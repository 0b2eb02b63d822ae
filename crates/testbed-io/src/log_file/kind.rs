//! The types of columns.

use parquet_table::{Column, Values};
use serde::{Deserialize, Serialize};

/// Which type of values a column has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    Float,
    Integer,
    Text,
}

impl Kind {
    pub(super) fn of(values: &Values) -> Kind {
        match values {
            Values::Float(_) => Kind::Float,
            Values::Integer(_) => Kind::Integer,
            Values::Text(_) => Kind::Text,
        }
    }

    pub(super) fn column(self, name: String) -> Column {
        let values = match self {
            Kind::Float => Values::Float(Vec::new()),
            Kind::Integer => Values::Integer(Vec::new()),
            Kind::Text => Values::Text(Vec::new()),
        };
        Column { name, values }
    }
}

pub(super) fn letter(kind: Kind) -> char {
    match kind {
        Kind::Float => 'f',
        Kind::Integer => 'i',
        Kind::Text => 't',
    }
}

pub(super) fn kind(letter: char) -> Option<Kind> {
    match letter {
        'f' => Some(Kind::Float),
        'i' => Some(Kind::Integer),
        't' => Some(Kind::Text),
        _ => None,
    }
}

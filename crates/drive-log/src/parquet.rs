//! Parquet files.

use std::path::Path;

use parquet_table::Kind;

use crate::Error;
use crate::columns::Wanted;
use crate::compressed::LIMIT_BYTES;
use crate::header::Head;
use crate::note::excerpt;
use crate::top::MAX_COLUMNS;

/// A Parquet file whose columns are known.
pub(crate) struct File<'a> {
    path: &'a Path,
    file: parquet_table::File<'a>,
    pub(crate) head: Head,
}

impl<'a> File<'a> {
    pub(crate) fn open(path: &'a Path, bytes: &'a [u8]) -> Result<File<'a>, Error> {
        let file = parquet_table::File::open(bytes).map_err(|problem| of_file(path, &problem))?;
        let columns = file.columns().len();
        if columns > MAX_COLUMNS {
            return Err(Error::TooManyColumns {
                path: path.to_owned(),
                columns,
                limit: MAX_COLUMNS,
            });
        }
        if file.rows() == 0 {
            return Err(Error::NoData {
                path: path.to_owned(),
                found: "no rows",
            });
        }
        let headers = file.columns().iter().map(|column| column.name.clone());
        let head = Head {
            preamble: Vec::new(),
            headers: headers.collect(),
            has_header: true,
            line: 0,
        };
        Ok(File { path, file, head })
    }

    /// Reads columns of numbers, NaN for null.
    pub(crate) fn numbers(&self, columns: &[Wanted]) -> Result<Vec<Vec<f64>>, Error> {
        let columns: Vec<usize> = columns.iter().map(|wanted| wanted.column).collect();
        self.check_types(&columns, is_number)?;
        let read = self.file.floats(&columns);
        read.map_err(|problem| of_file(self.path, &problem))
    }

    /// Reads a column of texts or whole numbers as texts, empty for null.
    pub(crate) fn texts(&self, column: usize) -> Result<Vec<String>, Error> {
        self.check_types(&[column], |kind| is_number(kind) || kind == Kind::Text)?;
        if !self.is_text(column) {
            let read = self.file.floats(&[column]);
            let values = read.map_err(|problem| of_file(self.path, &problem))?;
            return Ok(values.iter().flatten().map(ToString::to_string).collect());
        }
        let read = self.file.texts(column, LIMIT_BYTES);
        let texts = read.map_err(|problem| of_file(self.path, &problem))?;
        Ok(texts.into_iter().map(Option::unwrap_or_default).collect())
    }

    /// Whether a column holds texts.
    pub(crate) fn is_text(&self, column: usize) -> bool {
        self.file.columns()[column].kind == Kind::Text
    }

    fn check_types(
        &self,
        columns: &[usize],
        can_be_read: impl Fn(Kind) -> bool,
    ) -> Result<(), Error> {
        let heads = self.file.columns();
        if let Some(&column) = columns.iter().find(|c| !can_be_read(heads[**c].kind)) {
            return Err(Error::ColumnType {
                path: self.path.to_owned(),
                header: heads[column].name.clone(),
                found: excerpt(&heads[column].type_name),
            });
        }
        if (self.file.rows() as u64).saturating_mul(8 * columns.len() as u64) > LIMIT_BYTES {
            return Err(too_large(self.path));
        }
        Ok(())
    }
}

fn is_number(kind: Kind) -> bool {
    matches!(kind, Kind::Float | Kind::Integer)
}

fn too_large(path: &Path) -> Error {
    Error::TooLarge {
        path: path.to_owned(),
        limit_bytes: LIMIT_BYTES,
    }
}

fn of_file(path: &Path, problem: &parquet_table::Error) -> Error {
    match problem {
        parquet_table::Error::TooLarge { .. } => too_large(path),
        other => Error::Parquet {
            path: path.to_owned(),
            problem: other.to_string(),
        },
    }
}

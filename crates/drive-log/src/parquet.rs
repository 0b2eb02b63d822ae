//! Parquet files.

use std::io::Cursor;
use std::ops::Range;
use std::path::Path;

use polars::prelude::*;

use crate::Error;
use crate::body::{Wanted, floats};
use crate::compressed::LIMIT_BYTES;
use crate::layout::Head;
use crate::note::excerpt;
use crate::pages::check_chunk;
use crate::text::MAX_COLUMNS;

pub(crate) const MAGIC: &[u8] = b"PAR1";

/// A Parquet file whose columns are known.
pub(crate) struct File<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    rows: u64,
    types: Vec<ArrowDataType>,
    pub(crate) head: Head,
}

impl<'a> File<'a> {
    pub(crate) fn open(path: &'a Path, bytes: &'a [u8]) -> Result<File<'a>, Error> {
        let mut reader = ParquetReader::new(Cursor::new(bytes));
        let rows = guarded(path, || reader.num_rows())?;
        let problem = guarded(path, || {
            let checks = reader.get_metadata()?.row_groups.iter().flat_map(|group| {
                let chunks = group.parquet_columns().iter();
                chunks.map(|chunk| {
                    let flat = chunk.descriptor().descriptor.max_rep_level == 0;
                    check_values(
                        bytes,
                        chunk.byte_range(),
                        chunk.num_values(),
                        flat.then(|| group.num_rows()),
                    )
                })
            });
            Ok(checks.collect::<Result<(), &str>>().err())
        })?;
        if let Some(problem) = problem {
            return Err(Error::Parquet {
                path: path.to_owned(),
                problem: problem.to_owned(),
            });
        }
        let schema = guarded(path, || reader.schema())?;
        let columns = schema.len();
        if columns > MAX_COLUMNS {
            return Err(Error::TooManyColumns {
                path: path.to_owned(),
                columns,
                limit: MAX_COLUMNS,
            });
        }
        if rows == 0 {
            return Err(Error::NoData {
                path: path.to_owned(),
                found: "no rows",
            });
        }
        Ok(File {
            path,
            bytes,
            rows: rows as u64,
            types: schema
                .iter_values()
                .map(|field| field.dtype().clone())
                .collect(),
            head: Head {
                preamble: Vec::new(),
                headers: schema.iter_names().map(ToString::to_string).collect(),
                has_header: true,
                line: 0,
            },
        })
    }

    /// Reads columns of numbers, NaN for null.
    pub(crate) fn numbers(&self, columns: &[Wanted]) -> Result<Vec<Vec<f64>>, Error> {
        let columns: Vec<usize> = columns.iter().map(|wanted| wanted.column).collect();
        self.check_types(&columns, is_number)?;
        self.read(&columns, |column| floats(&column.cast(&DataType::Float64)?))
    }

    /// Reads a column of texts or whole numbers as texts, empty for null.
    pub(crate) fn texts(&self, column: usize) -> Result<Vec<String>, Error> {
        self.check_types(&[column], |data_type| {
            is_number(data_type) || is_text(data_type)
        })?;
        let numbers = !self.is_text(column);
        let texts: Vec<Vec<String>> = self.read(&[column], |column| {
            if numbers {
                let values = floats(&column.cast(&DataType::Float64)?)?;
                return Ok(values.iter().map(ToString::to_string).collect());
            }
            let values = column.str()?.iter();
            Ok(values
                .map(|text| text.unwrap_or_default().to_owned())
                .collect())
        })?;
        Ok(texts.into_iter().flatten().collect())
    }

    /// Whether a column holds texts.
    pub(crate) fn is_text(&self, column: usize) -> bool {
        is_text(&self.types[column])
    }

    fn check_types(
        &self,
        columns: &[usize],
        can_be_read: impl Fn(&ArrowDataType) -> bool,
    ) -> Result<(), Error> {
        if let Some(&column) = columns.iter().find(|c| !can_be_read(&self.types[**c])) {
            return Err(Error::ColumnType {
                path: self.path.to_owned(),
                header: self.head.headers[column].clone(),
                found: excerpt(&format!("{:?}", self.types[column])),
            });
        }
        if self.rows.saturating_mul(8 * columns.len() as u64) > LIMIT_BYTES {
            return Err(Error::TooLarge {
                path: self.path.to_owned(),
                limit_bytes: LIMIT_BYTES,
            });
        }
        Ok(())
    }

    /// Decodes columns and takes what is wanted of each.
    fn read<T>(
        &self,
        columns: &[usize],
        take: impl Fn(&Column) -> PolarsResult<T>,
    ) -> Result<Vec<T>, Error> {
        let mut projection = columns.to_vec();
        projection.sort_unstable();
        projection.dedup();
        guarded(self.path, || {
            let frame = ParquetReader::new(Cursor::new(self.bytes))
                .with_projection(Some(projection))
                .read_parallel(ParallelStrategy::None)
                .finish()?;
            columns
                .iter()
                .map(|column| take(frame.column(&self.head.headers[*column])?))
                .collect()
        })
    }
}

fn is_text(data_type: &ArrowDataType) -> bool {
    use ArrowDataType::{LargeUtf8, Utf8, Utf8View};
    matches!(data_type, Utf8 | LargeUtf8 | Utf8View)
}

/// Numbers that polars reads; of a half-precision column it panics.
fn is_number(data_type: &ArrowDataType) -> bool {
    use ArrowDataType::{
        Float32, Float64, Int8, Int16, Int32, Int64, UInt8, UInt16, UInt32, UInt64,
    };
    matches!(
        data_type,
        Float64 | Float32 | Int8 | Int16 | Int32 | Int64 | UInt8 | UInt16 | UInt32 | UInt64
    )
}

/// Checks a column chunk before it is decoded; a flat one has a value per row.
fn check_values(
    bytes: &[u8],
    range: Range<u64>,
    values: i64,
    rows: Option<usize>,
) -> Result<(), &'static str> {
    let values = u64::try_from(values).map_err(|_| "a column with a negative number of values")?;
    if rows.is_some_and(|rows| rows as u64 != values) {
        return Err("a column with more or fewer values than rows");
    }
    let outside = "a column outside the file";
    let start = usize::try_from(range.start).map_err(|_| outside)?;
    let end = usize::try_from(range.end).map_err(|_| outside)?;
    check_chunk(bytes.get(start..end).ok_or(outside)?, values)
}

/// Runs the decoder. Polars may panic on a damaged file: that too is the file's error, not the
/// program's.
fn guarded<T>(path: &Path, decode: impl FnOnce() -> PolarsResult<T>) -> Result<T, Error> {
    let problem = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)) {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(error)) => error.to_string(),
        Err(_) => "the decoder gave up".to_owned(),
    };
    Err(Error::Parquet {
        path: path.to_owned(),
        problem,
    })
}

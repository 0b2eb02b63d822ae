//! From files to columns.

use std::io::Cursor;
use std::ops::Range;

use polars_core::prelude::{ArrowDataType, Column as Decoded, DataType, PolarsResult};
use polars_io::SerReader;
use polars_io::parquet::read::{ParallelStrategy, ParquetReader};

use crate::Error;
use crate::pages::check_chunk;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Numbers of single or double precision
    Float,
    /// Whole numbers of 8 to 64 bits
    Integer,
    /// Texts
    Text,
    /// Anything else, which is not read
    Other,
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnHead {
    /// Its name
    pub name: String,
    /// What it holds
    pub kind: Kind,
    /// The name of its type, for messages
    pub type_name: String,
}

/// A Parquet file that has been checked and not yet been decoded.
#[derive(Debug)]
pub struct File<'a> {
    bytes: &'a [u8],
    rows: usize,
    columns: Vec<ColumnHead>,
    metadata: Vec<(String, String)>,
}

impl<'a> File<'a> {
    /// Reads the footer and checks the page headers of all columns.
    ///
    /// # Errors
    /// [`Error::Decoder`] where the footer cannot be read, [`Error::Damaged`] where what it promises is not there.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Error> {
        let mut reader = ParquetReader::new(Cursor::new(bytes));
        let rows = guarded(|| reader.num_rows())?;
        let footer = guarded(|| Ok(reader.get_metadata()?.clone()))?;
        guarded(|| {
            let mut chunks = footer.row_groups.iter().flat_map(|group| {
                let chunks = group.parquet_columns().iter();
                chunks.map(|chunk| {
                    let is_flat = chunk.descriptor().descriptor.max_rep_level == 0;
                    let rows = is_flat.then(|| group.num_rows());
                    check_values(bytes, chunk.byte_range(), chunk.num_values(), rows)
                })
            });
            Ok(chunks.try_for_each(|checked| checked))
        })?
        .map_err(Error::Damaged)?;
        let schema = guarded(|| reader.schema())?;
        let columns = schema.iter_values().map(|field| ColumnHead {
            name: field.name.to_string(),
            kind: kind(field.dtype()),
            type_name: format!("{:?}", field.dtype()),
        });
        let pairs = footer.key_value_metadata.iter().flatten();
        Ok(Self {
            bytes,
            rows,
            columns: columns.collect(),
            metadata: pairs
                .filter_map(|pair| Some((pair.key.clone(), pair.value.clone()?)))
                .collect(),
        })
    }

    /// The number of rows that the footer promises.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The heads of the columns, in the file's order.
    #[must_use]
    pub fn columns(&self) -> &[ColumnHead] {
        &self.columns
    }

    /// What the footer says under a key.
    #[must_use]
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let mut pairs = self.metadata.iter();
        Some(pairs.find(|(name, _)| name == key)?.1.as_str())
    }

    /// Columns of numbers or whole numbers as numbers, NaN for null: one vector per entry of `columns`, one value per row.
    ///
    /// # Errors
    /// [`Error::Decoder`] where a column is of another kind or cannot be decoded.
    pub fn floats(&self, columns: &[usize]) -> Result<Vec<Vec<f64>>, Error> {
        self.read(columns, |column| floats(&column.cast(&DataType::Float64)?))
    }

    /// Columns of whole numbers, one vector per entry of `columns`, one value per row.
    ///
    /// # Errors
    /// As [`floats`](Self::floats).
    pub fn integers(&self, columns: &[usize]) -> Result<Vec<Vec<Option<i64>>>, Error> {
        self.read(columns, |column| {
            Ok(column.cast(&DataType::Int64)?.i64()?.iter().collect())
        })
    }

    /// The texts of a column. A few bytes of a dictionary may stand for any number of long texts: `limit_bytes` is what
    /// they may take.
    ///
    /// # Errors
    /// As [`floats`](Self::floats), and [`Error::TooLarge`].
    pub fn texts(&self, column: usize, limit_bytes: u64) -> Result<Vec<Option<String>>, Error> {
        let mut left = Some(limit_bytes);
        let texts = self.read(&[column], |column| {
            let total: u64 = column
                .str()?
                .iter()
                .flatten()
                .map(|text| text.len() as u64)
                .sum();
            left = limit_bytes.checked_sub(total);
            if left.is_none() {
                return Ok(Vec::new());
            }
            let texts = column.str()?.iter();
            Ok(texts.map(|text| text.map(ToOwned::to_owned)).collect())
        })?;
        left.ok_or(Error::TooLarge { limit_bytes })?;
        Ok(texts.into_iter().flatten().collect())
    }

    /// Decodes columns and takes what is wanted of each.
    fn read<T>(
        &self,
        columns: &[usize],
        mut take: impl FnMut(&Decoded) -> PolarsResult<T>,
    ) -> Result<Vec<T>, Error> {
        let mut projection = columns.to_vec();
        projection.sort_unstable();
        projection.dedup();
        guarded(|| {
            let frame = ParquetReader::new(Cursor::new(self.bytes))
                .with_projection(Some(projection))
                .read_parallel(ParallelStrategy::None)
                .finish()?;
            let mut taken = Vec::with_capacity(columns.len());
            for column in columns {
                taken.push(take(frame.column(&self.columns[*column].name)?)?);
            }
            Ok(taken)
        })
    }
}

/// What is read; of a half-precision column polars panics.
fn kind(data_type: &ArrowDataType) -> Kind {
    use ArrowDataType::{
        Float32, Float64, Int8, Int16, Int32, Int64, LargeUtf8, UInt8, UInt16, UInt32, UInt64,
        Utf8, Utf8View,
    };
    match data_type {
        Float64 | Float32 => Kind::Float,
        Int8 | Int16 | Int32 | Int64 | UInt8 | UInt16 | UInt32 | UInt64 => Kind::Integer,
        Utf8 | LargeUtf8 | Utf8View => Kind::Text,
        _ => Kind::Other,
    }
}

fn floats(column: &Decoded) -> PolarsResult<Vec<f64>> {
    let values = column.f64()?;
    Ok(values.iter().map(|v| v.unwrap_or(f64::NAN)).collect())
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

/// Runs the decoder. Polars may panic on a damaged file: that too is the file's error, not the program's.
fn guarded<T>(decode: impl FnOnce() -> PolarsResult<T>) -> Result<T, Error> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(Error::Decoder(error.to_string())),
        Err(_) => Err(Error::Decoder("the decoder gave up".to_owned())),
    }
}

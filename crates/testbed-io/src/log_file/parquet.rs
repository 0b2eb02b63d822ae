//! Run logs as Apache Parquet files.

use std::io::{self, Cursor, Write};

use polars::io::parquet::write::KeyValueMetadata;
use polars::prelude::{
    ArrowDataType, Column as PolarsColumn, DataFrame, DataType, NamedFrom, ParallelStrategy,
    ParquetReader, ParquetWriter, PolarsResult, SerReader, Series,
};

use super::check::Check;
use super::pages::check_chunk;
use super::{Column, DAMAGED, Flaw, LogTable, MAX_BYTES, MAX_COLUMNS, Values, shortened, table};

/// The key of the metadata in the footer.
const KEY: &str = "drivekit";
/// The key of the check of all values; logs of before have none.
const CHECK: &str = "drivekit_check";
const FOREIGN: &str = "only Parquet files that drivekit logged are read";

pub(super) fn write(table: &LogTable, out: &mut dyn Write) -> io::Result<()> {
    let columns = table.columns().iter().map(|column| {
        let name = column.name.as_str().into();
        PolarsColumn::from(match &column.values {
            Values::Float(values) => Series::new(name, values),
            Values::Integer(values) => Series::new(name, values),
            Values::Text(values) => Series::new(name, values),
        })
    });
    let check = Check::of(table.columns()).text();
    let meta = vec![
        (KEY.to_owned(), table.meta().to_owned()),
        (CHECK.to_owned(), check),
    ];
    let mut frame = DataFrame::new(table.rows(), columns.collect()).map_err(io::Error::other)?;
    ParquetWriter::new(&mut *out)
        .with_key_value_metadata(Some(KeyValueMetadata::from_static(meta)))
        .set_parallel(false)
        .finish(&mut frame)
        .map_err(io::Error::other)?;
    out.flush()
}

pub(super) fn read(bytes: &[u8]) -> Result<LogTable, Flaw> {
    let mut reader = ParquetReader::new(Cursor::new(bytes));
    let (meta, written) = check(bytes, &mut reader)?;
    let frame = guarded(|| reader.read_parallel(ParallelStrategy::None).finish())?;
    let mut room = MAX_BYTES;
    let columns = frame.columns().iter().map(|column| {
        let values = guarded(|| values(column, &mut room))?;
        let name = column.name().to_string();
        match values {
            Ok(values) => Ok(Column { name, values }),
            Err(found) => {
                let place = format!(", column {:?}", shortened(&name));
                Err(Flaw::at(place, found, FOREIGN))
            }
        }
    });
    let columns = columns.collect::<Result<Vec<Column>, Flaw>>()?;
    let found = Check::of(&columns).text();
    if written.is_some_and(|written| written != found) {
        let found = "damaged: its values do not agree with its check";
        return Err(Flaw::new(found, DAMAGED));
    }
    table(&meta, columns, false)
}

/// Checks what the footer promises before anything is decoded, and returns the metadata and the check of all values.
fn check(
    bytes: &[u8],
    reader: &mut ParquetReader<Cursor<&[u8]>>,
) -> Result<(String, Option<String>), Flaw> {
    let schema = guarded(|| reader.schema())?;
    let footer = guarded(|| Ok(reader.get_metadata()?.clone()))?;
    if schema.len() > MAX_COLUMNS {
        let found = format!("{} columns", schema.len());
        return Err(Flaw::new(found, FOREIGN));
    }
    for field in schema.iter_values() {
        use ArrowDataType::{Float64, Int64, LargeUtf8, Utf8, Utf8View};
        if !matches!(field.dtype(), Float64 | Int64 | LargeUtf8 | Utf8 | Utf8View) {
            let place = format!(", column {:?}", shortened(&field.name));
            let found = format!("type {}", shortened(&format!("{:?}", field.dtype())));
            return Err(Flaw::at(place, found, FOREIGN));
        }
    }
    let values = (footer.num_rows as u64).saturating_mul(8 * schema.len() as u64);
    if values > MAX_BYTES {
        return Err(Flaw::too_large());
    }
    let checked = guarded(|| {
        let chunks = footer.row_groups.iter().flat_map(|group| {
            let chunks = group.parquet_columns().iter();
            chunks.map(|chunk| {
                let size = chunk.num_values();
                let values = u64::try_from(size).map_err(|_| "a negative number of values")?;
                if values != group.num_rows() as u64 {
                    return Err("a column with more or fewer values than rows");
                }
                let outside = "a column outside the file";
                let range = chunk.byte_range();
                let start = usize::try_from(range.start).map_err(|_| outside)?;
                let end = usize::try_from(range.end).map_err(|_| outside)?;
                check_chunk(bytes.get(start..end).ok_or(outside)?, values)
            })
        });
        Ok(chunks.collect::<Result<(), &str>>())
    })?;
    checked.map_err(|found| Flaw::new(found, DAMAGED))?;
    let said = |key: &str| {
        let mut pairs = footer.key_value_metadata.iter().flatten();
        pairs.find(|pair| pair.key == key)?.value.clone()
    };
    let meta = said(KEY);
    let absent = || Flaw::new(format!("no metadata {KEY:?} in the footer"), FOREIGN);
    Ok((meta.ok_or_else(absent)?, said(CHECK)))
}

/// The values of a column, or what is wrong with it. `room` is the number of bytes that texts may
/// still take: a few bytes of a dictionary may stand for any number of long texts.
fn values(column: &PolarsColumn, room: &mut u64) -> PolarsResult<Result<Values, String>> {
    const NULL: &str = "a value is missing";
    Ok(match column.dtype() {
        DataType::Float64 => {
            let values = column.f64()?.iter();
            Ok(Values::Float(
                values.map(|v| v.unwrap_or(f64::NAN)).collect(),
            ))
        }
        DataType::Int64 => {
            let values = column.i64()?.iter().collect::<Option<Vec<i64>>>();
            values.map(Values::Integer).ok_or_else(|| NULL.to_owned())
        }
        DataType::String => {
            let texts = column.str()?.iter().map(|text| {
                let text = text.ok_or_else(|| NULL.to_owned())?;
                let left = room.checked_sub(text.len() as u64);
                *room = left.ok_or_else(|| Flaw::too_large().found)?;
                Ok(text.to_owned())
            });
            texts
                .collect::<Result<Vec<String>, String>>()
                .map(Values::Text)
        }
        other => Err(format!("type {other}")),
    })
}

/// Runs the decoder. Polars may panic on a damaged file: that too is the file's error, not the
/// program's.
fn guarded<T>(decode: impl FnOnce() -> PolarsResult<T>) -> Result<T, Flaw> {
    let found = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)) {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(error)) => shortened(&error.to_string()),
        Err(_) => "the decoder gave up".to_owned(),
    };
    Err(Flaw::new(
        format!("not a whole Parquet file ({found})"),
        "copy the file again; of a Parquet file that was cut short nothing can be read",
    ))
}

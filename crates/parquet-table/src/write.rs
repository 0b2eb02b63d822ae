//! From columns to files.

use std::io::{self, Write};

use polars_core::prelude::{Column as Encoded, DataFrame, NamedFrom, PlSmallStr, Series};
use polars_io::parquet::write::{KeyValueMetadata, ParquetWriter};

use crate::{Column, Values};

/// Writes columns of one length, NaN as null, with pairs of key and value in the footer.
///
/// # Errors
/// Where the columns differ in length or two have one name, or `out` fails.
pub fn write(columns: &[Column], metadata: &[(&str, &str)], mut out: impl Write) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.values.len());
    let encoded = columns.iter().map(encoded).collect();
    let mut frame = DataFrame::new(rows, encoded).map_err(io::Error::other)?;
    let mut writer = ParquetWriter::new(&mut out).set_parallel(false);
    if !metadata.is_empty() {
        let pairs = metadata
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        let pairs = KeyValueMetadata::from_static(pairs.collect());
        writer = writer.with_key_value_metadata(Some(pairs));
    }
    writer.finish(&mut frame).map_err(io::Error::other)?;
    out.flush()
}

fn encoded(column: &Column) -> Encoded {
    let name = PlSmallStr::from(column.name.as_str());
    Encoded::from(match &column.values {
        Values::Float(values) if values.iter().any(|value| value.is_nan()) => {
            let values: Vec<Option<f64>> =
                values.iter().map(|v| (!v.is_nan()).then_some(*v)).collect();
            Series::new(name, values)
        }
        Values::Float(values) => Series::new(name, values),
        Values::Integer(values) => Series::new(name, values),
        Values::Text(values) => Series::new(name, values),
    })
}

//! Run logs as Apache Parquet files.

use parquet_table::{Column, Values};
use parquet_table::{Error, File, Kind};
use std::io::{self, Write};

use super::check::Check;
use super::flaw::{DAMAGED, Flaw, shortened};
use super::limits::{MAX_BYTES, MAX_COLUMNS};
use super::table::{LogTable, table};

/// The key of the metadata in the footer.
const KEY: &str = "drivekit";
/// The key of the check of all values; logs of before have none.
const CHECK: &str = "drivekit_check";
const FOREIGN: &str = "only Parquet files that drivekit logged are read";

pub(super) fn write(table: &LogTable, out: &mut dyn Write) -> io::Result<()> {
    let check = Check::of(table.columns()).text();
    let metadata = [(KEY, table.meta()), (CHECK, check.as_str())];
    parquet_table::write(table.columns(), &metadata, out)
}

pub(super) fn read(bytes: &[u8]) -> Result<LogTable, Flaw> {
    let file = File::open(bytes).map_err(flaw)?;
    if file.columns().len() > MAX_COLUMNS {
        let found = format!("{} columns", file.columns().len());
        return Err(Flaw::new(found, FOREIGN));
    }
    let values = (file.rows() as u64).saturating_mul(8 * file.columns().len() as u64);
    if values > MAX_BYTES {
        return Err(Flaw::too_large());
    }
    let columns = columns(&file)?;
    let absent = || Flaw::new(format!("no metadata {KEY:?} in the footer"), FOREIGN);
    let meta = file.metadata(KEY).ok_or_else(absent)?;
    let found = Check::of(&columns).text();
    if file.metadata(CHECK).is_some_and(|written| written != found) {
        let found = "damaged: its values do not agree with its check";
        return Err(Flaw::new(found, DAMAGED));
    }
    table(meta, columns, false)
}

/// The columns in the file's order.
fn columns(file: &File<'_>) -> Result<Vec<Column>, Flaw> {
    let of = |kind: Kind| -> Vec<usize> {
        let heads = file.columns().iter().enumerate();
        heads
            .filter(|(_, head)| head.kind == kind)
            .map(|(index, _)| index)
            .collect()
    };
    let mut floats = file.floats(&of(Kind::Float)).map_err(flaw)?.into_iter();
    let mut integers = file.integers(&of(Kind::Integer)).map_err(flaw)?.into_iter();
    let mut room = MAX_BYTES;
    let mut columns = Vec::with_capacity(file.columns().len());
    for (index, head) in file.columns().iter().enumerate() {
        let values = match head.kind {
            Kind::Float => floats.next().map(Values::Float),
            Kind::Integer => integers.next().and_then(whole).map(Values::Integer),
            Kind::Text => texts(file, index, &mut room)?.map(Values::Text),
            _ => {
                return Err(column_flaw(
                    &head.name,
                    format!("type {}", shortened(&head.type_name)),
                ));
            }
        };
        let values =
            values.ok_or_else(|| column_flaw(&head.name, "a value is missing".to_owned()))?;
        columns.push(Column::new(head.name.clone(), values));
    }
    Ok(columns)
}

fn whole<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

/// `room` is the number of bytes that texts may still take.
fn texts(file: &File<'_>, column: usize, room: &mut u64) -> Result<Option<Vec<String>>, Flaw> {
    let texts = file.texts(column, *room).map_err(flaw)?;
    let taken: usize = texts.iter().flatten().map(String::len).sum();
    *room = room.saturating_sub(taken as u64);
    Ok(whole(texts))
}

fn column_flaw(name: &str, found: String) -> Flaw {
    Flaw::at(format!(", column {:?}", shortened(name)), found, FOREIGN)
}

fn flaw(error: Error) -> Flaw {
    match error {
        Error::Damaged(found) => Flaw::new(found, DAMAGED),
        Error::TooLarge { .. } => Flaw::too_large(),
        other => Flaw::new(
            format!(
                "not a whole Parquet file ({})",
                shortened(&other.to_string())
            ),
            "copy the file again; of a Parquet file that was cut short nothing can be read",
        ),
    }
}

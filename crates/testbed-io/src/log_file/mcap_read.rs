//! Reading of MCAP files: of one that was cut, the whole chunks; one that is damaged is refused.

use std::collections::HashSet;
use std::ops::ControlFlow;

use ::mcap::records::{Record, op};
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use ::mcap::{MAGIC, McapError, parse_record};
use parquet_table::{Column, Values};
use serde_json::{Map, Value};

use super::flaw::{DAMAGED, Flaw, shortened};
use super::kind::Kind;
use super::limits::MAX_BYTES;
use super::mcap::{INFINITE, NAME, TICK_SCHEMA};
use super::table::{LogTable, table};

/// The largest record or chunk that is read, in bytes.
const MAX_RECORD: usize = 256 << 20;
const FOREIGN: &str = "only MCAP files that drivekit logged are read";

pub(super) fn read(bytes: &[u8]) -> Result<LogTable, Flaw> {
    let (meta, mut columns) = read_metadata(bytes)?;
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true);
    let mut before = String::new();
    let mut schemas = HashSet::new();
    let mut channels = HashSet::new();
    let mut room = MAX_BYTES;
    let end = each_record(bytes, options, |record| {
        match record {
            Record::Schema { header, .. } if header.name == TICK_SCHEMA => {
                schemas.insert(header.id);
            }
            Record::Channel(channel) if schemas.contains(&channel.schema_id) => {
                channels.insert(channel.id);
            }
            Record::Message { header, data } if channels.contains(&header.channel_id) => {
                let left = room.checked_sub(data.len() as u64);
                room = left.ok_or_else(Flaw::too_large)?;
                let (tick, time) = (header.sequence, header.log_time);
                push(&mut columns, &data).map_err(|(place, found)| {
                    let record = format!(", record of tick {tick} at {time} ns{place}");
                    Flaw::at(record, found, DAMAGED)
                })?;
                before = format!(", after the record of tick {tick} at {time} ns");
            }
            _ => {}
        }
        Ok(ControlFlow::Continue(()))
    })?;
    match end {
        End::Damaged(found) => Err(Flaw::at(before, found, DAMAGED)),
        end => table(&meta, columns, end == End::Cut),
    }
}

/// What the records of a file end with.
#[derive(Debug, PartialEq, Eq)]
enum End {
    Whole,
    Cut,
    Damaged(String),
}

impl End {
    /// `at` is how far the file was read. One that has its last bytes was not cut.
    fn of(error: &McapError, bytes: &[u8], at: usize) -> Self {
        let is_out_of_bytes = matches!(error, McapError::UnexpectedEof);
        if is_out_of_bytes && !bytes.ends_with(MAGIC) {
            return Self::Cut;
        }
        Self::Damaged(format!("damaged before byte {at}: {error}"))
    }
}

fn read_metadata(bytes: &[u8]) -> Result<(String, Vec<Column>), Flaw> {
    let mut found = None;
    let options = LinearReaderOptions::default().with_emit_chunks(true);
    let end = each_record(bytes, options, |record| match record {
        Record::Metadata(metadata) if metadata.name == NAME => {
            found = Some(metadata.metadata);
            Ok(ControlFlow::Break(()))
        }
        _ => Ok(ControlFlow::Continue(())),
    })?;
    if let (End::Damaged(what), None) = (end, &found) {
        return Err(Flaw::new(what, FOREIGN));
    }
    let absent = format!("no metadata record {NAME:?}");
    let mut found = found.ok_or_else(|| Flaw::new(absent, FOREIGN))?;
    let place = || format!(", metadata record {NAME:?}");
    let mut value = |key: &str| {
        let value = found.remove(key);
        value.ok_or_else(|| Flaw::at(place(), format!("no {key:?}"), FOREIGN))
    };
    let (meta, columns) = (value("meta")?, value("columns")?);
    let columns: Vec<(String, Kind)> = serde_json::from_str(&columns)
        .map_err(|error| Flaw::at(place(), format!("columns: {error}"), DAMAGED))?;
    let columns = columns.into_iter().map(|(name, kind)| kind.column(name));
    Ok((meta, columns.collect()))
}

/// Calls `take` with the records that matter here, up to the first broken one.
fn each_record(
    bytes: &[u8],
    options: LinearReaderOptions,
    mut take: impl FnMut(Record<'_>) -> Result<ControlFlow<()>, Flaw>,
) -> Result<End, Flaw> {
    let mut reader = LinearReader::new_with_options(options.with_record_length_limit(MAX_RECORD));
    let mut rest = bytes;
    let mut has_broken_off = false;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let (now, later) = rest.split_at(need.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                // the parser panics on a short attachment
                let wanted = [op::SCHEMA, op::CHANNEL, op::MESSAGE, op::METADATA];
                if !wanted.contains(&opcode) {
                    continue;
                }
                let record = match parse_record(opcode, data) {
                    Ok(record) => record,
                    Err(error) => return Ok(End::of(&error, bytes, bytes.len() - rest.len())),
                };
                if take(record)?.is_break() {
                    has_broken_off = true;
                    break;
                }
            }
            Err(McapError::UnsupportedCompression(name)) => {
                let found = format!("compression {:?}", shortened(&name));
                return Err(Flaw::new(found, "compress it with zstd: mcap compress"));
            }
            Err(error) => return Ok(End::of(&error, bytes, bytes.len() - rest.len())),
        }
    }
    let after = if has_broken_off { 0 } else { rest.len() };
    if after > 0 {
        let found = format!("{after} bytes after its end: another file, or none");
        return Ok(End::Damaged(found));
    }
    Ok(End::Whole)
}

/// Appends a message; what is wrong with it on failure, and in which column.
fn push(columns: &mut [Column], data: &[u8]) -> Result<(), (String, String)> {
    let mut message: Map<String, Value> =
        serde_json::from_slice(data).map_err(|error| (String::new(), error.to_string()))?;
    let infinite = match message.remove(INFINITE) {
        Some(Value::Object(infinite)) => infinite,
        _ => Map::new(),
    };
    for column in columns {
        let wrong = |found: String| Err((format!(", column {:?}", shortened(&column.name)), found));
        let value = message.remove(&column.name).or_else(|| {
            let is_number = matches!(column.values, Values::Float(_));
            let apart = infinite.get(&column.name).cloned();
            is_number.then(|| apart.unwrap_or(Value::Null))
        });
        let Some(value) = value else {
            return wrong("the value is missing".to_owned());
        };
        let pushed = match (&mut column.values, value) {
            (Values::Float(values), value) => {
                float(&value).map(|value| values.push(value)).ok_or(value)
            }
            (Values::Integer(values), value) => {
                value.as_i64().map(|value| values.push(value)).ok_or(value)
            }
            (Values::Text(values), Value::String(text)) => {
                values.push(text);
                Ok(())
            }
            (Values::Text(_), value) => Err(value),
        };
        if let Err(value) = pushed {
            return wrong(format!(
                "{} is of another type",
                shortened(&value.to_string())
            ));
        }
    }
    Ok(())
}

/// Logs of before have `null` and infinities in place.
fn float(value: &Value) -> Option<f64> {
    match value {
        Value::Null => Some(f64::NAN),
        Value::String(text) if text == "inf" => Some(f64::INFINITY),
        Value::String(text) if text == "-inf" => Some(f64::NEG_INFINITY),
        value => value.as_f64(),
    }
}

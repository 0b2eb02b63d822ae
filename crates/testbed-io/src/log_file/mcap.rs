//! Run logs as MCAP files (<https://mcap.dev/spec>), for Foxglove and the tools of robots.
//!
//! Each row is a JSON message on the topic `/robot<N>/tick`. A metadata record `drivekit` comes
//! first and holds the metadata and the names and types of the columns. Poses are for display and are not read: on
//! `/robot<N>/pose` those that were measured, of the axle's middle, when they arrived; on `/robot<N>/true_point_of_interest` where
//! a simulation had the point of interest.
//!
//! Times are by the wall clock where the column `unix_time_s` gives it, or else count from 0.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::{Compression, McapResult, WriteOptions, Writer};
use parquet_table::{Column, Values};
use serde_json::{Map, Value, json};

use super::kind::Kind;
use super::table::LogTable;
use crate::Error;

pub(super) const NAME: &str = "drivekit";
pub(super) const TICK_SCHEMA: &str = "drivekit.RunTick";
/// Of the object with the infinities of a message
pub(super) const INFINITE: &str = "infinite_numbers";
/// A chunk is what a crash can lose: at 1 kB per row about 120 rows.
const CHUNK_BYTES: u64 = 128 << 10;

pub(super) fn write(table: &LogTable, out: &mut dyn Write) -> Result<(), Error> {
    let rows = Rows::of(table)?;
    let bytes = rows.encode().map_err(|error| Error::Write {
        source: std::io::Error::other(error),
    })?;
    let written = out.write_all(&bytes).and_then(|()| out.flush());
    written.map_err(|source| Error::Write { source })
}

/// A table whose rows can be messages.
struct Rows<'a> {
    table: &'a LogTable,
    ticks: Vec<u32>,
    robots: &'a [i64],
    /// Of the messages, in ns
    times_ns: Vec<u64>,
    poses: Vec<Poses<'a>>,
}

/// A topic of poses.
struct Poses<'a> {
    topic: &'static str,
    /// x and y in m, heading in rad
    columns: [&'a [f64]; 3],
    /// When each was so, in ns
    stamps_ns: Vec<u64>,
}

const ELSE: &str = "log as CSV or Parquet";

impl<'a> Rows<'a> {
    fn of(table: &'a LogTable) -> Result<Rows<'a>, Error> {
        let missing = |name: &str, kind: &str| Error::Table {
            problem: format!("MCAP needs a column {name:?} of {kind}; {ELSE}"),
        };
        let integers = |name| match table.column(name) {
            Some(Values::Integer(values)) => Ok(values),
            _ => Err(missing(name, "whole numbers")),
        };
        let (ticks, robots) = (integers("tick")?, integers("robot")?);
        let times_s = floats(table, "time_s").ok_or_else(|| missing("time_s", "numbers"))?;
        let ticks = ticks.iter().enumerate().map(|(row, tick)| {
            u32::try_from(*tick).map_err(|_| Error::Table {
                problem: format!("tick {tick} in row {row}; MCAP needs 0 to 4294967295; {ELSE}"),
            })
        });
        let times_ns = match floats(table, "unix_time_s") {
            Some(unix_s) => nanoseconds("unix_time_s", unix_s)?,
            None => nanoseconds("time_s", times_s)?,
        };
        Ok(Rows {
            table,
            ticks: ticks.collect::<Result<_, Error>>()?,
            robots,
            poses: Poses::all(table, times_s, &times_ns),
            times_ns,
        })
    }

    fn encode(&self) -> McapResult<Vec<u8>> {
        let options = WriteOptions::new()
            .library(concat!("drivekit ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(CHUNK_BYTES));
        let mut writer = options.create(Cursor::new(Vec::new()))?;
        writer.write_metadata(&metadata(self.table))?;
        let tick_schema = tick_schema(self.table).to_string();
        let tick_schema = writer.add_schema(TICK_SCHEMA, "jsonschema", tick_schema.as_bytes())?;
        let pose_schema = if self.poses.is_empty() {
            0
        } else {
            let schema = pose_schema().to_string();
            writer.add_schema("foxglove.PoseInFrame", "jsonschema", schema.as_bytes())?
        };
        let mut topics = Topics::default();
        let keys: Vec<String> = self.table.columns().iter().map(|c| key(&c.name)).collect();
        let mut message = Vec::new();
        for row in 0..self.table.rows() {
            let robot = self.robots[row];
            let mut header = MessageHeader {
                channel_id: topics.channel(&mut writer, robot, "tick", tick_schema)?,
                sequence: self.ticks[row],
                log_time: self.times_ns[row],
                publish_time: self.times_ns[row],
            };
            message.clear();
            put_row(&mut message, self.table, &keys, row);
            writer.write_to_known_channel(&header, &message)?;
            for poses in &self.poses {
                let Some(pose) = poses.message(row) else {
                    continue;
                };
                header.channel_id = topics.channel(&mut writer, robot, poses.topic, pose_schema)?;
                writer.write_to_known_channel(&header, pose.to_string().as_bytes())?;
            }
        }
        writer.finish()?;
        Ok(writer.into_inner().into_inner())
    }
}

impl<'a> Poses<'a> {
    fn all(table: &'a LogTable, times_s: &[f64], times_ns: &[u64]) -> Vec<Self> {
        let named = |topic, names: [&str; 3], stamps_ns| {
            let [x_m, y_m, heading_rad] = names.map(|name| floats(table, name));
            Some(Self {
                topic,
                columns: [x_m?, y_m?, heading_rad?],
                stamps_ns,
            })
        };
        let stamps_ns = match floats(table, "pose_stamp_s") {
            Some(stamps_s) => stamps(times_ns, times_s, stamps_s),
            None => times_ns.to_vec(),
        };
        let measured = ["pose_x_m", "pose_y_m", "pose_heading_rad"];
        let truth = ["true_x_m", "true_y_m", "true_heading_rad"];
        let topics = [
            named("pose", measured, stamps_ns),
            named("true_point_of_interest", truth, times_ns.to_vec()),
        ];
        topics.into_iter().flatten().collect()
    }

    /// As `foxglove.PoseInFrame`, where it is known.
    fn message(&self, row: usize) -> Option<Value> {
        let [x, y, heading] = self.columns.map(|values| values[row]);
        if ![x, y, heading].iter().all(|value| value.is_finite()) {
            return None;
        }
        let (sin, cos) = (heading / 2.0).sin_cos();
        let stamp = self.stamps_ns[row];
        Some(json!({
            "timestamp": {"sec": stamp / 1_000_000_000, "nsec": stamp % 1_000_000_000},
            "frame_id": "lane",
            "pose": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": sin, "w": cos},
            },
        }))
    }
}

/// By the clock of the messages; a stamp from before that clock's zero is at its zero.
fn stamps(times_ns: &[u64], times_s: &[f64], stamps_s: &[f64]) -> Vec<u64> {
    let rows = times_ns.iter().zip(times_s).zip(stamps_s);
    rows.map(|((time_ns, time_s), stamp_s)| {
        let later_ns = ((stamp_s - time_s) * 1e9).round() as i64;
        time_ns.saturating_add_signed(later_ns)
    })
    .collect()
}

fn floats<'a>(table: &'a LogTable, name: &str) -> Option<&'a [f64]> {
    match table.column(name) {
        Some(Values::Float(values)) => Some(values),
        _ => None,
    }
}

/// The channels by robot and kind.
#[derive(Default)]
struct Topics(BTreeMap<(i64, &'static str), u16>);

impl Topics {
    fn channel(
        &mut self,
        writer: &mut Writer<Cursor<Vec<u8>>>,
        robot: i64,
        kind: &'static str,
        schema: u16,
    ) -> McapResult<u16> {
        if let Some(channel) = self.0.get(&(robot, kind)) {
            return Ok(*channel);
        }
        let topic = format!("/robot{robot}/{kind}");
        let channel = writer.add_channel(schema, &topic, "json", &BTreeMap::new())?;
        self.0.insert((robot, kind), channel);
        Ok(channel)
    }
}

fn nanoseconds(name: &str, times_s: &[f64]) -> Result<Vec<u64>, Error> {
    let rows = times_s.iter().enumerate().map(|(row, time_s)| {
        let ns = (time_s * 1e9).round();
        let is_time = (0.0..1.8e19).contains(&ns);
        is_time.then_some(ns as u64).ok_or_else(|| Error::Table {
            problem: format!("{name} {time_s} in row {row}; MCAP needs times from 0 on; {ELSE}"),
        })
    });
    rows.collect()
}

fn metadata(table: &LogTable) -> Metadata {
    let columns = table.columns().iter();
    let columns: Vec<(&str, Kind)> = columns
        .map(|column| (column.name.as_str(), Kind::of(&column.values)))
        .collect();
    Metadata {
        name: NAME.to_owned(),
        metadata: BTreeMap::from([
            ("meta".to_owned(), table.meta().to_owned()),
            ("columns".to_owned(), json!(columns).to_string()),
        ]),
    }
}

/// Foxglove takes one type per property and none of `null`, so that numbers that are not known are left out of messages, and
/// infinities, for which JSON has no number, stand in an object of their own.
fn tick_schema(table: &LogTable) -> Value {
    let properties = table.columns().iter().map(|column| {
        let kind = match Kind::of(&column.values) {
            Kind::Float => "number",
            Kind::Integer => "integer",
            Kind::Text => "string",
        };
        (column.name.clone(), json!({"type": kind}))
    });
    let mut properties: Map<String, Value> = properties.collect();
    let infinite = infinite_columns(table).map(|name| (name.to_owned(), json!({"type": "string"})));
    let infinite: Map<String, Value> = infinite.collect();
    if !infinite.is_empty() {
        let object = json!({"type": "object", "properties": infinite});
        properties.insert(INFINITE.to_owned(), object);
    }
    json!({
        "title": TICK_SCHEMA,
        "description": "One robot at one step, without the numbers that are not known",
        "type": "object",
        "properties": properties,
    })
}

fn infinite_columns(table: &LogTable) -> impl Iterator<Item = &str> {
    let is_infinite = |column: &&Column| match &column.values {
        Values::Float(values) => values.iter().any(|value| value.is_infinite()),
        _ => false,
    };
    let columns = table.columns().iter().filter(is_infinite);
    columns.map(|column| column.name.as_str())
}

/// After <https://github.com/foxglove/schemas>.
fn pose_schema() -> Value {
    let number = json!({"type": "number"});
    let whole = json!({"type": "integer", "minimum": 0});
    let object = |title: &str, properties: Value| json!({"title": title, "type": "object", "properties": properties});
    object(
        "foxglove.PoseInFrame",
        json!({
            "timestamp": object("time", json!({"sec": whole, "nsec": whole})),
            "frame_id": {"type": "string"},
            "pose": object("foxglove.Pose", json!({
                "position": object(
                    "foxglove.Vector3",
                    json!({"x": number, "y": number, "z": number}),
                ),
                "orientation": object(
                    "foxglove.Quaternion",
                    json!({"x": number, "y": number, "z": number, "w": number}),
                ),
            })),
        }),
    )
}

fn key(name: &str) -> String {
    format!("{}:", Value::from(name))
}

fn put_row(message: &mut Vec<u8>, table: &LogTable, keys: &[String], row: usize) {
    let mut infinite = Map::new();
    let mut before = b'{';
    for (column, key) in table.columns().iter().zip(keys) {
        if let Values::Float(values) = &column.values
            && !values[row].is_finite()
        {
            if values[row].is_infinite() {
                infinite.insert(column.name.clone(), infinity(values[row]).into());
            }
            continue;
        }
        message.push(before);
        before = b',';
        message.extend_from_slice(key.as_bytes());
        // writing numbers and texts to memory cannot fail
        let _ = match &column.values {
            Values::Float(values) => serde_json::to_writer(&mut *message, &values[row]),
            Values::Integer(values) => serde_json::to_writer(&mut *message, &values[row]),
            Values::Text(values) => serde_json::to_writer(&mut *message, &values[row]),
        };
    }
    if !infinite.is_empty() {
        message.push(before);
        message.extend_from_slice(key(INFINITE).as_bytes());
        message.extend_from_slice(Value::from(infinite).to_string().as_bytes());
    }
    message.push(b'}');
}

fn infinity(value: f64) -> &'static str {
    if value > 0.0 { "inf" } else { "-inf" }
}

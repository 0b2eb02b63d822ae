//! Run logs as MCAP files (<https://mcap.dev/spec>), for Foxglove and the tools of robots.
//!
//! Each row is a JSON message on the topic `/robot<N>/tick`. A metadata record `drivekit` comes
//! first and holds the metadata and the names and types of the columns. Poses on `/robot<N>/pose`
//! are for display and are not read.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::{Compression, McapResult, WriteOptions, Writer};
use serde_json::{Map, Value, json};

use super::{Kind, LogTable, Values};
use crate::Error;

pub(super) const NAME: &str = "drivekit";
pub(super) const TICK_SCHEMA: &str = "drivekit.RunTick";
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
    times_ns: Vec<u64>,
    /// x and y in m, heading in rad
    poses: Option<[&'a [f64]; 3]>,
}

impl<'a> Rows<'a> {
    fn of(table: &'a LogTable) -> Result<Rows<'a>, Error> {
        const ELSE: &str = "log as CSV or Parquet";
        let missing = |name: &str, kind: &str| Error::Table {
            problem: format!("MCAP needs a column {name:?} of {kind}; {ELSE}"),
        };
        let integers = |name| match table.column(name) {
            Some(Values::Integer(values)) => Ok(values),
            _ => Err(missing(name, "whole numbers")),
        };
        let (ticks, robots) = (integers("tick")?, integers("robot")?);
        let Some(Values::Float(times)) = table.column("time_s") else {
            return Err(missing("time_s", "numbers"));
        };
        let ticks = ticks.iter().enumerate().map(|(row, tick)| {
            u32::try_from(*tick).map_err(|_| Error::Table {
                problem: format!("tick {tick} in row {row}; MCAP needs 0 to 4294967295; {ELSE}"),
            })
        });
        let times = times.iter().enumerate().map(|(row, time)| {
            nanoseconds(*time).ok_or_else(|| Error::Table {
                problem: format!("time_s {time} in row {row}; MCAP needs times from 0 on; {ELSE}"),
            })
        });
        let pose = ["true_x_m", "true_y_m", "true_heading_rad"].map(|name| table.column(name));
        let poses = match pose {
            [
                Some(Values::Float(x)),
                Some(Values::Float(y)),
                Some(Values::Float(heading)),
            ] => Some([x.as_slice(), y, heading]),
            _ => None,
        };
        Ok(Rows {
            table,
            ticks: ticks.collect::<Result<_, Error>>()?,
            robots,
            times_ns: times.collect::<Result<_, Error>>()?,
            poses,
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
        let pose_schema = match self.poses {
            Some(_) => {
                let schema = pose_schema().to_string();
                writer.add_schema("foxglove.PoseInFrame", "jsonschema", schema.as_bytes())?
            }
            None => 0,
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
            if let Some(pose) = self.pose(row) {
                header.channel_id = topics.channel(&mut writer, robot, "pose", pose_schema)?;
                writer.write_to_known_channel(&header, pose.to_string().as_bytes())?;
            }
        }
        writer.finish()?;
        Ok(writer.into_inner().into_inner())
    }

    /// The true pose as `foxglove.PoseInFrame`, where it is known.
    fn pose(&self, row: usize) -> Option<Value> {
        let [x, y, heading] = self.poses?.map(|values| values[row]);
        if ![x, y, heading].iter().all(|value| value.is_finite()) {
            return None;
        }
        let (sin, cos) = (heading / 2.0).sin_cos();
        let time = self.times_ns[row];
        Some(json!({
            "timestamp": {"sec": time / 1_000_000_000, "nsec": time % 1_000_000_000},
            "frame_id": "lane",
            "pose": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": sin, "w": cos},
            },
        }))
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

fn nanoseconds(time_s: f64) -> Option<u64> {
    let ns = (time_s * 1e9).round();
    (0.0..1.8e19).contains(&ns).then_some(ns as u64)
}

fn metadata(table: &LogTable) -> Metadata {
    let columns = table.columns().iter();
    let columns: Vec<(&str, Kind)> = columns
        .map(|column| (column.name.as_str(), column.values.kind()))
        .collect();
    Metadata {
        name: NAME.to_owned(),
        metadata: BTreeMap::from([
            ("meta".to_owned(), table.meta().to_owned()),
            ("columns".to_owned(), json!(columns).to_string()),
        ]),
    }
}

/// Foxglove takes one type per property, so that `null` for NaN is not in the schema.
fn tick_schema(table: &LogTable) -> Value {
    let properties = table.columns().iter().map(|column| {
        let kind = match column.values.kind() {
            Kind::Float => "number",
            Kind::Integer => "integer",
            Kind::Text => "string",
        };
        (column.name.clone(), json!({"type": kind}))
    });
    json!({
        "title": TICK_SCHEMA,
        "description": "One robot at one step; null where a number is not known",
        "type": "object",
        "properties": properties.collect::<Map<String, Value>>(),
    })
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
    let mut before = b'{';
    for (column, key) in table.columns().iter().zip(keys) {
        message.push(before);
        before = b',';
        message.extend_from_slice(key.as_bytes());
        // writing numbers and texts to memory cannot fail
        let _ = match &column.values {
            Values::Float(values) if values[row].is_infinite() => {
                serde_json::to_writer(&mut *message, infinity(values[row]))
            }
            // null for NaN
            Values::Float(values) => serde_json::to_writer(&mut *message, &values[row]),
            Values::Integer(values) => serde_json::to_writer(&mut *message, &values[row]),
            Values::Text(values) => serde_json::to_writer(&mut *message, &values[row]),
        };
    }
    message.push(b'}');
}

fn infinity(value: f64) -> &'static str {
    if value > 0.0 { "inf" } else { "-inf" }
}

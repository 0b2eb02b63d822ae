//! MCAP files as others see them, and as others write them.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

use testbed_io::Error;
use testbed_io::log_file::{Column, LogFormat, LogTable, Values, read_bytes, write};

use super::{bits, bytes, column, run};

#[test]
fn mcap_has_topics_schemas_and_times() {
    let table = run(7);
    let bytes = bytes(&table, LogFormat::Mcap);
    let mut seen: BTreeMap<String, Vec<(u32, u64)>> = BTreeMap::new();
    let mut poses = 0;
    for message in mcap::read::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        let (topic, pose) = (
            &message.channel.topic,
            message.channel.topic.ends_with("/pose"),
        );
        let name = if pose {
            "foxglove.PoseInFrame"
        } else {
            "drivekit.RunTick"
        };
        assert_eq!(
            (schema.name.as_str(), schema.encoding.as_str()),
            (name, "jsonschema")
        );
        assert_eq!(message.channel.message_encoding, "json");
        assert_eq!(message.log_time, message.publish_time);
        let schema: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
        assert_eq!(schema["type"], "object");
        let properties = schema["properties"].as_object().unwrap();
        assert!(
            value.as_object().unwrap().keys().eq(properties.keys()),
            "{topic}"
        );
        if pose {
            poses += 1;
            assert_eq!(value["frame_id"], "lane");
            assert_eq!(value["timestamp"]["nsec"], message.log_time);
            assert_eq!(value["pose"]["orientation"]["z"], 0.25_f64.sin());
        } else {
            assert_eq!(properties["time_s"]["type"], "number");
            assert_eq!(properties["tick"]["type"], "integer");
            assert_eq!(properties["outcome"]["type"], "string");
            assert_eq!(value["tick"], message.sequence);
        }
        let times = seen.entry(topic.clone()).or_default();
        times.push((message.sequence, message.log_time));
    }
    assert_eq!(poses, 5, "none where the pose is not known");
    let topics: Vec<&str> = seen.keys().map(String::as_str).collect();
    let expected = [
        "/robot0/pose",
        "/robot0/tick",
        "/robot1/pose",
        "/robot1/tick",
    ];
    assert_eq!(topics, expected);
    let times = [(0, 0), (1, 33_333_333), (2, 66_666_667), (3, 100_000_000)];
    assert_eq!(seen["/robot0/tick"], times);
    assert_eq!(seen["/robot1/tick"], times[..3]);
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.metadata_indexes[0].name, "drivekit");
    assert_eq!(summary.stats.unwrap().message_count, 12);
}

#[test]
fn an_mcap_cut_short_gives_its_whole_chunks() {
    let table = run(3000);
    let whole = bytes(&table, LogFormat::Mcap);
    let mut counts = BTreeSet::new();
    for end in (0..whole.len()).step_by(whole.len() / 60) {
        match read_bytes(&whole[..end], LogFormat::Mcap) {
            Ok(cut) => {
                let ends = bits(&cut)
                    .iter()
                    .zip(bits(&table))
                    .all(|(a, b)| b.1.starts_with(&a.1));
                assert!(ends && cut.truncated(), "{end}");
                counts.insert(cut.rows());
            }
            Err(error) => assert!(end < 1000, "{end}: {error}"),
        }
    }
    assert!(counts.len() > 3 && counts.contains(&3000), "{counts:?}");
    let mut damaged = whole.clone();
    damaged[whole.len() / 3] ^= 4;
    let damaged = read_bytes(&damaged, LogFormat::Mcap).unwrap();
    assert!(damaged.truncated() && damaged.rows() > 0 && damaged.rows() < 3000);
}

#[test]
fn mcap_needs_ticks_robots_and_times() {
    let refused = |columns: Vec<Column>| {
        let table = LogTable::new("{}", columns).unwrap();
        write(&table, LogFormat::Mcap, &mut Vec::new())
            .unwrap_err()
            .to_string()
    };
    let columns = |tick, time| {
        vec![
            column("tick", Values::Integer(vec![tick])),
            column("robot", Values::Integer(vec![0])),
            column("time_s", Values::Float(vec![time])),
        ]
    };
    assert!(refused(vec![]).contains("\"tick\" of whole numbers"));
    assert!(refused(columns(-1, 0.0)).contains("tick -1 in row 0"));
    for time in [-1.0, f64::NAN, f64::INFINITY, 1e11] {
        assert!(
            refused(columns(0, time)).contains("times from 0 on"),
            "{time}"
        );
    }
}

/// An MCAP file with a column `x` of floats and one message.
fn foreign_mcap(metadata: &[(&str, &str)], message: &str) -> Result<LogTable, Error> {
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let pairs = metadata
        .iter()
        .map(|(key, value)| (key.to_string(), value.to_string()));
    let record = mcap::records::Metadata {
        name: "drivekit".to_owned(),
        metadata: pairs.collect(),
    };
    writer.write_metadata(&record).unwrap();
    let schema = writer
        .add_schema("drivekit.RunTick", "jsonschema", b"{}")
        .unwrap();
    let channel = writer
        .add_channel(schema, "/robot0/tick", "json", &BTreeMap::new())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 4,
        log_time: 7,
        publish_time: 7,
    };
    writer
        .write_to_known_channel(&header, message.as_bytes())
        .unwrap();
    writer.finish().unwrap();
    read_bytes(&writer.into_inner().into_inner(), LogFormat::Mcap)
}

#[test]
fn messages_of_mcap_are_checked() {
    let columns = r#"[["x","float"]]"#;
    let metadata = [("meta", "{}"), ("columns", columns)];
    let read = foreign_mcap(&metadata, r#"{"x": 1, "more": []}"#).unwrap();
    assert_eq!(read.column("x"), Some(&Values::Float(vec![1.0])));
    for (message, found) in [
        ("{", "EOF while parsing"),
        ("[1]", "invalid type: sequence"),
        ("{}", "column \"x\": the value is missing"),
        (r#"{"x": "1"}"#, "column \"x\": \"1\" is of another type"),
        (r#"{"x": 1e999}"#, "out of range"),
    ] {
        let error = foreign_mcap(&metadata, message).unwrap_err().to_string();
        assert!(
            error.contains("record of tick 4 at 7 ns") && error.contains(found),
            "{error}"
        );
    }
    for (metadata, found) in [
        (vec![], "no \"meta\""),
        (vec![("meta", "{}")], "no \"columns\""),
        (vec![("meta", "{"), ("columns", columns)], "not JSON"),
        (
            vec![("meta", "{}"), ("columns", r#"[["x","bool"]]"#)],
            "unknown variant",
        ),
    ] {
        let error = foreign_mcap(&metadata, r#"{"x": 1}"#)
            .unwrap_err()
            .to_string();
        assert!(error.contains(found), "{error}");
    }
}

//! MCAP files as others see them, and as others write them.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

use testbed_io::log_file::{Column, LogFormat, LogTable, Values, read_bytes, write};
use testbed_io::{Error, RunFile};
use testbed_sim::Disturbances;

use unicycle_cbf::{Preset, ScenarioSpec, Testbed};

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
            message.channel.topic.ends_with("/true_point_of_interest"),
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
        assert_valid(&value, &schema, topic);
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
        "/robot0/tick",
        "/robot0/true_point_of_interest",
        "/robot1/tick",
        "/robot1/true_point_of_interest",
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
}

#[test]
fn a_flipped_bit_in_an_mcap_is_an_error_that_says_after_which_record() {
    let table = run(3000);
    let whole = bytes(&table, LogFormat::Mcap);
    for at in (8..whole.len()).step_by(whole.len() / 97) {
        for end in [whole.len(), whole.len() - 100] {
            let mut damaged = whole.clone();
            damaged[at] ^= 4;
            damaged.truncate(end);
            match read_bytes(&damaged, LogFormat::Mcap) {
                Err(error) => assert!(
                    error.to_string().contains("copy the file again") || at < 1000,
                    "{error}"
                ),
                // What tells how long a record is may seem to point beyond a file that was also cut.
                Ok(table) => assert!(end < whole.len() && table.truncated(), "{at}"),
            }
        }
    }
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 1;
    let error = read_bytes(&damaged, LogFormat::Mcap).unwrap_err();
    assert!(
        error.to_string().contains(", after the record of tick "),
        "{error}"
    );
}

/// Types of properties, which is all that schemas of run logs say.
fn assert_valid(value: &serde_json::Value, schema: &serde_json::Value, place: &str) {
    let fits = match schema["type"].as_str().unwrap() {
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        other => panic!("{place}: type {other}"),
    };
    assert!(fits, "{place}: {value} is no {}", schema["type"]);
    let Some(object) = value.as_object() else {
        return;
    };
    for (name, value) in object {
        let property = &schema["properties"][name];
        assert!(property.is_object(), "{place}: no {name} in the schema");
        assert_valid(value, property, &format!("{place}/{name}"));
    }
}

/// A simulated run whose poses come late, with some lost, by a wall clock.
fn simulated() -> LogTable {
    let scenario = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    let spec = RunFile {
        seed: 3,
        scenario: ScenarioSpec {
            duration_s: 4.0,
            ..scenario
        },
        disturbances: Disturbances::HARD,
        link: None,
    };
    let (mut run, _) = spec.simulate().unwrap();
    run.started_unix_s = Some(1_760_000_000.0);
    run.to_table().unwrap()
}

#[test]
fn what_stands_after_the_end_is_refused() {
    let whole = bytes(&simulated(), LogFormat::Mcap);
    for after in [&whole[..], b"and more"] {
        let error = read_bytes(&[&whole[..], after].concat(), LogFormat::Mcap).unwrap_err();
        assert!(error.to_string().contains("bytes after its end"), "{error}");
    }
}

#[test]
fn every_message_of_a_run_is_valid_by_its_own_schema() {
    let table = simulated();
    let bytes = bytes(&table, LogFormat::Mcap);
    let mut count = 0;
    for message in mcap::read::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        let schema = serde_json::from_slice(&schema.data).unwrap();
        let value = serde_json::from_slice(&message.data).unwrap();
        assert_valid(&value, &schema, &message.channel.topic);
        count += 1;
    }
    assert!(count > 2 * table.rows(), "{count}");
}

#[test]
fn measured_poses_are_those_measured_at_their_time_by_the_wall_clock() {
    let table = simulated();
    let bytes = bytes(&table, LogFormat::Mcap);
    let numbers = |name: &str| match table.column(name) {
        Some(Values::Float(values)) => values.clone(),
        _ => panic!("{name}"),
    };
    let [x_m, y_m, stamps_s, times_s] =
        ["pose_x_m", "pose_y_m", "pose_stamp_s", "time_s"].map(numbers);
    let mut rows = (0..table.rows()).filter(|row| x_m[*row].is_finite());
    let mut ages_s = Vec::new();
    for message in mcap::read::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if !message.channel.topic.ends_with("/pose") {
            continue;
        }
        let row = rows.next().unwrap();
        let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
        let place = &value["pose"]["position"];
        assert_eq!(
            (&place["x"], &place["y"]),
            (&x_m[row].into(), &y_m[row].into())
        );
        let stamp = &value["timestamp"];
        let stamp_s =
            stamp["sec"].as_f64().unwrap() - 1.76e9 + 1e-9 * stamp["nsec"].as_f64().unwrap();
        assert!((stamp_s - stamps_s[row]).abs() < 1e-6, "{stamp}");
        let log_s = (message.log_time - 1_760_000_000_000_000_000) as f64 * 1e-9;
        assert!((log_s - times_s[row]).abs() < 1e-6);
        ages_s.push(log_s - stamp_s);
    }
    assert_eq!(rows.next(), None);
    assert!(ages_s.iter().any(|age_s| *age_s > 0.05), "poses were late");
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
    for missing in ["{}", r#"{"x": null}"#] {
        let read = foreign_mcap(&metadata, missing).unwrap();
        assert!(matches!(read.column("x"), Some(Values::Float(x)) if x[0].is_nan()));
    }
    for infinite in [r#"{"x": "inf"}"#, r#"{"infinite_numbers": {"x": "inf"}}"#] {
        let read = foreign_mcap(&metadata, infinite).unwrap();
        assert_eq!(read.column("x"), Some(&Values::Float(vec![f64::INFINITY])));
    }
    for (message, found) in [
        ("{", "EOF while parsing"),
        ("[1]", "invalid type: sequence"),
        (r#"{"x": [1]}"#, "column \"x\": [1] is of another type"),
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

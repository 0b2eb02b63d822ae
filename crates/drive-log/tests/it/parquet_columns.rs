//! Parquet columns of every type.

use std::path::Path;

use drive_log::{Channel, Error, LayoutChoice, LogFile, read_bytes};
use polars_core::prelude::*;
use polars_io::parquet::write::ParquetWriter;

/// A Parquet file of these columns.
fn parquet(columns: Vec<Column>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut frame = DataFrame::new_infer_height(columns).unwrap();
    ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
    bytes
}

fn column<T, const N: usize>(name: &str, values: [T; N]) -> Column
where
    Series: NamedFrom<Vec<T>, [T]>,
{
    Series::new(name.into(), Vec::from(values)).into_column()
}

fn read(columns: Vec<Column>) -> Result<LogFile, Error> {
    let bytes = parquet(columns);
    read_bytes(Path::new("log.parquet"), &bytes, &LayoutChoice::Auto)
}

#[test]
fn integers_of_every_width_are_numbers() {
    let time = || column("time_s", [0.0, 0.1, 0.2]);
    for dtype in [
        DataType::Int8,
        DataType::Int16,
        DataType::Int32,
        DataType::Int64,
        DataType::UInt8,
        DataType::UInt16,
        DataType::UInt32,
        DataType::UInt64,
        DataType::Float32,
    ] {
        let speed = column("speed_mps", [1_i64, 100, 7]).cast(&dtype).unwrap();
        let file = read(vec![time(), speed]).unwrap_or_else(|error| panic!("{dtype}: {error}"));
        let speed = file.logs[0].channel(Channel::Speed).unwrap();
        assert_eq!(speed, [1.0, 100.0, 7.0], "{dtype}");
    }
    let error = read(vec![time(), column("speed_mps", [true, false, true])]).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("\"speed_mps\"") && message.contains("Boolean"),
        "{message}"
    );
}

#[test]
fn trips_are_text_or_numbers_and_times_may_be_text() {
    let clock = ["2026-03-29T01:55:00Z", "2026-03-29T01:55:01Z"];
    let time = column(
        "timestamp",
        [clock[0], clock[0], clock[1], clock[1]].map(str::to_owned),
    );
    let trip = column("trip", [7_i64, 8, 7, 8])
        .cast(&DataType::Int16)
        .unwrap();
    let file = read(vec![
        column("Vehicle", ["x", "x", "x", "x"].map(str::to_owned)),
        trip,
        time,
        column("speed_mps", [1.0, 2.0, 1.5, 2.5]),
    ])
    .unwrap();
    let names: Vec<&str> = file.logs.iter().map(drive_log::RawLog::name).collect();
    assert_eq!(names, ["log#trip=7", "log#trip=8"]);
    assert_eq!(file.logs[1].origin()["Vehicle"], "x");
    assert_eq!(file.logs[1].time_s(), [0.0, 1.0]);
    assert_eq!(file.logs[1].channel(Channel::Speed).unwrap(), [2.0, 2.5]);
}

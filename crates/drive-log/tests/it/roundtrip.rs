//! Write and read again.

use std::path::Path;

use drive_log::{
    Channel, DriveLog, LayoutChoice, Preparation, prepare, read_bytes, write_csv, write_parquet,
};
use proptest::prelude::*;

use crate::same;

fn read_again(bytes: &[u8]) -> DriveLog {
    let file = read_bytes(Path::new("log"), bytes, &LayoutChoice::Auto).unwrap();
    assert_eq!((file.layout.as_str(), file.logs.len()), ("canonical", 1));
    let options = Preparation {
        raw: true,
        ..Preparation::default()
    };
    prepare(file.logs.into_iter().next().unwrap(), &options)
        .unwrap()
        .pieces
        .remove(0)
}

fn assert_same(a: &DriveLog, b: &DriveLog) {
    assert_eq!((a.name(), a.t0_s(), a.len()), (b.name(), b.t0_s(), b.len()));
    assert!((a.step_s() - b.step_s()).abs() <= 1e-12);
    assert!(a.channels().map(|c| c.0).eq(b.channels().map(|c| c.0)));
    for ((_, a), (_, b)) in a.channels().zip(b.channels()) {
        assert!(same(a, b), "{a:?} {b:?}");
    }
}

fn csv(log: &DriveLog) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_csv(log, &mut bytes).unwrap();
    bytes
}

fn parquet(log: &DriveLog) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_parquet(log, &mut bytes).unwrap();
    bytes
}

fn any_value() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -1e3_f64..1e3,
        1 => Just(f64::NAN),
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => prop::num::f64::NORMAL,
        1 => prop::num::f64::SUBNORMAL,
    ]
}

prop_compose! {
    // one sample has no step of its own
    fn any_log()(len in 2_usize..40)(
        t0_us in -1_000_000_000_i64..1_000_000_000_000,
        step_s in prop::sample::select(vec![0.1, 0.01, 0.5, 1.0, 0.016, 0.123_456]),
        speed in proptest::collection::vec(-20.0_f64..60.0, len),
        others in proptest::collection::btree_map(
            prop::sample::select(&Channel::ALL[1..]), proptest::collection::vec(any_value(), len), 0..5),
    ) -> DriveLog {
        let mut channels = others;
        channels.insert(Channel::Speed, speed);
        // CSV has times to the nanosecond
        DriveLog::new("log", t0_us as f64 / 1e6, step_s, channels).unwrap()
    }
}

proptest! {
    #[test]
    fn csv_is_the_identity(log in any_log()) {
        assert_same(&log, &read_again(&csv(&log)));
    }

    #[test]
    fn parquet_is_the_identity(log in any_log()) {
        assert_same(&log, &read_again(&parquet(&log)));
    }

    #[test]
    fn damaged_parquet_never_panics(log in any_log(), at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in 0_usize..50) {
        let mut bytes = parquet(&log);
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = read_bytes(Path::new("log"), &bytes, &LayoutChoice::Auto);
        bytes.truncate(bytes.len() - cut);
        let _ = read_bytes(Path::new("log"), &bytes, &LayoutChoice::Auto);
    }
}

#[test]
fn prepared_again_a_drive_is_the_same() {
    let text = "time_s,speed_mps,soc_pct\n3,1,50\n3.1,2,\n3.2,4,49.5\n";
    let options = Preparation {
        smooth: drive_log::Smoothing::None,
        ..Preparation::default()
    };
    let file = read_bytes(Path::new("log.csv"), text.as_bytes(), &LayoutChoice::Auto).unwrap();
    let once = prepare(file.logs[0].clone(), &options)
        .unwrap()
        .pieces
        .remove(0);
    let again = read_bytes(Path::new("log.csv"), &csv(&once), &LayoutChoice::Auto).unwrap();
    let twice = prepare(again.logs[0].clone(), &options)
        .unwrap()
        .pieces
        .remove(0);
    assert_eq!(once, twice);
}

#[test]
fn parquet_of_other_makers() {
    use polars_core::prelude::*;
    use polars_io::parquet::write::ParquetWriter;
    let write = |columns: Vec<Column>| {
        let mut bytes = Vec::new();
        let mut frame = DataFrame::new(columns[0].len(), columns).unwrap();
        ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
        bytes
    };
    let whole = write(vec![
        Column::new("time_ms".into(), [0_i64, 100, 200]),
        Column::new("speed_kmh".into(), [Some(36.0_f32), None, Some(72.0)]),
        Column::new("note".into(), ["a", "b", "c"]),
    ]);
    let file = read_bytes(Path::new("log.parquet"), &whole, &LayoutChoice::Auto).unwrap();
    assert_eq!(file.logs[0].time_s(), [0.0, 0.1, 0.2]);
    assert!(same(
        file.logs[0].channel(drive_log::Channel::Speed).unwrap(),
        &[10.0, f64::NAN, 20.0]
    ));

    let text = write(vec![
        Column::new("time_s".into(), [0.0]),
        Column::new("speed_mps".into(), ["fast"]),
    ]);
    let error = read_bytes(Path::new("log.parquet"), &text, &LayoutChoice::Auto)
        .unwrap_err()
        .to_string();
    assert!(error.contains("\"speed_mps\" holds Utf8"), "{error}");

    let empty = write(vec![
        Column::new("time_s".into(), Vec::<f64>::new()),
        Column::new("speed_mps".into(), Vec::<f64>::new()),
    ]);
    assert!(
        read_bytes(Path::new("x"), &empty, &LayoutChoice::Auto)
            .unwrap_err()
            .to_string()
            .contains("no rows")
    );
}

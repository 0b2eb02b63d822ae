//! Integration tests of drive-log, a module per theme.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    missing_docs
)]

mod bad_input;
mod battery;
mod contradictions;
mod divided;
mod dropouts;
mod heating;
mod held;
mod hostile;
mod layouts;
mod made;
mod odd_rows;
mod parquet_columns;
mod plausibility;
mod quality;
mod real_data;
mod resample;
mod roundtrip;
mod sensors;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod shared_cases;
mod times;
mod twins;
mod witnesses;

use std::collections::BTreeMap;
use std::path::Path;

use drive_log::{Channel, Error, LayoutChoice, LogFile, RawLog, read_bytes};

/// Reads a text with the layout recognised.
fn read(text: impl AsRef<[u8]>) -> Result<LogFile, Error> {
    read_bytes(Path::new("log.csv"), text.as_ref(), &LayoutChoice::Auto)
}

/// The only log of a text that can be read.
fn log(text: impl AsRef<[u8]>) -> RawLog {
    let mut logs = read(text).unwrap().logs;
    assert_eq!(logs.len(), 1);
    logs.remove(0)
}

/// A recording of some channels.
fn raw(time_s: Vec<f64>, channels: impl IntoIterator<Item = (Channel, Vec<f64>)>) -> RawLog {
    RawLog::new(
        "log",
        time_s,
        channels.into_iter().collect::<BTreeMap<_, _>>(),
    )
    .unwrap()
}

/// `len` times at 10 Hz.
fn ten_hertz(len: usize) -> Vec<f64> {
    (0..len).map(|i| i as f64 * 0.1).collect()
}

/// Equal to the last bit, NaN equal to NaN.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len()
        && a.iter()
            .zip(b)
            .all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
}

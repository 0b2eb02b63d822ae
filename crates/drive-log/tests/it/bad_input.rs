//! What is not a log: each a clear error, none a panic.

use std::io::Write;
use std::path::Path;

use drive_log::{Error, Layout, LayoutChoice, Preparation, prepare, read_bytes};
use proptest::prelude::*;

use crate::{log, read};

/// The message of an error, which must say these words.
fn message(text: impl AsRef<[u8]>, words: &[&str]) -> String {
    let message = read(text).expect_err("is refused").to_string();
    for word in words {
        assert!(message.contains(word), "{message:?} does not say {word:?}");
    }
    message
}

fn gzipped(text: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

const GOOD: &str = "time_s,speed_mps\n0,1\n0.1,2\n0.2,3\n";

#[test]
fn empty_files() {
    message("", &["log.csv", "empty file"]);
    message(" \r\n\n", &["empty file"]);
    message("\u{feff}", &["empty file"]);
    message(gzipped(b""), &["empty file"]);
}

#[test]
fn a_header_alone() {
    message("time_s,speed_mps\n", &["header without rows"]);
    message("time_s,speed_mps", &["header without rows"]);
}

#[test]
fn binary_content() {
    message(
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
        &["a PNG picture", "no log"],
    );
    message(b"time_s,speed_mps\n0,1\n0.1,\0\n", &["NUL byte", "byte 25"]);
    message(b"\x1b\x1b\x1b\x07\n\x80\n", &["no log"]);
}

#[test]
fn utf16() {
    let utf16: Vec<u8> = GOOD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    message(&utf16, &["UTF-16"]);
    message(
        [b"\xff\xfe".as_slice(), &utf16].concat(),
        &["UTF-16", "UTF-8"],
    );
    let big_endian: Vec<u8> = GOOD.encode_utf16().flat_map(u16::to_be_bytes).collect();
    message(&big_endian, &["UTF-16"]);
}

#[test]
fn truncated_streams() {
    let long: String = (0..1000).map(|i| format!("{i},{}\n", i % 7)).collect();
    let text = format!("time_s,speed_mps\n{long}");
    for (codec, stream) in [
        ("gzip", gzipped(text.as_bytes())),
        ("zstd", zstd::encode_all(text.as_bytes(), 3).unwrap()),
    ] {
        assert_eq!(read(&stream).unwrap().logs[0].len(), 1000);
        for len in [stream.len() - 1, stream.len() / 2, 12] {
            message(&stream[..len], &["damaged", codec]);
        }
    }
}

#[test]
fn millions_of_columns_fail_at_once() {
    let header: String = (0..1_000_000).map(|i| format!("c{i},")).collect();
    let message = message(format!("{header}\n1,2\n"), &["line 1", "1048576 bytes"]);
    assert!(message.len() < 300);
}

#[test]
fn ragged_rows() {
    message(
        "time_s,speed_mps\n0,1\n0.1\n",
        &["line 3", "1 field ", "2 are expected"],
    );
    message(
        "time_s,speed_mps\n0,1\n\n0.1,2,3\n",
        &["line 4", "3 fields"],
    );
    message(
        "time_s;speed_mps\n0,0;1,5\n0,1;1,6;7\n",
        &["line 3", "3 fields", "';'"],
    );
}

#[test]
fn empty_surplus_fields_are_no_harm() {
    assert_eq!(log("time_s,speed_mps\n0,1,\n0.1,2,,\n").len(), 2);
    assert_eq!(log("time_s,speed_mps,,\n0,1\n0.1,2\n").len(), 2);
}

#[test]
fn mixed_delimiters() {
    message("time_s,speed_mps\n0;1\n0.1;2\n", &["line 2", "','"]);
    message("time_s;speed_mps\n0;1\n0.1,2\n", &["line 3", "';'"]);
}

#[test]
fn mixed_decimal_marks() {
    message(
        "time_s;speed_mps\n0,0;1,5\n0,1;1.6\n",
        &["line 3", "\"1.6\"", "speed_mps"],
    );
    message(
        "time_s;speed_mps\n0.0;1.5\n0.1;1,600\n",
        &["line 3", "\"1,600\""],
    );
}

#[test]
fn a_cell_that_is_no_number() {
    message(
        "time_s,speed_mps\n0,1\n0.1,fast\n",
        &["line 3", "\"speed_mps\"", "\"fast\"", "not a number"],
    );
    message(
        "time_s,speed_mps\n0,1\nsoon,1\n1,1\n",
        &["line 3", "\"time_s\"", "\"soon\""],
    );
    // columns that nobody reads may hold anything
    assert_eq!(log("time_s,speed_mps,note\n0,1,fast\n").len(), 1);
}

#[test]
fn a_long_cell_is_cut_in_the_message() {
    let text = format!("time_s,speed_mps\n0,1\n1,{}\n", "x".repeat(100_000));
    assert!(message(text, &["line 3"]).len() < 300);
}

#[test]
fn missing_columns() {
    message("time_s,accel_mps2\n0,1\n", &["speed_mps", "\"accel_mps2\""]);
    message("speed_mps,accel_mps2\n0,1\n", &["time", "time_s"]);
    message(
        "a,b\n0,1\n",
        &["no known layout", "\"a\", \"b\"", "[channels]"],
    );
    message("1,2\n3,4\n", &["no known layout", "2 columns of numbers"]);
    message("time_s\n0\n", &["without rows of numbers"]);
}

#[test]
fn unknown_units() {
    message(
        "time_s,speed_furlongs\n0,1\n",
        &["\"speed_furlongs\"", "_mps, _kmh, _mph, _kn"],
    );
    message(
        "time_fortnights,speed_mps\n0,1\n",
        &["\"time_fortnights\"", "_s, _ms"],
    );
}

#[test]
fn the_same_channel_twice() {
    message(
        "time_s,speed_mps,speed_kmh\n0,1,3.6\n",
        &["\"speed_mps\"", "\"speed_kmh\"", "both"],
    );
    message("t,time_s,v\n0,0,1\n", &["both time"]);
}

#[test]
fn no_speed_at_all() {
    message(
        "time_s,speed_mps\n0,NaN\n0.1,\n",
        &["speed_mps is missing in all 2 samples"],
    );
}

#[test]
fn one_sample_is_no_drive() {
    let error = prepare(log("time_s,speed_mps\n0,1\n"), &Preparation::default()).unwrap_err();
    assert!(
        matches!(error, Error::NoPiece { samples: 1, .. }),
        "{error}"
    );
}

#[test]
fn time_that_runs_backward_throughout() {
    message(
        "time_s,speed_mps\n0.3,1\n0.2,1\n0.1,1\n",
        &["backward in 2 of 3", "\"time_s\""],
    );
}

#[test]
fn layouts_that_are_none() {
    let named = LayoutChoice::Named("bmw-i4".to_owned());
    let error = read_bytes(Path::new("x"), GOOD.as_bytes(), &named)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("\"bmw-i4\"") && error.contains("bmw-i3"),
        "{error}"
    );
    let time = "time = { header = \"t\", unit = \"s\" }\n[channels]\n";
    for (text, word) in [
        ("", "time"),
        ("time = 3", "time"),
        ("time = { header = \"t\", unit = \"s\" }", "channels"),
        (
            &format!("{time}accel = {{ header = \"a\", unit = \"g\" }}"),
            "no speed",
        ),
        (
            &format!("{time}speed = {{ header = \"v\", unit = \"furlongs\" }}"),
            "m/s, km/h, mph, kn",
        ),
        (
            &format!("{time}speeed = {{ header = \"v\", unit = \"m/s\" }}"),
            "known channels",
        ),
        (
            &format!("{time}speed = {{ header = \"v\", unit = \"m/s\", sign = 2 }}"),
            "1 or -1",
        ),
        (&format!("{time}speed = {{ unit = \"m/s\" }}"), "header"),
        (
            &format!("no_header = true\n{time}speed = {{ column = 2, unit = \"m/s\" }}"),
            "number of its column",
        ),
        (
            &format!("delimiter = \"|\"\n{time}speed = {{ header = \"v\", unit = \"m/s\" }}"),
            "delimiter",
        ),
        (
            &format!(
                "delimiter = \",\"\ndecimal = \",\"\n{time}speed = {{ header = \"v\", unit = \"m/s\" }}"
            ),
            "comma",
        ),
    ] {
        let error = Layout::from_toml_str("mine", text).unwrap_err().to_string();
        assert!(
            error.contains("layout mine") && error.contains(word),
            "{error}"
        );
    }
}

#[test]
fn damaged_parquet() {
    message(b"PAR1", &["Parquet"]);
    message(b"PAR1 and then nothing that is Parquet PAR1", &["Parquet"]);
    message(
        [b"PAR1".as_slice(), &[0xff; 64], b"PAR1"].concat(),
        &["Parquet"],
    );
}

#[test]
fn a_file_that_is_not_there() {
    let error =
        drive_log::read_file(Path::new("no/such/file.csv"), &LayoutChoice::Auto).unwrap_err();
    assert!(error.to_string().contains("no/such/file.csv"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes);
    }

    /// Bytes that come further: words of a log in any order.
    #[test]
    fn almost_logs_never_panic(
        words in proptest::collection::vec(
            prop::sample::select(vec![
                "time_s", "t", "v", "speed_kmh", "soc_pct", ",", ";", "\t", " ", "\n", "\r\n", "\n", "0", "0.1", "1", "-2.5", "1e9", "1,5",
                "NaN", "inf", "\"", "x", "", "Time [s]", "Velocity [km/h]", "Date", "Time", "Speed", "12:00:00", "01/02/2021", "Vehicle_order",
                "\u{feff}", "é", "trip", "vehicle", "timestamp", "date", "a", "# ", "//", "sep=;", "\r", "km/h", "48-40", "1.234", "1,234.5",
                "3/4/2021", "29.03.2026", "2026-03-29T01:55:00Z", "PM", "095959", "--", "speed_limit_kmh",
            ]),
            0..120,
        )
    ) {
        if let Ok(file) = read(words.concat()) {
            for log in file.logs {
                let _ = prepare(log, &Preparation::default());
            }
        }
    }

    /// Files that were good before a byte was changed.
    #[test]
    fn damaged_logs_never_panic(at in 0..GOOD.len(), byte in any::<u8>()) {
        let mut text = GOOD.as_bytes().to_vec();
        text[at] = byte;
        let _ = read(&text);
        let mut gzip = gzipped(GOOD.as_bytes());
        let at = at % gzip.len();
        gzip[at] = byte;
        let _ = read(&gzip);
    }
}

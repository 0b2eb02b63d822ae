//! Bad input: a clear error with place and remedy, exit code 2, no panic, nothing overwritten.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, fixture};

/// Writes the bytes to a file and inspects and evaluates it; both must refuse with all of the words.
fn refused(name: &str, bytes: &[u8], words: &[&str]) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    let path = path.to_str().unwrap();
    let mut expected = vec![name];
    expected.extend(words);
    drivekit(&["inspect", path]).refused(&expected);
    drivekit(&["evaluate", path]).refused(&expected);
}

fn rows(n: usize, row: impl Fn(usize) -> String) -> String {
    (0..n).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "{}", row(i));
        text
    })
}

#[test]
fn an_empty_file() {
    refused("empty.csv", b"", &["empty"]);
}

#[test]
fn a_header_alone() {
    refused("header.csv", b"time_s,speed_mps\n", &["without rows"]);
}

#[test]
fn a_binary_file() {
    let bytes: Vec<u8> = (0..4096u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    refused("binary.csv", &bytes, &["binary"]);
}

#[test]
fn a_million_columns() {
    let mut text = vec!["c"; 1_000_000].join(",");
    text.push('\n');
    text.push_str(&vec!["0"; 1_000_000].join(","));
    refused("wide.csv", text.as_bytes(), &["columns"]);
}

#[test]
fn time_running_backward() {
    let text = "time_s,speed_mps\n".to_owned() + &rows(100, |i| format!("{},5", 100 - i));
    refused("backward.csv", text.as_bytes(), &["time", "backward"]);
}

#[test]
fn one_sample() {
    refused(
        "one.csv",
        b"time_s,speed_mps\n0,5\n",
        &["no two with a valid speed"],
    );
}

#[test]
fn all_nan() {
    let text = "time_s,speed_mps\n".to_owned() + &rows(100, |i| format!("{i},NaN"));
    refused("nan.csv", text.as_bytes(), &["speed"]);
}

#[test]
fn a_missing_speed_column() {
    let text = "time_s,elevation_m\n".to_owned() + &rows(100, |i| format!("{i},500"));
    refused("nospeed.csv", text.as_bytes(), &["speed"]);
}

#[test]
fn mixed_delimiters() {
    let text = "time_s,speed_mps,elevation_m\n".to_owned()
        + &rows(100, |i| match i {
            57 => format!("{i};5;500"),
            _ => format!("{i},5,500"),
        });
    refused("mixed.csv", text.as_bytes(), &["59"]);
}

#[test]
fn a_truncated_gzip() {
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    let text = "time_s,speed_mps\n".to_owned() + &rows(5000, |i| format!("{},{}", i, i % 17));
    std::io::Write::write_all(&mut gzip, text.as_bytes()).unwrap();
    let bytes = gzip.finish().unwrap();
    refused("cut.csv.gz", &bytes[..bytes.len() / 2], &["gzip"]);
}

#[test]
fn a_damaged_parquet() {
    refused("cut.parquet", b"PAR1 and nothing of use PAR1", &["Parquet"]);
}

#[test]
fn an_unknown_unit() {
    let text = "time_s,speed_furlongs\n".to_owned() + &rows(100, |i| format!("{i},5"));
    refused("unit.csv", text.as_bytes(), &["speed_furlongs"]);
}

#[test]
fn text_in_a_number_column() {
    let text = "time_s,speed_mps\n".to_owned()
        + &rows(100, |i| match i {
            42 => format!("{i},fast"),
            _ => format!("{i},5"),
        });
    refused("text.csv", text.as_bytes(), &["44", "fast"]);
}

#[test]
fn a_folder_without_logs() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("notes.md"), "nothing here").unwrap();
    drivekit(&["evaluate", folder.path().to_str().unwrap()]).refused(&["no logs in the folder"]);
}

#[test]
fn a_path_that_is_not_there() {
    drivekit(&["inspect", "no/such/log.csv"]).refused(&["no/such/log.csv"]);
}

#[test]
fn every_bad_log_of_a_folder_is_named() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.csv"), "").unwrap();
    fs::write(folder.path().join("b.csv"), "time_s,speed_mps\n").unwrap();
    drivekit(&["inspect", folder.path().to_str().unwrap()]).refused(&["a.csv", "b.csv"]);
}

#[test]
fn an_output_path_that_is_a_folder() {
    let folder = TempDir::new().unwrap();
    let place = folder.path().to_str().unwrap();
    let drive = fixture("drives/drive-01.csv");
    drivekit(&["evaluate", "--report", place]).refused(&["it is a folder"]);
    drivekit(&["segment", &drive, "--plot", place]).refused(&["it is a folder"]);
    drivekit(&["fit", &drive, "--model", "profile", "-o", place]).refused(&["it is a folder"]);
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
fn what_was_written_before_survives_an_error() {
    let folder = TempDir::new().unwrap();
    let model = folder.path().join("model.json");
    fs::write(&model, "precious").unwrap();
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, "time_s,speed_mps\n0,5\n").unwrap();
    let arguments = |log: &Path| {
        [
            "fit",
            log.to_str().unwrap(),
            "--model",
            "inverse",
            "-o",
            model.to_str().unwrap(),
        ]
        .map(str::to_owned)
    };
    let arguments = arguments(&bad);
    drivekit(&arguments.each_ref().map(String::as_str)).refused(&["bad.csv"]);
    assert_eq!(fs::read_to_string(&model).unwrap(), "precious");
    assert_eq!(
        folder.path().read_dir().unwrap().count(),
        2,
        "no temporary file stays behind"
    );
}

#[test]
fn a_foreign_model_file() {
    let folder = TempDir::new().unwrap();
    let model = folder.path().join("model.json");
    fs::write(&model, "{\"schema\": \"someone/else/3\"}").unwrap();
    let drive = fixture("drives/drive-01.csv");
    drivekit(&["predict", &drive, "--model", model.to_str().unwrap()])
        .refused(&["model.json", "someone/else/3"]);
}

#[test]
fn usage_errors() {
    drivekit(&["evaluate", "--no-such-flag"]).refused(&["--no-such-flag"]);
    drivekit(&["evaluate", "--models", "oracle"]).refused(&["oracle", "inverse"]);
    drivekit(&["evaluate", "--vehicle", "batmobile"]).refused(&["batmobile", "b250e"]);
    drivekit(&["segment"]).refused(&["no logs given"]);
    drivekit(&["evaluate", "--band=-3"]).refused(&["--band", "width in km/h"]);
    drivekit(&["predict", "--band=nan"]).refused(&["--band", "width in km/h"]);
    drivekit(&["evaluate", "--require", "profile>=3"])
        .refused(&["no figure `profile`", "`profile."]);
    drivekit(&["segment", &fixture("drives/drive-01.csv"), "--weights", "1"])
        .refused(&["--weights"]);
    drivekit(&[
        "segment",
        &fixture("drives/drive-01.csv"),
        "--weights",
        "0,0",
    ])
    .refused(&["--weights", "above 0"]);
    drivekit(&["inspect", &fixture("drives/drive-01.csv"), "--step=-1"]).refused(&["step"]);
}

/// Libraries speak of values; the flags that set them are named below.
#[test]
fn errors_of_libraries_name_the_flags_that_help() {
    let folder = TempDir::new().unwrap();
    let rows = |speed: fn(u32) -> f64| {
        (0..600).fold("time_s,speed_mps\n".to_owned(), |text, k| {
            text + &format!("{},{}\n", f64::from(k) / 10.0, speed(k))
        })
    };
    std::fs::write(folder.path().join("steady.csv"), rows(|_| 10.0)).unwrap();
    std::fs::write(
        folder.path().join("two.csv"),
        rows(|k| f64::from(5 + 17 * (k % 2)) + (f64::from(k) / 25.0).sin()),
    )
    .unwrap();
    for (arguments, help) in [
        (
            "fit steady.csv --model constant -o model.json",
            "help: see --min-duration",
        ),
        ("inspect two.csv", "help: --raw takes"),
        (
            "segment - --follow --scale range",
            "help: such as --scale 10,0.5",
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let run = drivekit_in(folder.path(), &arguments);
        assert!(
            run.code == 2 && run.stderr.contains(help),
            "{arguments:?}: {}",
            run.stderr
        );
    }
}

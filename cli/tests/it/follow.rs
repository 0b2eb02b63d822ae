//! Segments of a drive that is still going on.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use serde_json::Value;

use crate::program::{Run, drivekit, fixture, run};

/// Long enough for any machine; only a line that never comes makes a test wait for it.
const HANG: Duration = Duration::from_secs(60);

fn following(more: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(["segment", "-", "--follow"])
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Follows `text` to its end.
fn follow(text: &str, more: &[&str]) -> Run {
    let mut child = following(more);
    let mut stdin = child.stdin.take().unwrap();
    let text = text.to_owned();
    // A program that refuses the input stops reading.
    let writer = std::thread::spawn(move || drop(stdin.write_all(text.as_bytes())));
    let run = run(child.wait_with_output());
    writer.join().unwrap();
    run
}

fn lines(text: &str) -> Vec<Value> {
    let json = |line| serde_json::from_str(line).unwrap();
    text.lines().map(json).collect()
}

#[test]
fn a_followed_drive_has_the_segments_of_the_whole() {
    let drive = fixture("drives/drive-01.csv");
    let text = fs::read_to_string(&drive).unwrap();
    for (scale, more) in [
        (&[][..], &[][..]),
        (&["--scale", "10,0.5"], &["--raw", "--refill", "fixed"]),
        (&["--scale", "none"], &["--merge", "none", "--window", "40"]),
    ] {
        let more = [more, &["--format", "json"]].concat();
        let followed = follow(&text, &[scale, &more].concat()).ok().stdout;
        let followed = lines(&followed);
        // What --help says of the default.
        let scale = if scale.is_empty() {
            &["--scale", "18,1.6"]
        } else {
            scale
        };
        let whole = drivekit(&[&["segment", &drive], scale, &more].concat())
            .ok()
            .json();
        let whole = whole["logs"][0]["segments"].as_array().unwrap();
        assert_eq!(followed.len(), whole.len());
        for (followed, whole) in followed.iter().zip(whole) {
            for key in ["start", "end", "phase", "lead_influenced"] {
                assert_eq!(followed[key], whole[key], "{key}");
            }
            for key in ["start_s", "end_s", "mean_speed_mps", "mean_accel_mps2"] {
                let [a, b] = [followed, whole].map(|segment| segment[key].as_f64().unwrap());
                assert!((a - b).abs() < 1e-9, "{key}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_segment_is_printed_while_the_drive_goes_on() {
    let text = fs::read_to_string(fixture("drives/drive-01.csv")).unwrap();
    let mut child = following(&["--format", "json"]);
    let mut stdin = child.stdin.take().unwrap();
    let stdout = BufReader::new(child.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        for line in stdout.lines() {
            sender.send(line.unwrap()).unwrap();
        }
    });
    let rows: Vec<&str> = text.split_inclusive('\n').collect();
    stdin
        .write_all(rows[..rows.len() / 2].concat().as_bytes())
        .unwrap();
    stdin.flush().unwrap();
    let first: Value = serde_json::from_str(&receiver.recv_timeout(HANG).unwrap()).unwrap();
    assert_eq!(first["start"], 0);
    drop(stdin);
    assert!(child.wait().unwrap().success());
    reader.join().unwrap();
}

#[test]
fn a_gap_starts_anew_and_segments_count_on() {
    let row = |i: u32, offset: f64| format!("{},{}\n", f64::from(i) / 10.0 + offset, 10);
    let rows = |offset| (0..50).map(move |i| row(i, offset)).collect::<String>();
    let text = format!("time_s,speed_mps\n{}{}", rows(0.0), rows(100.0));
    let segments = lines(&follow(&text, &["--format", "json"]).ok().stdout);
    let spans: Vec<_> = segments
        .iter()
        .map(|segment| (segment["start"].as_u64(), segment["end"].as_u64()))
        .collect();
    assert_eq!(spans, [(Some(0), Some(50)), (Some(50), Some(100))]);
}

#[test]
fn a_bad_row_ends_it_with_the_number_of_its_line() {
    for (row, word) in [
        ("0.2,fast\n", "fast"),
        ("0.2,\n", "speed"),
        ("0.15,10\n", "0.1 s"),
        ("0.2\n", "field"),
    ] {
        let run = follow(&format!("time_s,speed_mps\n0,10\n0.1,10\n{row}"), &[]);
        assert_eq!(run.code, 2);
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
        for word in [word, "line 4"] {
            assert!(run.stderr.contains(word), "no `{word}` in: {}", run.stderr);
        }
    }
}

#[test]
fn what_needs_the_whole_drive_is_refused() {
    let drive = fixture("drives/drive-01.csv");
    for (more, words) in [
        (&["-", "--method", "dynamic"][..], &["SWAB"][..]),
        (&["-", "--scale", "zscore"], &["scale"]),
        (&["-", "--layout", "bmw-i3"], &["--layout"]),
        (&[&drive], &["stdin"]),
    ] {
        drivekit(&[&["segment", "--follow"], more].concat()).refused(words);
    }
}

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

/// A drive with some of its rows spoilt, by the row without its time.
fn spoilt(spoil: impl Fn(usize, f64, &str) -> String) -> String {
    let text = fs::read_to_string(fixture("drives/drive-01.csv")).unwrap();
    let rows = text.lines().skip(1).enumerate().map(|(k, row)| {
        let mut cells = row.split(',');
        let time_s = cells.next().unwrap().parse().unwrap();
        spoil(k, time_s, cells.next().unwrap()) + "\n"
    });
    "time_s,speed_mps\n".to_owned() + &rows.collect::<String>()
}

/// Boundaries of the whole log, whose pieces count on.
fn boundaries_of_the_whole(text: &str) -> Vec<(u64, u64)> {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("drive.csv");
    fs::write(&path, text).unwrap();
    let args = [
        "segment",
        path.to_str().unwrap(),
        "--scale",
        "18,1.6",
        "--format",
        "json",
    ];
    let document = drivekit(&args).ok().json();
    let mut before = 0;
    let mut found = Vec::new();
    for log in document["logs"].as_array().unwrap() {
        let segments = log["segments"].as_array().unwrap();
        let at = |segment: &Value, key| before + segment[key].as_u64().unwrap();
        found.extend(segments.iter().map(|s| (at(s, "start"), at(s, "end"))));
        before = found.last().unwrap().1;
    }
    found
}

fn boundaries_followed(text: &str) -> (Vec<(u64, u64)>, String) {
    let run = follow(text, &["--format", "json"]).ok();
    let segments = lines(&run.stdout);
    let spans = segments
        .iter()
        .map(|s| (s["start"].as_u64().unwrap(), s["end"].as_u64().unwrap()));
    (spans.collect(), run.stderr)
}

#[test]
fn it_goes_on_after_rows_that_cannot_be_used() {
    let plain = |time_s: f64, speed: &str| format!("{time_s},{speed}");
    let missing = |k| (300..311).contains(&k) || (600..651).contains(&k) || k == 900;
    for (instead, words) in [("", "no value"), ("--", "--"), ("nan", "no value")] {
        let text = spoilt(|k, t, v| plain(t, if missing(k) { instead } else { v }));
        let (followed, notes) = boundaries_followed(&text);
        let emptied = spoilt(|k, t, v| plain(t, if missing(k) { "" } else { v }));
        assert_eq!(followed, boundaries_of_the_whole(&emptied), "{instead:?}");
        for words in [
            words,
            "line 302",
            "11 rows",
            "line 602",
            "new piece",
            "line 902",
            "1 row",
        ] {
            assert!(notes.contains(words), "no `{words}` in {notes}");
        }
    }
    // Rows that are lost, cut off or late.
    for spoil in [|k: usize| k % 97 == 5, |k: usize| k % 301 == 7] {
        let lost = spoilt(|k, t, v| if spoil(k) { String::new() } else { plain(t, v) });
        let expected = boundaries_of_the_whole(&lost);
        assert_eq!(boundaries_followed(&lost).0, expected);
        let cut = spoilt(|k, t, v| if spoil(k) { t.to_string() } else { plain(t, v) });
        assert_eq!(boundaries_followed(&cut).0, expected);
        let late = spoilt(|k, t, v| plain(if spoil(k) { t - 0.35 } else { t }, v));
        assert_eq!(boundaries_followed(&late).0, expected);
    }
}

#[test]
fn a_clock_that_is_set_back_starts_anew() {
    let text = spoilt(|k, t, v| format!("{},{v}", if k < 600 { t } else { t - 60.0 }));
    let (followed, notes) = boundaries_followed(&text);
    let samples = fs::read_to_string(fixture("drives/drive-01.csv"))
        .unwrap()
        .lines()
        .count() as u64
        - 1;
    assert!(followed.iter().any(|span| span.1 == 600) && followed.last().unwrap().1 == samples);
    assert!(followed.windows(2).all(|pair| pair[0].1 == pair[1].0));
    assert!(
        notes.contains("set back") && notes.contains("line 602"),
        "{notes}"
    );
}

#[test]
fn what_has_come_is_printed_whatever_ends_the_stream() {
    let text = fs::read_to_string(fixture("drives/drive-01.csv")).unwrap();
    let whole = lines(&follow(&text, &["--format", "json"]).ok().stdout);
    let endless = text.clone() + &"x".repeat(2 << 20);
    let broken = follow(&endless, &["--format", "json"]);
    assert_eq!(broken.code, 2);
    assert_eq!(lines(&broken.stdout), whole);
}

#[cfg(unix)]
#[test]
fn what_has_come_is_printed_before_a_signal_ends_it() {
    let text = fs::read_to_string(fixture("drives/drive-01.csv")).unwrap();
    let whole = lines(&follow(&text, &["--format", "json"]).ok().stdout);
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        if crate::program::is_ignored(number) {
            continue;
        }
        let mut child = following(&["--format", "json"]);
        let mut stdin = child.stdin.take().unwrap();
        stdin.write_all(text.as_bytes()).unwrap();
        stdin.flush().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut printed = String::new();
        // The last segments stay open as long as the stream is.
        while lines(&printed).len() < whole.len() / 2 {
            assert!(stdout.read_line(&mut printed).unwrap() > 0);
        }
        std::thread::sleep(Duration::from_millis(300));
        crate::program::signal(&child, signal);
        std::io::Read::read_to_string(&mut stdout, &mut printed).unwrap();
        assert!(child.wait().unwrap().success());
        assert_eq!(lines(&printed), whole, "{signal}");
        drop(stdin);
    }
}

#[test]
fn the_shared_streams_go_on() {
    let Some(folder) = crate::program::shared("cases/cars/41-follow") else {
        return;
    };
    for name in ["clean.csv", "nan.csv", "word.csv", "gap.csv", "back.csv"] {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        let (followed, _) = boundaries_followed(&text);
        assert_eq!(followed[0].0, 0, "{name}");
        assert!(
            followed.windows(2).all(|pair| pair[0].1 == pair[1].0),
            "{name}"
        );
        let rows = text.lines().count() as u64 - 1;
        let missing = if name == "nan.csv" { 51 } else { 0 };
        assert_eq!(followed.last().unwrap().1, rows - missing, "{name}");
        if name != "back.csv" {
            assert_eq!(
                followed,
                boundaries_of_the_whole(&text.replace("--", "")),
                "{name}"
            );
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

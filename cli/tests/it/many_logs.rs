//! Folders of logs, and what else lies in them.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Run, drivekit, drivekit_in, run, shared};

/// A drive of 30 s at 10 Hz, another for every `seed`.
fn log(seed: usize) -> String {
    let mut text = "time_s,speed_mps\n".to_owned();
    for i in 0..300 {
        let phase = i as f64 / 20.0 + seed as f64;
        let _ = writeln!(
            text,
            "{:.1},{:.3}",
            i as f64 / 10.0,
            8.0 + 6.0 * phase.sin()
        );
    }
    text
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, content).unwrap();
}

fn paths(list: &Value) -> Vec<&str> {
    let entries = list.as_array().unwrap().iter();
    entries
        .map(|entry| entry["path"].as_str().unwrap())
        .collect()
}

fn inspect(folder: &Path, args: &[&str]) -> Run {
    drivekit_in(folder, &[&["inspect", "--format", "json"], args].concat())
}

#[test]
fn a_folder_of_a_thousand_logs_is_read_by_any_number_of_threads() {
    let folder = TempDir::new().unwrap();
    for k in 0..1400 {
        write(folder.path(), &format!("f{k:05}.csv"), log(k));
    }
    let of_one = inspect(folder.path(), &[".", "--threads", "1"]).ok();
    assert_eq!(of_one.json()["inputs"].as_array().unwrap().len(), 1400);
    for threads in ["2", "16"] {
        let run = inspect(folder.path(), &[".", "--threads", threads]).ok();
        assert!(run.stdout == of_one.stdout, "{threads} threads");
    }
}

#[test]
fn more_threads_than_a_computer_can_use_are_refused() {
    for threads in ["100000", "-1", "many"] {
        drivekit(&["inspect", &format!("--threads={threads}")]).refused(&["--threads"]);
    }
}

#[test]
fn folders_are_searched_to_the_bottom_and_sorted_by_name() {
    let folder = TempDir::new().unwrap();
    for name in ["b.csv", "deep/er/a.csv.gz", "deep/c.txt", ".cache/d.csv"] {
        match name.strip_suffix(".gz") {
            None => write(folder.path(), name, log(1)),
            Some(_) => {
                let mut gzip =
                    flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
                std::io::Write::write_all(&mut gzip, log(2).as_bytes()).unwrap();
                write(folder.path(), name, gzip.finish().unwrap());
            }
        }
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.path(), folder.path().join("deep/back")).unwrap();
    let document = inspect(folder.path(), &["./"]).ok().json();
    assert_eq!(
        paths(&document["inputs"]),
        ["b.csv", "deep/c.txt", "deep/er/a.csv.gz"]
    );
}

#[test]
fn files_that_are_no_logs_are_named_and_left_out_of_a_folder() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "a.csv", log(1));
    let foreign: [(&str, &[u8]); 12] = [
        ("README.md", b"# Drives\n"),
        ("empty.csv", b""),
        (
            "notes.txt",
            b"We drove on the 3rd of May, 2021.\nIt rained.\n",
        ),
        ("page.csv", b"<!DOCTYPE html>\n<p>404</p>\n"),
        ("picture.csv", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"),
        (
            "result.txt",
            b"{\n  \"schema\": \"drivekit/inspect/1\"\n}\n",
        ),
        ("trips.csv", b"trip,km,driver\n1,12.5,anna\n2,7.25,ben\n"),
        ("heart.csv", b"time_s,heart_rate\n0,60\n1,61\n"),
        ("limits.csv", b"lat,lon,speed_limit_kmh\n1,2,50\n1,3,60\n"),
        (
            "summary.csv",
            b"trip,mean speed km/h,max speed km/h\n1,33.2,80\n2,22.1,70\n",
        ),
        (
            "out.txt",
            b"2 drives, 27 phases of at least 10 km/h, one left out\n1 2 3\n4 5 6\n",
        ),
        (
            "trace.csv",
            b"time_s,speed_mps,wheel_force_n,rolling_n,grade_n,terminal_power_w\n0,1,2,3,4,5\n1,1,2,3,4,5\n",
        ),
    ];
    for (name, content) in foreign {
        write(folder.path(), name, content);
    }
    let run = inspect(folder.path(), &["."]).ok();
    let document = run.json();
    assert_eq!(paths(&document["inputs"]), ["a.csv"]);
    let mut left_out = paths(&document["files"]["left_out"]);
    left_out.sort_unstable();
    let mut named = foreign.map(|(name, _)| name);
    named.sort_unstable();
    assert_eq!(left_out, named);
    let line = run
        .stderr
        .lines()
        .find(|l| l.contains("12 files that are no logs"));
    assert!(
        line.is_some_and(|l| l.contains("README.md")),
        "{}",
        run.stderr
    );

    for (name, _) in &foreign[1..] {
        inspect(folder.path(), &["a.csv", name]).refused(&[name]);
    }
}

#[test]
fn a_broken_log_stops_the_run_or_is_skipped_on_request() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "a.csv", log(1));
    write(folder.path(), "b.csv", log(2).replace("1.5,", "1.5,fast"));
    write(folder.path(), "c.csv", "time_s,speed_mps\n");
    write(folder.path(), "d.csv", "time_s,speed_furlongs\n0,1\n1,2\n");
    write(folder.path(), "e.csv", log(3));
    let broken = ["b.csv", "c.csv", "d.csv"];
    let stopped = inspect(folder.path(), &["."]);
    stopped.refused(&[&broken[..], &["--on-error skip", "2 logs"]].concat());

    for subcommand in [
        &["inspect"][..],
        &["segment"],
        &["energy", "--vehicle", "b250e"],
    ] {
        let args = [subcommand, &[".", "--on-error", "skip", "--format", "json"]].concat();
        let run = drivekit_in(folder.path(), &args);
        assert_eq!(run.code, 1, "{}", run.stderr);
        let document = run.json();
        assert_eq!(paths(&document["inputs"]), ["a.csv", "e.csv"]);
        assert_eq!(paths(&document["files"]["skipped"]), broken);
        for name in broken {
            assert!(run.stderr.contains(name), "{}", run.stderr);
        }
    }
}

#[test]
fn nothing_but_broken_logs_is_an_error() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "a.csv", "time_s,speed_mps\n");
    inspect(folder.path(), &[".", "--on-error", "skip"]).refused(&["a.csv", "without rows"]);
    write(folder.path(), "a.csv", "");
    inspect(folder.path(), &["."]).refused(&["no logs", "a.csv", "empty"]);
}

#[test]
#[cfg(unix)]
fn an_endless_file_is_refused_from_its_first_block() {
    let before = Instant::now();
    drivekit(&["inspect", "/dev/zero"]).refused(&["/dev/zero", "binary"]);
    let zeros = fs::File::open("/dev/zero").unwrap();
    let mut of_stdin = Command::new(env!("CARGO_BIN_EXE_drivekit"));
    run(of_stdin.args(["inspect", "-"]).stdin(zeros).output()).refused(&["stdin", "binary"]);
    assert!(before.elapsed() < Duration::from_secs(30));
}

#[test]
fn a_first_line_of_a_hundred_megabytes_is_refused_in_seconds() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "line.csv", b"speed ".repeat(100_000_000 / 6));
    let before = Instant::now();
    inspect(folder.path(), &["line.csv"]).refused(&["line.csv", "line 1", "longer than"]);
    assert!(before.elapsed() < Duration::from_secs(30));
}

#[test]
#[ignore = "takes minutes"]
fn ten_thousand_logs_are_an_ordinary_folder() {
    let folder = TempDir::new().unwrap();
    for k in 0..10_000 {
        write(folder.path(), &format!("{}/f{k:05}.csv", k % 10), log(k));
    }
    for subcommand in [
        &["inspect"][..],
        &["energy", "--vehicle", "b250e"],
        &["segment"],
    ] {
        let of = |threads| {
            let before = Instant::now();
            let args = [subcommand, &[".", "--format", "json", "--threads", threads]].concat();
            let document = drivekit_in(folder.path(), &args).ok().stdout;
            eprintln!("{subcommand:?} {threads} threads: {:?}", before.elapsed());
            document
        };
        let of_one = of("1");
        assert!(of("2") == of_one && of("16") == of_one, "{subcommand:?}");
    }
}

/// The recorded logs beside the project, and what is recorded that is no drive.
fn recorded() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = shared("data").into_iter().collect();
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().unwrap() {
            let path = entry.unwrap().path();
            let into = if path.is_dir() {
                &mut folders
            } else {
                &mut files
            };
            into.push(path);
        }
    }
    files.sort();
    files
}

#[test]
#[ignore = "takes an hour"]
fn random_subsets_of_recorded_logs_end_with_figures_or_an_error() {
    let files = recorded();
    let folder = TempDir::new().unwrap();
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    let subcommands = [
        &["inspect"][..],
        &["segment", "--method", "heuristic"],
        &["energy", "--vehicle", "bmw-i3-60ah"],
        &["evaluate", "--models", "profile"],
        &["fit", "--model", "cruise", "-o", "model.json"],
    ];
    for round in 0..if files.is_empty() { 0 } else { 500 } {
        let count = 1 + random(files.len());
        let some: Vec<&str> = (0..count)
            .map(|_| files[random(files.len())].to_str().unwrap())
            .collect();
        let threads = ["1", "2", "16"][random(3)];
        for subcommand in subcommands {
            let more = ["--on-error", "skip", "--threads", threads];
            let run = drivekit_in(folder.path(), &[subcommand, &some, &more].concat());
            let crashed = run.code > 2 || run.stderr.contains("bug in drivekit");
            assert!(
                !crashed,
                "round {round}, {subcommand:?} {some:?}: {}",
                run.stderr
            );
        }
    }
}

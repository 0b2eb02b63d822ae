//! The same drive by two names, and who is held out.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Run, drivekit_in, fixture, shared};

/// Columns of a fixture: time in s, speed in m/s.
fn drive(number: usize) -> Vec<[f64; 2]> {
    let text = fs::read_to_string(fixture(&format!("drives/drive-{number:02}.csv"))).unwrap();
    let row = |line: &str| {
        let mut cells = line.split(',').map(|cell| cell.parse().unwrap());
        [cells.next().unwrap(), cells.next().unwrap()]
    };
    text.lines().skip(1).map(row).collect()
}

fn csv(header: &str, rows: impl Iterator<Item = [f64; 2]>) -> String {
    rows.fold(format!("{header}\n"), |mut text, [time, speed]| {
        let _ = writeln!(text, "{time:.3},{speed:.2}");
        text
    })
}

/// A folder with the first drives of the fixtures, a folder each.
fn drives(count: usize) -> TempDir {
    let folder = TempDir::new().unwrap();
    for number in 1..=count {
        let place = folder.path().join(format!("d{number}"));
        fs::create_dir(&place).unwrap();
        fs::copy(
            fixture(&format!("drives/drive-{number:02}.csv")),
            place.join("log.csv"),
        )
        .unwrap();
    }
    folder
}

fn evaluate(folder: &Path, args: &[&str]) -> Run {
    let common = ["evaluate", "--models", "profile", "--format", "json"];
    drivekit_in(folder, &[&common, args].concat())
}

/// Why each drive is not counted, by its path.
fn twice(document: &Value) -> Vec<[&str; 2]> {
    let entries = document["files"]["twice"].as_array().unwrap().iter();
    entries
        .map(|entry| ["path", "why"].map(|key| entry[key].as_str().unwrap()))
        .collect()
}

/// A copy of the first drive beside its folder.
fn copy_log(folder: &Path) {
    fs::copy(folder.join("d1/log.csv"), folder.join("copy.csv")).unwrap();
}

#[test]
fn one_file_by_several_paths_is_read_once() {
    let folder = drives(3);
    #[cfg(unix)]
    std::os::unix::fs::symlink("d1/log.csv", folder.path().join("link.csv")).unwrap();
    let run = evaluate(folder.path(), &["d1", "./d1", "d*/log.csv", "link.csv"]).ok();
    let document = run.json();
    assert_eq!(document["inputs"].as_array().unwrap().len(), 3);
    let again = twice(&document);
    assert!(again.contains(&["d1/log.csv", "same-file"]), "{again:?}");
    assert!(
        again.iter().all(|[_, why]| *why == "same-file"),
        "{again:?}"
    );
    assert!(run.stderr.contains("`d1/log.csv`"), "{}", run.stderr);
}

#[test]
fn a_copy_under_another_name_counts_once() {
    let folder = drives(3);
    fs::create_dir(folder.path().join("copies")).unwrap();
    fs::copy(
        folder.path().join("d2/log.csv"),
        folder.path().join("copies/other.csv"),
    )
    .unwrap();
    for hold_out in ["trip", "file", "driver"] {
        let args = [".", "--hold-out", hold_out];
        let document = evaluate(folder.path(), &args).ok().json();
        assert_eq!(document["inputs"].as_array().unwrap().len(), 3);
        assert_eq!(twice(&document), [["d2/log.csv", "same-bytes"]]);
    }
}

#[test]
fn the_same_drive_in_another_dress_counts_once() {
    let folder = drives(3);
    let of_drive = drive(1);
    let saved = [
        (
            "kmh.csv",
            csv(
                "t,speed_kmh",
                of_drive.iter().map(|[t, v]| [t + 1e5, 3.6 * v]),
            ),
        ),
        (
            "whole.csv",
            csv(
                "t,speed_kmh",
                of_drive.iter().map(|[t, v]| [*t, (3.6 * v).round()]),
            ),
        ),
        (
            "rare.csv",
            csv("t,v", of_drive.iter().skip(3).step_by(10).copied()),
        ),
        ("part.csv", csv("t,v", of_drive[1200..4800].iter().copied())),
    ];
    for (name, text) in &saved {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let args = [
        "d1",
        "d2",
        "d3",
        "kmh.csv",
        "whole.csv",
        "rare.csv",
        "part.csv",
    ];
    let document = evaluate(folder.path(), &args).ok().json();
    assert_eq!(
        twice(&document),
        [
            ["kmh.csv", "same-speed"],
            ["whole.csv", "same-speed"],
            ["rare.csv", "same-speed"],
            ["part.csv", "part-of"],
        ]
    );
    let backward = ["part.csv", "d1", "d2", "d3"];
    let document = evaluate(folder.path(), &backward).ok().json();
    assert_eq!(twice(&document), [["part.csv", "part-of"]]);
}

#[test]
fn of_equal_drives_the_one_with_more_channels_stays() {
    let folder = drives(3);
    let speed_alone = csv("t,v", drive(1).into_iter());
    fs::write(folder.path().join("alone.csv"), speed_alone).unwrap();
    let document = evaluate(folder.path(), &["alone.csv", "d1", "d2", "d3"])
        .ok()
        .json();
    assert_eq!(twice(&document), [["alone.csv", "same-speed"]]);
}

#[test]
fn own_logs_are_no_prior() {
    let folder = drives(4);
    let args = ["d1", "d2", "d3", "--prior", "d4", "--prior", "./d2"];
    let run = evaluate(folder.path(), &args).ok();
    assert_eq!(twice(&run.json()), [["d2/log.csv", "same-bytes"]]);
    assert!(run.stderr.contains("d2/log.csv"), "{}", run.stderr);
    let args = ["fit", "d1", "d2", "--prior", "d2", "--prior", "d3"];
    let more = ["--model", "profile", "-o", "model.json", "--format", "json"];
    let document = drivekit_in(folder.path(), &[&args[..], &more].concat())
        .ok()
        .json();
    assert_eq!(twice(&document), [["d2/log.csv", "same-bytes"]]);
}

#[test]
fn calibration_counts_a_drive_once() {
    let folder = drives(2);
    copy_log(folder.path());
    let args = [
        "calibrate",
        "d1",
        "d2",
        "copy.csv",
        "--vehicle",
        "bmw-i3-60ah",
    ];
    let more = ["-o", "car.toml", "--format", "json"];
    let document = drivekit_in(folder.path(), &[&args[..], &more].concat())
        .ok()
        .json();
    assert_eq!(document["trips"].as_array().unwrap().len(), 2);
    assert_eq!(twice(&document), [["copy.csv", "same-bytes"]]);
}

#[test]
fn commands_that_learn_nothing_take_copies_as_they_come() {
    let folder = drives(1);
    copy_log(folder.path());
    let args = ["inspect", "d1", "copy.csv", "--format", "json"];
    let document = drivekit_in(folder.path(), &args).ok().json();
    assert_eq!(document["inputs"].as_array().unwrap().len(), 2);
}

fn held_out(document: &Value) -> Vec<(&str, u64)> {
    let drives = document["held_out"]["drives"].as_object().unwrap().iter();
    drives
        .map(|(unit, count)| (unit.as_str(), count.as_u64().unwrap()))
        .collect()
}

#[test]
fn a_driver_is_a_folder_at_a_stated_level() {
    let folder = TempDir::new().unwrap();
    for (number, place) in [(1, "anna/1"), (2, "anna/2"), (3, "ben/1"), (4, "ben/2")] {
        let place = folder.path().join(place);
        fs::create_dir_all(&place).unwrap();
        let drive = fixture(&format!("drives/drive-{number:02}.csv"));
        fs::copy(drive, place.join("log.csv")).unwrap();
    }
    let by = |args: &[&str]| {
        let args = [&["--hold-out", "driver"], args].concat();
        evaluate(folder.path(), &args)
    };
    let run = by(&["."]).ok();
    assert_eq!(held_out(&run.json()), [("anna", 2), ("ben", 2)]);
    assert!(run.stderr.contains("anna (2), ben (2)"), "{}", run.stderr);
    let run = by(&["anna", "./ben", "./anna"]).ok();
    assert_eq!(held_out(&run.json()), [("anna", 2), ("ben", 2)]);
    let run = by(&[".", "--driver-level", "2"]).ok();
    assert_eq!(held_out(&run.json()), [("anna", 2), ("ben", 2)]);
    let run = by(&[".", "--driver-level", "1"]).ok();
    assert_eq!(held_out(&run.json()).len(), 4);
    by(&[".", "--driver-column", "driver"]).refused(&["anna", "no column `driver`"]);
    by(&["anna/1"]).refused(&["--hold-out driver", "--driver-level"]);
    by(&[".", "--driver-level", "40"]).refused(&["no folder 40 above"]);
}

#[test]
fn a_driver_is_a_column_whatever_its_header() {
    let folder = TempDir::new().unwrap();
    for (number, driver) in [(1, "Anna"), (2, "Ben"), (3, "Anna")] {
        let text = fs::read_to_string(fixture(&format!("drives/drive-{number:02}.csv"))).unwrap();
        let mut rows = text.lines();
        let header = format!("{},Driver Name\n", rows.next().unwrap());
        let rows: String = rows.map(|row| format!("{row},{driver}\n")).collect();
        let path = folder.path().join(format!("{number}.csv"));
        fs::write(path, header + &rows).unwrap();
    }
    let args = [".", "--hold-out", "driver", "--driver-column"];
    let by = |column: &str| evaluate(folder.path(), &[&args[..], &[column]].concat());
    let document = by("driver name").ok().json();
    assert_eq!(held_out(&document), [("Anna", 2), ("Ben", 1)]);
    by("time_s").refused(&["no column `time_s`"]);
}

#[test]
fn drives_of_one_name_are_drives_of_their_own() {
    let folder = drives(3);
    let document = evaluate(folder.path(), &["."]).ok().json();
    let names = held_out(&document);
    assert_eq!(
        names,
        [("d1/log.csv", 1), ("d2/log.csv", 1), ("d3/log.csv", 1)]
    );
}

#[test]
fn three_logs_of_one_name_are_three_units() {
    let Some(folder) = shared("cases/cars/57-same-name-trajectory") else {
        return;
    };
    let args = [
        "evaluate",
        "d1",
        "d2",
        "d3",
        "--task",
        "trajectory",
        "--models",
        "ridge",
        "--horizons",
        "5",
        "--format",
        "json",
    ];
    let document = drivekit_in(&folder, &args).ok().json();
    assert_eq!(document["units"].as_array().unwrap().len(), 3);
}

#[test]
fn the_error_of_a_single_drive_says_that_the_others_are_the_same() {
    let folder = drives(1);
    let again = csv(
        "time_s,speed_mps",
        drive(1)
            .into_iter()
            .map(|[time, speed]| [time + 60.0, speed]),
    );
    fs::write(folder.path().join("again.csv"), again).unwrap();
    for task in [
        &[][..],
        &[
            "--task",
            "trajectory",
            "--models",
            "ridge",
            "--horizons",
            "5",
        ],
    ] {
        let args = [&["evaluate", ".", "-q"], task].concat();
        drivekit_in(folder.path(), &args).refused(&["log is the same drive", "d1/log.csv"]);
    }
}

//! Run logs that were damaged or cut off, and paths from files, as users meet them.

use std::fs;
use std::path::Path;

use crate::program::drivekit_in;

fn logged(folder: &Path, name: &str) -> Vec<u8> {
    let args = ["ctrl", "run", "--duration", "1", "-o", name, "--quiet"];
    drivekit_in(folder, &args).ok();
    fs::read(folder.join(name)).unwrap()
}

#[test]
fn a_damaged_run_log_is_an_error_and_one_cut_off_a_note() {
    let folder = tempfile::tempdir().unwrap();
    for (name, place) in [
        ("run.csv", ", line "),
        ("run.mcap", ", after the record of tick "),
    ] {
        let whole = logged(folder.path(), name);
        let replay = |bytes: &[u8]| {
            fs::write(folder.path().join(name), bytes).unwrap();
            drivekit_in(folder.path(), &["ctrl", "replay", name])
        };
        let mut damaged = whole.clone();
        damaged[whole.len() * 3 / 4] ^= 1;
        let out = replay(&damaged);
        assert_eq!(out.code, 2, "{}", out.stdout);
        let error = &out.stderr;
        assert!(error.contains(name) && error.contains("damaged"), "{error}");
        assert!(error.contains(place), "{error}");
        if name == "run.csv" {
            let out = replay(&whole[..whole.len() - 20]);
            assert_eq!(out.code, 2, "{}", out.stdout);
            assert!(out.stderr.contains("run.csv is cut off"), "{}", out.stderr);
            assert!(
                out.stdout.contains("98 decisions, every one the same"),
                "{}",
                out.stdout
            );
        }
    }
}

#[test]
fn csv_logs_have_a_row_per_decision() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(logged(folder.path(), "run.csv")).unwrap();
    let (names, rows) = text.split_once('\n').unwrap();
    assert!(
        names.starts_with("tick,robot,time_s,outcome,")
            && names.ends_with(",lane_clearance_m,about")
    );
    assert_eq!(rows.lines().count(), 100);
}

#[test]
fn paths_are_read_by_their_header_and_closed_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let half = |turns: f64| -> String {
        let angles = (0..40).map(|i| f64::from(i) / 40.0 * turns * std::f64::consts::TAU);
        let lines = angles.map(|a| format!("{a},{},{},1\n", 1000.0 * a.cos(), 1000.0 * a.sin()));
        format!("s_m,x_mm,y_mm,kappa\n{}", lines.collect::<String>())
    };
    let drive = |path: &str, text: &str, more: &[&str]| {
        fs::write(folder.path().join(path), text).unwrap();
        let args = [
            "ctrl",
            "run",
            "--scenario",
            "brake",
            "--preset",
            "hardened",
            "--path",
            path,
        ];
        drivekit_in(folder.path(), &[&args, more].concat())
    };
    let out = drive("round.csv", &half(1.0), &[]).ok();
    assert!(out.stdout.contains("safe: "), "{}", out.stdout);
    let out = drive("open.csv", &half(0.7), &[]);
    assert_eq!(out.code, 2);
    assert!(
        out.stderr.contains("open.csv: the path is open") && out.stderr.contains("--close-path")
    );
    let out = drive("open.csv", &half(0.7), &["--close-path"]);
    assert!(
        out.stderr.contains("is closed by a curve"),
        "{}",
        out.stderr
    );
    let out = drive("drive.csv", "time_s,speed_mps\n0,3\n1,4\n2,5\n", &[]);
    assert_eq!(out.code, 2);
    assert!(
        out.stderr
            .contains("drive.csv, line 1: no column `x` among: time_s, speed_mps")
    );
}

#[test]
fn a_log_that_ends_too_early_is_not_called_safe() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(logged(folder.path(), "run.csv")).unwrap();
    for missing in [1, 2, 40] {
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let cut = lines[..lines.len() - missing].concat();
        fs::write(folder.path().join("cut.csv"), cut).unwrap();
        let out = drivekit_in(folder.path(), &["ctrl", "replay", "cut.csv"]);
        assert_eq!(out.code, 2, "{}", out.stdout);
        assert!(out.stderr.contains("cut.csv is cut off"), "{}", out.stderr);
        let verdict = "NOT KNOWN whether the robots were safe: the end of the log is missing";
        assert!(out.stdout.contains(verdict), "{}", out.stdout);
    }
}

#[test]
fn the_replay_of_an_unsafe_run_has_its_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let stop = [
        "--testbed",
        "khepera",
        "--scenario",
        "stop",
        "-o",
        "run.csv",
    ];
    let run = drivekit_in(folder.path(), &[&["ctrl", "run"], &stop[..]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    let out = drivekit_in(folder.path(), &["ctrl", "replay", "run.csv"]);
    assert_eq!(out.code, 1, "{}", out.stderr);
    assert!(
        out.stdout.contains("the robots were UNSAFE from"),
        "{}",
        out.stdout
    );
}

#[test]
fn the_replay_of_a_missing_file_says_so_once() {
    let folder = tempfile::tempdir().unwrap();
    let out = drivekit_in(folder.path(), &["ctrl", "replay", "none.csv"]);
    out.refused(&["none.csv"]);
    assert_eq!(
        out.stderr.matches("No such file").count(),
        1,
        "{}",
        out.stderr
    );
}

#[test]
fn controllers_beside_recorded_robots_that_touch_say_so() {
    let folder = tempfile::tempdir().unwrap();
    for (apart_m, code, verdict) in [(0.05, 1, "UNSAFE from 0.00 s on"), (0.8, 0, "safe: ")] {
        let row = |step: u32| {
            let time_s = 0.1 * f64::from(step);
            let angle = std::f64::consts::TAU * time_s / 50.0;
            let at = |angle: f64, robot: u32| {
                let (sin, cos) = angle.sin_cos();
                let heading_rad = angle + std::f64::consts::FRAC_PI_2;
                format!("{time_s},{robot},{cos},{sin},{heading_rad}\n")
            };
            at(angle, 1) + &at(angle - apart_m, 2)
        };
        let rows: String = (0..500).map(row).collect();
        let text = format!("time_s,robot,x_m,y_m,heading_rad\n{rows}");
        fs::write(folder.path().join("poses.csv"), text).unwrap();
        let args = ["ctrl", "replay", "--poses", "csv", "poses.csv"];
        let out = drivekit_in(folder.path(), &args);
        assert_eq!(out.code, code, "{} {}", out.stdout, out.stderr);
        assert!(out.stdout.contains(verdict), "{}", out.stdout);
    }
}

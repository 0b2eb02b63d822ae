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
            let out = replay(&whole[..whole.len() - 20]).ok();
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

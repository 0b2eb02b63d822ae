//! `--no-times`: the same input, the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, fixture};

/// Drives, a link of recorded poses and models that commands read.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("logs")).unwrap();
    for name in [
        "drive-01.csv",
        "drive-02.csv",
        "drive-03.csv",
        "drive-04.csv",
        "drive-05.csv",
    ] {
        fs::copy(
            fixture(&format!("drives/{name}")),
            folder.path().join("logs").join(name),
        )
        .unwrap();
    }
    for args in [
        &[
            "fit",
            "logs",
            "--model",
            "profile-conditioned",
            "-o",
            "phases.json",
        ][..],
        &["fit", "logs", "--model", "cruise", "-o", "cruise.json"],
        &[
            "fit",
            "logs",
            "--model",
            "ridge",
            "--horizons",
            "2",
            "-o",
            "ahead.json",
        ],
        &["fit", "logs", "--model", "trip-driver", "-o", "trip.json"],
        &["ctrl", "run", "--duration", "3", "-o", "recorded.csv"],
    ] {
        drivekit_in(folder.path(), args).ok();
    }
    let state = r#"{"follower": {"x_m": 0.9, "y_m": 0, "speed_mps": 0.2, "heading_rad": 1.57, "turn_rate_rad_s": 0}}"#;
    fs::write(folder.path().join("state.json"), state).unwrap();
    crate::program::write_poses(folder.path());
    folder
}

/// Every command that computes, with every kind of file that it writes, into the folder `out`.
const COMMANDS: [&[&str]; 31] = [
    &["inspect", "logs"],
    &["segment", "logs", "--plot", "out/segment.svg"],
    &[
        "segment",
        "logs",
        "--method",
        "dynamic",
        "--segments",
        "20",
        "--first",
        "800",
    ],
    &[
        "segment",
        "logs/drive-01.csv",
        "--compare",
        "--first",
        "600",
        "--segments",
        "20",
        "--report",
        "out/compare.html",
    ],
    &[
        "energy",
        "logs",
        "--vehicle",
        "b250e",
        "--vehicle",
        "vw-id3",
        "--report",
        "out/energy.html",
    ],
    &[
        "energy",
        "logs/drive-01.csv",
        "--vehicle",
        "b250e",
        "--trace",
        "out/energy.csv",
    ],
    &[
        "calibrate",
        "logs",
        "--vehicle",
        "b250e",
        "-o",
        "out/car.toml",
        "--report",
        "out/car.html",
    ],
    &[
        "fit",
        "logs",
        "--model",
        "profile-onset",
        "-o",
        "out/onset.json",
    ],
    &["fit", "logs", "--model", "idm", "-o", "out/idm.json"],
    &[
        "fit",
        "logs",
        "--model",
        "svr-rbf",
        "--horizons",
        "2",
        "-o",
        "out/svr.json",
    ],
    &[
        "fit",
        "logs",
        "--model",
        "boosted-trees",
        "--horizons",
        "2",
        "-o",
        "out/trees.json",
    ],
    &["model", "show", "phases.json", "--plot", "out/model.svg"],
    &["predict", "logs", "--model", "phases.json"],
    &["predict", "logs", "--model", "cruise.json"],
    &["predict", "logs", "--model", "ahead.json"],
    &["predict", "logs", "--model", "trip.json"],
    &[
        "evaluate",
        "logs",
        "--learning-curve",
        "--report",
        "out/evaluate.html",
    ],
    &[
        "evaluate",
        "logs",
        "--task",
        "trajectory",
        "--models",
        "ridge,svr-linear",
        "--horizons",
        "2",
        "--max-samples",
        "400",
        "--folds",
        "2",
        "--report",
        "out/trajectory.html",
    ],
    &["portrait", "logs", "--report", "out/portrait.html"],
    &[
        "synth",
        "--force",
        "-o",
        "out",
        "--drives",
        "2",
        "--duration",
        "60",
        "--noise",
    ],
    &[
        "synth",
        "--force",
        "-o",
        "out",
        "--drives",
        "1",
        "--duration",
        "60",
        "--file-format",
        "parquet",
    ],
    &["vehicle", "check"],
    &["vehicle", "point", "b250e", "--speed", "10"],
    &[
        "ctrl",
        "run",
        "--duration",
        "2",
        "-o",
        "out/run.csv",
        "--report",
        "out/run.html",
    ],
    &[
        "ctrl",
        "run",
        "--duration",
        "2",
        "--preset",
        "hardened",
        "--disturb",
        "all",
        "-o",
        "out/run.mcap",
    ],
    &["ctrl", "run", "--duration", "2", "-o", "out/run.parquet"],
    &[
        "ctrl",
        "campaign",
        "--runs",
        "20",
        "--duration",
        "2",
        "--report",
        "out/campaign.html",
    ],
    &["ctrl", "replay", "recorded.csv"],
    &["ctrl", "replay", "--poses", "csv", "poses.csv"],
    &["ctrl", "check"],
    &["ctrl", "explain", "--state", "state.json"],
];

/// What a command prints and writes.
fn made(folder: &Path, args: &[&str], format: &str, threads: &str) -> BTreeMap<String, Vec<u8>> {
    let out = folder.join("out");
    let _ = fs::remove_dir_all(&out);
    fs::create_dir(&out).unwrap();
    let always = ["--no-times", "--format", format, "--threads", threads];
    let run = drivekit_in(folder, &[args, &always].concat());
    assert!(run.code < 2, "{args:?}: {}", run.stderr);
    let mut made = BTreeMap::from([
        ("stdout".to_owned(), run.stdout.into_bytes()),
        ("stderr".to_owned(), run.stderr.into_bytes()),
    ]);
    for entry in fs::read_dir(out).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        made.insert(name, fs::read(path).unwrap());
    }
    made
}

#[test]
fn the_same_input_gives_the_same_bytes_with_any_number_of_threads() {
    let folder = folder();
    for args in COMMANDS {
        for format in ["text", "json"] {
            let first = made(folder.path(), args, format, "1");
            let second = made(folder.path(), args, format, "2");
            assert_eq!(
                first.keys().collect::<Vec<_>>(),
                second.keys().collect::<Vec<_>>()
            );
            for (name, bytes) in &first {
                assert!(*bytes == second[name], "{args:?} {format}: {name} differs");
            }
        }
    }
}

#[test]
fn without_it_times_are_there() {
    let folder = TempDir::new().unwrap();
    let run = [
        "ctrl",
        "run",
        "--duration",
        "1",
        "-o",
        "run.csv",
        "--format",
        "json",
    ];
    let has_times = |more: &[&str]| {
        let document = drivekit_in(folder.path(), &[&run[..], more].concat())
            .ok()
            .json();
        let text = fs::read_to_string(folder.path().join("run.csv")).unwrap();
        let mut rows = text.lines();
        let column = rows
            .next()
            .unwrap()
            .split(',')
            .position(|name| name == "step_us")
            .unwrap();
        let logged = !rows
            .next()
            .unwrap()
            .split(',')
            .nth(column)
            .unwrap()
            .is_empty();
        assert_eq!(document["loop"]["median_us"].is_number(), logged);
        logged
    };
    assert!(has_times(&[]));
    assert!(!has_times(&["--no-times"]));
    let evaluated = |more: &[&str]| {
        let args = ["evaluate", "--models", "profile", "--format", "json"];
        drivekit(&[&args[..], more].concat()).ok().json()["models"]["profile"]["fit_seconds"]
            .is_number()
    };
    assert!(evaluated(&[]));
    assert!(!evaluated(&["--no-times"]));
}

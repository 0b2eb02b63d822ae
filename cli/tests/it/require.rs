//! `--require` in every command that computes figures, and what scripts see of it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, fixture};

/// Documents by the name of their list of figures.
fn documents() -> Vec<(&'static str, Value)> {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    let state = r#"{"follower": {"x_m": 0.9, "y_m": 0, "speed_mps": 0.2, "heading_rad": 1.57, "turn_rate_rad_s": 0},
        "leader": {"x_m": 0.5, "y_m": 0.8, "speed_mps": 0.2, "heading_rad": 2.6, "turn_rate_rad_s": 0}}"#;
    fs::write(folder.path().join("state.json"), state).unwrap();
    let points = "speed_mps,accel_mps2,grade\n10,0,0\n20,0.5,0\n";
    fs::write(folder.path().join("points.csv"), points).unwrap();
    fs::write(folder.path().join("none.json"), "[]").unwrap();
    crate::program::write_poses(folder.path());
    let run = |args: &[&str]| drivekit_in(folder.path(), &[args, &["--format", "json"]].concat());
    let mut found = Vec::new();
    let mut add = |name, args: &[&str]| found.push((name, run(args).ok().json()));
    add("inspect", &["inspect", &drives]);
    add(
        "segment",
        &["segment", &drives, "--method", "dynamic", "--first", "500"],
    );
    add("segment", &["segment", &drives]);
    add(
        "segment-compare",
        &[
            "segment",
            &drives,
            "--compare",
            "--first",
            "500",
            "--segments",
            "20",
        ],
    );
    add("energy", &["energy", &drives, "--vehicle", "b250e"]);
    add(
        "calibrate",
        &["calibrate", &drives, "--vehicle", "b250e", "-o", "car.toml"],
    );
    for (model, more) in [
        ("profile", &[][..]),
        ("inverse", &[]),
        ("cruise", &[]),
        ("idm", &[]),
        ("ridge", &["--horizons", "2"]),
        ("trip-driver", &[]),
    ] {
        let fit = ["fit", &drives, "--model", model, "-o", "model.json"];
        add("fit", &[&fit[..], more].concat());
        add("predict", &["predict", &drives, "--model", "model.json"]);
    }
    add("evaluate", &["evaluate", "--learning-curve"]);
    let trajectory = [
        "evaluate",
        "--task",
        "trajectory",
        "--models",
        "ridge",
        "--horizons",
        "2",
    ];
    add(
        "evaluate-trajectory",
        &[&trajectory[..], &["--max-samples", "500", "--folds", "2"]].concat(),
    );
    add("portrait", &["portrait", &drives, "--fleet", &drives]);
    let drive = fixture("drives/drive-01.csv");
    add("road", &["road", &drive, "-o", "road.toml"]);
    let road = fixture("roads/town-and-country.toml");
    add("plan", &["plan", &road, "--arrive", "300"]);
    add("plan", &["plan", &road, "--frontier", "3"]);
    add("plan-potential", &["plan", &drives, "--potential"]);
    let alone = [
        "plan",
        &road,
        "--signals",
        "none.json",
        "--certify",
        "convex",
    ];
    add("plan", &alone);
    add("vehicle-check", &["vehicle", "check"]);
    add(
        "vehicle-point",
        &["vehicle", "point", "b250e", "--speed", "10"],
    );
    add(
        "vehicle-point",
        &["vehicle", "point", "b250e", "--points", "points.csv"],
    );
    add(
        "ctrl-run",
        &["ctrl", "run", "--duration", "3", "-o", "run.csv"],
    );
    add("ctrl-replay", &["ctrl", "replay", "run.csv"]);
    let link = "robots = [1, 2]\nlost_after_s = 5.0\n[poses]\nkind = \"recording\"\nfile = \"live.csv\"\npace = \"fast\"\n\
        [commands]\nkind = \"none\"\n";
    fs::write(folder.path().join("lab.toml"), link).unwrap();
    run(&[
        "ctrl",
        "run",
        "--preset",
        "hardened",
        "--duration",
        "3",
        "-o",
        "live.csv",
    ])
    .ok();
    add(
        "ctrl-run",
        &["ctrl", "run", "--live", "lab.toml", "--duration", "3"],
    );
    add(
        "ctrl-replay",
        &["ctrl", "replay", "--poses", "csv", "poses.csv"],
    );
    add(
        "ctrl-campaign",
        &[
            "ctrl",
            "campaign",
            "--runs",
            "20",
            "--duration",
            "3",
            "--preset",
            "thesis",
        ],
    );
    add("ctrl-check", &["ctrl", "check"]);
    add(
        "ctrl-explain",
        &["ctrl", "explain", "--state", "state.json"],
    );
    found
}

/// Keys under which names stand, and not figures.
const NAMED: [&str; 9] = [
    "models",
    "baselines",
    "in_sample",
    "bands",
    "methods",
    "mean",
    "horizons",
    "left_out",
    "function_fits",
];

/// Keys under which figures stand by seconds ahead.
const BY_HORIZON: [&str; 3] = ["rmse_mps", "skill_pct", "fold_skill_pct"];

/// Parts that are no results.
const NO_FIGURES: [&str; 7] = [
    "schema", "version", "config", "inputs", "files", "spec", "model",
];

fn paths(value: &Value, keys: &mut Vec<String>, found: &mut BTreeSet<String>) {
    match value {
        // A figure that these drives do not give.
        Value::Null | Value::Number(_) | Value::Bool(_) => {
            found.insert(keys.join("."));
        }
        Value::Array(entries) => {
            keys.push("[]".to_owned());
            entries.iter().for_each(|entry| paths(entry, keys, found));
            keys.pop();
        }
        Value::Object(object) => {
            let last = keys.last().map(String::as_str).unwrap_or_default();
            let by_model_and_horizon = keys.ends_with(&["horizons".to_owned(), "*".to_owned()]);
            let first = keys.first().map_or("", String::as_str);
            let has_names_of_its_own = ["cruise", "following"].contains(&first);
            let is_of_names =
                NAMED.contains(&last) || BY_HORIZON.contains(&last) || by_model_and_horizon;
            let by_name = is_of_names && !has_names_of_its_own;
            for (key, below) in object {
                let is_no_figure = NO_FIGURES.contains(&key.as_str()) && !below.is_number();
                if keys.is_empty() && is_no_figure {
                    continue;
                }
                keys.push(if by_name { "*".to_owned() } else { key.clone() });
                paths(below, keys, found);
                keys.pop();
            }
        }
        Value::String(_) => {}
    }
}

fn list(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("src/figures/{name}.txt"))
}

/// With `DRIVEKIT_FIGURES=write`, the lists are made anew.
#[test]
fn the_lists_hold_every_figure_of_the_documents() {
    let mut found: std::collections::BTreeMap<&str, BTreeSet<String>> =
        std::collections::BTreeMap::new();
    for (name, document) in documents() {
        paths(&document, &mut Vec::new(), found.entry(name).or_default());
    }
    for (name, figures) in found {
        let text: String = figures.iter().map(|figure| figure.clone() + "\n").collect();
        if std::env::var_os("DRIVEKIT_FIGURES").is_some() {
            fs::write(list(name), &text).unwrap();
        }
        let listed = fs::read_to_string(list(name)).unwrap();
        let known: BTreeSet<&str> = listed.lines().collect();
        let missing: Vec<&String> = figures
            .iter()
            .filter(|figure| !known.contains(figure.as_str()))
            .collect();
        assert!(
            missing.is_empty(),
            "{name} lacks {missing:?}; `just figures` makes the lists anew"
        );
        let stale: Vec<&&str> = known
            .iter()
            .filter(|figure| !figures.contains(**figure))
            .collect();
        assert!(
            stale.is_empty(),
            "{name} has no {stale:?}; `just figures` makes the lists anew"
        );
    }
}

/// A command, a figure that holds, and one that does not.
fn commands() -> Vec<(Vec<String>, &'static str, &'static str)> {
    let drives = fixture("drives");
    let drive = fixture("drives/drive-01.csv");
    let own = |args: &[&str]| args.iter().map(|arg| (*arg).to_owned()).collect();
    vec![
        (
            own(&["inspect", &drives]),
            "logs.duration_s>10",
            "logs.distance_m<1",
        ),
        (
            own(&["segment", &drive]),
            "logs.metrics.segments>=2",
            "metrics.mean_length<1",
        ),
        (
            own(&[
                "segment",
                &drive,
                "--compare",
                "--first",
                "400",
                "--segments",
                "9",
            ]),
            "mean.swab.mean_length>0",
            "mean.swab.std_length<0",
        ),
        (
            own(&["plan", &fixture("roads/town-and-country.toml")]),
            "plans.gap_pct<0.1",
            "plans.energy_j<1",
        ),
        (
            own(&["plan", &drive, "--potential"]),
            "total.saving_pct>1",
            "trips.saving_pct>90",
        ),
        (
            own(&["energy", &drive, "--vehicle", "b250e"]),
            "error_pct<=50",
            "totals.distance_m<1",
        ),
        (
            own(&["portrait", &drives]),
            "driver.distance_m>1",
            "driver.distance_m<1",
        ),
        (
            own(&["vehicle", "check", "b250e"]),
            "vehicles.top_speed_mps>20",
            "vehicles.b250e.top_speed_mps<1",
        ),
        (
            own(&["vehicle", "point", "b250e", "--speed", "10"]),
            "battery_power_w>0",
            "battery_power_w<0",
        ),
        (
            own(&["evaluate", "--models", "profile"]),
            "braking.profile.rmse_mps<5",
            "profile.in_band_pct>=101",
        ),
        (
            own(&["ctrl", "run", "--duration", "3"]),
            "mean_speed_mps>0",
            "mean_speed_mps>9",
        ),
        (own(&["ctrl", "check"]), "half_width_m>0", "half_width_m>9"),
        (
            own(&["ctrl", "campaign", "--runs", "11", "--duration", "2"]),
            "totals.runs>=11",
            "totals.runs<11",
        ),
    ]
}

#[test]
fn every_command_says_whether_its_figures_are_met() {
    for (args, met, missed) in commands() {
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let with = |more: &[&str]| drivekit(&[&args[..], more].concat());
        let run = with(&["-q", "--require", met]).ok();
        assert!(
            run.stderr.contains(&format!("met: {met}")),
            "{}",
            run.stderr
        );
        let run = with(&[
            "-q",
            "--require",
            met,
            "--require",
            missed,
            "--format",
            "json",
        ]);
        assert_eq!(run.code, 1, "{args:?} {missed}: {}", run.stderr);
        assert!(
            run.stderr.contains(&format!("missed: {missed}: found")),
            "{}",
            run.stderr
        );
        let judged = &run.json()["requirements"];
        assert_eq!(judged[0]["require"], met);
        assert_eq!(judged[0]["met"], true);
        assert_eq!(judged[1]["met"], false);
        assert!(judged[1]["found"].is_number());
    }
}

#[test]
fn an_unknown_figure_is_an_error_before_the_work() {
    for (args, figure, near) in [
        (
            &["inspect", "no.csv"][..],
            "logs.duration>1",
            "logs.duration_s",
        ),
        (
            &["energy", "no.csv", "--vehicle", "b250e"],
            "eror_pct<1",
            "error_pct",
        ),
        (
            &["evaluate", "no.csv"],
            "profil.in_band_pct>=1",
            "profile.in_band_pct",
        ),
        (
            &["evaluate", "no.csv", "--models", "inverse"],
            "profile.in_band_pct>=1",
            "inverse.in_band_pct",
        ),
        (
            &["evaluate", "no.csv"],
            "braking.profile.rmse>=1",
            "braking.profile.rmse_mps",
        ),
        (
            &["evaluate", "no.csv", "--task", "trajectory"],
            "rigde.rmse_mps.2<1",
            "ridge.rmse_mps.2",
        ),
        (
            &["ctrl", "run", "--scenario", "no.toml"],
            "mean_sped_mps>0",
            "mean_speed_mps",
        ),
    ] {
        let run = drivekit(&[args, &["--require", figure]].concat());
        run.refused(&["no figure", near]);
    }
    for figure in ["profile.rmse_mps", "profile.rmse_mps<=nan", "<=1"] {
        drivekit(&["evaluate", "--require", figure]).refused(&["FIGURE>=NUMBER"]);
    }
}

/// Exit code with a reader that goes away at once.
#[cfg(unix)]
fn code_without_a_reader(args: &[&str]) -> Option<i32> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_drivekit"))
        .args(args)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    child.wait().unwrap().code()
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_does_not_change_how_it_ends() {
    let drives = fixture("drives");
    for format in ["text", "json"] {
        let inspect = ["inspect", &drives, "--format", format];
        assert_eq!(code_without_a_reader(&inspect), Some(0));
        let missed = [&inspect[..], &["--require", "logs.duration_s<0"]].concat();
        assert_eq!(code_without_a_reader(&missed), Some(1));
    }
    assert_eq!(code_without_a_reader(&["inspect", "no.csv"]), Some(2));
    assert_eq!(code_without_a_reader(&["vehicle", "list"]), Some(0));
    assert_eq!(code_without_a_reader(&["--help"]), Some(0));
}

#[cfg(unix)]
#[test]
fn a_report_is_written_though_nobody_reads_the_text() {
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("energy.html");
    let args = [
        "energy",
        &fixture("drives"),
        "--vehicle",
        "b250e",
        "--report",
        page.to_str().unwrap(),
    ];
    assert_eq!(code_without_a_reader(&args), Some(0));
    assert!(page.is_file());
}

//! `drivekit ctrl` and the binary `ctrl`.

use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::program::{drivekit, drivekit_in, run};

fn document(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_run_of_the_thesis_is_safe_and_says_so() {
    let out = drivekit(&["ctrl", "run", "--duration", "20", "--format", "json"]).ok();
    let document = document(&out.stdout);
    assert_eq!(document["schema"], "drivekit/ctrl-run/1");
    assert_eq!(
        (&document["scenario"], &document["testbed"]),
        (&json!("on-off"), &json!("khepera"))
    );
    assert_eq!(
        (&document["rate_hz"], &document["steps"]),
        (&json!(50.0), &json!(1000))
    );
    assert_eq!(document["safe"], true);
    assert_eq!(
        document["outcomes"],
        json!({ "optimal": 2000, "relaxed": 0, "braking": 0, "waiting": 0, "deadlock": 0 })
    );
    for key in [
        "min_h_headway_m",
        "min_h_lane",
        "lane_clearance_m",
        "max_abs_lateral_m",
        "mean_speed_mps",
        "max_slack",
    ] {
        assert!(document[key].as_f64().unwrap() >= 0.0, "{key}");
    }
    for key in ["median_us", "p99_us", "max_us", "missed"] {
        assert!(document["loop"][key].is_number(), "{key}");
    }
}

#[test]
fn an_unsafe_run_is_an_honest_negative() {
    let out = drivekit(&[
        "ctrl",
        "run",
        "--scenario",
        "decay",
        "--disturb",
        "all",
        "--seed",
        "1",
    ]);
    assert_eq!(out.code, 1, "{}", out.stderr);
    assert!(out.stdout.contains("UNSAFE from "), "{}", out.stdout);
    let hardened = [
        "ctrl",
        "run",
        "--scenario",
        "decay",
        "--disturb",
        "all",
        "--preset",
        "hardened",
    ];
    assert!(
        drivekit(&hardened)
            .ok()
            .stdout
            .contains("safe: no robot left its lane")
    );
}

#[test]
fn the_binary_ctrl_is_the_subcommand() {
    let of = |args: &[&str]| {
        run(Command::new(env!("CARGO_BIN_EXE_ctrl"))
            .args(args)
            .stdin(Stdio::null())
            .output())
    };
    let shown = ["run", "--show-config", "--testbed", "robotarium"];
    let long = drivekit(&["ctrl", "run", "--show-config", "--testbed", "robotarium"]).ok();
    assert_eq!(of(&shown).ok().stdout, long.stdout);
    assert!(of(&["--help"]).ok().stdout.contains("campaign"));
    assert_eq!(of(&["run", "--no-such-flag"]).code, 2);
}

#[test]
fn a_shown_scenario_runs_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let flags = [
        "--testbed",
        "robotarium",
        "--scenario",
        "track",
        "--preset",
        "hardened",
    ];
    let more = ["--disturb", "all", "--seed", "9", "--duration", "10"];
    let with = |first: &[&'static str]| [first, &flags, &more].concat();
    let shown = drivekit(&with(&["ctrl", "run", "--show-config"]))
        .ok()
        .stdout;
    std::fs::write(folder.path().join("mine.toml"), shown).unwrap();
    let named = drivekit(&with(&["ctrl", "run", "--format", "json"]))
        .ok()
        .stdout;
    let file = ["ctrl", "run", "--scenario", "mine.toml", "--format", "json"];
    let file = drivekit_in(folder.path(), &file).ok().stdout;
    let (named, file) = (document(&named), document(&file));
    for key in [
        "spec",
        "min_h_headway_m",
        "min_h_lane",
        "outcomes",
        "mean_speed_mps",
    ] {
        assert_eq!(named[key], file[key], "{key}");
    }
    let both = [
        "ctrl",
        "run",
        "--scenario",
        "mine.toml",
        "--testbed",
        "khepera",
    ];
    let out = drivekit_in(folder.path(), &both);
    assert_eq!(out.code, 2);
    assert!(out.stderr.contains("leave --testbed out"), "{}", out.stderr);
}

#[test]
fn a_configuration_file_reaches_subcommands_of_subcommands() {
    let folder = tempfile::tempdir().unwrap();
    let shown = |config: &str| {
        std::fs::write(folder.path().join("c.toml"), config).unwrap();
        let args = ["ctrl", "run", "--show-config", "--config", "c.toml"];
        drivekit_in(folder.path(), &args)
    };
    for config in [
        "[ctrl.run]\npreset = \"hardened\"\n",
        "preset = \"hardened\"\n",
    ] {
        assert!(shown(config).ok().stdout.contains("kind = \"exponential\""));
    }
    assert!(
        shown("[ctrl.campaign]\npreset = \"hardened\"\n")
            .ok()
            .stdout
            .contains("kind = \"quadratic\"")
    );
    let out = shown("[ctrl.run]\nspeed = 1\n");
    assert_eq!(out.code, 2);
    assert!(
        out.stderr
            .contains("`drivekit ctrl run` has no flag --speed"),
        "{}",
        out.stderr
    );
}

#[test]
fn a_path_from_a_file_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let mut oval = "x_m,y_m\n".to_owned();
    for i in 0..48 {
        let angle = f64::from(i) * std::f64::consts::TAU / 48.0;
        oval += &format!("{},{}\n", 0.9 * angle.cos(), 0.55 * angle.sin());
    }
    std::fs::write(folder.path().join("oval.csv"), oval).unwrap();
    for preset in ["thesis", "hardened"] {
        let args = [
            "ctrl",
            "run",
            "--testbed",
            "robotarium",
            "--scenario",
            "track",
            "--path",
            "oval.csv",
            "--preset",
            preset,
        ];
        let out = drivekit_in(folder.path(), &args).ok();
        assert!(out.stdout.contains("safe: "), "{}", out.stdout);
    }
    std::fs::write(folder.path().join("bad.csv"), "0,0\n1,0\n1,one\n").unwrap();
    let out = drivekit_in(folder.path(), &["ctrl", "run", "--path", "bad.csv"]);
    assert_eq!(out.code, 2);
    assert!(out.stderr.contains("bad.csv, line 3"), "{}", out.stderr);
}

/// A CSV run log as they were once written: without checks, what is said of the run in two lines of its own.
fn as_before(log: &str) -> String {
    let cut = |line: &str, from: &str| line.split_once(from).unwrap().0.to_owned() + "\n";
    let mut lines = log.lines();
    let names = cut(lines.next().unwrap(), ",about").replace(",lane_row,", ",h_lane,");
    let first = lines.next().unwrap();
    let about = first.split_once(",\"{").unwrap().1.replace("\"\"", "\"");
    let about: Value = serde_json::from_str(&format!("{{{}", about.trim_end_matches('"'))).unwrap();
    let types: Vec<String> = about["types"]
        .as_str()
        .unwrap()
        .chars()
        .map(String::from)
        .collect();
    let head = format!(
        "# drivekit run log 1 {}\n# types {}\n",
        about["run"],
        types.join(",")
    );
    let rows: String = lines.map(|line| cut(line, ",crc ")).collect();
    head + &names + &cut(first, ",\"{") + &rows
}

#[test]
fn run_logs_are_replayed_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.csv", "run.parquet", "run.mcap"] {
        let args = [
            "ctrl",
            "run",
            "--disturb",
            "all",
            "--preset",
            "hardened",
            "--duration",
            "8",
            "-o",
            name,
            "--quiet",
        ];
        drivekit_in(folder.path(), &args).ok();
        let out = drivekit_in(folder.path(), &["ctrl", "replay", name, "--format", "json"]).ok();
        let document = document(&out.stdout);
        assert_eq!(
            (&document["decisions"], &document["different"]),
            (&json!(800), &json!(0))
        );
    }
    let log = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let log = as_before(&log);
    std::fs::write(folder.path().join("before.csv"), &log).unwrap();
    let out = drivekit_in(folder.path(), &["ctrl", "replay", "before.csv"]).ok();
    assert!(out.stdout.contains("800 decisions, every one the same"));
    let changed = log.replacen("optimal", "relaxed", 1);
    std::fs::write(folder.path().join("run.csv"), changed).unwrap();
    let out = drivekit_in(folder.path(), &["ctrl", "replay", "run.csv"]);
    assert_eq!(out.code, 1);
    assert!(
        out.stdout.contains("outcome was relaxed, is optimal"),
        "{}",
        out.stdout
    );
    let out = drivekit_in(folder.path(), &["ctrl", "run", "-o", "run.txt"]);
    assert_eq!(out.code, 2);
    assert!(
        out.stderr
            .contains("end its name in .parquet or .csv or .mcap"),
        "{}",
        out.stderr
    );
}

#[test]
fn a_campaign_names_the_command_that_repeats_a_violation() {
    let args = [
        "ctrl",
        "campaign",
        "--testbed",
        "khepera",
        "--scenario",
        "decay",
        "--preset",
        "thesis",
        "--runs",
        "12",
        "--format",
        "json",
    ];
    let out = drivekit(&args);
    assert_eq!(out.code, 1, "{}", out.stderr);
    let report = document(&out.stdout);
    assert_eq!(report["totals"][0]["runs"], 12);
    let violation = &report["violations"][0];
    let command = violation["command"].as_str().unwrap();
    let args: Vec<&str> = command
        .split(' ')
        .skip(1)
        .chain(["--format", "json"])
        .collect();
    let again = drivekit(&args);
    assert_eq!(again.code, 1);
    let again = document(&again.stdout);
    for key in ["min_h_headway_m", "lane_clearance_m", "first_unsafe_s"] {
        assert_eq!(again[key], violation[key], "{key}");
    }
    let out = drivekit(&[
        "ctrl",
        "campaign",
        "--testbed",
        "khepera",
        "--scenario",
        "track",
    ]);
    assert_eq!(out.code, 2);
    assert!(out.stderr.contains("no scenario `track`"), "{}", out.stderr);
    assert_eq!(drivekit(&["ctrl", "campaign", "--runs", "0"]).code, 2);
}

#[test]
fn a_state_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let state = json!({
        "follower": { "x_m": 0.9, "y_m": 0.0, "speed_mps": 0.2, "heading_rad": 1.2, "turn_rate_rad_s": 0.1 },
        "leader": { "x_m": 0.5, "y_m": 0.6, "speed_mps": 0.1, "heading_rad": 2.0, "turn_rate_rad_s": 0.0 },
        "desired_speed_mps": 0.25,
        "lateral": "frenet",
        "lane_barrier": "exponential",
    });
    let write =
        |value: &Value| std::fs::write(folder.path().join("s.json"), value.to_string()).unwrap();
    write(&json!([state, { "follower": state["follower"] }]));
    let args = ["ctrl", "explain", "--state", "s.json"];
    let json_args = [&args[..], &["--format", "json"]].concat();
    let out = drivekit_in(folder.path(), &json_args).ok();
    let states = document(&out.stdout)["states"].clone();
    let first = &states[0];
    let rows: Vec<&str> = first["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r.as_str().unwrap())
        .collect();
    assert_eq!(rows[..4], ["V1", "V2", "V3", "headway"]);
    assert_eq!(rows.len(), 6);
    let size = |key: &str| first[key].as_array().unwrap().len();
    assert_eq!(
        [
            "a",
            "b",
            "multipliers",
            "v",
            "lf_v",
            "lg_v",
            "optimum",
            "lane"
        ]
        .map(size),
        [6, 6, 6, 3, 3, 3, 5, 2]
    );
    assert!((first["v"][0].as_f64().unwrap() - 0.0025).abs() < 1e-12);
    assert_eq!(first["outcome"], "optimal");
    assert!(states[1]["headway"].is_null());
    assert!(
        drivekit_in(folder.path(), &args)
            .ok()
            .stdout
            .contains("every row holds")
    );

    write(&json!({ "follower": { "x_m": 0.9, "y_m": 0.0 } }));
    let out = drivekit_in(folder.path(), &args);
    assert_eq!(out.code, 2);
    assert!(
        out.stderr.contains("missing field `speed_mps`"),
        "{}",
        out.stderr
    );
    write(&json!({ "follower": state["follower"], "speed": 1 }));
    assert!(
        drivekit_in(folder.path(), &args)
            .stderr
            .contains("unknown field `speed`")
    );
}

#[test]
fn malformed_scenarios_say_where_and_what() {
    let folder = tempfile::tempdir().unwrap();
    let shown = drivekit(&["ctrl", "run", "--show-config"]).ok().stdout;
    let refused = |text: &str| {
        std::fs::write(folder.path().join("m.toml"), text).unwrap();
        let out = drivekit_in(folder.path(), &["ctrl", "run", "--scenario", "m.toml"]);
        assert_eq!(out.code, 2, "{text}");
        out.stderr
    };
    for (from, to, words) in [
        (
            "mass_kg = 0.69",
            "mass_kg = -1",
            "`mass_kg` is -1; it must be positive",
        ),
        ("mass_kg = 0.69", "mass = 0.69", "unknown field `mass`"),
        ("mass_kg = 0.69", "mass_kg = nan", "`mass_kg` is NaN"),
        ("kind = \"polar\"", "kind = \"spiral\"", "spiral"),
        ("rate_hz = 50.0", "", "rate_hz"),
        ("seed = 1", "seed = [", "m.toml"),
    ] {
        assert!(shown.contains(from), "{shown}");
        let error = refused(&shown.replacen(from, to, 1));
        assert!(error.contains(words), "{error}");
    }
    let out = drivekit(&["ctrl", "run", "--scenario", "figure-eight"]);
    assert!(
        out.stderr.contains("no scenario `figure-eight`"),
        "{}",
        out.stderr
    );
}

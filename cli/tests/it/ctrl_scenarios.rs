//! Scenarios of one's own: presets, what is shown of them, campaigns over files and folders.

use std::path::Path;

use serde_json::Value;

use crate::program::{drivekit, drivekit_in};

/// Writes what `run --show-config` with these flags shows.
fn write(folder: &Path, file: &str, flags: &[&str]) -> String {
    let shown = drivekit_in(folder, &[&["ctrl", "run", "--show-config"], flags].concat()).ok();
    std::fs::write(folder.join(file), &shown.stdout).unwrap();
    shown.stdout
}

fn run(folder: &Path, flags: &[&str]) -> Value {
    let args = [&["ctrl", "run", "--format", "json"], flags].concat();
    drivekit_in(folder, &args).json()
}

fn assert_same(a: &Value, b: &Value) {
    assert!(a["spec"].is_object());
    for key in [
        "spec",
        "safe",
        "min_h_headway_m",
        "lane_clearance_m",
        "outcomes",
        "mean_speed_mps",
    ] {
        assert_eq!(a[key], b[key], "{key}");
    }
}

#[test]
fn a_preset_makes_of_a_file_what_it_makes_of_a_built_in_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (testbed, scenario) in [("khepera", "on-off"), ("robotarium", "track")] {
        let named = ["--testbed", testbed, "--scenario", scenario];
        let with = |preset: &'static str| [&named[..], &["--preset", preset]].concat();
        let thesis = write(folder, "thesis.toml", &with("thesis"));
        let hardened = write(folder, "hardened.toml", &with("hardened"));
        assert_ne!(thesis, hardened);
        for (file, preset, expected) in [
            ("thesis.toml", "thesis", &thesis),
            ("thesis.toml", "hardened", &hardened),
            ("hardened.toml", "hardened", &hardened),
            ("hardened.toml", "thesis", &thesis),
        ] {
            let args = [
                "ctrl",
                "run",
                "--show-config",
                "--scenario",
                file,
                "--preset",
                preset,
            ];
            let shown = drivekit_in(folder, &args).ok().stdout;
            assert_eq!(&shown, expected, "{file} with {preset}");
        }
        let as_it_is = ["ctrl", "run", "--show-config", "--scenario", "thesis.toml"];
        assert_eq!(drivekit_in(folder, &as_it_is).ok().stdout, thesis);
    }
}

#[test]
fn a_file_without_guards_says_so_and_is_hardened_by_the_preset() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let thesis = write(folder, "thesis.toml", &[]);
    let hardened = write(folder, "hardened.toml", &["--preset", "hardened"]);
    let mut document: toml::Table = thesis.parse().unwrap();
    let controller = document["scenario"]["controller"].as_table_mut().unwrap();
    controller.remove("hardening").unwrap();
    let without = toml::to_string(&document).unwrap();
    std::fs::write(folder.join("without.toml"), without).unwrap();
    let file = ["--scenario", "without.toml"];
    let shown = write(folder, "shown.toml", &file);
    assert_eq!(shown, thesis.replace("every_robot = false\n", ""));
    let preset = [&file[..], &["--preset", "hardened"]].concat();
    assert_eq!(write(folder, "shown.toml", &preset), hardened);
    let note = "guards are not given; none is taken";
    for (arguments, is_noted) in [(&file[..], true), (&preset, false)] {
        let run = [&["ctrl", "run", "--duration", "1"], arguments].concat();
        assert_eq!(drivekit_in(folder, &run).stderr.contains(note), is_noted);
    }
}

#[test]
fn what_a_file_states_of_its_world_survives_hardening() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = write(folder, "mine.toml", &["--preset", "hardened"]);
    let rough = text
        .replace("position_noise_m = 0.003", "position_noise_m = 0.008")
        .replace("max_pose_age_s = 0.3", "max_pose_age_s = 0.5");
    assert_ne!(text, rough);
    std::fs::write(folder.join("mine.toml"), &rough).unwrap();
    let args = ["ctrl", "run", "--show-config", "--scenario", "mine.toml"];
    let args = [&args[..], &["--preset", "hardened"]].concat();
    assert_eq!(drivekit_in(folder, &args).ok().stdout, rough);
}

#[test]
fn what_is_shown_is_what_is_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut oval = "x_m,y_m\n".to_owned();
    for i in 0..48 {
        let angle = f64::from(i) * std::f64::consts::TAU / 48.0;
        oval += &format!("{},{}\n", 0.9 * angle.cos(), 0.55 * angle.sin());
    }
    std::fs::write(folder.join("oval.csv"), oval).unwrap();
    write(
        folder,
        "mine.toml",
        &["--testbed", "robotarium", "--scenario", "brake"],
    );
    let flags = [
        ["--scenario", "mine.toml"],
        ["--preset", "hardened"],
        ["--path", "oval.csv"],
        ["--disturb", "all"],
        ["--seed", "5"],
        ["--duration", "7"],
    ]
    .concat();
    write(folder, "shown.toml", &flags);
    let again = run(folder, &["--scenario", "shown.toml"]);
    assert_same(&run(folder, &flags), &again);
    assert_eq!(again["spec"]["seed"], 5);
    assert_eq!(again["spec"]["scenario"]["duration_s"], 7.0);
}

#[test]
fn a_session_shows_hardened_controllers_and_no_link() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let link = drivekit(&["ctrl", "run", "--show-link", "program"])
        .ok()
        .stdout;
    std::fs::write(folder.join("lab.toml"), link).unwrap();
    let shown = write(folder, "shown.toml", &["--live", "lab.toml"]);
    assert!(
        shown.contains("kind = \"exponential\"") && !shown.contains("[link"),
        "{shown}"
    );
    assert_eq!(run(folder, &["--scenario", "shown.toml"])["safe"], true);
    // A file is taken as it is, and what it lacks is said, in a line each.
    write(folder, "thesis.toml", &[]);
    let args = [
        "ctrl",
        "run",
        "--show-config",
        "--live",
        "lab.toml",
        "--scenario",
        "thesis.toml",
    ];
    let out = drivekit_in(folder, &args).ok();
    assert!(out.stdout.contains("max_pose_age_s = 0.3") && out.stdout.contains("predict = false"));
    for guard in [
        "no watchdog",
        "no prediction",
        "noise",
        "wheels' limits",
        "starts at the desired speed",
    ] {
        let lines = out.stderr.lines().filter(|line| line.contains(guard));
        assert_eq!(lines.count(), 1, "{guard} in {}", out.stderr);
    }
    assert!(out.stderr.contains("`--preset hardened`"), "{}", out.stderr);
    let out = drivekit_in(folder, &[&args[..], &["--preset", "hardened"]].concat()).ok();
    assert_eq!(out.stdout, shown);
    assert!(out.stderr.is_empty(), "{}", out.stderr);
}

/// Files at several depths, one of them a link.
fn others(folder: &Path) {
    std::fs::create_dir_all(folder.join("others/deep er")).unwrap();
    write(
        folder,
        "mine.toml",
        &["--scenario", "decay", "--duration", "20"],
    );
    write(
        folder,
        "others/b.toml",
        &["--scenario", "stop", "--duration", "20"],
    );
    write(
        folder,
        "others/deep er/a.toml",
        &["--scenario", "decay", "--duration", "20"],
    );
    let link = drivekit(&["ctrl", "run", "--show-link", "program"])
        .ok()
        .stdout;
    std::fs::write(folder.join("others/link.toml"), link).unwrap();
    std::fs::write(folder.join("others/notes.txt"), "nothing").unwrap();
}

#[test]
fn campaigns_take_files_and_folders_and_name_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    others(folder);
    let args = ["ctrl", "campaign", "--runs", "16", "--format", "json"];
    let scenarios = ["--scenario", "mine.toml", "others", "./mine.toml", "track"];
    let out = drivekit_in(folder, &[&args[..], &scenarios].concat());
    assert_eq!(out.code, 1, "{}", out.stderr);
    assert!(
        out.stderr.contains("left out") && out.stderr.contains("link.toml"),
        "{}",
        out.stderr
    );
    assert!(
        out.stderr.contains("mine.toml: without ") && out.stderr.contains("guards of the hardened"),
        "{}",
        out.stderr
    );
    let document = out.json();
    assert_eq!(document["runs"], 32);
    assert_eq!(document["duration_s"], Value::Null);
    let rows = document["rows"].as_array().unwrap();
    let names: Vec<[&str; 2]> = rows
        .iter()
        .map(|row| ["preset", "scenario"].map(|key| row[key].as_str().unwrap()))
        .collect();
    assert_eq!(
        names,
        [
            ["hardened", "track"],
            ["file", "mine.toml"],
            ["file", "others/b.toml"],
            ["file", "others/deep er/a.toml"],
        ]
    );
    let violation = document["violations"].as_array().unwrap().iter();
    let violation = violation
        .clone()
        .find(|v| v["scenario"] == "others/deep er/a.toml");
    let violation = violation.unwrap();
    let command = violation["command"].as_str().unwrap();
    let seed = &violation["seed"];
    assert_eq!(
        command,
        format!("drivekit ctrl run --scenario 'others/deep er/a.toml' --disturb all --seed {seed}")
    );
    let seed = seed.to_string();
    let again = [
        "--scenario",
        "others/deep er/a.toml",
        "--disturb",
        "all",
        "--seed",
        &seed,
    ];
    let again = run(folder, &again);
    for key in ["min_h_headway_m", "lane_clearance_m", "first_unsafe_s"] {
        assert_eq!(again[key], violation[key], "{key}");
    }
}

#[test]
fn a_preset_of_a_campaign_applies_to_files_too() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    others(folder);
    let args = [
        "ctrl",
        "campaign",
        "--runs",
        "8",
        "--format",
        "json",
        "--scenario",
        "mine.toml",
    ];
    let presets = ["--preset", "thesis,hardened"];
    let out = drivekit_in(folder, &[&args[..], &presets].concat());
    let document = out.json();
    let unsafe_runs = |index: usize| &document["totals"][index];
    assert_eq!(unsafe_runs(0)["preset"], "thesis");
    assert!(unsafe_runs(0)["unsafe"].as_u64().unwrap() > 0);
    assert_eq!(unsafe_runs(1)["preset"], "hardened");
    assert_eq!(unsafe_runs(1)["unsafe"], 0);
    let command = document["violations"][0]["command"].as_str().unwrap();
    assert!(
        command.contains("--scenario mine.toml --preset thesis"),
        "{command}"
    );
}

#[test]
fn scenarios_of_a_campaign_that_cannot_be_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    others(folder);
    std::fs::create_dir(folder.join("empty")).unwrap();
    let refused = |flags: &[&str], words: &[&str]| {
        let args = [&["ctrl", "campaign", "--runs", "1"], flags].concat();
        drivekit_in(folder, &args).refused(words);
    };
    refused(&["--scenario", "empty"], &["`empty`", ".toml"]);
    refused(&["--scenario", "none.toml"], &["none.toml"]);
    refused(&["--scenario", "none"], &["no scenario `none`"]);
    refused(
        &["--testbed", "khepera", "--scenario", "mine.toml"],
        &["--testbed"],
    );
    let text = std::fs::read_to_string(folder.join("mine.toml")).unwrap();
    let text = text.replace("mass_kg = 0.69", "mass_kg = -1.0");
    std::fs::write(folder.join("others/heavy.toml"), text).unwrap();
    refused(
        &["--scenario", "others"],
        &["others/heavy.toml", "`mass_kg` is -1"],
    );
    std::fs::write(folder.join("others/heavy.toml"), "scenario = [").unwrap();
    refused(&["--scenario", "others"], &["others/heavy.toml"]);
}

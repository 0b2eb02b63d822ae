//! Configuration files, help, completions and manual pages.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn a_configuration_gives_defaults_and_a_flag_wins() {
    let folder = TempDir::new().unwrap();
    let config = folder.path().join("drivekit.toml");
    fs::write(
        &config,
        "format = \"json\"\nmax-gap = 5\n[segment]\nmethod = \"heuristic\"\nweights = [2.0, 1.0]\n",
    )
    .unwrap();
    let config = config.to_str().unwrap();
    let drive = fixture("drives/drive-01.csv");
    let document = drivekit(&["segment", &drive, "--config", config])
        .ok()
        .json();
    assert_eq!(document["config"]["max_gap"], 5.0);
    assert_eq!(document["config"]["method"], "heuristic");
    assert_eq!(document["config"]["weights"], serde_json::json!([2.0, 1.0]));
    let equals = format!("--config={config}");
    let document = drivekit(&[
        &equals,
        "segment",
        &drive,
        "--method",
        "swab",
        "--max-gap",
        "3",
    ])
    .ok()
    .json();
    assert_eq!(document["config"]["max_gap"], 3.0);
    assert_eq!(document["config"]["method"], "swab");
}

#[test]
fn a_configuration_gives_flags_that_must_be_given() {
    let folder = TempDir::new().unwrap();
    let config = folder.path().join("drivekit.toml");
    let drive = fixture("drives/drive-01.csv");
    for (text, vehicles) in [
        ("vehicle = \"b250e\"\n", 1),
        ("[energy]\nvehicle = [\"b250e\", \"vw-id3\"]\n", 2),
    ] {
        fs::write(&config, text).unwrap();
        let config = config.to_str().unwrap();
        let document = drivekit(&["energy", &drive, "--config", config, "--format", "json"])
            .ok()
            .json();
        assert_eq!(document["totals"].as_array().unwrap().len(), vehicles);
    }
}

#[test]
fn a_bad_configuration_names_file_and_key() {
    let folder = TempDir::new().unwrap();
    let config = folder.path().join("drivekit.toml");
    let path = config.to_str().unwrap();
    let drive = fixture("drives/drive-01.csv");
    for (text, words) in [
        ("stepp = 0.1", &["drivekit.toml", "stepp"][..]),
        ("[segment]\nband = 3", &["drivekit.toml", "segment.band"]),
        ("[paint]\ncolour = 3", &["drivekit.toml", "paint"]),
        ("step = ", &["drivekit.toml", "TOML"]),
        ("step = \"fast\"", &["fast"]),
    ] {
        fs::write(&config, text).unwrap();
        drivekit(&["inspect", &drive, "--config", path]).refused(words);
    }
    drivekit(&["inspect", &drive, "--config", "no-such.toml"]).refused(&["no-such.toml"]);
}

#[test]
fn every_subcommand_has_help_with_examples() {
    let help = drivekit(&["--help"]).ok().stdout;
    for name in [
        "inspect",
        "segment",
        "energy",
        "fit",
        "predict",
        "evaluate",
        "synth",
        "vehicle",
        "completions",
        "man",
    ] {
        assert!(help.contains(name), "{name}");
    }
    for args in [
        &["inspect"][..],
        &["segment"],
        &["energy"],
        &["fit"],
        &["predict"],
        &["evaluate"],
        &["synth"],
        &["vehicle", "show"],
        &["vehicle", "point"],
        &["completions"],
        &["man"],
    ] {
        let mut args = args.to_vec();
        args.push("--help");
        let help = drivekit(&args).ok().stdout;
        assert!(help.contains("Example"), "{args:?}: {help}");
    }
}

#[test]
fn completions_and_manual_pages() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(
            drivekit(&["completions", shell])
                .ok()
                .stdout
                .contains("evaluate")
        );
    }
    assert!(drivekit(&["man"]).ok().stdout.contains(".TH"));
    let folder = TempDir::new().unwrap();
    drivekit(&["man", "-o", folder.path().to_str().unwrap()]).ok();
    assert!(folder.path().join("drivekit.1").is_file());
    assert!(folder.path().join("drivekit-vehicle-point.1").is_file());
}

#[test]
fn long_help_says_more_than_a_line() {
    for (command, words) in [
        ("evaluate", "held out once"),
        ("calibrate", "fitted within bounds"),
        ("energy", "With several vehicles"),
    ] {
        let help = drivekit(&[command, "--help"]).ok().stdout;
        let text = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(words), "{help}");
        assert!(text.contains("Examples:"), "{help}");
    }
}

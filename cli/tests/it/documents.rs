//! What every JSON document has in common.

use crate::program::{drivekit, fixture};

#[test]
fn every_document_names_schema_version_configuration_and_inputs() {
    let drive = fixture("drives/drive-01.csv");
    for (subcommand, more) in [
        ("inspect", &[][..]),
        ("segment", &[]),
        ("energy", &["--vehicle", "b250e"]),
    ] {
        let mut args = vec![subcommand, &drive, "--format", "json"];
        args.extend(more);
        let document = drivekit(&args).ok().json();
        assert_eq!(document["schema"], format!("drivekit/{subcommand}/1"));
        assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
        assert_eq!(document["config"]["step"], 0.1);
        assert_eq!(document["config"]["smooth"], "hann:5");
        let input = &document["inputs"][0];
        assert_eq!(input["path"], drive);
        assert_eq!(input["sha256"].as_str().unwrap().len(), 64);
        assert!(input["samples"].as_u64().unwrap() > 100);
        assert_eq!(input["step_s"], 0.1);
        assert!(input["findings"].is_array());
        assert_eq!(document["logs"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn keys_come_in_the_documented_order() {
    let text = drivekit(&["evaluate", "--models", "profile", "--format", "json"])
        .ok()
        .stdout;
    let keys: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("  \""))
        .map(|line| line.trim_start().split('"').nth(1).unwrap())
        .collect();
    assert_eq!(
        keys,
        [
            "schema",
            "version",
            "config",
            "inputs",
            "files",
            "hold_out",
            "held_out",
            "models",
            "folds",
            "baselines",
            "paired",
            "bands",
            "left_out",
            "braking",
            "whole_phases",
            "function_fits",
            "learning_curve",
            "cruise",
            "following",
            "system_identification",
            "not_evaluated",
            "left_out_drives",
            "default_vehicle"
        ]
    );
}

#[test]
fn stdout_is_the_document_and_nothing_else() {
    let run = drivekit(&[
        "inspect",
        &fixture("drives/drive-01.csv"),
        "--format",
        "json",
        "-v",
    ])
    .ok();
    run.json();
    assert!(run.stderr.contains("layout"), "{}", run.stderr);
    let quiet = drivekit(&["inspect", &fixture("drives/drive-01.csv"), "--quiet"]).ok();
    assert!(quiet.stderr.is_empty(), "{}", quiet.stderr);
    assert!(!quiet.stdout.contains('\u{1b}'), "no colours in a pipe");
}

//! Which crate may depend on which; docs/architecture.md draws the same arrows.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

const ALLOWED: [(&str, &[&str]); 16] = [
    ("parquet-table", &[]),
    ("drive-log", &["parquet-table"]),
    ("tseg", &[]),
    ("ev-energy", &[]),
    ("svr", &[]),
    ("driver-model", &["drive-log", "ev-energy", "svr", "tseg"]),
    ("drive-sim", &["drive-log", "driver-model", "ev-energy"]),
    (
        "driver-eval",
        // the simulated drives are for its tests
        &[
            "drive-log",
            "drive-sim",
            "driver-model",
            "ev-energy",
            "svr",
            "tseg",
        ],
    ),
    ("speed-plan", &["ev-energy"]),
    (
        "assistance",
        // logs are for its examples
        &["drive-log", "driver-model", "ev-energy", "speed-plan"],
    ),
    ("report", &[]),
    ("unicycle-cbf", &[]),
    ("testbed-sim", &["unicycle-cbf"]),
    (
        "testbed-io",
        &["parquet-table", "testbed-sim", "unicycle-cbf"],
    ),
    ("live-view", &["report", "testbed-sim", "unicycle-cbf"]),
    (
        "drivekit",
        &[
            "assistance",
            "drive-log",
            "drive-sim",
            "driver-eval",
            "driver-model",
            "ev-energy",
            "live-view",
            "report",
            "speed-plan",
            "svr",
            "testbed-io",
            "testbed-sim",
            "tseg",
            "unicycle-cbf",
        ],
    ),
];

fn metadata() -> serde_json::Value {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--no-deps",
            "--offline",
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The README's command names no binary, and there are two.
#[test]
fn cargo_run_takes_drivekit() {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    let package = packages.iter().find(|p| p["name"] == "drivekit").unwrap();
    assert_eq!(package["default_run"], "drivekit");
}

#[test]
fn crates_depend_only_on_those_below_them() {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    let members: BTreeSet<&str> = packages
        .iter()
        .map(|p| p["name"].as_str().unwrap())
        .collect();
    let found: BTreeMap<&str, BTreeSet<&str>> = packages
        .iter()
        .map(|package| {
            let dependencies = package["dependencies"].as_array().unwrap();
            let inside = dependencies
                .iter()
                .map(|d| d["name"].as_str().unwrap())
                .filter(|name| members.contains(name))
                .collect();
            (package["name"].as_str().unwrap(), inside)
        })
        .collect();
    let allowed: BTreeMap<&str, BTreeSet<&str>> = ALLOWED
        .iter()
        .map(|(name, below)| (*name, below.iter().copied().collect()))
        .collect();
    assert_eq!(
        found.keys().collect::<Vec<_>>(),
        allowed.keys().collect::<Vec<_>>(),
        "a crate is missing here or in the workspace"
    );
    for (name, below) in &found {
        assert!(
            below.is_subset(&allowed[name]),
            "{name} depends on {below:?}, allowed are {:?}",
            allowed[name]
        );
    }
}

//! Simulated drives: same seed, same bytes.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn the_shipped_drives_are_what_synth_writes() {
    let folder = TempDir::new().unwrap();
    drivekit(&["synth", "--noise", "-o", folder.path().to_str().unwrap()]).ok();
    for name in [
        "drive-01.csv",
        "drive-12.csv",
        "truth.json",
        "true-model.json",
    ] {
        let made = fs::read(folder.path().join(name)).unwrap();
        let shipped = fs::read(fixture(&format!("drives/{name}"))).unwrap();
        assert!(
            made == shipped,
            "{name} differs; `just fixtures` makes them anew"
        );
    }
}

#[test]
fn the_shipped_drives_are_small() {
    let total: u64 = fs::read_dir(fixture("drives"))
        .unwrap()
        .map(|e| e.unwrap().metadata().unwrap().len())
        .sum();
    assert!(total < 5_000_000, "{total} bytes");
}

#[test]
fn the_seed_decides() {
    let make = |seed: &str| {
        let folder = TempDir::new().unwrap();
        drivekit(&[
            "synth",
            "-o",
            folder.path().to_str().unwrap(),
            "--drives",
            "1",
            "--duration",
            "120",
            "--seed",
            seed,
        ])
        .ok();
        fs::read(folder.path().join("drive-01.csv")).unwrap()
    };
    assert_eq!(make("7"), make("7"));
    assert_ne!(make("7"), make("8"));
}

/// Function models lose nothing when the heuristic cuts the ends of a phase off: they know start speed and duration alone.
#[test]
fn the_true_model_predicts_every_phase_that_is_found() {
    for kind in [
        "inverse",
        "exponential",
        "exponential-amplitude",
        "constant",
    ] {
        let folder = TempDir::new().unwrap();
        let path = folder.path().to_str().unwrap();
        drivekit(&[
            "synth",
            "-o",
            path,
            "--driver",
            kind,
            "--variation",
            "0",
            "--no-leaders",
        ])
        .ok();
        let model = format!("{path}/true-model.json");
        let logs = format!("{path}/*.csv");
        let document = drivekit(&["predict", &logs, "--model", &model, "--format", "json"])
            .ok()
            .json();
        let phases: Vec<&serde_json::Value> = document["logs"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|log| log["phases"].as_array().unwrap())
            .collect();
        assert!(phases.len() > 100, "{kind}: {}", phases.len());
        assert!(
            phases.iter().all(|phase| phase["in_band_pct"] == 100.0),
            "{kind}"
        );
    }
}

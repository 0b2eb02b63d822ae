//! Fit, write, read, predict.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn every_model_is_fitted_written_read_and_predicts() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    let test = fixture("drives/drive-12.csv");
    for kind in [
        "inverse",
        "exponential",
        "exponential-amplitude",
        "rise-time",
        "profile",
        "constant",
        "straight",
        "smoothstep",
    ] {
        let file = folder.path().join(format!("{kind}.json"));
        let file = file.to_str().unwrap();
        drivekit(&["fit", &drives, "--model", kind, "-o", file]).ok();
        let document = drivekit(&["predict", &test, "--model", file, "--format", "json"])
            .ok()
            .json();
        let phases = document["logs"][0]["phases"].as_array().unwrap();
        assert!(!phases.is_empty(), "{kind}");
        for phase in phases {
            assert_eq!(
                phase["speed_mps"].as_array().unwrap().len() as u64,
                phase["samples"].as_u64().unwrap()
            );
            assert!(phase["in_band_pct"].as_f64().unwrap() >= 0.0);
        }
    }
}

#[test]
fn a_model_file_says_where_it_comes_from() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    let drive = fixture("drives/drive-01.csv");
    drivekit(&[
        "fit",
        &drive,
        "--model",
        "profile",
        "-o",
        file.to_str().unwrap(),
    ])
    .ok();
    let model: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    assert_eq!(model["schema"], "drivekit/model/1");
    assert_eq!(model["inputs"][0]["path"], drive);
    assert_eq!(model["config"]["min_gain"], 10.0);
}

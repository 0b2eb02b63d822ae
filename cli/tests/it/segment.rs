//! Boundaries, phases and the picture of them.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn boundaries_partition_the_log_for_every_method() {
    let drive = fixture("drives/drive-03.csv");
    for more in [
        &["--method", "heuristic"][..],
        &["--method", "bottom-up", "--merge", "none"],
        &["--method", "swab", "--refill", "fixed"],
        &["--cost", "z-scale", "--threshold", "20"],
        &["--scale", "zscore", "--weights", "1,1"],
    ] {
        let mut args = vec!["segment", &drive, "--format", "json"];
        args.extend(more);
        let document = drivekit(&args).ok().json();
        let entry = &document["logs"][0];
        let boundaries: Vec<u64> = serde_json::from_value(entry["boundaries"].clone()).unwrap();
        assert_eq!(boundaries[0], 0);
        assert!(boundaries.windows(2).all(|w| w[0] < w[1]));
        let segments = entry["segments"].as_array().unwrap();
        assert_eq!(segments.len() + 1, boundaries.len());
        assert_eq!(segments.last().unwrap()["end"], *boundaries.last().unwrap());
        assert_eq!(entry["metrics"]["segments"], segments.len());
        assert_eq!(entry["cost"].is_null(), more.contains(&"heuristic"));
    }
}

#[test]
fn the_picture_is_svg_with_coloured_phases() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("phases.svg");
    let drive = fixture("drives/drive-01.csv");
    drivekit(&["segment", &drive, "--plot", path.to_str().unwrap()]).ok();
    let picture = fs::read_to_string(path).unwrap();
    assert!(picture.starts_with("<svg"));
    for phase in ["acceleration", "braking", "cruise"] {
        assert!(picture.contains(phase), "{phase}");
    }
}

#[test]
fn a_uniform_log_is_taken_as_it_is_with_raw() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("ramp.csv");
    let text: String = (0..200)
        .map(|i| format!("{},{}\n", f64::from(i) / 10.0, f64::from(i) / 20.0))
        .collect();
    fs::write(&path, "time_s,speed_mps\n".to_owned() + &text).unwrap();
    let path = path.to_str().unwrap();
    let document = drivekit(&[
        "segment",
        path,
        "--raw",
        "--method",
        "heuristic",
        "--format",
        "json",
    ])
    .ok()
    .json();
    let segments = document["logs"][0]["segments"].as_array().unwrap();
    assert_eq!(segments.len(), 1);
    assert_eq!(segments[0]["phase"], "acceleration");
    assert!((segments[0]["mean_accel_mps2"].as_f64().unwrap() - 0.5).abs() < 1e-9);
}

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
        &[
            "--method",
            "bottom-up",
            "--stop",
            "segment-max",
            "--merge",
            "mean",
        ],
        &["--method", "sliding-window", "--merge", "association"],
        &["--method", "dynamic", "--segments", "30", "--first", "2000"],
        &[
            "--method",
            "dynamic",
            "--cost",
            "squared-error",
            "--segments",
            "auto",
            "--first",
            "1000",
        ],
        &["--cost", "z-scale", "--threshold", "20"],
        &["--scale", "18,1.6", "--merge", "mean-literal"],
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
    let run = ["segment", &drive, "--scale", "zscore", "--plot"];
    drivekit(&[&run[..], &[path.to_str().unwrap()]].concat()).ok();
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

#[test]
fn dynamic_programming_says_that_it_is_certified_and_shows_the_knee() {
    let drive = fixture("drives/drive-03.csv");
    let run = ["segment", &drive, "--first", "1000", "--method", "dynamic"];
    let text = drivekit(&run).ok().stdout;
    assert!(
        text.contains("certified optimal") && text.contains("knee"),
        "{text}"
    );
    let exact = [&run[..], &["--segments", "12", "--format", "json"]].concat();
    let document = drivekit(&exact).ok().json();
    assert_eq!(document["logs"][0]["metrics"]["segments"], 12);
    assert_eq!(document["logs"][0]["optimality_gap"], 0.0);
    drivekit(&[&run[..], &["--segments", "500"]].concat()).refused(&["drive-03", "2500 samples"]);
}

#[test]
fn flags_of_another_method_are_refused() {
    let drive = fixture("drives/drive-03.csv");
    drivekit(&["segment", &drive, "--window", "50", "--method", "bottom-up"])
        .refused(&["--window", "bottom-up"]);
    drivekit(&["segment", &drive, "--segments", "50"]).refused(&["--segments", "swab"]);
}

#[test]
fn methods_are_compared_in_a_table_and_on_a_page() {
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("compare.html");
    let (one, two) = (
        fixture("drives/drive-01.csv"),
        fixture("drives/drive-02.csv"),
    );
    let run = [
        "segment",
        &one,
        &two,
        "--compare",
        "--first",
        "1000",
        "--segments",
        "40",
        "--format",
        "json",
    ];
    let document = drivekit(&[&run[..], &["--report", page.to_str().unwrap()]].concat())
        .ok()
        .json();
    assert_eq!(document["schema"], "drivekit/segment-compare/1");
    assert_eq!(document["config"]["scale"], "range");
    for log in document["logs"].as_array().unwrap() {
        assert_eq!(log["samples"], 1000);
        for method in [
            "dynamic",
            "bottom-up",
            "swab",
            "sliding-window",
            "heuristic",
        ] {
            assert!(log["methods"][method]["mean_length"].as_f64().unwrap() >= 1.0);
            assert!(document["mean"][method]["seconds"].as_f64().unwrap() > 0.0);
        }
    }
    let page = fs::read_to_string(page).unwrap();
    for figure in ["3.3", "3.5", "3.6", "3.7", "3.8", "3.10"] {
        assert!(
            page.contains(&format!("\"figure\":\"{figure}\"")),
            "{figure}"
        );
    }
}

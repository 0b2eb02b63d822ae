//! Calibration of a vehicle file.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture};

/// Simulated drives, with the battery of a `b250e`.
fn drives() -> Vec<String> {
    (1..=4)
        .map(|k| fixture(&format!("drives/drive-{k:02}.csv")))
        .collect()
}

#[test]
fn a_wrong_vehicle_is_put_right() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (wrong, fitted, page) = (path("wrong.toml"), path("fitted.toml"), path("page.html"));
    let shown = drivekit(&["vehicle", "show", "b250e"]).ok().stdout;
    let heavy = shown.replace("mass_kg = 1928.0", "mass_kg = 1700.0");
    assert_ne!(heavy, shown);
    fs::write(&wrong, heavy).unwrap();

    let drives = drives();
    let mut arguments = vec!["calibrate"];
    arguments.extend(drives.iter().map(String::as_str));
    arguments.extend(["--vehicle", &wrong, "-o", &fitted, "--report", &page]);
    arguments.extend(["--format", "json"]);
    let document = drivekit(&arguments).ok().json();
    assert_eq!(document["schema"], "drivekit/calibrate/1");
    let mass = &document["parameters"][0];
    assert_eq!(mass["key"], "mass_kg");
    assert_eq!(mass["start"], 1700.0);
    let mass_kg = mass["value"].as_f64().unwrap();
    assert!((mass_kg - 1928.0).abs() < 5.0, "{mass}");
    let parameters = document["parameters"].as_array().unwrap().len();
    let matrix = document["correlation"]["matrix"].as_array().unwrap();
    assert_eq!(matrix.len(), parameters);
    assert_eq!(document["trips"].as_array().unwrap().len(), 4);
    let error = |name: &str| {
        document["summary"][name]["mean_abs_error_pct"]
            .as_f64()
            .unwrap()
    };
    assert!(
        error("held_out") < error("start"),
        "{}",
        document["summary"]
    );
    assert!(error("held_out") < 2.0, "{}", document["summary"]);
    assert!(
        fs::read_to_string(page)
            .unwrap()
            .contains("drivekit/calibrate/1")
    );

    // the file is a vehicle, knows how good it is, and is better
    let check = drivekit(&["vehicle", "check", &fitted, "--format", "json"])
        .ok()
        .json();
    assert_eq!(check["vehicles"][0]["name"], "fitted");
    let energy = drivekit(&["energy", &drives[0], "--vehicle", &fitted]).ok();
    assert!(
        energy.stdout.contains("calibrated with 4 trips"),
        "{}",
        energy.stdout
    );
}

#[test]
fn logs_without_battery_are_named_or_refused() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("car.toml");
    let out = out.to_str().unwrap();
    let blind = folder.path().join("blind.csv");
    fs::write(&blind, "time_s,speed_mps\n0,10\n0.1,10\n0.2,10\n0.3,10\n").unwrap();
    let blind = blind.to_str().unwrap();
    drivekit(&["calibrate", blind, "--vehicle", "b250e", "-o", out]).refused(&["measured power"]);
    assert!(fs::metadata(out).is_err(), "nothing is written");
    let drive = fixture("drives/drive-01.csv");
    let run = drivekit(&["calibrate", blind, &drive, "--vehicle", "b250e", "-o", out]).ok();
    assert!(
        run.stderr.contains(
            "left out, less than a minute of volts and amps, which are the measured power: blind"
        ),
        "{}",
        run.stderr
    );
    // of a single trip nothing can be held out
    assert!(run.stdout.contains("each held out"), "{}", run.stdout);
    drivekit(&[
        "calibrate",
        &drive,
        "--vehicle",
        "b250e",
        "-o",
        "no/such/car.toml",
    ])
    .refused(&["no/such"]);
}

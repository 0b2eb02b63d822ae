//! Energy budgets and operating points.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, fixture};

#[test]
fn the_budget_closes_and_a_simulated_drive_agrees_with_its_battery() {
    let drive = fixture("drives/drive-01.csv");
    let document = drivekit(&["energy", &drive, "--vehicle", "b250e", "--format", "json"])
        .ok()
        .json();
    let entry = &document["logs"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    let terms: f64 = [
        "inertia_j",
        "rolling_j",
        "aero_j",
        "grade_j",
        "gear_loss_j",
        "motor_loss_j",
        "auxiliary_j",
        "battery_loss_j",
        "friction_brake_j",
    ]
    .iter()
    .map(|key| number(&entry["budget"][key]))
    .sum();
    let undelivered = number(&entry["limited"]["undelivered_j"]);
    let battery = number(&entry["battery_energy_j"]);
    assert!((terms - undelivered - battery).abs() < 1e-6 * battery.abs());
    assert!(
        number(&entry["error_pct"]).abs() < 5.0,
        "{}",
        entry["error_pct"]
    );
    assert!(number(&entry["consumption_kwh_per_100km"]) > 8.0);
}

#[test]
fn the_trace_has_every_step() {
    let folder = TempDir::new().unwrap();
    let trace = folder.path().join("trace.csv");
    let drive = fixture("drives/drive-02.csv");
    drivekit(&[
        "energy",
        &drive,
        "--vehicle",
        "b250e",
        "--trace",
        trace.to_str().unwrap(),
    ])
    .ok();
    let text = fs::read_to_string(trace).unwrap();
    let columns = text.lines().next().unwrap().split(',').count();
    assert!(text.lines().count() > 1000);
    assert!(text.lines().all(|line| line.split(',').count() == columns));
}

#[test]
fn one_point_and_many() {
    let one = drivekit(&[
        "vehicle", "point", "b250e", "--speed", "20", "--accel", "0.5", "--grade", "0.02",
        "--format", "json",
    ])
    .ok()
    .json();
    let folder = TempDir::new().unwrap();
    let points = folder.path().join("points.csv");
    fs::write(&points, "speed_mps,accel_mps2,grade\n20,0.5,0.02\n0,0,0\n").unwrap();
    let points = points.to_str().unwrap();
    let many = drivekit(&[
        "vehicle", "point", "b250e", "--points", points, "--format", "json",
    ])
    .ok()
    .json();
    for key in [
        "wheel_force_n",
        "rolling_n",
        "aero_n",
        "grade_n",
        "motor_speed_rad_s",
        "motor_torque_nm",
        "friction_brake_n",
        "motor_electric_w",
        "electric_power_w",
        "battery_current_a",
        "battery_power_w",
    ] {
        assert_eq!(one[key], many["points"][0][key], "{key}");
    }
    assert_eq!(many["points"][1]["limited"]["torque"], false);
    fs::write(points, "speed_mps,accel_mps2,grade\n20,fast,0\n").unwrap();
    drivekit(&["vehicle", "point", "b250e", "--points", points]).refused(&["line 2"]);
}

#[test]
fn a_shown_vehicle_is_a_vehicle_file() {
    let folder = TempDir::new().unwrap();
    let list = drivekit(&["vehicle", "list"]).ok().stdout;
    for name in ["b250e", "b250e-coast-down", "bmw-i3-60ah"] {
        assert!(list.contains(name), "{list}");
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, drivekit(&["vehicle", "show", name]).ok().stdout).unwrap();
        let point = |vehicle: &str| {
            let run = drivekit(&[
                "vehicle", "point", vehicle, "--speed", "20", "--format", "json",
            ])
            .ok();
            run.json()["battery_power_w"].clone()
        };
        assert_eq!(point(name), point(file.to_str().unwrap()));
    }
}

#[test]
fn a_bad_vehicle_file_names_file_key_and_range() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("bad.toml");
    let good = drivekit(&["vehicle", "show", "b250e"]).ok().stdout;
    let line = good.lines().find(|l| l.starts_with("mass_kg")).unwrap();
    fs::write(&file, good.replace(line, "mass_kg = -1.0")).unwrap();
    drivekit(&["vehicle", "show", file.to_str().unwrap()]).refused(&["bad.toml", "mass_kg", "-1"]);
}

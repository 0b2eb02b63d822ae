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
fn the_trace_adds_up_to_the_energy() {
    let folder = TempDir::new().unwrap();
    let trace = folder.path().join("trace.csv");
    let drive = fixture("drives/drive-03.csv");
    let document = drivekit(&[
        "energy",
        &drive,
        "--vehicle",
        "bmw-i3-60ah",
        "--trace",
        trace.to_str().unwrap(),
        "--format",
        "json",
    ])
    .ok()
    .json();
    let text = fs::read_to_string(trace).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = header.iter().position(|h| *h == "battery_power_w").unwrap();
    let power_w = |line: &str| line.split(',').nth(column).unwrap().parse::<f64>().unwrap();
    let energy_j = lines.map(power_w).sum::<f64>() * 0.1;
    let expected_j = document["logs"][0]["battery_energy_j"].as_f64().unwrap();
    assert!((energy_j / expected_j - 1.0).abs() < 1e-9);
}

#[test]
fn several_vehicles_are_compared_on_the_same_drives() {
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("energy.html");
    let (first, second) = (
        fixture("drives/drive-01.csv"),
        fixture("drives/drive-02.csv"),
    );
    let arguments = [
        "energy",
        &first,
        &second,
        "--vehicle",
        "b250e",
        "--vehicle",
        "vw-id3",
        "--report",
        page.to_str().unwrap(),
    ];
    let text = drivekit(&arguments).ok().stdout;
    assert!(text.contains("drive-01 (vw-id3)"), "{text}");
    let document = drivekit(&[&arguments[..], &["--format", "json"]].concat())
        .ok()
        .json();
    let logs = document["logs"].as_array().unwrap();
    let names: Vec<&Value> = logs.iter().map(|log| &log["vehicle"]).collect();
    assert_eq!(names, ["b250e", "vw-id3", "b250e", "vw-id3"]);
    for (k, totals) in document["totals"].as_array().unwrap().iter().enumerate() {
        let number = |value: &Value| value["terminal_energy_j"].as_f64().unwrap();
        let sum = number(&logs[k]) + number(&logs[k + 2]);
        assert!((number(totals) / sum - 1.0).abs() < 1e-12);
        assert_eq!(totals["trips"], 2);
    }
    assert!(logs.iter().all(|log| log.get("curve").is_none()));
    let page = fs::read_to_string(&page).unwrap();
    assert!(page.contains("\"curve\""));
    drivekit(&[&arguments[..], &["--trace", "t.csv"]].concat()).refused(&["--trace", "2"]);
}

#[test]
fn cars_are_checked_against_what_was_published() {
    let document = drivekit(&["vehicle", "check", "--format", "json"])
        .ok()
        .json();
    let vehicles = document["vehicles"].as_array().unwrap();
    assert_eq!(vehicles.len(), 8);
    let b250e = vehicles
        .iter()
        .find(|v| v["name"] == "b250e-coast-down")
        .unwrap();
    let figures = b250e["consumption"].as_array().unwrap();
    let of = |cycle: &str| figures.iter().find(|f| f["cycle"] == cycle).unwrap();
    for (cycle, purpose, within_pct) in [
        ("UDDS", "fitted", 2.0),
        ("HWFET", "fitted", 2.0),
        ("NEDC", "hold_out", 8.0),
    ] {
        assert_eq!(of(cycle)["use"], purpose);
        assert!(of(cycle)["error_pct"].as_f64().unwrap().abs() < within_pct);
    }
    let text = drivekit(&["vehicle", "check"]).ok().stdout;
    assert!(
        text.contains("held out") && text.contains("bmw-i3-60ah"),
        "{text}"
    );
}

#[test]
fn a_loss_table_is_read_beside_its_vehicle_and_its_holes_are_named() {
    let folder = TempDir::new().unwrap();
    let shown = drivekit(&["vehicle", "show", "b250e"]).ok().stdout;
    let (before, rest) = shown.split_once("[motor.loss]").unwrap();
    let (_, after) = rest.split_once("\n\n").unwrap();
    let (after, _) = after.split_once("[sources").unwrap();
    let vehicle = folder.path().join("car.toml");
    let table = folder.path().join("loss.csv");
    fs::write(
        &vehicle,
        format!("{before}[motor.loss_table]\nfile = \"loss.csv\"\nspin_share_in_road_load = 0.0\n\n{after}"),
    )
    .unwrap();
    let vehicle = vehicle.to_str().unwrap();
    let whole = "speed_rad_s,torque_nm,loss_w\n0,-300,3000\n0,0,100\n0,300,3000\n1500,-300,5000\n1500,0,900\n1500,300,5000\n";
    let run = |text: &str| {
        fs::write(&table, text).unwrap();
        drivekit(&[
            "vehicle", "point", vehicle, "--speed", "20", "--format", "json",
        ])
    };
    let point = run(whole).ok().json();
    let loss_w = point["motor_loss_w"].as_f64().unwrap();
    assert!((400.0..900.0).contains(&loss_w), "{loss_w}");
    run(&whole.replace("1500,0,900\n", "")).refused(&["loss.csv", "speed 1500", "torque 0"]);
    run(&whole.replace("900", "nan")).refused(&["loss.csv", "line 6", "loss_w", "0 to"]);
    fs::remove_file(&table).unwrap();
    drivekit(&["vehicle", "show", vehicle]).refused(&["loss.csv"]);
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
    let file = file.to_str().unwrap();
    drivekit(&["vehicle", "show", file]).refused(&["bad.toml", "mass_kg", "-1", "1 to 1000000"]);
    drivekit(&["vehicle", "check", file]).refused(&["bad.toml", "mass_kg"]);
}

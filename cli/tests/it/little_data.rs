//! Drives that lack something: they are named and left out, and the others go on.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, fixture, shared};

/// A simulated drive, its rows changed.
fn drive(number: usize, change: impl Fn(&mut Vec<String>)) -> String {
    let text = fs::read_to_string(fixture(&format!("drives/drive-{number:02}.csv"))).unwrap();
    let mut rows: Vec<String> = text.lines().map(str::to_owned).collect();
    change(&mut rows);
    rows.join("\n") + "\n"
}

/// Blanks a column.
fn without(rows: &mut [String], column: &str) {
    let place = place_of(rows, column);
    for row in &mut rows[1..] {
        let mut cells: Vec<&str> = row.split(',').collect();
        cells[place] = "";
        *row = cells.join(",");
    }
}

fn place_of(rows: &[String], column: &str) -> usize {
    let mut names = rows[0].split(',');
    names.position(|name| name == column).unwrap()
}

/// A folder of logs by name.
fn folder(logs: &[(&str, String)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in logs {
        fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    folder
}

fn path(folder: &TempDir) -> &str {
    folder.path().to_str().unwrap()
}

fn left_out(document: &Value) -> Vec<&str> {
    let drives = document["left_out_drives"].as_array().unwrap();
    drives.iter().map(|d| d["log"].as_str().unwrap()).collect()
}

/// The columns `time_s` and others at 10 Hz.
fn log(header: &str, seconds: usize, row: impl Fn(f64) -> String) -> String {
    let mut text = format!("time_s,{header}\n");
    for k in 0..10 * seconds {
        let time_s = 0.1 * k as f64;
        writeln!(text, "{time_s:.1},{}", row(time_s)).unwrap();
    }
    text
}

const AHEAD: [&str; 8] = [
    "--task",
    "trajectory",
    "--models",
    "ridge",
    "--horizons",
    "5,10",
    "--max-samples",
    "800",
];

#[test]
fn going_back_and_noise_at_standstill_are_driving() {
    let place = |rows: &mut Vec<String>| place_of(rows, "speed_mps");
    let crept = drive(1, |rows| {
        let place = place(rows);
        for row in &mut rows[1..] {
            let mut cells: Vec<&str> = row.split(',').collect();
            if cells[place] == "0" {
                cells[place] = "-0.01";
            }
            *row = cells.join(",");
        }
    });
    let backed_up = drive(2, |rows| {
        let (place, last) = (place(rows), rows.len() - 40);
        for row in &mut rows[last..] {
            let mut cells: Vec<&str> = row.split(',').collect();
            cells[place] = "-1";
            *row = cells.join(",");
        }
    });
    let logs = folder(&[("crept", crept), ("backed-up", backed_up)]);
    let energy = |path: &str| {
        let document = drivekit(&["energy", path, "--vehicle", "b250e", "--format", "json"])
            .ok()
            .json();
        document["totals"][0]["terminal_energy_j"].as_f64().unwrap()
    };
    let crept = logs.path().join("crept.csv");
    let ratio = energy(crept.to_str().unwrap()) / energy(&fixture("drives/drive-01.csv"));
    assert!((ratio - 1.0).abs() < 5e-3, "{ratio}");
    energy(path(&logs));
    for command in ["evaluate", "portrait"] {
        drivekit(&[command, path(&logs), "--vehicle", "b250e"]).ok();
    }
}

#[test]
fn cruising_is_evaluated_where_nobody_accelerates() {
    let cruise = |phase: f64| {
        log("speed_kmh", 200, |t| {
            format!("{:.2}", 100.0 + (0.2 * t + phase).sin())
        })
    };
    let logs = folder(&[("a", cruise(0.0)), ("b", cruise(1.0)), ("c", cruise(2.0))]);
    let run = drivekit(&["evaluate", path(&logs), "--format", "json"]).ok();
    let document = run.json();
    assert!(document["cruise"]["models"]["cruise"]["rmse_mps"].is_number());
    assert_eq!(document["models"], serde_json::json!({}));
    let missing = document["not_evaluated"].as_object().unwrap();
    let parts: Vec<&str> = missing.keys().map(String::as_str).collect();
    assert_eq!(parts, ["acceleration", "braking", "following"]);
    assert!(
        run.stderr.contains("no figures of acceleration"),
        "{}",
        run.stderr
    );
    let text = drivekit(&["evaluate", path(&logs)]).ok().stdout;
    assert!(text.contains("cruising, 3 units"), "{text}");
}

#[test]
fn drives_with_nothing_to_evaluate_are_refused_by_name() {
    let standing = |seconds| log("speed_mps", seconds, |_| "0".to_owned());
    let logs = folder(&[("a", standing(30)), ("b", standing(40))]);
    drivekit(&["evaluate", path(&logs)]).refused(&[
        "nothing to evaluate",
        "\n  a: ",
        "\n  b: ",
        "cruise",
    ]);
}

#[test]
fn a_drive_without_limits_and_a_short_one_do_not_stop_the_others() {
    let logs = folder(&[
        ("d1", drive(1, |_| {})),
        ("d2", drive(2, |_| {})),
        ("d3", drive(3, |_| {})),
        ("blind", drive(4, |rows| without(rows, "speed_limit_mps"))),
        ("short", drive(5, |rows| rows.truncate(130))),
    ]);
    let mut arguments = vec!["evaluate", path(&logs), "--format", "json"];
    arguments.extend(AHEAD);
    let run = drivekit(&arguments).ok();
    let document = run.json();
    assert_eq!(document["units"], serde_json::json!(["d1", "d2", "d3"]));
    assert_eq!(left_out(&document), ["short", "blind"]);
    assert!(document["horizons"]["10"]["ridge"]["rmse_mps"].is_number());
    assert_eq!(document["trials"].as_array().unwrap().len(), 5);
    assert!(
        run.stderr
            .contains("no speed limits, which the others have: blind"),
        "{}",
        run.stderr
    );

    let model = logs.path().join("ridge.json");
    let model = model.to_str().unwrap();
    let fit = [
        "fit",
        path(&logs),
        "--model",
        "ridge",
        "--horizons",
        "5,10",
        "-o",
        model,
    ];
    let fitted = drivekit(&fit).ok();
    assert!(
        fitted.stderr.contains("blind") && fitted.stderr.contains("short"),
        "{}",
        fitted.stderr
    );
    let predicted = drivekit(&["predict", path(&logs), "--model", model, "--format", "json"])
        .ok()
        .json();
    assert_eq!(left_out(&predicted), ["blind"]);
    let blind = logs.path().join("blind.csv");
    drivekit(&["predict", blind.to_str().unwrap(), "--model", model])
        .refused(&["blind", "no speed limits"]);
}

#[test]
fn drives_that_are_all_too_short_are_refused_before_any_work() {
    let short = |number| drive(number, |rows| rows.truncate(100));
    let logs = folder(&[("a", short(1)), ("b", short(2))]);
    let mut arguments = vec!["evaluate", path(&logs)];
    arguments.extend(AHEAD);
    drivekit(&arguments).refused(&["\n  a: ", "\n  b: ", "10 s ahead"]);
}

#[test]
fn few_moments_cost_the_models_that_learn_and_nothing_else() {
    let cut = |number, rows: usize| drive(number, move |lines| lines.truncate(rows));
    let logs = folder(&[
        ("long", cut(1, 4000)),
        ("b", cut(2, 300)),
        ("c", cut(3, 300)),
    ]);
    let mut arguments = vec!["evaluate", path(&logs), "--format", "json"];
    arguments.extend(AHEAD);
    let document = drivekit(&arguments).ok().json();
    assert!(document["horizons"]["5"]["persistence"]["rmse_mps"].is_number());
    assert!(
        document["left_out"]["ridge"]
            .as_str()
            .unwrap()
            .contains("moments")
    );
}

#[test]
fn trip_drivers_learn_from_the_roads_that_are_known() {
    let logs = folder(&[
        ("d1", drive(1, |_| {})),
        ("blind", drive(2, |rows| without(rows, "speed_limit_mps"))),
    ]);
    let model = logs.path().join("trips.json");
    let model = model.to_str().unwrap();
    let fit = drivekit(&["fit", path(&logs), "--model", "trip-driver", "-o", model]).ok();
    assert!(fit.stderr.contains("blind"), "{}", fit.stderr);
    let predicted = drivekit(&["predict", path(&logs), "--model", model, "--format", "json"])
        .ok()
        .json();
    assert_eq!(left_out(&predicted), ["blind"]);
}

#[test]
fn a_short_piece_does_not_stop_dynamic_programming() {
    let cut = |rows: usize| drive(1, move |lines| lines.truncate(rows));
    let logs = folder(&[("long", cut(1000)), ("short", cut(60))]);
    let run = |folder: &str| {
        let method = [
            "--method",
            "dynamic",
            "--segments",
            "20",
            "--format",
            "json",
        ];
        drivekit(&[&["segment", folder][..], &method].concat())
    };
    let document = run(path(&logs)).ok().json();
    assert_eq!(left_out(&document), ["short"]);
    assert_eq!(document["logs"].as_array().unwrap().len(), 1);
    let short = logs.path().join("short.csv");
    run(short.to_str().unwrap()).refused(&["short", "100 samples"]);
}

#[test]
fn a_vehicle_that_nobody_named_is_said() {
    let drives = [
        fixture("drives/drive-01.csv"),
        fixture("drives/drive-02.csv"),
    ];
    for command in ["evaluate", "portrait"] {
        let run = drivekit(&[command, &drives[0], &drives[1], "--format", "json"]).ok();
        assert!(run.stderr.contains("b250e"), "{command}: {}", run.stderr);
        assert_eq!(run.json()["default_vehicle"], "b250e");
        let named = drivekit(&[
            command,
            &drives[0],
            &drives[1],
            "--format",
            "json",
            "--vehicle",
            "b250e",
        ])
        .ok();
        assert!(
            !named.stderr.contains("b250e"),
            "{command}: {}",
            named.stderr
        );
        assert_eq!(named.json()["default_vehicle"], Value::Null);
        assert_eq!(run.json()["config"]["vehicle"], "b250e");
    }
}

/// Where the values of a fitted vehicle are those from before, and the reasons.
fn calibrated(logs: &str, file: &Path) -> (Value, String) {
    let file_name = file.to_str().unwrap();
    let arguments = [
        "calibrate",
        logs,
        "--vehicle",
        "b250e",
        "-o",
        file_name,
        "--format",
        "json",
    ];
    let document = drivekit(&arguments).ok().json();
    (document, fs::read_to_string(file).unwrap())
}

fn assert_nothing_told(document: &Value) {
    for parameter in document["parameters"].as_array().unwrap() {
        assert_eq!(parameter["identified"], false, "{parameter}");
        assert_eq!(parameter["value"], parameter["start"], "{parameter}");
        assert!(
            parameter["remark"]
                .as_str()
                .unwrap()
                .starts_with("not identified"),
            "{parameter}"
        );
    }
}

#[test]
fn one_constant_speed_tells_no_parameter() {
    let header = "speed_mps,battery_voltage_v,battery_current_a";
    let at = |phase: f64| {
        log(header, 120, |t| {
            format!(
                "{:.3},320,{:.2}",
                13.9 + 0.01 * (t + phase).sin(),
                12.0 + (3.0 * t + phase).sin()
            )
        })
    };
    let logs = folder(&[("a", at(0.0)), ("b", at(1.0)), ("c", at(2.0))]);
    let (document, file) = calibrated(path(&logs), &logs.path().join("x.toml"));
    assert_nothing_told(&document);
    assert!(
        file.contains("# mass_kg is still 1928 (a fit made it"),
        "{file}"
    );
    assert!(file.contains("one speed, 50 km/h"), "{file}");
}

#[test]
fn the_cases_of_little_data_end_with_figures_or_reasons() {
    let Some(cases) = shared("cases/cars") else {
        return;
    };
    let case = |name: &str| cases.join(name).to_str().unwrap().to_owned();
    let out = TempDir::new().unwrap();
    let energy = |log: &str| {
        let run = drivekit(&[
            "energy",
            &case(log),
            "--vehicle",
            "b250e",
            "--format",
            "json",
        ])
        .ok();
        run.json()["totals"][0]["terminal_energy_j"]
            .as_f64()
            .unwrap()
            / 3.6e6
    };
    let kwh = energy("34-negative-at-standstill/minus_1cm.csv");
    assert!((kwh / 1.256 - 1.0).abs() < 5e-3, "{kwh}");
    energy("20-reverse/signed.csv");
    // its three logs are of one drive
    let another = case("46-one-drive-without-limit/drive-02.csv");
    drivekit(&["evaluate", &case("34-negative-at-standstill"), &another]).ok();

    let mut arguments = vec!["evaluate", "--format", "json"];
    arguments.extend(AHEAD);
    let without_limit = case("46-one-drive-without-limit");
    arguments.push(&without_limit);
    let document = drivekit(&arguments).ok().json();
    assert!(document["horizons"]["5"]["ridge"]["rmse_mps"].is_number());
    assert!(
        left_out(&document)
            .iter()
            .all(|log| log.starts_with("drive-06"))
            && !left_out(&document).is_empty()
    );

    for (name, part) in [
        ("43-no-phases", "cruise"),
        ("45-always-following", "following"),
    ] {
        let document = drivekit(&["evaluate", &case(name), "--format", "json"])
            .ok()
            .json();
        assert!(document[part]["models"].is_object(), "{name}");
    }
    for name in ["identical", "constant", "one"] {
        let logs = case(&format!("40-calibrate-degenerate/{name}"));
        let (document, _) = calibrated(&logs, &out.path().join("x.toml"));
        assert_nothing_told(&document);
    }
}

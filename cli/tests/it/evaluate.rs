//! The main job.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, shared};

const MODELS: [&str; 9] = [
    "exponential",
    "exponential-amplitude",
    "inverse",
    "profile",
    "profile-conditioned",
    "profile-onset",
    "rise-time",
    "rise-time-exact",
    "transition-point",
];
const BASELINES: [&str; 3] = ["constant", "smoothstep", "straight"];

fn keys(value: &Value) -> Vec<&str> {
    value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

#[test]
fn without_arguments_it_evaluates_the_built_in_drives_from_any_folder() {
    let folder = TempDir::new().unwrap();
    let document = drivekit_in(folder.path(), &["evaluate", "--format", "json"])
        .ok()
        .json();
    assert_eq!(document["inputs"].as_array().unwrap().len(), 12);
    assert_eq!(keys(&document["models"]), MODELS);
    assert_eq!(keys(&document["baselines"]), BASELINES);
    assert_eq!(document["folds"].as_array().unwrap().len(), 12 * 12);
    for table in ["models", "baselines"] {
        for (name, figures) in document[table].as_object().unwrap() {
            for key in [
                "phases",
                "rmse_mps",
                "sqrt_sse_per_sample_mps",
                "in_band_pct",
                "out_of_band_pct",
                "band_kmh",
                "final_speed_error_mps",
                "fit_seconds",
                "predict_seconds",
            ] {
                assert!(figures[key].is_number(), "{name}.{key}");
            }
            for key in ["mean", "median", "mean_abs"] {
                assert!(
                    figures["energy_error_j"][key].is_number(),
                    "{name}.energy_error_j.{key}"
                );
            }
        }
    }
    let text = drivekit_in(folder.path(), &["evaluate"]).ok().stdout;
    for name in MODELS.iter().chain(&BASELINES) {
        assert!(text.contains(name), "{text}");
    }
}

#[test]
fn the_figures_do_not_depend_on_the_number_of_threads() {
    let figures = |threads| {
        let arguments = [
            "evaluate",
            "--learning-curve",
            "--format",
            "json",
            "--threads",
            threads,
        ];
        without_times(drivekit(&arguments).ok().json())
    };
    assert_eq!(figures("1"), figures("3"));
}

/// Wall times are the only figures that may differ from run to run.
fn without_times(value: Value) -> Value {
    match value {
        Value::Object(map) => map
            .into_iter()
            .filter(|(key, _)| !key.ends_with("_seconds"))
            .map(|(key, value)| (key, without_times(value)))
            .collect(),
        Value::Array(list) => list.into_iter().map(without_times).collect(),
        other => other,
    }
}

#[test]
fn every_kind_of_driving_is_evaluated() {
    let document = drivekit(&["evaluate", "--format", "json"]).ok().json();
    assert_eq!(document["hold_out"], "trip");
    assert_eq!(keys(&document["braking"]["models"]), MODELS);
    for part in [&document, &document["braking"]] {
        assert_eq!(part["paired"].as_array().unwrap().len(), 12 * 11 / 2);
        let band = &part["bands"]["profile-onset"][2];
        assert_eq!(band["level_pct"], 90.0);
        assert!((band["inside_pct"].as_f64().unwrap() - 90.0).abs() < 5.0);
    }
    assert!(document["cruise"]["models"]["hold"]["rmse_mps"].is_number());
    assert!(document["following"]["models"]["idm"]["gap_rmse_m"].is_number());
    assert_eq!(
        document["function_fits"]["acceleration"]["fits"]
            .as_array()
            .unwrap()
            .len(),
        6
    );
    assert!(document["system_identification"]["thrown_away"].is_number());
    assert_eq!(document["learning_curve"], Value::Null);
}

#[test]
fn a_folder_or_a_file_can_be_held_out_as_one() {
    let folder = TempDir::new().unwrap();
    let source = crate::program::fixture("drives");
    for (driver, drives) in [
        ("anna", ["drive-01", "drive-02"]),
        ("ben", ["drive-03", "drive-04"]),
    ] {
        fs::create_dir(folder.path().join(driver)).unwrap();
        for drive in drives {
            let name = format!("{drive}.csv");
            fs::copy(
                format!("{source}/{name}"),
                folder.path().join(driver).join(name),
            )
            .unwrap();
        }
    }
    let evaluate = |arguments: &[&str]| {
        let all = [
            &[
                "evaluate", "anna", "ben", "--models", "profile", "--format", "json",
            ],
            arguments,
        ];
        drivekit_in(folder.path(), &all.concat()).ok().json()
    };
    let units = |document: &Value| {
        let folds = document["folds"].as_array().unwrap().iter();
        let names: std::collections::BTreeSet<_> =
            folds.map(|f| f["held_out"].to_string()).collect();
        names.len()
    };
    assert_eq!(units(&evaluate(&["--hold-out", "driver"])), 2);
    assert_eq!(units(&evaluate(&["--hold-out", "file"])), 4);
}

#[test]
fn other_drivers_make_a_prior_and_a_learning_curve() {
    let drives = |numbers: [u32; 3]| {
        numbers.map(|n| crate::program::fixture(&format!("drives/drive-{n:02}.csv")))
    };
    let (own, prior) = (drives([1, 2, 3]), drives([4, 5, 6]));
    let mut arguments = vec![
        "evaluate",
        "--models",
        "profile",
        "--learning-curve",
        "--format",
        "json",
    ];
    arguments.extend(own.iter().map(String::as_str));
    for log in &prior {
        arguments.extend(["--prior", log.as_str()]);
    }
    let document = drivekit(&arguments).ok().json();
    let rows: Vec<(String, u64)> = document["learning_curve"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| {
            (
                row["training"].as_str().unwrap().to_owned(),
                row["own_trips"].as_u64().unwrap(),
            )
        })
        .collect();
    let expected = [
        ("prior", 0),
        ("own and prior", 1),
        ("own and prior", 2),
        ("own", 1),
        ("own", 2),
    ];
    assert_eq!(
        rows,
        expected.map(|(training, trips)| (training.to_owned(), trips))
    );
    drivekit(&["evaluate", "--prior-weight=-1"]).refused(&["prior-weight", "0 to 1000"]);
}

#[test]
fn thresholds_reach_into_the_other_kinds() {
    let met = drivekit(&["evaluate", "--require", "braking.profile.in_band_pct>=1"]);
    assert_eq!(met.code, 0, "{}", met.stderr);
    let missed = drivekit(&["evaluate", "--require", "following.idm.gap_rmse_m<=0.01"]);
    assert_eq!(missed.code, 1, "{}", missed.stderr);
}

#[test]
fn models_can_be_chosen_and_baselines_stay() {
    let document = drivekit(&[
        "evaluate",
        "--models",
        "profile,inverse",
        "--format",
        "json",
    ])
    .ok()
    .json();
    assert_eq!(keys(&document["models"]), ["inverse", "profile"]);
    assert_eq!(keys(&document["baselines"]), BASELINES);
}

#[test]
fn a_missed_threshold_is_exit_code_1_and_a_met_one_0() {
    let met = drivekit(&["evaluate", "--require", "profile.in_band_pct>=1"]);
    assert_eq!(met.code, 0, "{}", met.stderr);
    let missed = drivekit(&["evaluate", "--require", "profile.energy_error_j.mean_abs<0"]);
    assert_eq!(missed.code, 1);
    assert!(
        missed
            .stderr
            .contains("missed: profile.energy_error_j.mean_abs<0"),
        "{}",
        missed.stderr
    );
    assert!(
        missed.stdout.contains("profile"),
        "the table is printed all the same"
    );
    drivekit(&[
        "evaluate",
        "--models",
        "profile",
        "--require",
        "inverse.in_band_pct>=1",
    ])
    .refused(&["no figure", "`profile.in_band_pct`"]);
}

#[test]
fn the_report_is_one_page_that_asks_nothing_of_a_network() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("report.html");
    drivekit(&["evaluate", "--report", path.to_str().unwrap()]).ok();
    let page = fs::read_to_string(path).unwrap();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"));
    assert!(page.contains("drive-07"));
}

#[test]
fn recorded_drives_of_a_folder() {
    let Some(folder) = shared("data/rsk-twizy") else {
        return;
    };
    let document = drivekit(&["evaluate", folder.to_str().unwrap(), "--format", "json"])
        .ok()
        .json();
    assert_eq!(document["inputs"].as_array().unwrap().len(), 10);
    assert!(document["models"]["profile"]["phases"].as_u64().unwrap() > 50);
}

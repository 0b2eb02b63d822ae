//! The main job.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{drivekit, drivekit_in, shared};

const MODELS: [&str; 5] = [
    "exponential",
    "exponential-amplitude",
    "inverse",
    "profile",
    "rise-time",
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
    assert_eq!(document["folds"].as_array().unwrap().len(), 12 * 8);
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
        let mut document = drivekit(&["evaluate", "--format", "json", "--threads", threads])
            .ok()
            .json();
        for table in ["models", "baselines"] {
            for figures in document[table].as_object_mut().unwrap().values_mut() {
                figures["fit_seconds"] = Value::Null;
                figures["predict_seconds"] = Value::Null;
            }
        }
        document
    };
    assert_eq!(figures("1"), figures("3"));
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
    .refused_after_output("no model `inverse` was evaluated");
}

impl crate::program::Run {
    fn refused_after_output(&self, words: &str) {
        assert_eq!(self.code, 2);
        assert!(self.stderr.contains(words), "{}", self.stderr);
    }
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

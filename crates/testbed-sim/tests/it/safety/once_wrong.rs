//! Scenarios that once went wrong, where they are at hand beside the project.

use std::path::{Path, PathBuf};

use testbed_sim::{RunSpec, Verdict};
use unicycle_cbf::Preset;

use crate::shared::shared;

const FOLDERS: [&str; 9] = [
    "01-ring-lap",
    "02-standstill",
    "03-figure-eight",
    "09-narrow",
    "11-reverse",
    "12-start",
    "13-fast",
    "14-random",
    "17-mine",
];

fn scenarios(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    files
        .filter(|file| file.extension().is_some_and(|ext| ext == "toml"))
        .collect()
}

/// As written; what was written with the thesis's controllers, hardened.
fn spec(file: &Path) -> RunSpec {
    let mut spec: RunSpec = toml::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let scenario = &mut spec.scenario;
    if !scenario.controller.hardening.wheel_rows {
        scenario.controller = Preset::Hardened.applied_to(&scenario.controller, &scenario.body);
    }
    spec
}

/// All are safe but one, which starts outside its lane and comes back.
#[test]
fn scenarios_that_went_wrong_are_safe() {
    let Some(shared) = shared("cases/robots") else {
        return;
    };
    for folder in FOLDERS {
        for file in scenarios(&shared.join(folder)) {
            let spec = spec(&file);
            let half_width_m = spec.scenario.controller.lane.half_width_m;
            let (run, summary) = spec.simulate().unwrap();
            let what = format!("{}: {summary:?}", file.display());
            if !file.ends_with("outside.toml") {
                assert_eq!(summary.verdict, Verdict::Safe, "{what}");
                continue;
            }
            assert_eq!(summary.first_unsafe_s, Some(0.0), "{what}");
            assert!(!summary.bodies_were_near, "{what}");
            let late = run.ticks.iter().filter(|tick| tick.time_s > 10.0);
            let off_m = late.map(|tick| tick.truth.unwrap().safety.deviation_m.abs());
            assert!(off_m.fold(0.0, f64::max) < half_width_m, "{what}");
        }
    }
}

//! How much what recorded trips could have cost depends on what a plan may do beside them.
//!
//! `cargo run --release -p assistance --example potential_settings -- VEHICLE LOG…`, with the name or the TOML file of a vehicle and files or folders of logs.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::{Path, PathBuf};

use assistance::{Potential, PotentialSettings, RecordedMotion, potential_of_pieces};
use drive_log::collection::{Collection, Reading};
use drive_log::{LayoutChoice, Preparation};
use driver_model::Motion;
use driver_model::motion::drives;
use driver_model::statistics::quantile;
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, StepModel, Vehicle};
use speed_plan::Settings;

const DRIVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "b250e".to_owned());
    let mut logs: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if logs.is_empty() {
        logs.extend((1..=3).map(|number| format!("{DRIVES}/drive-{number:02}.csv").into()));
    }
    let vehicle = match name.ends_with(".toml") {
        true => Vehicle::read(Path::new(&name))?,
        false => Vehicle::builtin(&name)?,
    };
    let reading = Reading {
        layout: LayoutChoice::Auto,
        preparation: Preparation::default(),
        limit_map: None,
        skip_broken: true,
        threads: 2,
    };
    let read = Collection::read(&logs, &reading, |_| {}, &|| {})?.each_once();
    let mut motions = Vec::new();
    for log in &read[..] {
        motions.extend(Motion::of_drive(&log.drive, DEFAULT_SLOPE_BANDWIDTH_M)?);
    }
    let model = StepModel::new(&vehicle);
    println!("{:<34} trips  all %  quartiles and median %", "");
    for (words, settings) in variants() {
        print(&words, &motions, &model, &settings);
    }
    Ok(())
}

/// One setting at a time.
fn variants() -> Vec<(String, PotentialSettings)> {
    let base = PotentialSettings::default();
    let mut variants = vec![("as they are".to_owned(), base)];
    for window_m in [0.0, 25.0, 50.0, 200.0] {
        variants.push((
            format!("window of {window_m} m"),
            PotentialSettings { window_m, ..base },
        ));
    }
    for prominence_mps in [1.0, 1.5, 3.0, 4.0] {
        let words = format!("lows of {prominence_mps} m/s");
        variants.push((
            words,
            PotentialSettings {
                prominence_mps,
                ..base
            },
        ));
    }
    for accel_quantile in [0.9, 0.95, 0.98, 1.0] {
        let words = format!("acceleration, quantile {accel_quantile}");
        variants.push((
            words,
            PotentialSettings {
                accel_quantile,
                ..base
            },
        ));
    }
    for min_mps2 in [-1.5, -2.0, -3.5] {
        let words = format!("braking to {min_mps2} m/s²");
        variants.push((words, PotentialSettings { min_mps2, ..base }));
    }
    variants
}

fn print(words: &str, motions: &[Motion], model: &StepModel, settings: &PotentialSettings) {
    let search = Settings::default();
    let of_drive = |pieces: &[Motion]| {
        let pieces = pieces.iter().map(RecordedMotion::from);
        potential_of_pieces(pieces, model, settings, &search).ok()
    };
    let planned: Vec<Potential> = drives(motions).filter_map(of_drive).collect();
    let mut all = Potential::default();
    planned.iter().for_each(|one| all += *one);
    let mut savings_pct: Vec<f64> = planned.iter().map(Potential::saving_pct).collect();
    savings_pct.sort_by(f64::total_cmp);
    let at = |share| quantile(&savings_pct, share).unwrap_or(f64::NAN);
    println!(
        "{words:<34} {:>5} {:>6.1} {:>6.1} {:>6.1} {:>6.1}",
        planned.len(),
        all.saving_pct(),
        at(0.25),
        at(0.5),
        at(0.75)
    );
}

//! How phases that have just begun go on, each trip held out once: what `drivekit predict - --follow` says of them, judged.
//!
//! `cargo run --release -p driver-eval --example begun_phases -- LOG…`, with files or folders of logs, by default three simulated drives.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::PathBuf;

use drive_log::collection::{Collection, Reading};
use drive_log::{LayoutChoice, Preparation};
use driver_eval::begun::{BegunOf, BegunScore, evaluate_begun};
use driver_model::live::BegunSettings;
use driver_model::{
    FitSettings, Manoeuvre, ModelKind, Motion, PhaseExtent, PhaseSettings, find_behaviour,
};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

const DRIVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drives");

fn main() -> Result<(), Box<dyn Error>> {
    let mut logs: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    if logs.is_empty() {
        logs.extend((1..=3).map(|number| format!("{DRIVES}/drive-{number:02}.csv").into()));
    }
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
    for extent in [PhaseExtent::Threshold, PhaseExtent::Whole] {
        let phases = PhaseSettings::default().reaching(extent);
        let trips = find_behaviour(&motions, &phases, &|| {})?;
        for manoeuvre in [Manoeuvre::Acceleration, Manoeuvre::Braking] {
            let fit = FitSettings {
                phases,
                manoeuvre,
                ..FitSettings::default()
            };
            for (words, judged) in [("all", BegunOf::All), ("counting", BegunOf::Counting)] {
                println!("\n{manoeuvre:?}, phases {}, {words}", extent.words());
                let scores = evaluate_begun(
                    &trips,
                    ModelKind::ProfileOnset,
                    &fit,
                    &BegunSettings::default(),
                    judged,
                )?;
                print(&scores);
            }
        }
    }
    Ok(())
}

fn print(scores: &[BegunScore]) {
    println!(
        "{:>5} {:>6}  {:>6} {:>6} {:>6}  {:>6} {:>6} {:>6}  {:>6} {:>6} {:>6}  {:>20}",
        "in s",
        "phases",
        "in %",
        "width",
        "score",
        "in %",
        "width",
        "score",
        "median",
        "hold",
        "a const",
        "gain"
    );
    for score in scores
        .iter()
        .filter(|s| [1.0, 2.0, 3.0, 5.0, 8.0].contains(&s.after_s))
    {
        let kmh = |mps: f64| 3.6 * mps;
        let (band, all) = (score.band, score.band_of_all);
        let gain = score
            .gain_mps
            .map_or_else(String::new, |(gain, low, high)| {
                format!("{:.2} ({:.2} … {:.2})", kmh(gain), kmh(low), kmh(high))
            });
        println!(
            "{:>5} {:>6}  {:>6.1} {:>6.1} {:>6.1}  {:>6.1} {:>6.1} {:>6.1}  {:>6.2} {:>6.2} {:>6.2}  {gain:>20}",
            score.after_s,
            score.phases,
            band.coverage_pct,
            kmh(band.width_mps),
            kmh(band.score_mps),
            all.coverage_pct,
            kmh(all.width_mps),
            kmh(all.score_mps),
            kmh(score.rmse_mps),
            kmh(score.hold_rmse_mps),
            kmh(score.constant_acceleration_rmse_mps),
        );
    }
}

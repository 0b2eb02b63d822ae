//! How soon the model of a driver who is new is good: from the own trips alone, and as a model of other drivers that goes on learning.
//!
//! `cargo run --release -p driver-eval --example new_driver -- [--step S] OWN… --others OTHER…`, with files or folders of logs; without any,
//! simulated drives of a driver, and of others who accelerate by other models. Speed is smoothed at 0.1 s and not at longer steps.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::PathBuf;

use drive_log::collection::{Collection, Reading};
use drive_log::{Drive, LayoutChoice, Preparation, Smoothing};
use drive_sim::{SimulatedDriver, SynthSettings, simulate};
use driver_eval::new_driver::new_driver_curve;
use driver_eval::phase::DEFAULT_PRIOR_WEIGHT;
use driver_model::{
    DriveBehaviour, FitSettings, Manoeuvre, ModelKind, Motion, PhaseSettings, find_behaviour,
};
use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Vehicle};
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

const COUNTS: [usize; 8] = [0, 1, 2, 3, 5, 8, 12, 20];
const ORDERS: u64 = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut own, mut others, mut step_s) = (Vec::new(), Vec::new(), 0.1);
    let mut args = std::env::args().skip(1);
    let mut is_other = false;
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--step" => step_s = args.next().ok_or("--step needs a number")?.parse()?,
            "--others" => is_other = true,
            log if is_other => others.push(PathBuf::from(log)),
            log => own.push(PathBuf::from(log)),
        }
    }
    let (own, others) = if own.is_empty() {
        (
            trips(&simulated(ModelKind::Profile, 1)?)?,
            trips(&simulated(ModelKind::Inverse, 2)?)?,
        )
    } else {
        (
            trips(&read(&own, step_s)?)?,
            trips(&read(&others, step_s)?)?,
        )
    };
    println!("{} own trips, {} of others", own.len(), others.len());
    let orders: Vec<Vec<usize>> = (0..ORDERS)
        .map(|seed| {
            let mut order: Vec<usize> = (0..own.len()).collect();
            order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
            order
        })
        .collect();
    for manoeuvre in [Manoeuvre::Acceleration, Manoeuvre::Braking] {
        let fit = FitSettings {
            manoeuvre,
            ..FitSettings::default()
        };
        let model = ModelKind::ProfileOnset;
        let points = new_driver_curve(
            &own,
            &others,
            model,
            &fit,
            DEFAULT_PRIOR_WEIGHT,
            &COUNTS,
            &orders,
        )?;
        println!("\n{manoeuvre:?}, {model}, RMSE in km/h");
        println!("trips  orders    own  others updated  difference           over all orders");
        for point in points {
            let kmh =
                |mps: Option<f64>| mps.map_or("–".to_owned(), |v| format!("{:.2}", 3.6 * v));
            let difference = point
                .difference_mps
                .map_or("–".to_owned(), |(d, low, high)| {
                    format!("{:+.2} ({:+.2} … {:+.2})", 3.6 * d, 3.6 * low, 3.6 * high)
                });
            println!(
                "{:>5}  {:>2}/{:<2}  {:>6}  {:>14}  {difference:20} {:>6}",
                point.own_trips,
                point.fitted_orders.0,
                point.fitted_orders.1,
                kmh(point.own_rmse_mps),
                kmh(point.updated_rmse_mps),
                kmh(Some(point.updated_rmse_all_mps)),
            );
        }
    }
    Ok(())
}

fn trips(drives: &[Drive]) -> Result<Vec<DriveBehaviour>, driver_model::Error> {
    let mut motions = Vec::new();
    for drive in drives {
        motions.extend(Motion::of_drive(drive, DEFAULT_SLOPE_BANDWIDTH_M)?);
    }
    find_behaviour(&motions, &PhaseSettings::default(), &|| {})
}

fn read(logs: &[PathBuf], step_s: f64) -> Result<Vec<Drive>, drive_log::Error> {
    let mut preparation = Preparation {
        step_s,
        ..Preparation::default()
    };
    if step_s > 0.1 {
        preparation.smooth = Smoothing::None;
    }
    let reading = Reading {
        layout: LayoutChoice::Auto,
        preparation,
        limit_map: None,
        skip_broken: true,
        threads: 2,
    };
    let read = Collection::read(logs, &reading, |_| {}, &|| {})?.each_once();
    Ok(read.iter().map(|log| log.drive.clone()).collect())
}

fn simulated(kind: ModelKind, seed: u64) -> Result<Vec<Drive>, Box<dyn Error>> {
    let settings = SynthSettings {
        drives: 12,
        duration_s: 400.0,
        driver: SimulatedDriver::with(kind).ok_or("no driver accelerates so")?,
        seed,
        ..SynthSettings::default()
    };
    let drives = simulate(&settings, &Vehicle::builtin("b250e")?)?;
    Ok(drives
        .into_iter()
        .map(|drive| Drive::from(drive.log))
        .collect())
}

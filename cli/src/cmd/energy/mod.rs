mod body;
mod text;

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use driver_model::Motion;
use driver_model::energy::{DriveEnergy, EnergyTotals, drive_energy, trace_csv};
use driver_model::motion;
use ev_energy::Vehicle;
use rayon::prelude::*;
use serde::Serialize;

use crate::cmd::motions::motions;
use crate::cmd::phases::vehicle;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};
use body::{Body, Entry, Totals};

/// Where the energy of drives went, against measured battery power where the log has it
///
/// With several vehicles, what each of them would have used on the same drives.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit energy logs/ --vehicle bmw-i3-60ah --report energy.html
  drivekit energy drive.csv --vehicle my-car.toml --trace power.csv
  drivekit energy logs/ --vehicle bmw-i3-60ah --vehicle vw-id3      what another car would have used")]
pub(crate) struct EnergyArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    /// Vehicle: a built-in name (see `drivekit vehicle list`) or a TOML file; give it again to compare
    #[arg(long, required = true, value_name = "NAME|FILE")]
    vehicle: Vec<String>,
    /// Slopes are smoothed over this distance to either side, in m
    #[arg(long, default_value_t = ev_energy::DEFAULT_SLOPE_BANDWIDTH_M, value_parser = numbers::bandwidth_m, value_name = "M")]
    slope_bandwidth: f64,
    /// Take the car for warm at the start of every log, which is else taken for a cold start
    #[arg(long)]
    warm_start: bool,
    /// Write every term of every step, of one log and one vehicle
    #[arg(long, value_name = "FILE.csv")]
    #[serde(skip)]
    trace: Option<PathBuf>,
    /// Write one self-contained page with the flow of energy and power over time
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

const COLD_START: &str = "the start of every log is taken for a cold start, since how long the car stood is not in it; --warm-start takes the car for warm";

pub(crate) fn run(args: &EnergyArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&KnownFigures::new(include_str!("../../figures/energy.txt")))?;
    let vehicles: Vec<Vehicle> = args
        .vehicle
        .iter()
        .map(|name| Ok(vehicle(name)?.started(args.warm_start)))
        .collect::<anyhow::Result<_>>()?;
    let inputs = inputs::load(&args.logs, context)?;
    let motions = motions(&inputs, args.slope_bandwidth)?;
    if let Some(path) = &args.trace {
        let ([_], [vehicle]) = (&inputs[..], &vehicles[..]) else {
            anyhow::bail!(
                "--trace writes one log and one vehicle, {} and {} were given; name one of each",
                inputs.len(),
                vehicles.len()
            );
        };
        let trace = trace_csv(&motions, vehicle)?;
        output::write_file(path, |out| Ok(out.write_all(trace.as_bytes())?))?;
        output::note(context, &format!("trace written to {}", path.display()));
    }
    if vehicles.iter().any(Vehicle::warms_up) {
        output::note(context, COLD_START);
    }
    let drives = inputs.iter().zip(motion::drives(&motions));
    let pairs: Vec<(&Input, &[Motion], &Vehicle)> = drives
        .flat_map(|(input, drive)| vehicles.iter().map(move |vehicle| (input, drive, vehicle)))
        .collect();
    let entries = pairs
        .par_iter()
        .map(|(input, drive, vehicle)| {
            Ok(Entry {
                name: &input.drive.name,
                origin: &input.drive.origin,
                vehicle: &vehicle.spec().name,
                energy: drive_energy(drive, vehicle, &mut |_| {}).with_context(|| input.label())?,
                curve: None,
            })
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let totals = vehicles
        .iter()
        .enumerate()
        .map(|(k, vehicle)| {
            let of_vehicle = entries.iter().skip(k).step_by(vehicles.len());
            let energies: Vec<&DriveEnergy> = of_vehicle.map(|entry| &entry.energy).collect();
            Totals {
                vehicle: &vehicle.spec().name,
                calibration: vehicle.spec().calibration,
                totals: EnergyTotals::of(&energies),
            }
        })
        .collect();
    let mut document = Document::new(
        "energy",
        args,
        &inputs,
        Body {
            totals,
            logs: entries,
        },
    );
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text::text(&document.body))?,
    }
    if let Some(path) = &args.report {
        for entry in &mut document.body.logs {
            entry.curve = Some(std::mem::take(&mut entry.energy.curve));
        }
        let page = report::ENERGY.filled(&serde_json::to_value(&document)?);
        output::write_page(path, &page, context)?;
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

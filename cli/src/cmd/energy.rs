use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use driver_model::{DriveEnergy, EnergyStep, drive_energy};
use ev_energy::Vehicle;
use rayon::prelude::*;
use serde::Serialize;

use super::phases::vehicle;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::render::json::{Document, Logs};
use crate::render::table::{Table, number};

/// Energy budget, against measured battery power where the log has it
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit energy logs/ --vehicle bmw-i3-60ah
  drivekit energy drive.csv --vehicle my-car.toml --trace power.csv")]
pub(crate) struct EnergyArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    /// Vehicle: a built-in name (see `drivekit vehicle list`) or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    vehicle: String,
    /// Elevation is smoothed over this distance to either side for the slope, in m
    #[arg(long, default_value_t = ev_energy::DEFAULT_SLOPE_BANDWIDTH_M, value_name = "M")]
    slope_bandwidth: f64,
    /// Write every term of every step of one log
    #[arg(long, value_name = "FILE.csv")]
    #[serde(skip)]
    trace: Option<PathBuf>,
}

pub(crate) fn run(args: &EnergyArgs, context: &Context) -> anyhow::Result<Outcome> {
    let vehicle = vehicle(&args.vehicle)?;
    if let Some(path) = &args.trace {
        output::check_file_place(path)?;
    }
    let inputs = inputs::load(&args.logs, context)?;
    if args.trace.is_some() && inputs.len() != 1 {
        anyhow::bail!(
            "--trace writes one log, {} were given; name one",
            inputs.len()
        );
    }
    let energies = inputs
        .par_iter()
        .map(|input| {
            Ok(drive_energy(
                &input.drive,
                &vehicle,
                args.slope_bandwidth,
                |_| {},
            )?)
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    if let (Some(path), [input]) = (&args.trace, &inputs[..]) {
        write_trace(path, input, &vehicle, args.slope_bandwidth)?;
        output::note(context, &format!("trace written to {}", path.display()));
    }
    match context.format {
        Format::Json => {
            let logs = inputs
                .iter()
                .zip(&energies)
                .map(|(input, energy)| Entry {
                    name: &input.drive.name,
                    energy,
                })
                .collect();
            output::print_json(&Document::new("energy", args, &inputs, Logs { logs }))?;
        }
        Format::Text => output::print_text(&text(&inputs, &energies))?,
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    #[serde(flatten)]
    energy: &'a DriveEnergy,
}

fn text(inputs: &[Input], energies: &[DriveEnergy]) -> String {
    let mut table = Table::new([
        "log",
        "km",
        "kWh/100 km",
        "terminal kWh",
        "measured kWh",
        "error %",
        "power RMSE kW",
        "limited s",
    ]);
    for (input, energy) in inputs.iter().zip(energies) {
        table.row([
            input.drive.name.clone(),
            number(energy.modelled.distance_m / 1e3, 2),
            number(energy.consumption_kwh_per_100km, 2),
            kwh(energy.modelled.terminal_energy_j),
            number(
                energy
                    .measured_terminal_energy_j
                    .map(|e| e / ev_energy::JOULES_PER_KWH),
                3,
            ),
            number(energy.error_pct, 1),
            number(energy.power_rmse_w.map(|p| p / 1e3), 2),
            number(
                energy.modelled.limited.torque_s + energy.modelled.limited.battery_s,
                1,
            ),
        ]);
    }
    let mut text = table.render();
    let mut budget = Table::new([
        "budget in kWh",
        "inertia",
        "rolling",
        "aero",
        "grade",
        "gear loss",
        "motor loss",
        "auxiliary",
        "battery loss",
        "brakes",
        "cells",
        "(regenerated)",
    ]);
    for (input, energy) in inputs.iter().zip(energies) {
        let b = &energy.modelled.budget;
        budget.row([
            input.drive.name.clone(),
            kwh(b.inertia_j),
            kwh(b.rolling_j),
            kwh(b.aero_j),
            kwh(b.grade_j),
            kwh(b.gear_loss_j),
            kwh(b.motor_loss_j),
            kwh(b.auxiliary_j),
            kwh(b.battery_loss_j),
            kwh(b.friction_brake_j),
            kwh(energy.modelled.battery_energy_j),
            kwh(b.regenerated_j),
        ]);
    }
    let _ = write!(text, "\n{}", budget.render());
    text
}

fn kwh(energy_j: f64) -> String {
    number(energy_j / ev_energy::JOULES_PER_KWH, 3)
}

const TRACE_HEADER: &str = "time_s,speed_mps,accel_mps2,wheel_force_n,rolling_n,aero_n,grade_n,motor_speed_rad_s,\
motor_torque_nm,friction_brake_n,motor_electric_w,electric_power_w,terminal_power_w,battery_current_a,battery_power_w,measured_power_w\n";

fn write_trace(
    path: &std::path::Path,
    input: &Input,
    vehicle: &Vehicle,
    slope_bandwidth_m: f64,
) -> anyhow::Result<()> {
    let mut text = TRACE_HEADER.to_owned();
    drive_energy(&input.drive, vehicle, slope_bandwidth_m, |step| {
        let _ = writeln!(text, "{}", trace_line(step));
    })?;
    output::write_file(path, |out| Ok(out.write_all(text.as_bytes())?))
}

fn trace_line(step: &EnergyStep) -> String {
    let p = &step.point;
    let mut line = format!("{}", step.time_s);
    for value in [
        p.speed_mps,
        step.accel_mps2,
        p.wheel_force_n,
        p.rolling_n,
        p.aero_n,
        p.grade_n,
        p.motor_speed_rad_s,
        p.motor_torque_nm,
        p.friction_brake_n,
        p.motor_electric_w,
        p.electric_power_w,
        p.terminal_power_w,
        p.battery_current_a,
        p.battery_power_w,
    ] {
        let _ = write!(line, ",{value}");
    }
    match step.measured_power_w {
        Some(power_w) => {
            let _ = write!(line, ",{power_w}");
        }
        None => line.push(','),
    }
    line
}

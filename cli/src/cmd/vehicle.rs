use std::path::PathBuf;

use anyhow::{Context as _, anyhow, bail};
use clap::{Args, Subcommand};
use ev_energy::{ConsumptionUse, OperatingPoint, Vehicle, VehicleCheck, library};
use report::terminal::{Table, number};
use serde::Serialize;

use super::phases::vehicle;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// Built-in vehicles, vehicle files and single operating points
#[derive(Debug, Subcommand)]
pub(crate) enum VehicleCommand {
    /// Names of the built-in vehicles
    List,
    /// Whether vehicle files are sound, and what they give against published consumption
    #[command(after_help = "\
Examples:
  drivekit vehicle check my-car.toml
  drivekit vehicle check                    every built-in vehicle")]
    Check(CheckArgs),
    /// All parameters with their sources, as a vehicle file
    #[command(after_help = "Example:\n  drivekit vehicle show b250e > my-car.toml")]
    Show(ShowArgs),
    /// Every force, torque and power at one operating point, or at many from a file
    #[command(after_help = "\
Examples:
  drivekit vehicle point b250e --speed 13.9 --accel 0.5 --grade 0.02
  drivekit vehicle point b250e --points points.csv --format json")]
    Point(PointArgs),
}

#[derive(Debug, Args, Serialize)]
pub(crate) struct ShowArgs {
    /// A built-in name or a TOML file
    #[arg(value_name = "NAME|FILE")]
    vehicle: String,
}

#[derive(Debug, Args, Serialize)]
pub(crate) struct CheckArgs {
    /// Built-in names or TOML files; all built-in vehicles if left out
    #[arg(value_name = "NAME|FILE")]
    vehicles: Vec<String>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

#[derive(Debug, Args, Serialize)]
pub(crate) struct PointArgs {
    /// A built-in name or a TOML file
    #[arg(value_name = "NAME|FILE")]
    vehicle: String,
    /// Speed in m/s
    #[arg(
        long,
        required_unless_present = "points",
        conflicts_with = "points",
        allow_negative_numbers = true,
        value_parser = numbers::speed_mps,
        value_name = "M/S"
    )]
    speed: Option<f64>,
    /// Acceleration in m/s²
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = numbers::accel_mps2,
        value_name = "M/S2"
    )]
    accel: f64,
    /// Grade, the tangent of the slope angle
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = numbers::grade,
        value_name = "TAN"
    )]
    grade: f64,
    /// CSV with the columns speed_mps,accel_mps2,grade
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(command: &VehicleCommand, context: &Context) -> anyhow::Result<Outcome> {
    match command {
        VehicleCommand::List => list(context)?,
        VehicleCommand::Show(args) => show(args, context)?,
        VehicleCommand::Check(args) => return check(args, context),
        VehicleCommand::Point(args) => return point(args, context),
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct NoConfig {}

fn list(context: &Context) -> anyhow::Result<()> {
    let vehicles: Vec<Vehicle> = library::names()
        .map(Vehicle::builtin)
        .collect::<Result<_, _>>()?;
    if context.format == Format::Json {
        #[derive(Serialize)]
        struct Body {
            vehicles: Vec<&'static str>,
        }
        let vehicles = library::names().collect();
        return output::print_json(&Document::new(
            "vehicle",
            &NoConfig {},
            &[],
            Body { vehicles },
        ));
    }
    let mut table = Table::new(["name", "mass kg", "motor kW", "vehicle"]);
    for (name, vehicle) in library::names().zip(&vehicles) {
        let spec = vehicle.spec();
        table.row([
            name.to_owned(),
            number(spec.mass_kg, 0),
            number(spec.motor.max_power_w / 1e3, 0),
            spec.description.clone(),
        ]);
    }
    output::print_text(&table.render())
}

fn show(args: &ShowArgs, context: &Context) -> anyhow::Result<()> {
    let vehicle = vehicle(&args.vehicle)?;
    match context.format {
        Format::Text => output::print_text(&vehicle.spec().to_toml()?),
        Format::Json => {
            #[derive(Serialize)]
            struct Body<'a> {
                vehicle: &'a ev_energy::VehicleSpec,
            }
            let body = Body {
                vehicle: vehicle.spec(),
            };
            output::print_json(&Document::new("vehicle", args, &[], body))
        }
    }
}

fn check(args: &CheckArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../figures/vehicle-check.txt"
    )))?;
    #[derive(Serialize)]
    struct Body {
        vehicles: Vec<Checked>,
    }
    let names: Vec<&str> = if args.vehicles.is_empty() {
        library::names().collect()
    } else {
        args.vehicles.iter().map(String::as_str).collect()
    };
    let vehicles = names
        .into_iter()
        .map(|name| {
            let vehicle = vehicle(name)?;
            Ok(Checked {
                name: vehicle.spec().name.clone(),
                check: vehicle.check()?,
            })
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let mut document = Document::new("vehicle", args, &[], Body { vehicles });
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&check_text(&document.body.vehicles))?,
    }
    Ok(outcome)
}

#[derive(Serialize)]
struct Checked {
    name: String,
    #[serde(flatten)]
    check: VehicleCheck,
}

fn check_text(vehicles: &[Checked]) -> String {
    let mut consumption = Table::new([
        "vehicle",
        "cycle",
        "published kWh/100 km",
        "model",
        "error %",
        "figure was",
        "source",
    ]);
    let mut figures = Table::new([
        "vehicle",
        "peak efficiency %",
        "at Nm",
        "rad/s",
        "top speed km/h",
        "confidence of its values",
        "without source",
    ]);
    for Checked { name, check } in vehicles {
        for figure in &check.consumption {
            consumption.row([
                name.clone(),
                figure.cycle.name().to_owned(),
                number(figure.published_kwh_per_100km, 2),
                number(figure.model_kwh_per_100km, 2),
                number(figure.error_pct, 1),
                match figure.purpose {
                    ConsumptionUse::Fitted => "fitted to".to_owned(),
                    ConsumptionUse::HoldOut => "held out".to_owned(),
                },
                figure.source.clone(),
            ]);
        }
        let confidence = check.confidence.iter();
        let confidence = confidence.map(|(kind, count)| format!("{count} {}", kind.name()));
        figures.row([
            name.clone(),
            number(100.0 * check.peak_efficiency, 1),
            number(check.peak_torque_nm, 0),
            number(check.peak_speed_rad_s, 0),
            number(3.6 * check.top_speed_mps, 0),
            confidence.collect::<Vec<_>>().join(", "),
            check.without_source.join(", "),
        ]);
    }
    format!("{}\n{}", figures.render(), consumption.render())
}

fn point(args: &PointArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../figures/vehicle-point.txt"
    )))?;
    let vehicle = vehicle(&args.vehicle)?;
    let requests = match (&args.points, args.speed) {
        (Some(path), _) => read_points(path)?,
        (None, Some(speed)) => vec![[speed, args.accel, args.grade]],
        (None, None) => bail!("give --speed or --points"),
    };
    let points: Vec<OperatingPoint> = requests
        .iter()
        .map(|&[speed, accel, grade]| vehicle.operating_point(speed, accel, grade.atan()))
        .collect();
    let body = match (&args.points, &points[..]) {
        (None, [point]) => PointBody::One(point),
        _ => PointBody::Many { points: &points },
    };
    let mut document = Document::new("vehicle", args, &[], body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Text => output::print_text(&point_table(&requests, &points))?,
        Format::Json => output::print_json(&document)?,
    }
    Ok(outcome)
}

#[derive(Serialize)]
#[serde(untagged)]
enum PointBody<'a> {
    One(&'a OperatingPoint),
    Many { points: &'a [OperatingPoint] },
}

/// Lines of `speed_mps,accel_mps2,grade` under that header.
fn read_points(path: &std::path::Path) -> anyhow::Result<Vec<[f64; 3]>> {
    let file = path.display();
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read `{file}`"))?;
    let mut lines = text.lines().enumerate();
    let header = lines
        .next()
        .map(|(_, line)| line.trim().trim_start_matches('\u{feff}'));
    if header != Some("speed_mps,accel_mps2,grade") {
        bail!("`{file}`, line 1: expected the header speed_mps,accel_mps2,grade");
    }
    lines
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(index, line)| {
            let place = || format!("`{file}`, line {}", index + 1);
            let values: Vec<&str> = line.split(',').collect();
            let [speed, accel, grade] = values[..] else {
                bail!("{}: expected three numbers, found `{line}`", place());
            };
            let value = |parsed: Result<f64, String>| {
                parsed.map_err(|expected| anyhow!("{}: {expected}, found `{line}`", place()))
            };
            Ok([
                value(numbers::speed_mps(speed))?,
                value(numbers::accel_mps2(accel))?,
                value(numbers::grade(grade))?,
            ])
        })
        .collect()
}

fn point_table(requests: &[[f64; 3]], points: &[OperatingPoint]) -> String {
    let mut table = Table::new([
        "speed m/s",
        "accel m/s²",
        "wheel N",
        "rolling N",
        "aero N",
        "grade N",
        "motor rad/s",
        "motor Nm",
        "brakes N",
        "motor W",
        "electric W",
        "battery A",
        "battery W",
        "limited",
    ]);
    for (&[speed, accel, _], p) in requests.iter().zip(points) {
        let limited = match (p.limited.torque, p.limited.battery) {
            (false, false) => "",
            (true, false) => "torque",
            (false, true) => "battery",
            (true, true) => "torque, battery",
        };
        table.row([
            number(speed, 3),
            number(accel, 3),
            number(p.wheel_force_n, 1),
            number(p.rolling_n, 1),
            number(p.aero_n, 1),
            number(p.grade_n, 1),
            number(p.motor_speed_rad_s, 1),
            number(p.motor_torque_nm, 2),
            number(p.friction_brake_n, 1),
            number(p.motor_electric_w, 1),
            number(p.electric_power_w, 1),
            number(p.battery_current_a, 2),
            number(p.battery_power_w, 1),
            limited.to_owned(),
        ]);
    }
    table.render()
}

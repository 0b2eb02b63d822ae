use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use driver_eval::calibration::{CalibratedCycle, CalibrationReport, calibrate_vehicle};
use driver_model::energy::EnergyScore;
use ev_energy::{VehicleSpec, calibration::ParameterEstimate};
use report::terminal::{Table, number};
use serde::Serialize;

use super::left_out;
use super::motions::motions;
use super::phases::vehicle;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs;
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// Fit a vehicle to measured battery power, and say how far to trust it
///
/// Mass, road load, auxiliaries, losses and limits of regeneration are fitted within bounds to volts times amps. Every trip weighs
/// the same. Each trip is then held out once and predicted by a vehicle that is fitted to the others: that error is what to expect
/// of the next trip. A parameter that these trips do not tell keeps its value, and the output says so. The result is a vehicle file
/// for `--vehicle` of every other subcommand.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit calibrate logs/ --vehicle bmw-i3-60ah -o my-i3.toml
  drivekit calibrate logs/*.csv --vehicle my-car.toml -o better.toml --report calibration.html")]
pub(crate) struct CalibrateArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    /// Vehicle to start from: a built-in name (see `drivekit vehicle list`) or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    vehicle: String,
    /// Slopes are smoothed over this distance to either side, in m
    #[arg(long, default_value_t = ev_energy::DEFAULT_SLOPE_BANDWIDTH_M, value_parser = numbers::bandwidth_m, value_name = "M")]
    slope_bandwidth: f64,
    /// Take the car for warm at the start of every log, which is else taken for a cold start
    #[arg(long)]
    warm_start: bool,
    /// Vehicle file to write
    #[arg(long, short, value_name = "FILE.toml")]
    #[serde(skip)]
    output: PathBuf,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &CalibrateArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&KnownFigures::new(include_str!("../figures/calibrate.txt")))?;
    let start = vehicle(&args.vehicle)?;
    let inputs = inputs::load_once(&args.logs, context)?;
    let motions = motions(&inputs, args.slope_bandwidth)?;
    let progress = Progress::new(context, "fitting", inputs.len() + 1);
    progress.show();
    let report = calibrate_vehicle(&motions, &start, args.warm_start, &|| progress.step())?;
    drop(progress);
    left_out::mention(&report.left_out_drives, context);
    if let Some(kept) = report.kept() {
        output::note(context, &kept);
    }
    let spec = vehicle_file(&args.output, &report);
    let file = report.comments(&start.spec().name) + &spec.to_toml()?;
    output::write_file(&args.output, |out| Ok(out.write_all(file.as_bytes())?))?;
    output::note(
        context,
        &format!("vehicle written to {}", args.output.display()),
    );
    let mut document = Document::new(
        "calibrate",
        args,
        &inputs,
        Body {
            vehicle: &start.spec().name,
            report: &report,
        },
    );
    let outcome = document.judged(&args.require)?;
    if let Some(path) = &args.report {
        let page = report::CALIBRATION.filled(&serde_json::to_value(&document)?);
        output::write_page(path, &page, context)?;
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&report))?,
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

#[derive(Serialize)]
struct Body<'a> {
    vehicle: &'a str,
    #[serde(flatten)]
    report: &'a CalibrationReport,
}

/// The fitted vehicle with the name of its file and the record of its calibration.
fn vehicle_file(file: &Path, report: &CalibrationReport) -> VehicleSpec {
    let mut spec = report.vehicle.spec().clone();
    spec.calibration = report.record();
    if let Some(stem) = file.file_stem() {
        spec.name = stem.to_string_lossy().into_owned();
    }
    spec
}

fn text(report: &CalibrationReport) -> String {
    let mut text = parameters(&report.parameters).render();
    let mut scores = Table::new([
        "all trips",
        "mean |error| %",
        "total %",
        "median power RMSE kW",
    ]);
    for (name, score) in [
        ("before", &report.summary.start),
        ("fitted to all", &report.summary.fitted),
        ("each held out", &report.summary.held_out),
    ] {
        scores.row(score_row(name, score));
    }
    let _ = write!(text, "\n{}", scores.render());
    let mut trips = Table::new([
        "trip",
        "°C",
        "measured kWh",
        "before %",
        "fitted %",
        "held out %",
        "held-out RMSE kW",
    ]);
    for trip in &report.trips {
        trips.row([
            trip.name.clone(),
            number(trip.ambient_degc, 1),
            number(
                trip.measured_terminal_energy_j / ev_energy::JOULES_PER_KWH,
                3,
            ),
            number(trip.start_error_pct, 1),
            number(trip.fitted_error_pct, 1),
            number(trip.held_out_error_pct, 1),
            number(trip.held_out_power_rmse_w.map(|w| w / 1e3), 2),
        ]);
    }
    let _ = write!(text, "\n{}", trips.render());
    if !report.cycles.is_empty() {
        let _ = write!(text, "\n{}", cycles(&report.cycles).render());
    }
    text
}

/// At the wall, warm, at 20 °C.
fn cycles(cycles: &[CalibratedCycle]) -> Table {
    let mut table = Table::new([
        "kWh/100 km at the wall",
        "published",
        "fitted",
        "error %",
        "with mass and road load from before",
        "its error %",
    ]);
    for cycle in cycles {
        table.row([
            cycle.cycle.to_owned(),
            number(cycle.published_kwh_per_100km, 2),
            number(cycle.fitted_kwh_per_100km, 2),
            number(cycle.fitted_error_pct, 1),
            number(cycle.load_before_kwh_per_100km, 2),
            number(cycle.load_before_error_pct, 1),
        ]);
    }
    table
}

/// The parameters, those with the largest effect first.
fn parameters(estimates: &[ParameterEstimate]) -> Table {
    let mut table = Table::new([
        "parameter",
        "unit",
        "before",
        "fitted",
        "tried",
        "95 % from",
        "to",
        "+10 % does W",
        "remark",
    ]);
    let mut sorted: Vec<&ParameterEstimate> = estimates.iter().collect();
    sorted.sort_by(|a, b| b.sensitivity_w.total_cmp(&a.sensitivity_w));
    for estimate in sorted {
        let digits = digits(estimate.upper - estimate.lower);
        table.row([
            estimate.key.to_owned(),
            estimate.unit.to_owned(),
            // Above the bounds stands for no limit.
            number(
                Some(estimate.start).filter(|start| *start <= estimate.upper),
                digits,
            ),
            number(estimate.value, digits),
            number(estimate.tried, digits),
            number(estimate.ci95.map(|ci| ci[0]), digits),
            number(estimate.ci95.map(|ci| ci[1]), digits),
            number(estimate.sensitivity_w, 0),
            estimate.remark.clone(),
        ]);
    }
    table
}

/// Decimals that show a thousandth of a range.
fn digits(range: f64) -> usize {
    (3.0 - range.log10()).clamp(0.0, 6.0) as usize
}

fn score_row(name: &str, score: &EnergyScore) -> [String; 4] {
    [
        name.to_owned(),
        number(score.mean_abs_error_pct, 2),
        number(score.total_error_pct, 2),
        number(score.median_power_rmse_w.map(|w| w / 1e3), 2),
    ]
}

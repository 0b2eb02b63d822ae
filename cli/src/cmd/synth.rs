use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use drive_sim::{SimulatedDrive, SimulatedDriver, SynthSettings, Truth, simulate};
use driver_model::{DriverModel, ModelFile, ModelKind, PhaseExtent, TrainingRecord};
use report::terminal::{Table, number};
use serde::Serialize;

use super::phases::vehicle;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::names;
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::words::plural;

/// Simulated drives with known truth
///
/// A driver of known habits drives roads with speed limits, stops, hills and vehicles ahead. The logs are what a car
/// would record; `truth.json` says what made them, `true-model.json` is the driver's model. Same settings, same bytes.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit synth -o drives/ --noise
  drivekit synth -o clean/ --driver inverse --variation 0 --no-leaders   fits recover the truth
  drivekit synth -o many/ --drives 100 --seed 42 --file-format parquet")]
pub(crate) struct SynthArgs {
    /// Folder for drive-01.csv and so on, truth.json and true-model.json
    #[arg(short, long, value_name = "DIR")]
    #[serde(skip)]
    output: PathBuf,
    /// Write into a folder that has drives already; those of the same names are replaced, others stay
    #[arg(long)]
    #[serde(skip)]
    force: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of drives
    #[arg(long, default_value_t = SynthSettings::default().drives, value_parser = numbers::drives, value_name = "N")]
    drives: usize,
    /// Duration of each drive, in s
    #[arg(long, default_value_t = SynthSettings::default().duration_s, value_parser = numbers::drive_duration_s, value_name = "S")]
    duration: f64,
    /// Sampling interval, in s
    #[arg(long, default_value_t = SynthSettings::default().step_s, value_parser = numbers::drive_step_s, value_name = "S")]
    step: f64,
    /// Model by which the driver accelerates
    #[arg(long, default_value_t = ModelKind::Profile, value_parser = names::simulated_model(), value_name = "KIND")]
    driver: ModelKind,
    /// How much phases differ: 0 not at all, 1 as with real drivers
    #[arg(long, default_value_t = 1.0, value_parser = numbers::variation, value_name = "SHARE")]
    variation: f64,
    /// Noise of the sensors, and their resolution
    #[arg(long)]
    noise: bool,
    /// No vehicles ahead
    #[arg(long)]
    no_leaders: bool,
    /// Vehicle for battery volts and amps: a built-in name or a TOML file
    #[arg(long, default_value = "b250e", value_name = "NAME|FILE")]
    vehicle: String,
    /// Format of the logs
    #[arg(long, value_enum, default_value_t = FileFormat::Csv)]
    file_format: FileFormat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum FileFormat {
    Csv,
    Parquet,
}

pub(crate) fn run(args: &SynthArgs, context: &Context) -> anyhow::Result<Outcome> {
    let vehicle = vehicle(&args.vehicle)?;
    let settings = args.settings()?;
    let folder = &args.output;
    let there = logs_in(folder)?;
    if let (Some(one), false) = (there.first(), args.force) {
        bail!(
            "`{}` has drives already, such as `{one}`; name another folder, or write into it with --force",
            folder.display()
        );
    }
    let drives = simulate(&settings, &vehicle)?;
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    for drive in &drives {
        write_drive(folder, drive, args.file_format)?;
    }
    let truth = serde_json::to_string(&Truth::new(&settings, &vehicle, &drives))?;
    output::write_file(&folder.join("truth.json"), |out| {
        Ok(writeln!(out, "{truth}")?)
    })?;
    let model = true_model(args, &settings)?;
    output::write_file(&folder.join("true-model.json"), |out| {
        Ok(out.write_all(model.as_bytes())?)
    })?;
    mention_older(&there, &drives, args.file_format, context);
    match context.format {
        Format::Json => {
            let drives = drives.iter().map(Entry::new).collect();
            output::print_json(&Document::new("synth", args, &[], Body { drives }))?;
        }
        Format::Text => output::print_text(&text(&drives, folder))?,
    }
    Ok(Outcome::Done)
}

impl SynthArgs {
    fn settings(&self) -> anyhow::Result<SynthSettings> {
        let driver = SimulatedDriver::with(self.driver)
            .with_context(|| format!("no simulated driver accelerates by `{}`", self.driver))?;
        Ok(SynthSettings {
            seed: self.seed,
            drives: self.drives,
            duration_s: self.duration,
            step_s: self.step,
            driver,
            variation: self.variation,
            sensor_noise: self.noise,
            leaders: !self.no_leaders,
        })
    }
}

/// The driver's own model, for `predict`.
fn true_model(args: &SynthArgs, settings: &SynthSettings) -> anyhow::Result<String> {
    let no_logs = TrainingRecord {
        phases: 0,
        points: 0,
        inputs: Vec::new(),
        prior_inputs: Vec::new(),
        prior_weight: 0.0,
        extent: PhaseExtent::default(),
    };
    let model = settings.driver.acceleration.clone();
    let file = ModelFile::new(
        DriverModel::Acceleration(model),
        no_logs,
        serde_json::to_value(args)?,
    );
    Ok(file.to_json()?)
}

/// Names of the logs in a folder, sorted; none where there is no folder yet.
fn logs_in(folder: &Path) -> anyhow::Result<Vec<String>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let failed = || format!("cannot list the folder `{}`", folder.display());
    let mut logs = Vec::new();
    for entry in folder.read_dir().with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        let suffix = path.extension().and_then(|suffix| suffix.to_str());
        if let (Some(name), Some("csv" | "tsv" | "parquet" | "gz" | "zst")) =
            (path.file_name(), suffix)
        {
            logs.push(name.to_string_lossy().into_owned());
        }
    }
    logs.sort();
    Ok(logs)
}

/// With `--force`, drives that `truth.json` does not know of may stay.
fn mention_older(
    there: &[String],
    drives: &[SimulatedDrive],
    format: FileFormat,
    context: &Context,
) {
    let is_new = |name: &String| drives.iter().any(|drive| *name == file_name(drive, format));
    let older: Vec<&str> = there
        .iter()
        .filter(|name| !is_new(name))
        .map(String::as_str)
        .collect();
    if !older.is_empty() {
        let text = format!(
            "beside the new drives, older ones stay that truth.json does not know: {}",
            older.join(", ")
        );
        output::note(context, &text);
    }
}

fn file_name(drive: &SimulatedDrive, format: FileFormat) -> String {
    let suffix = match format {
        FileFormat::Csv => "csv",
        FileFormat::Parquet => "parquet",
    };
    format!("{}.{suffix}", drive.log.name())
}

fn write_drive(folder: &Path, drive: &SimulatedDrive, format: FileFormat) -> anyhow::Result<()> {
    let path = folder.join(file_name(drive, format));
    output::write_file(&path, |out| {
        match format {
            FileFormat::Csv => drive_log::write_csv(&drive.log, out)?,
            FileFormat::Parquet => drive_log::write_parquet(&drive.log, out)?,
        }
        Ok(())
    })
}

#[derive(Serialize)]
struct Body {
    drives: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    samples: usize,
    distance_m: f64,
    phases: usize,
}

impl Entry {
    fn new(drive: &SimulatedDrive) -> Self {
        Self {
            name: drive.log.name().to_owned(),
            samples: drive.log.len(),
            distance_m: drive.log.distance_m().last().copied().unwrap_or(0.0),
            phases: drive.phases.len(),
        }
    }
}

fn text(drives: &[SimulatedDrive], folder: &Path) -> String {
    let mut table = Table::new(["drive", "samples", "km", "phases"]);
    for entry in drives.iter().map(Entry::new) {
        table.row([
            entry.name,
            entry.samples.to_string(),
            number(entry.distance_m / 1e3, 2),
            entry.phases.to_string(),
        ]);
    }
    format!(
        "{}\nwritten to {}, with truth.json and true-model.json: {}\n",
        table.render(),
        folder.display(),
        plural(drives.len(), "drive")
    )
}

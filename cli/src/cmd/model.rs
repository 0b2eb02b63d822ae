//! `drivekit model show`: what a model file says.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::{Args, Subcommand};
use driver_eval::model_examples::Example;
use driver_eval::model_words::model_words;
use driver_model::cruise::CruiseModel;
use driver_model::following::FollowingModel;
use driver_model::speed_ahead::DirectModel;
use driver_model::trip_driver::TripDriver;
use driver_model::{DriverModel, ModelFile, PhaseMemory};
use report::picture::{self, SpeedCurve};
use report::terminal;
use serde::Serialize;

use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::output;
use crate::render::json::Document;
use crate::words::plural;
use report::terminal::{Table, number};

/// Model files
#[derive(Debug, Subcommand)]
pub(crate) enum ModelCommand {
    /// A model in words and a plot: what it says, what it was fitted to, and three phases as it predicts them
    #[command(after_help = "\
Examples:
  drivekit model show driver.json
  drivekit model show driver.json --plot driver.svg
  drivekit model show driver.json --format json")]
    Show(ShowArgs),
}

#[derive(Debug, Args, Serialize)]
pub(crate) struct ShowArgs {
    /// Model file written by `drivekit fit`
    #[arg(value_name = "FILE.json")]
    file: PathBuf,
    /// Also draw the phases as a picture, with the predictive band where the model has one
    #[arg(long, value_name = "FILE.svg")]
    #[serde(skip)]
    plot: Option<PathBuf>,
}

pub(crate) fn run(command: &ModelCommand, context: &Context) -> anyhow::Result<Outcome> {
    let ModelCommand::Show(args) = command;
    let file = read(&args.file)?;
    let examples = Example::of(&file.model);
    if let Some(path) = &args.plot {
        if examples.is_empty() {
            bail!("--plot draws models of acceleration and braking phases");
        }
        let curves: Vec<SpeedCurve> = examples.iter().map(curve).collect();
        let picture = picture::speeds_with_bands(&title(&file), &curves)?;
        output::write_file(path, |out| Ok(out.write_all(picture.as_bytes())?))?;
    }
    match context.format {
        Format::Json => {
            let body = Body {
                remembered: file.memory.as_ref().map(Remembered::of),
                file: &file.clone().with_memory(None),
                examples: &examples,
            };
            output::print_json(&Document::new("model-show", args, &[], body))?;
        }
        Format::Text => output::print_text(&text(&file, &examples))?,
    }
    Ok(Outcome::Done)
}

/// Reads a model file; errors name it.
pub(crate) fn read(path: &Path) -> anyhow::Result<ModelFile> {
    let place = || format!("`{}`", path.display());
    let text = std::fs::read_to_string(path).with_context(place)?;
    ModelFile::from_json(&text).with_context(place)
}

#[derive(Serialize)]
struct Body<'a> {
    file: &'a ModelFile,
    /// What the file holds of what the model was fitted to; null where it cannot be updated.
    remembered: Option<Remembered>,
    examples: &'a [Example],
}

#[derive(Serialize)]
struct Remembered {
    phases: usize,
    points: usize,
    own_drives: usize,
    other_drives: usize,
}

impl Remembered {
    fn of(memory: &PhaseMemory) -> Self {
        let (phases, points) = memory.counts();
        let (own_drives, other_drives) = memory.drive_counts();
        Self {
            phases,
            points,
            own_drives,
            other_drives,
        }
    }
}

fn curve(example: &Example) -> SpeedCurve<'_> {
    SpeedCurve {
        step_s: example.outline.step_s,
        speed_mps: &example.speed_mps,
        half_width_mps: example.half_width_mps.as_deref(),
    }
}

fn title(file: &ModelFile) -> String {
    format!(
        "{}, {}",
        file.model.kind().name(),
        file.model.behaviour().name()
    )
}

fn text(file: &ModelFile, examples: &[Example]) -> String {
    let training = &file.training;
    let mut text = title(file);
    if let DriverModel::Acceleration(model) | DriverModel::Braking(model) = &file.model {
        let (knows, extent) = (model.kind().knows(), training.extent.words());
        let _ = write!(text, ", knows {knows}; phases {extent}");
    }
    let _ = writeln!(
        text,
        "\n\n{}\n\nfitted by drivekit {} to {} phases or stretches and {} of {}; prior: {}, weight {}\n",
        model_words(&file.model),
        file.version,
        training.phases,
        plural(training.points, "point"),
        plural(training.inputs.len(), "log"),
        plural(training.prior_inputs.len(), "log"),
        training.prior_weight,
    );
    let _ = match file.remembered() {
        Ok(memory) => writeln!(
            text,
            "remembers these {}, so that `drivekit fit --update` can add drives\n",
            plural(memory.counts().0, "phase")
        ),
        Err(error) => writeln!(text, "cannot be updated: {error}\n"),
    };
    match &file.model {
        DriverModel::Acceleration(_) | DriverModel::Braking(_) => {
            text.push_str(&example_table(examples));
        }
        DriverModel::Cruise(model) => text.push_str(&cruise_table(model)),
        DriverModel::Following(model) => text.push_str(&gap_table(model)),
        DriverModel::SpeedAhead(model) => text.push_str(&interval_table(model)),
        DriverModel::Trip(driver) => text.push_str(&wanted_table(driver)),
    }
    text
}

fn example_table(examples: &[Example]) -> String {
    let headings = [
        "phase",
        "in s",
        "¼ T",
        "½ T",
        "¾ T",
        "at the end",
        "90 % band at ½ T",
    ];
    let mut table = Table::new(headings);
    for example in examples {
        table.row(example_row(example));
    }
    let curves: Vec<&[f64]> = examples.iter().map(|e| e.speed_mps.as_slice()).collect();
    let step_s = examples.first().map_or(1.0, |e| e.outline.step_s);
    format!(
        "{}\n{}",
        table.render(),
        terminal::speed_over_time(&curves, step_s)
    )
}

/// What is expected of a driver who passes at the limit, and how surely.
fn cruise_table(model: &CruiseModel) -> String {
    let mut table = Table::new([
        "after s",
        "expected from 50 km/h under a limit of 50",
        "90 % within",
    ]);
    let limit_mps = 50.0 / 3.6;
    for t_s in [1.0, 5.0, 10.0, 30.0, 60.0] {
        let half_width_mps = model.half_width_90_mps(Some(limit_mps), t_s);
        table.row([
            number(t_s, 0),
            number(3.6 * model.speed_mps(limit_mps, Some(limit_mps), t_s), 1),
            format!("±{:.1}", 3.6 * half_width_mps),
        ]);
    }
    table.render()
}

/// Gaps that the driver settles at behind a leader at constant speed.
fn gap_table(model: &FollowingModel) -> String {
    let mut table = Table::new(["behind a leader at km/h", "gap m", "headway s"]);
    for kmh in [10.0, 30.0, 50.0, 80.0, 100.0, 120.0] {
        let gap_m = model.equilibrium_gap_m(kmh / 3.6);
        table.row([
            number(kmh, 0),
            number(gap_m, 1),
            number(gap_m.map(|gap| gap / (kmh / 3.6)), 2),
        ]);
    }
    table.render()
}

fn example_row(example: &Example) -> [String; 7] {
    let outline = &example.outline;
    let at = |share: f64| (share * (outline.samples - 1) as f64) as usize;
    let speed = |share: f64| number(3.6 * example.speed_mps[at(share)], 1);
    let band = example.half_width_mps.as_ref();
    [
        format!(
            "{:.0} → {:.0} km/h",
            3.6 * outline.start_speed_mps,
            3.6 * outline.end_speed_mps
        ),
        number(outline.duration_s(), 1),
        speed(0.25),
        speed(0.5),
        speed(0.75),
        speed(1.0),
        band.map_or_else(|| "–".to_owned(), |b| format!("±{:.1}", 3.6 * b[at(0.5)])),
    ]
}

fn interval_table(model: &DirectModel) -> String {
    let mut table = Table::new(["ahead s", "interval of one width ± km/h"]);
    for (horizon_s, interval_mps) in model.horizons_s().zip(model.one_width_mps(None)) {
        table.row([
            horizon_s.to_string(),
            number(interval_mps.map(|v| v * 3.6), 1),
        ]);
    }
    table.render()
}

fn wanted_table(driver: &TripDriver) -> String {
    let mut table = Table::new(["limit km/h", "drives km/h"]);
    for habit in &driver.wanted().by_limit {
        let wanted_mps = driver.wanted().mps(habit.limit_mps);
        table.row([
            number(habit.limit_mps * 3.6, 0),
            number(wanted_mps * 3.6, 1),
        ]);
    }
    table.render()
}

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;
use testbed_io::log_file::{self, LogFormat};
use testbed_io::{Disturbances, Event, Figures, Run, RunSpec, Summary, Timing};
use unicycle_cbf::Scenario;

use super::scenario::{Disturbance, Named, PresetName, ScenarioArgs};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::output;
use crate::render::html;
use crate::render::json::Document;
use crate::render::table::{Table, number};

/// Run a scenario on simulated robots
///
/// Every robot has a controller of its own: a quadratic program that keeps the lane and the headway by barriers, and goes for the
/// desired speed and the path as far as they allow. Exit code 1 says that a robot left its lane or came too close.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl run --testbed robotarium --scenario track --report run.html
  drivekit ctrl run --preset hardened --disturb all --seed 7 -o run.mcap   for Foxglove
  drivekit ctrl run --show-config > mine.toml && drivekit ctrl run --scenario mine.toml
  drivekit ctrl run --scenario track --testbed robotarium --path oval.csv")]
pub(crate) struct RunArgs {
    /// Print the scenario as a file and end
    #[arg(long)]
    #[serde(skip)]
    show_config: bool,
    /// Disturbances of the simulated testbed [default: none, or those of the file]
    #[arg(long, value_enum, value_name = "GROUP")]
    disturb: Option<Disturbance>,
    /// Seed of all random numbers [default: 1, or that of the file]
    #[arg(long)]
    seed: Option<u64>,
    /// Length of the run, in s [default: 60, or that of the file]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Run log to write: .parquet, .csv or .mcap
    #[arg(long, short, value_name = "FILE")]
    #[serde(skip)]
    output: Option<PathBuf>,
    /// Write one self-contained page with an animated view and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(flatten)]
    scenario: ScenarioArgs,
}

pub(crate) fn run(args: &RunArgs, context: &Context) -> anyhow::Result<Outcome> {
    let named = args.named()?;
    let scenario = Scenario::new(named.spec.scenario.clone())?;
    if args.show_config {
        output::print_text(&toml::to_string(&named.spec)?)?;
        return Ok(Outcome::Done);
    }
    if let Some(bend_m) = scenario.tight_bend_m() {
        let text = format!(
            "the lane is wider than the path's tightest bend, whose radius is {bend_m:.3} m; on its inner side the nearest point of the path may jump"
        );
        output::note(context, &text);
    }
    let format = args
        .output
        .as_deref()
        .map(LogFormat::from_path)
        .transpose()?;
    for path in args.output.iter().chain(&args.report) {
        output::check_file_place(path)?;
    }
    let (run, summary) = named.spec.simulate()?;
    let timing = Timing::new(&run.ticks, scenario.controller().hold_s());
    if let (Some(path), Some(format)) = (&args.output, format) {
        let table = run.to_table()?;
        output::write_file(path, |out| Ok(log_file::write(&table, format, out)?))?;
        output::note(context, &format!("run log written to {}", path.display()));
    }
    let mut body = Body::new(&named, &summary, timing);
    if args.report.is_some() {
        body.figures = Some(figures(&named.spec, &scenario, &run)?);
        body.events = Event::all(&scenario);
    }
    let mut document = Document::new("ctrl-run", args, &[], body);
    if let Some(path) = &args.report {
        let page = html::CONTROL.filled(&serde_json::to_value(&document)?);
        output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
        output::note(context, &format!("report written to {}", path.display()));
        document.body.figures = None;
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&named, &summary, &timing))?,
    }
    Ok(if summary.safe {
        Outcome::Done
    } else {
        Outcome::Negative
    })
}

impl RunArgs {
    fn named(&self) -> anyhow::Result<Named> {
        let mut named = self.scenario.named()?;
        let spec = &mut named.spec;
        if let Some(group) = self.disturb {
            spec.disturbances = Disturbances::HARD.only(group.into());
        }
        if let Some(seed) = self.seed {
            spec.seed = seed;
        }
        if let Some(duration_s) = self.duration {
            spec.scenario.duration_s = duration_s;
        }
        spec.disturbances.check().context("disturbances")?;
        Ok(named)
    }
}

fn figures(spec: &RunSpec, scenario: &Scenario, run: &Run) -> anyhow::Result<Figures> {
    let undisturbed = if spec.disturbances.is_none() {
        None
    } else {
        let spec = RunSpec {
            disturbances: Disturbances::default(),
            ..spec.clone()
        };
        Some(spec.simulate()?.0)
    };
    let undisturbed = undisturbed.as_ref().map(|run| run.ticks.as_slice());
    Ok(Figures::new(scenario, &run.ticks, undisturbed))
}

#[derive(Serialize)]
struct Body<'a> {
    scenario: &'a str,
    testbed: &'a str,
    preset: Option<PresetName>,
    seed: u64,
    rate_hz: f64,
    disturbed: bool,
    #[serde(flatten)]
    summary: &'a Summary,
    r#loop: Timing,
    reproduces: &'static [&'static str],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    events: Vec<Event>,
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<Figures>,
    spec: &'a RunSpec,
}

impl<'a> Body<'a> {
    fn new(named: &'a Named, summary: &'a Summary, timing: Timing) -> Self {
        let scenario = &named.spec.scenario;
        Self {
            scenario: &scenario.name,
            testbed: &scenario.testbed,
            preset: named.preset,
            seed: named.spec.seed,
            rate_hz: scenario.rate_hz,
            disturbed: !named.spec.disturbances.is_none(),
            summary,
            r#loop: timing,
            reproduces: named.figures,
            events: Vec::new(),
            figures: None,
            spec: &named.spec,
        }
    }
}

fn text(named: &Named, summary: &Summary, timing: &Timing) -> String {
    let scenario = &named.spec.scenario;
    let mut table = Table::new(["figure", "value", "unit"]);
    let mut row = |name: &str, value: String, unit: &str| {
        table.row([name.to_owned(), value, unit.to_owned()]);
    };
    row(
        "least headway barrier",
        number(summary.min_h_headway_m.map(|h| 1e3 * h), 1),
        "mm",
    );
    row("least lane barrier", number(summary.min_h_lane, 4), "");
    row(
        "distance to the edge of the lane",
        number(1e3 * summary.lane_clearance_m, 1),
        "mm",
    );
    row(
        "largest deviation from the path",
        number(1e3 * summary.max_abs_lateral_m, 1),
        "mm",
    );
    row("mean speed", number(summary.mean_speed_mps, 3), "m/s");
    row(
        "mean speed, last 5 s",
        number(summary.final_speed_mps, 3),
        "m/s",
    );
    row("steps, optimal", summary.outcomes.optimal.to_string(), "");
    row("steps, relaxed", summary.outcomes.relaxed.to_string(), "");
    row("steps, braking", summary.outcomes.braking.to_string(), "");
    row("median step", number(timing.median_us, 2), "µs");
    row("99 % of steps within", number(timing.p99_us, 2), "µs");
    let verdict = match summary.first_unsafe_s {
        None => "safe: no robot left its lane or came too close".to_owned(),
        Some(time_s) => format!("UNSAFE from {time_s:.2} s on"),
    };
    format!(
        "{} on {}, {} robots, {} steps at {} Hz, seed {}\n\n{}\n{verdict}\n",
        scenario.name,
        scenario.testbed,
        scenario.robots.len(),
        summary.steps,
        scenario.rate_hz,
        named.spec.seed,
        table.render()
    )
}

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use testbed_io::{Campaign, CampaignReport, Disturbances, Tally, Violation, scenarios_of};
use unicycle_cbf::Testbed;

use super::scenario::{Disturbance, PresetName, TestbedName};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::output;
use crate::progress::Progress;
use crate::render::html;
use crate::render::json::Document;
use crate::render::table::{Table, number};

/// Thousands of seeded runs under disturbances, and which of them were unsafe
///
/// The runs are spread over the scenarios; every unsafe run is counted, and the first twenty of each kind are listed with the
/// command that repeats them. Exit code 1 says that there were some.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl campaign --runs 10000 --report campaign.html
  drivekit ctrl campaign --preset thesis,hardened --disturb none,noise,latency,drops,outages,mismatch,all
  drivekit ctrl campaign --testbed khepera --scenario decay --runs 2000 --seed 100000")]
pub(crate) struct CampaignArgs {
    /// Which robots; all if left out
    #[arg(long, value_enum, value_delimiter = ',')]
    testbed: Vec<TestbedName>,
    /// Scenarios by name; all if left out
    #[arg(long, value_delimiter = ',', value_name = "NAME")]
    scenario: Vec<String>,
    /// Settings of the controllers
    #[arg(long, value_enum, value_delimiter = ',', default_value = "hardened")]
    preset: Vec<PresetName>,
    /// Disturbances, each a row of the table
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "all",
        value_name = "GROUP"
    )]
    disturb: Vec<Disturbance>,
    /// Runs for each preset and group of disturbances
    #[arg(long, default_value_t = 1000, value_name = "N")]
    runs: usize,
    /// Length of each run, in s
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    duration: f64,
    /// Seed of the first run; the next ones count up
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
}

pub(crate) fn run(args: &CampaignArgs, context: &Context) -> anyhow::Result<Outcome> {
    if let Some(path) = &args.report {
        output::check_file_place(path)?;
    }
    let campaign = args.campaign()?;
    let work = campaign.runs * campaign.presets.len() * campaign.groups.len();
    let progress = Progress::new(context, "running", work);
    let report = campaign.run(&|| progress.step())?;
    drop(progress);
    let violations = report.violations.iter();
    let body = Body {
        seed: args.seed,
        duration_s: args.duration,
        report: &report,
        violations: violations.map(|v| Listed::new(v, args.duration)).collect(),
    };
    let document = Document::new("ctrl-campaign", args, &[], body);
    if let Some(path) = &args.report {
        let page = html::CAMPAIGN.filled(&serde_json::to_value(&document)?);
        output::write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
        output::note(context, &format!("report written to {}", path.display()));
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&report, &document.body.violations))?,
    }
    let safe = report
        .totals
        .iter()
        .all(|total| total.tally.violations == 0);
    Ok(if safe {
        Outcome::Done
    } else {
        Outcome::Negative
    })
}

impl CampaignArgs {
    fn campaign(&self) -> anyhow::Result<Campaign> {
        let testbeds: Vec<Testbed> = if self.testbed.is_empty() {
            Testbed::ALL.to_vec()
        } else {
            self.testbed.iter().map(|name| (*name).into()).collect()
        };
        anyhow::ensure!(self.runs > 0, "--runs has to be 1 or more");
        Ok(Campaign {
            scenarios: scenarios_of(&testbeds, &self.scenario)?,
            presets: self.preset.iter().map(|name| (*name).into()).collect(),
            groups: self.disturb.iter().map(|name| (*name).into()).collect(),
            runs: self.runs,
            duration_s: self.duration,
            seed: self.seed,
            disturbances: Disturbances::HARD,
        })
    }
}

#[derive(Serialize)]
struct Body<'a> {
    seed: u64,
    duration_s: f64,
    #[serde(flatten)]
    report: &'a CampaignReport,
    violations: Vec<Listed<'a>>,
}

/// A violation with the command that repeats it.
#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    violation: &'a Violation,
    command: String,
}

impl<'a> Listed<'a> {
    fn new(violation: &'a Violation, duration_s: f64) -> Self {
        let Violation {
            testbed,
            scenario,
            seed,
            ..
        } = violation;
        Self {
            violation,
            command: format!(
                "drivekit ctrl run --testbed {testbed} --scenario {scenario} --preset {} --disturb {} --seed {seed} --duration {duration_s}",
                violation.preset.name(),
                violation.disturbance.name()
            ),
        }
    }
}

const COLUMNS: [&str; 8] = [
    "runs",
    "out of lane",
    "too close",
    "least headway mm",
    "least clearance mm",
    "relaxed %",
    "braking %",
    "mean m/s",
];

fn cells(tally: &Tally) -> [String; COLUMNS.len()] {
    [
        tally.runs.to_string(),
        tally.lane_departures.to_string(),
        tally.headway_violations.to_string(),
        number(tally.min_h_headway_m.map(|h| 1e3 * h), 1),
        number(1e3 * tally.min_lane_clearance_m, 1),
        number(tally.relaxed_pct, 3),
        number(tally.braking_pct, 2),
        number(tally.mean_speed_mps, 3),
    ]
}

fn table(
    names: &[&str],
    rows: impl Iterator<Item = (Vec<String>, [String; COLUMNS.len()])>,
) -> String {
    let header = names.iter().chain(&COLUMNS).map(|name| (*name).to_owned());
    let mut table = Table::with_columns(header.collect());
    for (mut row, cells) in rows {
        row.extend(cells);
        table.add(row);
    }
    table.render()
}

fn text(report: &CampaignReport, violations: &[Listed]) -> String {
    let totals = report.totals.iter().map(|total| {
        let names = [total.preset.name(), total.disturbance.name()];
        (names.map(str::to_owned).to_vec(), cells(&total.tally))
    });
    let rows = report.rows.iter().map(|row| {
        let names = [
            row.preset.name(),
            row.disturbance.name(),
            row.testbed,
            &row.scenario,
        ];
        (names.map(str::to_owned).to_vec(), cells(&row.tally))
    });
    let listed: String = violations
        .iter()
        .map(|listed| format!("  {}\n", listed.command))
        .collect();
    let listed = if listed.is_empty() {
        "No run was unsafe.\n".to_owned()
    } else {
        format!("Unsafe runs, at most twenty of each kind:\n{listed}")
    };
    format!(
        "{}\n{}\n{listed}\n{} runs, {:.0} s simulated in {:.1} s: {:.0} s per s\n",
        table(&["preset", "disturbance"], totals),
        table(&["preset", "disturbance", "testbed", "scenario"], rows),
        report.runs,
        report.simulated_s,
        report.seconds,
        report.simulated_s_per_s
    )
}

use std::path::PathBuf;

use super::beyond;
use super::check;
use super::scenarios::{Wanted, is_path, shell_word};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::names::named;
use crate::numbers;
use crate::output;
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};
use crate::words::plural;
use clap::Args;
use report::terminal::{Table, number};
use serde::Serialize;
use testbed_sim::campaign::{Tally, Violation};
use testbed_sim::{Campaign, CampaignReport, Disturbances, Group, NamedScenario, SettingsOf};
use unicycle_cbf::{Demands, Preset, Scenario, Testbed};

/// Thousands of seeded runs under disturbances, and which of them were unsafe
///
/// The runs are spread over the scenarios; every unsafe run is counted, and the first twenty of each kind are listed with the
/// command that repeats them. Exit code 1 says that there were some.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl campaign --runs 10000 --report campaign.html
  drivekit ctrl campaign --preset thesis,hardened --disturb none,noise,latency,drops,outages,mismatch,all
  drivekit ctrl campaign --testbed khepera --scenario decay --runs 2000 --seed 100000
  drivekit ctrl campaign --scenario mine.toml others/ --preset hardened     files, and folders of them")]
pub(crate) struct CampaignArgs {
    /// Which robots of built-in scenarios; all if left out
    #[arg(long, value_parser = named::<Testbed>(), value_delimiter = ',')]
    testbed: Vec<Testbed>,
    /// Built-in scenarios by name, scenario files, and folders, which are searched to the bottom for files; every built-in scenario if
    /// left out
    #[arg(long, value_delimiter = ',', num_args = 1.., value_name = "NAME|FILE.toml|FOLDER")]
    scenario: Vec<String>,
    /// Settings of the controllers [default: hardened; scenario files as they are]
    #[arg(long, value_parser = named::<Preset>(), value_delimiter = ',')]
    preset: Vec<Preset>,
    /// Disturbances, each a row of the table
    #[arg(
        long,
        value_parser = named::<Group>(),
        value_delimiter = ',',
        default_value = "all",
        value_name = "GROUP"
    )]
    disturb: Vec<Group>,
    /// Runs for each preset and group of disturbances
    #[arg(long, default_value_t = 1000, value_parser = numbers::runs, value_name = "N")]
    runs: usize,
    /// Length of each run, in s [default: 60, or that of the file]
    #[arg(long, value_parser = numbers::run_duration_s, value_name = "S")]
    duration: Option<f64>,
    /// Seed of the first run; the next ones count up
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &CampaignArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/ctrl-campaign.txt"
    )))?;
    let (campaign, refused) = args.campaign(context)?;
    for refused in &refused {
        let Refused { scenario, reason } = refused;
        output::note(
            context,
            &format!("{scenario} is not run, it does not fit: {reason}"),
        );
    }
    if campaign.scenarios.is_empty() {
        return Ok(Outcome::Negative);
    }
    if campaign.idle() > 0 {
        let text = format!(
            "--runs {} is less than there are scenarios: {} are not run",
            campaign.runs,
            campaign.idle()
        );
        output::note(context, &text);
    }
    let progress = Progress::new(context, "running", campaign.work());
    let mut report = campaign.run(&|| progress.step())?;
    if context.no_times {
        (report.seconds, report.simulated_s_per_s) = (f64::NAN, f64::NAN);
    }
    drop(progress);
    let violations = report.violations.iter();
    let body = Body {
        seed: args.seed,
        duration_s: campaign.common_duration_s(),
        report: &report,
        refused,
        violations: violations.map(|v| Listed::new(v, args.duration)).collect(),
    };
    let inputs = FileInputs::read(campaign_files(&campaign))?;
    let mut document = Document::new("ctrl-campaign", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    if let Some(path) = &args.report {
        let page = report::CAMPAIGN.filled(&serde_json::to_value(&document)?);
        output::write_page(path, &page, context)?;
    }
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(
            &report,
            &document.body.violations,
            &document.body.refused,
        ))?,
    }
    let safe = report
        .totals
        .iter()
        .all(|total| total.tally.violations == 0);
    Ok(if safe { outcome } else { Outcome::Negative })
}

impl CampaignArgs {
    /// And what is left out of it.
    fn campaign(&self, context: &Context) -> anyhow::Result<(Campaign, Vec<Refused>)> {
        let wanted = Wanted {
            scenarios: &self.scenario,
            testbeds: &self.testbed,
            presets: &self.preset,
            duration_s: self.duration,
        };
        let (mut scenarios, mut refused) = (Vec::new(), Vec::new());
        for named in wanted.named(context)? {
            match check::fitting(&named.spec) {
                Ok(Err(reason)) => refused.push(Refused {
                    scenario: named.name,
                    reason,
                }),
                Ok(Ok(scenario)) => {
                    for text in self.notes(&named, &scenario) {
                        output::note(context, &format!("{}: {text}", named.name));
                    }
                    scenarios.push(named);
                }
                // Other errors are those of the campaign itself, by name.
                Err(_) => scenarios.push(named),
            }
        }
        let campaign = Campaign {
            scenarios,
            groups: self.disturb.clone(),
            runs: self.runs,
            seed: self.seed,
            disturbances: Disturbances::HARD,
        };
        Ok((campaign, refused))
    }

    /// What runs do otherwise than a file says, how many guards it lacks, and where disturbances are larger than it states.
    fn notes(&self, named: &NamedScenario, scenario: &Scenario) -> Vec<String> {
        let demands = Demands::new(scenario);
        let mut notes = Vec::new();
        if is_path(&named.name) {
            notes = check::notes(&named.spec, &demands);
            let missing = named.spec.controller.missing_guards().len();
            if missing > 0 {
                notes.push(format!(
                    "without {} nothing is guaranteed; `drivekit ctrl check` lists them",
                    plural(missing, "guard of the hardened preset")
                ));
            }
        }
        notes.extend(self.beyond(scenario, &demands));
        notes
    }

    fn beyond(&self, scenario: &Scenario, demands: &Demands) -> Option<String> {
        let stated = &scenario.spec().controller.hardening;
        let mut groups = self.disturb.iter();
        groups.find_map(|group| beyond::note(&Disturbances::HARD.only(*group), stated, demands))
    }
}

/// Each file once, also where it is run with several presets.
fn campaign_files(campaign: &Campaign) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for named in campaign
        .scenarios
        .iter()
        .filter(|named| is_path(&named.name))
    {
        let file = PathBuf::from(&named.name);
        if !files.contains(&file) {
            files.push(file);
        }
    }
    files
}

#[derive(Serialize)]
struct Body<'a> {
    seed: u64,
    duration_s: Option<f64>,
    #[serde(flatten)]
    report: &'a CampaignReport,
    /// Scenarios that no speed fits
    refused: Vec<Refused>,
    violations: Vec<Listed<'a>>,
}

#[derive(Serialize)]
struct Refused {
    scenario: String,
    reason: String,
}

/// A violation with the command that repeats it.
#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    violation: &'a Violation,
    command: String,
}

impl<'a> Listed<'a> {
    fn new(violation: &'a Violation, duration_s: Option<f64>) -> Self {
        let Violation {
            testbed,
            scenario,
            preset,
            seed,
            ..
        } = violation;
        let what = if is_path(scenario) {
            format!("--scenario {}", shell_word(scenario))
        } else {
            format!("--testbed {testbed} --scenario {scenario}")
        };
        let with = match preset {
            SettingsOf::File => String::new(),
            SettingsOf::Preset(preset) => format!(" --preset {}", preset.name()),
        };
        let long = duration_s.map_or_else(String::new, |s| format!(" --duration {s}"));
        let disturbance = violation.disturbance.name();
        Self {
            violation,
            command: format!(
                "drivekit ctrl run {what}{with} --disturb {disturbance} --seed {seed}{long}"
            ),
        }
    }
}

const COLUMNS: [&str; 10] = [
    "runs",
    "out of lane",
    "too close",
    "bodies too near",
    "least gap mm",
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
        tally.near_bodies.to_string(),
        number(tally.min_gap_m.map(|gap| 1e3 * gap), 1),
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

fn text(report: &CampaignReport, violations: &[Listed], refused: &[Refused]) -> String {
    let totals = report.totals.iter().map(|total| {
        let names = [total.preset.name(), total.disturbance.name()];
        (names.map(str::to_owned).to_vec(), cells(&total.tally))
    });
    let rows = report.rows.iter().map(|row| {
        let names = [
            row.preset.name(),
            row.disturbance.name(),
            &row.testbed,
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
    let refused = match refused.len() {
        0 => String::new(),
        count => format!(
            "Not run, as no speed fits: {}.\n",
            plural(count, "scenario")
        ),
    };
    format!(
        "{}\n{}\n{listed}{refused}\n{}, {:.0} s simulated in {} s: {} s per s\n",
        table(&["preset", "disturbance"], totals),
        table(&["preset", "disturbance", "testbed", "scenario"], rows),
        plural(report.runs, "run"),
        report.simulated_s,
        number(report.seconds, 1),
        number(report.simulated_s_per_s, 0)
    )
}

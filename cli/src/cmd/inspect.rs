use std::collections::BTreeMap;
use std::fmt::Write as _;

use clap::Args;
use drive_log::Drive;
use report::terminal::{Table, number};
use serde::Serialize;

use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::output;
use crate::render::json::{Document, Logs};
use crate::require::{KnownFigures, RequireArgs};
use crate::words::plural;

/// What is in a log, and what is wrong with it
///
/// Lists every channel with its range, and every finding with what was done about it: nothing is repaired silently.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit inspect drive.csv
  drivekit inspect logs/ --format json | jq '.inputs[].findings'
  drivekit inspect drive.csv --layout my-layout.toml")]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &InspectArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&KnownFigures::new(include_str!("../figures/inspect.txt")))?;
    let inputs = inputs::load_quietly(&args.logs, context)?;
    let logs = inputs.iter().map(|i| Entry::new(&i.drive)).collect();
    let mut document = Document::new("inspect", args, &inputs, Logs { logs });
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => {
            let texts: Vec<String> = inputs.iter().map(text).collect();
            output::print_text(&texts.join("\n"))?;
        }
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    origin: &'a BTreeMap<String, String>,
    duration_s: f64,
    distance_m: f64,
    pieces: Vec<Piece>,
    channels: Vec<drive_log::ChannelSummary>,
}

#[derive(Serialize)]
struct Piece {
    start_s: f64,
    end_s: f64,
    samples: usize,
}

impl<'a> Entry<'a> {
    fn new(drive: &'a Drive) -> Self {
        Self {
            name: &drive.name,
            origin: &drive.origin,
            duration_s: drive.duration_s(),
            distance_m: drive.distance_m(),
            pieces: drive
                .pieces
                .iter()
                .map(|log| Piece {
                    start_s: log.t0_s(),
                    end_s: log.time_s(log.len() - 1),
                    samples: log.len(),
                })
                .collect(),
            channels: drive.channel_summaries(),
        }
    }
}

fn text(input: &Input) -> String {
    let drive = &input.drive;
    let mut text = format!(
        "\u{1b}[1m{}\u{1b}[0m  {}\n{} samples at {} s ({} layout), {} s, {} km, {} after resampling\n\n",
        drive.name,
        input.path,
        drive.samples,
        number(drive.step_s, 3),
        input.layout,
        number(drive.duration_s(), 1),
        number(drive.distance_m() / 1e3, 2),
        plural(drive.pieces.len(), "piece"),
    );
    let mut table = Table::new(["channel", "min", "mean", "max", "missing %"]);
    for channel in drive.channel_summaries() {
        table.row([
            channel.channel.name().to_owned(),
            number(channel.min, 2),
            number(channel.mean, 2),
            number(channel.max, 2),
            number(channel.missing_pct, 1),
        ]);
    }
    text.push_str(&table.render());
    if drive.findings.is_empty() {
        text.push_str("\nno findings\n");
        return text;
    }
    let _ = writeln!(text, "\n{}", plural(drive.findings.len(), "finding"));
    for finding in &drive.findings {
        let _ = writeln!(
            text,
            "  {} … {} s  {}: {} – {} ({})",
            number(finding.from_s, 1),
            number(finding.to_s, 1),
            finding.channel,
            finding.kind,
            finding.detail,
            finding.action,
        );
    }
    text
}

//! `drivekit segment`: plain, compared (`--compare`) and live (`--follow`).

mod compare;
mod flags;
mod follow;
mod names;
mod output;

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use drive_log::DriveLog;
use driver_model::{Error, LeftOut, Segmented, Segmenter, StatisticalRules};
use rayon::prelude::*;
use serde::Serialize;

use crate::cmd::left_out;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::numbers;
use crate::output::{note, print_json, print_text, write_file};
use crate::progress::Progress;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};
use flags::MethodArgs;

pub(crate) use flags::refuse_idle;

/// Boundaries, phases and homogeneity figures
///
/// Cuts each drive into segments of like behaviour and says what the driver does in each. A drive with gaps counts as
/// one log per piece.
#[derive(Debug, Clone, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit segment drive.csv
  drivekit segment drive.csv --method heuristic --plot phases.svg
  drivekit segment drive.csv --merge mean --similarity 0.4,0.55
  drivekit segment logs/ --threshold 0.1 --window 150 --format json
  drivekit segment drive.csv --method dynamic --segments auto
  drivekit segment logs/ --compare --report compare.html
  logger | drivekit segment - --follow --format json")]
pub(crate) struct SegmentArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    method: MethodArgs,
    /// Only the first samples of each log [default: all; 3000 with --compare]
    #[arg(long, value_name = "SAMPLES", value_parser = numbers::samples)]
    first: Option<usize>,
    /// Draw speed with coloured phases
    #[arg(long, value_name = "FILE.svg")]
    #[serde(skip)]
    plot: Option<PathBuf>,
    /// Compare the methods as Table 3.5 of the thesis does: lengths, purity and time, without merging
    #[arg(long, conflicts_with_all = ["method", "cost", "stop", "refill", "merge", "similarity", "plot", "follow"], help_heading = "Comparison")]
    #[serde(skip)]
    compare: bool,
    /// Write one self-contained page with the comparison, and figures 3.3 to 3.10 for the first log
    #[arg(
        long,
        value_name = "FILE.html",
        requires = "compare",
        help_heading = "Comparison"
    )]
    #[serde(skip)]
    report: Option<PathBuf>,
    /// Segment canonical CSV from stdin while it is written, and print each segment when it has ended. Samples must be
    /// --step apart; a gap over --max-gap starts a new piece
    #[arg(long, conflicts_with_all = ["plot", "first", "require"], help_heading = "Streams")]
    #[serde(skip)]
    follow: bool,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    if args.follow {
        return follow::run(args, context);
    }
    let args = &SegmentArgs {
        method: args.method.resolved(StatisticalRules::default().scaling)?,
        ..args.clone()
    };
    if args.compare {
        return compare::run(args, context);
    }
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/segment.txt"
    )))?;
    let segmenter = args.method.segmenter()?;
    let inputs = inputs::load(&args.logs, context)?;
    let (logs, left_out) = long_enough(args.pieces(&inputs), &segmenter)?;
    left_out::mention(&left_out, context);
    let progress = Progress::new(context, "segmenting", logs.len());
    let segmented = logs
        .par_iter()
        .map(|log| {
            let part = progress.part();
            let segmented = segmenter
                .segment(log, &|share| {
                    part.at(share);
                    ControlFlow::Continue(())
                })
                .with_context(|| log.name().to_owned())?;
            part.at(1.0);
            Ok(segmented)
        })
        .collect::<anyhow::Result<Vec<Segmented>>>()?;
    drop(progress);
    if let Some(path) = &args.plot {
        let picture = output::plot(&logs, &segmented)?;
        write_file(path, |out| Ok(out.write_all(picture.as_bytes())?))?;
        note(context, &format!("picture written to {}", path.display()));
    }
    let entries = logs.iter().zip(&segmented);
    let body = output::Body {
        logs: entries.map(|(log, s)| output::Entry::new(log, s)).collect(),
        left_out_drives: &left_out,
    };
    let mut document = Document::new("segment", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => print_json(&document)?,
        Format::Text => print_text(&output::text(&inputs, &logs, &segmented))?,
    }
    Ok(inputs::outcome(&inputs).and(outcome))
}

/// Pieces of drives, as a segmentation sees them.
type Pieces<'a> = Vec<Cow<'a, DriveLog>>;

/// The pieces that have room for what was asked, and the others with the reason.
fn long_enough<'a>(
    pieces: Pieces<'a>,
    segmenter: &Segmenter,
) -> anyhow::Result<(Pieces<'a>, Vec<LeftOut>)> {
    let least = segmenter.least_samples();
    let (logs, short): (Vec<_>, Vec<_>) = pieces.into_iter().partition(|log| log.len() >= least);
    let left_out = |log: &Cow<'_, DriveLog>| LeftOut {
        log: log.name().to_owned(),
        reason: format!("less than {least} samples; ask for fewer or shorter segments"),
    };
    let left_out: Vec<LeftOut> = short.iter().map(left_out).collect();
    if logs.is_empty() {
        let task = "so many segments of this length";
        return Err(Error::NothingUsable { task, left_out }.into());
    }
    Ok((logs, left_out))
}

impl SegmentArgs {
    /// The pieces of all drives, each cut after `--first` samples.
    fn pieces<'a>(&self, inputs: &'a [Input]) -> Pieces<'a> {
        let cut = |log: &'a DriveLog| match self.first {
            Some(samples) => Cow::Owned(log.first(samples)),
            None => Cow::Borrowed(log),
        };
        let pieces = inputs.iter().flat_map(|input| &input.drive.pieces);
        pieces.map(cut).collect()
    }
}

use std::borrow::Cow;
use std::path::PathBuf;

use clap::Args;
use drive_log::DriveLog;
use serde::Serialize;

use super::flags::MethodArgs;
use crate::flags::LogArgs;
use crate::inputs::Input;
use crate::numbers;
use crate::require::RequireArgs;

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
    pub(super) logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) method: MethodArgs,
    /// Only the first samples of each log [default: all; 3000 with --compare]
    #[arg(long, value_name = "SAMPLES", value_parser = numbers::samples)]
    pub(super) first: Option<usize>,
    /// Draw speed with coloured phases
    #[arg(long, value_name = "FILE.svg")]
    #[serde(skip)]
    pub(super) plot: Option<PathBuf>,
    /// Compare the methods as Table 3.5 of the thesis does: lengths, purity and time, without merging
    #[arg(long, conflicts_with_all = ["method", "cost", "stop", "refill", "merge", "similarity", "plot", "follow"], help_heading = "Comparison")]
    #[serde(skip)]
    pub(super) compare: bool,
    /// Write one self-contained page with the comparison, and figures 3.3 to 3.10 for the first log
    #[arg(
        long,
        value_name = "FILE.html",
        requires = "compare",
        help_heading = "Comparison"
    )]
    #[serde(skip)]
    pub(super) report: Option<PathBuf>,
    /// Segment canonical CSV from stdin while it is written, and print each segment when it has ended. Samples must be
    /// --step apart; a gap over --max-gap starts a new piece
    #[arg(long, conflicts_with_all = ["plot", "first", "require"], help_heading = "Streams")]
    #[serde(skip)]
    pub(super) follow: bool,
    #[command(flatten)]
    #[serde(skip)]
    pub(super) require: RequireArgs,
}

/// Pieces of drives, as a segmentation sees them.
pub(super) type Pieces<'a> = Vec<Cow<'a, DriveLog>>;

impl SegmentArgs {
    /// The pieces of all drives, each cut after `--first` samples.
    pub(super) fn pieces<'a>(&self, inputs: &'a [Input]) -> Pieces<'a> {
        let cut = |log: &'a DriveLog| match self.first {
            Some(samples) => Cow::Owned(log.first(samples)),
            None => Cow::Borrowed(log),
        };
        let pieces = inputs.iter().flat_map(|input| &input.drive.pieces);
        pieces.map(cut).collect()
    }
}

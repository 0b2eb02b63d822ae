//! The command line as a whole: the subcommands and their help.

use clap::{Parser, Subcommand};

use crate::cmd;
use crate::flags::Global;

/// Driver models from recorded drives, and what driving costs in energy.
#[derive(Debug, Parser)]
#[command(
    name = "drivekit",
    version,
    propagate_version = true,
    max_term_width = 110
)]
#[command(after_help = "\
Examples:
  drivekit evaluate                         models of the driver of the built-in simulated drives
  drivekit evaluate logs/ --report out.html the same for your logs, with a page of pictures
  drivekit inspect drive.csv                what is in a log, and what is wrong with it

Exit codes: 0 done; 1 a threshold that you gave was missed; 2 an error.")]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// What is in a log, and what is wrong with it
    Inspect(cmd::inspect::InspectArgs),
    /// Boundaries, phases and homogeneity figures
    Segment(cmd::segment::SegmentArgs),
    /// Energy budget, against measured battery power where the log has it
    Energy(cmd::energy::EnergyArgs),
    /// Fit a vehicle to measured battery power
    Calibrate(cmd::calibrate::CalibrateArgs),
    /// Fit one model and write it to a file
    Fit(cmd::fit::FitArgs),
    /// Predict the acceleration phases of logs with a fitted model
    Predict(cmd::predict::PredictArgs),
    /// Leave-one-trip-out over models and baselines: the main job
    Evaluate(cmd::evaluate::EvaluateArgs),
    /// Simulated drives with known truth
    Synth(cmd::synth::SynthArgs),
    /// Built-in vehicles, vehicle files and single operating points
    #[command(subcommand)]
    Vehicle(cmd::vehicle::VehicleCommand),
    /// Print a completion script for a shell
    Completions(cmd::completions::CompletionsArgs),
    /// Print the manual page, or write one per subcommand
    Man(cmd::man::ManArgs),
}

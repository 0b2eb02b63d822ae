//! The command line as a whole: the subcommands and their help.

use clap::{Parser, Subcommand};

use crate::cmd;
use crate::flags::Global;

/// Driver models from recorded drives, what driving costs in energy, and safe controllers for robots.
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
  drivekit ctrl run --report run.html       robots that keep their lane and their distance

Exit codes: 0 done; 1 a threshold that you gave was missed, or a robot was unsafe; 2 an error.")]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Inspect(cmd::inspect::InspectArgs),
    Segment(cmd::segment::SegmentArgs),
    Energy(cmd::energy::EnergyArgs),
    Calibrate(cmd::calibrate::CalibrateArgs),
    Fit(cmd::fit::FitArgs),
    #[command(subcommand)]
    Model(cmd::model::ModelCommand),
    Predict(cmd::predict::PredictArgs),
    Evaluate(cmd::evaluate::EvaluateArgs),
    Portrait(cmd::portrait::PortraitArgs),
    Plan(cmd::plan::PlanArgs),
    Road(cmd::road::RoadArgs),
    Synth(cmd::synth::SynthArgs),
    #[command(subcommand)]
    Vehicle(cmd::vehicle::VehicleCommand),
    #[command(subcommand)]
    Ctrl(cmd::ctrl::CtrlCommand),
    Completions(cmd::completions::CompletionsArgs),
    Man(cmd::man::ManArgs),
}

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use driver_model::ModelKind;
use serde::Serialize;

use super::hold_out::HoldOutArgs;
use super::trajectory_args::TrajectoryArgs;
use crate::cmd::phases::PhaseArgs;
use crate::cmd::prior::PriorArgs;
use crate::cmd::vehicle_arg::VehicleArg;
use crate::flags::LogArgs;
use crate::names;
use crate::numbers;
use crate::require::RequireArgs;

/// Leave-one-out over models and baselines: the main job
///
/// Each drive is held out once; every model is fitted on the others and predicts the held-out acceleration and braking
/// phases from what it may know of them, and cruising and following where the logs have them. Without logs, the drives
/// are twelve simulated ones that come with the program.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit evaluate
  drivekit evaluate logs/ --vehicle bmw-i3-60ah --report report.html
  drivekit evaluate logs/*.csv --models inverse,profile-onset --format json > evaluation.json
  drivekit evaluate drivers/ --hold-out driver           drivers/anna/*.csv, drivers/ben/*.csv, …
  drivekit evaluate anna/ --prior others/ --learning-curve
  drivekit evaluate logs/ --task trajectory --models blend,svr-rbf --horizons 1,2,5,10
  drivekit evaluate logs/ --require 'profile.in_band_pct>=60' --require 'braking.profile.rmse_mps<=0.5'
                                                         exit code 1 if missed")]
pub(crate) struct EvaluateArgs {
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) phases: PhaseArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) prior: PriorArgs,
    /// What is predicted
    #[arg(long, value_enum, default_value_t = Task::Phases, value_name = "TASK")]
    pub(super) task: Task,
    /// Models to evaluate, comma separated [default: all of the task]; the baselines are always added
    #[arg(long, value_delimiter = ',', value_parser = names::evaluated_model(), hide_possible_values = true, value_name = "MODEL")]
    pub(super) models: Vec<ModelKind>,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) trajectory: TrajectoryArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) hold_out: HoldOutArgs,
    /// Also the error over the number of own trips that a model has seen
    #[arg(long)]
    pub(super) learning_curve: bool,
    /// Full width of the band around the measured speed, in km/h [default: 3 for phases, 5 for trips]
    #[arg(long, value_parser = numbers::width_kmh, value_name = "KM/H")]
    pub(super) band: Option<f64>,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) vehicle: VehicleArg,
    /// Write one self-contained page with tables and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    pub(super) report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    pub(super) require: RequireArgs,
}

/// What is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Task {
    /// Acceleration and braking phases, cruising and following
    Phases,
    /// The speed of the next seconds and of whole trips, from limits and own past
    Trajectory,
}

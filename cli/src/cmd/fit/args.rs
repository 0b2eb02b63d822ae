use std::path::PathBuf;

use clap::{Args, ValueEnum};
use driver_model::speed_ahead::DirectSettings;
use driver_model::{ModelKind, PhaseExtent};
use serde::Serialize;

use crate::cmd::phases::PhaseArgs;
use crate::cmd::prior::PriorArgs;
use crate::flags::LogArgs;
use crate::names;
use crate::numbers;
use crate::require::RequireArgs;

/// Fit one model and write it to a file
///
/// The model learns from the acceleration phases of the logs, or from their braking phases. With logs of other drivers
/// it learns from those, too, each of their phases with the prior weight. Models of cruising and following learn from
/// stretches of their own kind. A model of phases remembers all that it was fitted to, so that drives can be added later: the
/// model is then as if it were fitted to all of them.
#[derive(Debug, Clone, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit fit logs/ --model profile-onset -o driver.json
  drivekit fit logs/*.csv --model inverse -o inverse.json && drivekit predict new.csv --model inverse.json
  drivekit fit anna/ --prior others/ --prior-weight 0.33 --model profile-conditioned -o anna.json
  drivekit fit tuesday.csv --update anna.json -o anna.json            more drives for a model; those of before need not be there
  drivekit fit logs/ --model rise-time --phase braking -o braking.json
  drivekit fit logs/ --model profile-pedal --extent whole -o whole.json    phases from where they begin to where they end
  drivekit fit logs/ --model idm -o following.json
  drivekit fit logs/ --model svr-rbf --horizons 1,2,5,10 -o ahead.json && drivekit predict new.csv --model ahead.json --horizon 5
  drivekit fit logs/ --model trip-driver -o trips.json
  drivekit fit logs/ --model exponential --to samples -o all.json        the second row of Table 3.6")]
pub(crate) struct FitArgs {
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) phases: PhaseArgs,
    #[command(flatten)]
    #[serde(flatten)]
    pub(super) prior: PriorArgs,
    /// Model of phases: inverse, exponential, exponential-amplitude, rise-time, rise-time-exact, transition-point, profile, profile-conditioned,
    /// profile-onset, profile-pedal, or a baseline; of holding a speed: cruise; of following: idm, constant-time-gap; of the next seconds: svr-linear,
    /// svr-quadratic, svr-cubic, svr-rbf, least-squares, blend, ridge, boosted-trees; of whole trips: trip-driver
    #[arg(
        long,
        value_parser = names::fitted_model(),
        hide_possible_values = true,
        value_name = "KIND",
        required_unless_present = "update"
    )]
    pub(super) model: Option<ModelKind>,
    /// Add the logs to a model of phases that was fitted before; what it is, what it learns from and how other drivers count is as in its
    /// file, which -o may replace
    #[arg(
        long,
        value_name = "FILE.json",
        conflicts_with_all = ["model", "phase", "extent", "to", "horizons", "slope_ahead", "prior", "prior_weight"]
    )]
    pub(super) update: Option<PathBuf>,
    /// Phases to learn from
    #[arg(long, value_enum, default_value_t = Phase::Acceleration, value_name = "KIND")]
    pub(super) phase: Phase,
    /// How far those phases reach; `predict` takes them as the model's file says
    #[arg(long, value_parser = names::named::<PhaseExtent>(), default_value = "threshold", value_name = "EXTENT")]
    pub(super) extent: PhaseExtent,
    /// What a function of speed (inverse, exponential, exponential-amplitude) is fitted to
    #[arg(long, value_enum, default_value_t = Points::Means, value_name = "POINTS")]
    pub(super) to: Points,
    /// Seconds ahead of a model of the next seconds, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_parser = numbers::horizon_s, value_name = "S")]
    pub(super) horizons: Vec<f64>,
    /// Let a model of the next seconds know the slope ahead, if it does not come from the elevation of the same drive
    #[arg(long)]
    pub(super) slope_ahead: bool,
    /// File for the model
    #[arg(short, long, value_name = "FILE.json")]
    #[serde(skip)]
    pub(super) output: PathBuf,
    #[command(flatten)]
    #[serde(skip)]
    pub(super) require: RequireArgs,
    /// Names of the flags that the command line or `--config` has.
    #[arg(skip)]
    #[serde(skip)]
    pub(crate) given: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Phase {
    Acceleration,
    Braking,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Points {
    /// Means of segments
    Means,
    /// All samples of segments
    Samples,
}

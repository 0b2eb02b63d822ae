use clap::Args;
use driver_eval::speed_ahead::TrajectorySettings;
use driver_model::DriverChannel;
use driver_model::speed_ahead::DirectSettings;
use serde::Serialize;

use crate::{names, numbers};

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Trajectory")]
pub(super) struct TrajectoryArgs {
    /// Seconds ahead, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_parser = numbers::horizon_s, value_name = "S")]
    pub(super) horizons: Vec<f64>,
    /// Number of folds: every so many units are held out together
    #[arg(long, default_value_t = TrajectorySettings::default().folds, value_parser = numbers::folds, value_name = "N")]
    pub(super) folds: usize,
    /// Let models know the slope ahead. Not with elevation recorded on the same drive: its errors tell where the car stood
    #[arg(long)]
    pub(super) slope_ahead: bool,
    /// What models are told of the driver in rows marked `+channels`, as far as logs have it; all by default
    #[arg(long, value_delimiter = ',', value_parser = names::named::<DriverChannel>(), value_name = "CHANNEL")]
    pub(super) channels: Vec<DriverChannel>,
    /// Most training samples of a model
    #[arg(long, default_value_t = DirectSettings::default().max_samples, value_parser = numbers::samples, value_name = "N")]
    pub(super) max_samples: usize,
}

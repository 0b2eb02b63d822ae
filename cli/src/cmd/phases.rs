//! Flags that say which phases count, shared by `fit`, `predict` and `evaluate`.

use clap::Args;
use driver_model::{DriveBehaviour, PhaseSettings, find_behaviour};
use serde::Serialize;

use super::motions::motions;
use crate::flags::Context;
use crate::inputs::Input;
use crate::numbers;
use crate::progress::Progress;

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Phases")]
pub(crate) struct PhaseArgs {
    /// Shortest acceleration or braking phase that counts, in s
    #[arg(long, default_value_t = 3.0, value_parser = numbers::least_duration_s, value_name = "S")]
    pub(crate) min_duration: f64,
    /// Least change of speed of a phase that counts, in km/h
    #[arg(long, default_value_t = 10.0, value_parser = numbers::gain_kmh, value_name = "KM/H")]
    pub(crate) min_gain: f64,
    /// Acceleration under this magnitude counts as 0 in the segmentation, in m/s²
    #[arg(long, default_value_t = 0.4, value_parser = numbers::deadband_mps2, value_name = "M/S2")]
    pub(crate) accel_deadband: f64,
    /// Elevation is smoothed over this distance to either side for the slope, in m
    #[arg(long, default_value_t = ev_energy::DEFAULT_SLOPE_BANDWIDTH_M, value_parser = numbers::bandwidth_m, value_name = "M")]
    pub(crate) slope_bandwidth: f64,
}

impl PhaseArgs {
    pub(crate) fn settings(&self) -> PhaseSettings {
        let mut settings = PhaseSettings {
            min_duration_s: self.min_duration,
            min_gain_mps: self.min_gain / 3.6,
            ..PhaseSettings::default()
        };
        settings.statistical.accel_deadband_mps2 = self.accel_deadband;
        settings
    }

    /// Finds the phases of every drive, in parallel.
    pub(crate) fn trips(
        &self,
        inputs: &[Input],
        context: &Context,
    ) -> anyhow::Result<Vec<DriveBehaviour>> {
        let motions = motions(inputs, self.slope_bandwidth)?;
        let progress = Progress::new(context, "segmenting", inputs.len());
        Ok(find_behaviour(&motions, &self.settings(), &|| {
            progress.step();
        })?)
    }
}

/// A vehicle by name, or from a file where the argument ends in `.toml`.
pub(crate) fn vehicle(name: &str) -> anyhow::Result<ev_energy::Vehicle> {
    let vehicle = if name.ends_with(".toml") {
        ev_energy::Vehicle::read(std::path::Path::new(name))
    } else {
        ev_energy::Vehicle::builtin(name)
    };
    Ok(vehicle?)
}

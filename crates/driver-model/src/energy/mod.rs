//! Energy of drives: what the vehicle model says, and what was measured.

mod input;
mod score;
mod trace;

use drive_log::Channel;
use ev_energy::{
    OperatingPoint, TripEnergy, Vehicle,
    comparison::{Comparison, PowerAverager, PowerMean},
};
use serde::Serialize;

use crate::{Error, Motion, SlopeSource};
pub use input::EnergyInput;
pub use score::EnergyScore;
pub use trace::trace_csv;

/// Energy of a drive, model against measurement.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DriveEnergy {
    /// The vehicle model's energy over all pieces of the drive.
    #[serde(flatten)]
    pub modelled: TripEnergy,
    /// From the terminal energy; `None` without distance.
    pub consumption_kwh_per_100km: Option<f64>,
    /// Model against measurement, over the steps that have one.
    #[serde(flatten)]
    pub measured: Measured,
    /// The same, to be added up.
    #[serde(skip)]
    pub comparison: Comparison,
    /// Where the slope comes from and what it does.
    pub slope: SlopeEffect,
    /// Where the auxiliary power comes from.
    pub auxiliaries: Auxiliaries,
    /// Mean temperature of the air, °C, if the log has it.
    pub ambient_degc: Option<f64>,
    /// State of charge at the start, %, if the log has it.
    pub soc_start_pct: Option<f64>,
    /// Power over time, means over half a second.
    #[serde(skip)]
    pub curve: PowerCurve,
}

/// Model against measurement at the battery terminals; all `None` where nothing was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Measured {
    /// Volts times amps, J.
    pub measured_terminal_energy_j: Option<f64>,
    /// Model minus measurement, %.
    pub error_pct: Option<f64>,
    /// Root mean square of model minus measured power, each a mean over half a second, W.
    pub power_rmse_w: Option<f64>,
}

impl From<&Comparison> for Measured {
    fn from(comparison: &Comparison) -> Self {
        Self {
            measured_terminal_energy_j: (!comparison.is_empty()).then_some(comparison.measured_j),
            error_pct: comparison.error_pct(),
            power_rmse_w: comparison.power_rmse_w(),
        }
    }
}

/// What the slope does to the energy of a drive.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct SlopeEffect {
    /// Where it comes from; of a drive in pieces, in the first of them.
    pub source: SlopeSource,
    /// Terminal energy with it minus that on a level road, J.
    pub energy_j: f64,
}

/// Auxiliary power of a drive.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Auxiliaries {
    /// The vehicle's constant, and the channels of the log on top.
    pub source: String,
    /// Mean over the drive, W; `None` for a drive without a step.
    pub mean_w: Option<f64>,
}

/// Energy of several drives with one vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergyTotals {
    /// Number of drives.
    pub trips: usize,
    /// Sum of the vehicle model's energies.
    #[serde(flatten)]
    pub modelled: TripEnergy,
    /// From the terminal energy; `None` without distance.
    pub consumption_kwh_per_100km: Option<f64>,
    /// Volts times amps, J; `None` where nothing was measured.
    pub measured_terminal_energy_j: Option<f64>,
    /// Error of the sum, %.
    pub error_pct: Option<f64>,
    /// Mean over the drives of the magnitude of their error, %.
    pub mean_abs_error_pct: Option<f64>,
    /// Median over the drives of the root mean square of the power's error, W.
    pub median_power_rmse_w: Option<f64>,
    /// Terminal energy minus that on level roads, J.
    pub slope_energy_j: f64,
}

impl EnergyTotals {
    /// Sums drives up.
    #[must_use]
    pub fn of(drives: &[&DriveEnergy]) -> Self {
        let mut modelled = TripEnergy::default();
        for drive in drives {
            modelled += drive.modelled;
        }
        // Drives do not follow each other.
        modelled.soc_end_pct = None;
        let comparisons: Vec<Comparison> = drives
            .iter()
            .map(|drive| drive.comparison)
            .filter(|comparison| !comparison.is_empty())
            .collect();
        let score = EnergyScore::of(&comparisons);
        Self {
            trips: drives.len(),
            consumption_kwh_per_100km: modelled.consumption_kwh_per_100km(),
            modelled,
            measured_terminal_energy_j: (!comparisons.is_empty()).then(|| {
                comparisons
                    .iter()
                    .map(|comparison| comparison.measured_j)
                    .sum()
            }),
            error_pct: score.total_error_pct,
            mean_abs_error_pct: score.mean_abs_error_pct,
            median_power_rmse_w: score.median_power_rmse_w,
            slope_energy_j: drives.iter().map(|drive| drive.slope.energy_j).sum(),
        }
    }
}

/// Power over time, a value per mean, rounded to more than a picture shows.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PowerCurve {
    /// Time at the start of the mean, s.
    pub time_s: Vec<f64>,
    /// Speed, m/s.
    pub speed_mps: Vec<f64>,
    /// By the model, W.
    pub modelled_w: Vec<f64>,
    /// Measured, W.
    pub measured_w: Vec<Option<f64>>,
}

impl PowerCurve {
    fn add(&mut self, mean: &PowerMean, time_s: f64) {
        let thousandths = |value: f64| (value * 1e3).round() / 1e3;
        self.time_s.push(thousandths(time_s));
        self.speed_mps.push(thousandths(mean.speed_mps));
        self.modelled_w.push(mean.modelled_w.round());
        self.measured_w.push(mean.measured_w.map(f64::round));
    }
}

/// Everything about one step of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyStep {
    /// Time at the start of the step.
    pub time_s: f64,
    /// The vehicle model's terms.
    pub point: OperatingPoint,
    /// Measured terminal power, mean of the two samples.
    pub measured_power_w: Option<f64>,
}

/// Calls `visit` with every step of a drive, given piece by piece.
///
/// Auxiliary power is the vehicle's constant plus the log's auxiliary and heating power where it has them. The state of charge is
/// followed from the log's first one. The start of the log is taken for a cold start, which matters to a vehicle with a warm-up.
///
/// # Errors
/// [`Error::Energy`] for samples outside the vehicle model's range.
pub fn drive_energy(
    motions: &[Motion],
    vehicle: &Vehicle,
    visit: &mut dyn FnMut(&EnergyStep),
) -> Result<DriveEnergy, Error> {
    let mut total = DriveEnergy::default();
    let mut comparison = Comparison::default();
    let inputs = EnergyInput::of_drive(motions);
    for (index, (motion, input)) in motions.iter().zip(inputs).enumerate() {
        let log = motion.log();
        if index == 0 {
            total.slope.source = motion.slope_source();
            total.auxiliaries.source = aux_source(vehicle, &input.aux_channels);
            total.ambient_degc = input.weather.map(|weather| weather.temperature_degc);
            total.soc_start_pct = input.soc_start_pct;
        }
        let mut averager = PowerAverager::new(log.step_s());
        let mut step = 0;
        let mut mean_start_s = log.t0_s();
        let mut keep = |mean: &PowerMean| {
            comparison.add(mean);
            total.curve.add(mean, mean_start_s);
            mean_start_s += mean.duration_s;
        };
        let energy = vehicle.trip_energy_with(&input.trip(), |point| {
            let measured_w = input.power_w[step];
            averager.add(point, measured_w, &mut keep);
            visit(&EnergyStep {
                time_s: log.time_s(step),
                point: *point,
                measured_power_w: Some(measured_w).filter(|power| power.is_finite()),
            });
            step += 1;
        });
        let energy = energy.map_err(|error| Error::from(error).in_log(log.name()))?;
        averager.finish(&mut keep);
        total.slope.energy_j += input.slope_energy_j(vehicle, energy.terminal_energy_j)?;
        total.modelled += energy;
    }
    total.consumption_kwh_per_100km = total.modelled.consumption_kwh_per_100km();
    total.measured = Measured::from(&comparison);
    total.comparison = comparison;
    let duration_s = total.modelled.duration_s;
    total.auxiliaries.mean_w =
        (duration_s > 0.0).then(|| total.modelled.budget.auxiliary_j / duration_s);
    Ok(total)
}

fn aux_source(vehicle: &Vehicle, channels: &[Channel]) -> String {
    let mut source = format!("base {} W", vehicle.spec().auxiliary_power_w.round());
    for channel in channels {
        source.push_str(" + ");
        source.push_str(channel.name());
    }
    source
}

/// Battery energy of driving at these speeds over these slopes, `step_s` apart. Backward counts as standing.
///
/// # Errors
/// [`Error::Energy`] for what the vehicle cannot have driven.
pub fn driving_energy_j(
    vehicle: &Vehicle,
    step_s: f64,
    speed_mps: &[f64],
    slope_rad: Option<&[f64]>,
) -> Result<f64, Error> {
    let forward: Vec<f64> = speed_mps.iter().map(|v| v.max(0.0)).collect();
    let energy = vehicle.trip_energy(&ev_energy::Trip {
        step_s,
        speed_mps: &forward,
        slope_rad,
        ..ev_energy::Trip::default()
    })?;
    Ok(energy.battery_energy_j)
}

use drive_log::{Channel, Drive, DriveLog};
use ev_energy::{OperatingPoint, TripEnergy, Vehicle};
use serde::Serialize;

use crate::{Error, slope_rad};

/// Energy of a drive, model against measurement.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct DriveEnergy {
    /// The vehicle model's energy over all pieces of the drive.
    #[serde(flatten)]
    pub modelled: TripEnergy,
    /// From the terminal energy; `None` without distance.
    pub consumption_kwh_per_100km: Option<f64>,
    /// Volts times amps over the steps that have both; `None` where the log has no battery channels.
    pub measured_terminal_energy_j: Option<f64>,
    /// Model against measurement on the steps that have one.
    pub error_pct: Option<f64>,
    /// Root mean square of model minus measured terminal power, per step.
    pub power_rmse_w: Option<f64>,
}

/// Everything about one step of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyStep {
    /// Time at the start of the step.
    pub time_s: f64,
    /// Acceleration over the step.
    pub accel_mps2: f64,
    /// The vehicle model's terms.
    pub point: OperatingPoint,
    /// Measured terminal power, mean of the two samples.
    pub measured_power_w: Option<f64>,
}

/// Calls `visit` with every step of a drive, piece by piece.
///
/// Auxiliary power is the vehicle's constant plus the log's auxiliary and heating power where it has them.
///
/// # Errors
/// [`Error::Energy`] for samples outside the vehicle model's range.
pub fn drive_energy(
    drive: &Drive,
    vehicle: &Vehicle,
    slope_bandwidth_m: f64,
    mut visit: impl FnMut(&EnergyStep),
) -> Result<DriveEnergy, Error> {
    let mut total = DriveEnergy::default();
    let mut comparison = Comparison::default();
    for log in &drive.pieces {
        let slope = slope_rad(log, slope_bandwidth_m)?;
        let aux = auxiliary_power_w(log, vehicle);
        let trip = ev_energy::Trip {
            step_s: log.step_s(),
            speed_mps: log.speed_mps(),
            slope_rad: slope.as_deref(),
            aux_power_w: aux.as_deref(),
        };
        total.modelled += vehicle.trip_energy(&trip)?;
        let power_w = terminal_power_w(log);
        let accel = log.accel_mps2();
        for (k, point) in vehicle.trip_points(&trip)?.enumerate() {
            let measured_power_w = power_w
                .as_deref()
                .map(|p| 0.5 * (p[k] + p[k + 1]))
                .filter(|p| p.is_finite());
            if let Some(measured_w) = measured_power_w {
                comparison.add(point.terminal_power_w, measured_w, log.step_s());
            }
            visit(&EnergyStep {
                time_s: log.time_s(k),
                accel_mps2: accel[k],
                point,
                measured_power_w,
            });
        }
    }
    total.consumption_kwh_per_100km = total.modelled.consumption_kwh_per_100km();
    comparison.finish(&mut total);
    Ok(total)
}

fn auxiliary_power_w(log: &DriveLog, vehicle: &Vehicle) -> Option<Vec<f64>> {
    let recorded: Vec<&[f64]> = [Channel::AuxPower, Channel::HeatingPower]
        .into_iter()
        .filter_map(|channel| log.channel(channel))
        .collect();
    if recorded.is_empty() {
        return None;
    }
    let constant_w = vehicle.spec().auxiliary_power_w;
    let known = |value: f64| if value.is_finite() { value } else { 0.0 };
    Some(
        (0..log.len())
            .map(|k| {
                constant_w
                    + recorded
                        .iter()
                        .map(|channel| known(channel[k]))
                        .sum::<f64>()
            })
            .collect(),
    )
}

fn terminal_power_w(log: &DriveLog) -> Option<Vec<f64>> {
    let voltage = log.channel(Channel::BatteryVoltage)?;
    let current = log.channel(Channel::BatteryCurrent)?;
    Some(voltage.iter().zip(current).map(|(u, i)| u * i).collect())
}

#[derive(Default)]
struct Comparison {
    steps: usize,
    modelled_j: f64,
    measured_j: f64,
    squared_w2: f64,
}

impl Comparison {
    fn add(&mut self, modelled_w: f64, measured_w: f64, step_s: f64) {
        self.steps += 1;
        self.modelled_j += modelled_w * step_s;
        self.measured_j += measured_w * step_s;
        self.squared_w2 += (modelled_w - measured_w).powi(2);
    }

    fn finish(self, total: &mut DriveEnergy) {
        if self.steps == 0 {
            return;
        }
        total.measured_terminal_energy_j = Some(self.measured_j);
        total.power_rmse_w = Some((self.squared_w2 / self.steps as f64).sqrt());
        total.error_pct = (self.measured_j != 0.0)
            .then(|| 100.0 * (self.modelled_j - self.measured_j) / self.measured_j.abs());
    }
}

//! What the vehicle model needs of a drive, from what the log has.

use drive_log::{Channel, DriveLog};
use ev_energy::{CellState, Trip, Vehicle, Weather};

use crate::{Error, Motion};

/// What a vehicle model takes from a piece of a drive.
#[derive(Debug, Clone)]
pub struct EnergyInput<'a> {
    motion: &'a Motion,
    extra_aux_power_w: Option<Vec<f64>>,
    /// The channels of which the auxiliary power is made.
    pub aux_channels: Vec<Channel>,
    /// Of the air, where the log has it.
    pub weather: Option<Weather>,
    /// State of charge at the start, %, where the log has it.
    pub soc_start_pct: Option<f64>,
    /// Cells of the battery, where the log has their temperature.
    pub cells: Option<CellState>,
    /// Time from the start of the drive, which is taken for a cold start, to the first sample, s.
    pub since_start_s: f64,
    /// Measured at the terminals, per step, W; NaN where there is none.
    pub power_w: Vec<f64>,
    /// Measured at the motor shaft, per step, N m; NaN where there is none.
    pub motor_torque_nm: Vec<f64>,
}

impl<'a> EnergyInput<'a> {
    /// Of every piece of a drive. How long the car stood before is not known: the drive is taken to start cold.
    pub fn of_drive(motions: &'a [Motion]) -> impl Iterator<Item = Self> {
        let start_s = motions.first().map_or(0.0, |first| first.log().t0_s());
        motions.iter().map(move |motion| Self::of(motion, start_s))
    }

    fn of(motion: &'a Motion, start_s: f64) -> Self {
        let log = motion.log();
        let soc_start_pct = soc_start_pct(log);
        let aux_channels: Vec<Channel> = [Channel::AuxPower, Channel::HeatingPower]
            .into_iter()
            .filter(|channel| log.channel(*channel).is_some())
            .collect();
        Self {
            motion,
            extra_aux_power_w: extra_aux_power_w(log, &aux_channels),
            aux_channels,
            weather: weather(log),
            soc_start_pct,
            cells: mean(log, Channel::BatteryTemperature).map(|temperature_degc| CellState {
                temperature_degc,
                soc_pct: soc_start_pct,
            }),
            since_start_s: (log.t0_s() - start_s).max(0.0),
            power_w: terminal_power_w(log),
            motor_torque_nm: motor_torque_nm(log),
        }
    }

    /// The motion, for a vehicle model.
    #[must_use]
    pub fn trip(&self) -> Trip<'_> {
        Trip {
            step_s: self.motion.step_s(),
            speed_mps: self.motion.speed_mps(),
            slope_rad: self.motion.slope_rad(),
            extra_aux_power_w: self.extra_aux_power_w.as_deref(),
            weather: self.weather,
            soc_start_pct: self.soc_start_pct,
            since_cold_start_s: Some(self.since_start_s),
            cells: self.cells,
        }
    }

    /// Terminal energy of a vehicle minus that on the same motion without slope, J.
    pub(crate) fn slope_energy_j(&self, vehicle: &Vehicle, energy_j: f64) -> Result<f64, Error> {
        if self.motion.slope_rad().is_none() {
            return Ok(0.0);
        }
        let level = Trip {
            slope_rad: None,
            ..self.trip()
        };
        Ok(energy_j - vehicle.trip_energy(&level)?.terminal_energy_j)
    }
}

fn extra_aux_power_w(log: &DriveLog, channels: &[Channel]) -> Option<Vec<f64>> {
    let recorded: Vec<&[f64]> = channels
        .iter()
        .filter_map(|channel| log.channel(*channel))
        .collect();
    let known = |value: f64| if value.is_finite() { value } else { 0.0 };
    let sum = |k: usize| recorded.iter().map(|values| known(values[k])).sum();
    (!recorded.is_empty()).then(|| (0..log.len()).map(sum).collect())
}

/// Mean temperature and elevation; at sea level where the log has no elevation.
fn weather(log: &DriveLog) -> Option<Weather> {
    Some(Weather {
        temperature_degc: mean(log, Channel::AmbientTemperature)?,
        elevation_m: mean(log, Channel::Elevation).unwrap_or(0.0),
    })
}

/// Of the values that there are.
fn mean(log: &DriveLog, channel: Channel) -> Option<f64> {
    let values = log
        .channel(channel)?
        .iter()
        .filter(|value| value.is_finite());
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

fn soc_start_pct(log: &DriveLog) -> Option<f64> {
    let soc_pct = log.channel(Channel::StateOfCharge)?;
    let first = soc_pct.iter().find(|soc| soc.is_finite())?;
    // An estimate may overshoot.
    Some(first.clamp(0.0, 100.0))
}

fn terminal_power_w(log: &DriveLog) -> Vec<f64> {
    let channels = log
        .channel(Channel::BatteryVoltage)
        .zip(log.channel(Channel::BatteryCurrent));
    let Some((voltage_v, current_a)) = channels else {
        return vec![f64::NAN; log.len() - 1];
    };
    let power_w = |k: usize| voltage_v[k] * current_a[k];
    per_step(log.len(), power_w)
}

fn motor_torque_nm(log: &DriveLog) -> Vec<f64> {
    let torque_nm = log.channel(Channel::MotorTorque);
    per_step(log.len(), |k| {
        torque_nm.map_or(f64::NAN, |torque| torque[k])
    })
}

/// Means of the two samples of every step.
fn per_step(samples: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
    (1..samples)
        .map(|k| 0.5 * (value(k - 1) + value(k)))
        .collect()
}

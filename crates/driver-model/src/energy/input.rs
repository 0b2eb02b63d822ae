//! What the vehicle model needs of a drive, from what the log has.

use drive_log::{Channel, DriveLog};
use ev_energy::{Trip, Vehicle, Weather};

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
    /// Measured at the terminals, per step, W; NaN where there is none.
    pub power_w: Vec<f64>,
}

impl<'a> EnergyInput<'a> {
    /// From the channels of its log.
    #[must_use]
    pub fn of(motion: &'a Motion) -> Self {
        let log = motion.log();
        let aux_channels: Vec<Channel> = [Channel::AuxPower, Channel::HeatingPower]
            .into_iter()
            .filter(|channel| log.channel(*channel).is_some())
            .collect();
        Self {
            motion,
            extra_aux_power_w: extra_aux_power_w(log, &aux_channels),
            aux_channels,
            weather: weather(log),
            soc_start_pct: soc_start_pct(log),
            power_w: terminal_power_w(log),
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
    let mean = |channel| {
        let values = log
            .channel(channel)?
            .iter()
            .filter(|value| value.is_finite());
        let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    };
    Some(Weather {
        temperature_degc: mean(Channel::AmbientTemperature)?,
        elevation_m: mean(Channel::Elevation).unwrap_or(0.0),
    })
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
    (1..log.len())
        .map(|k| 0.5 * (power_w(k - 1) + power_w(k)))
        .collect()
}

//! What the vehicle model needs of a drive, from what the log has.

use drive_log::{Channel, DriveLog};
use ev_energy::{Trip, Vehicle, Weather, slope_from_accelerometer, slope_from_elevation};
use serde::{Serialize, Serializer};

use crate::Error;

/// Where the slope of a drive comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlopeSource {
    /// The log has it.
    Recorded,
    /// Accelerometer over short distances, elevation over long ones.
    ElevationAndAccelerometer,
    /// Accelerometer; level over long distances.
    Accelerometer,
    /// Elevation.
    Elevation,
    /// Nothing: a level road.
    #[default]
    Level,
}

impl SlopeSource {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::ElevationAndAccelerometer => "elevation and accelerometer",
            Self::Accelerometer => "accelerometer",
            Self::Elevation => "elevation",
            Self::Level => "level",
        }
    }
}

impl Serialize for SlopeSource {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Slope at every sample of a drive, `None` for a level road: as recorded, else from accelerometer and elevation as far as the log
/// has them. Unknown stretches count as level.
///
/// # Errors
/// [`Error::Energy`] for a bandwidth out of range.
pub fn slope_rad(log: &DriveLog, bandwidth_m: f64) -> Result<Option<Vec<f64>>, Error> {
    Ok(slope(log, bandwidth_m)?.1)
}

/// As [`slope_rad`], with where it comes from; an error names the log.
fn slope(log: &DriveLog, bandwidth_m: f64) -> Result<(SlopeSource, Option<Vec<f64>>), Error> {
    found_slope(log, bandwidth_m).map_err(|error| error.in_log(log.name()))
}

fn found_slope(log: &DriveLog, bandwidth_m: f64) -> Result<(SlopeSource, Option<Vec<f64>>), Error> {
    let elevation_m = log.channel(Channel::Elevation);
    if let Some(slope_rad) = log.channel(Channel::Slope) {
        let known = |slope: &f64| if slope.is_finite() { *slope } else { 0.0 };
        let slope_rad = slope_rad.iter().map(known).collect();
        return Ok((SlopeSource::Recorded, Some(slope_rad)));
    }
    if let Some(accelerometer_mps2) = log.channel(Channel::Accelerometer) {
        let source = match elevation_m {
            Some(_) => SlopeSource::ElevationAndAccelerometer,
            None => SlopeSource::Accelerometer,
        };
        let slope_rad = slope_from_accelerometer(
            log.step_s(),
            log.speed_mps(),
            accelerometer_mps2,
            elevation_m,
            bandwidth_m,
        )?;
        return Ok((source, Some(slope_rad)));
    }
    let Some(elevation_m) = elevation_m else {
        return Ok((SlopeSource::Level, None));
    };
    let slope_rad = slope_from_elevation(&log.place_m(), elevation_m, bandwidth_m)?;
    Ok((SlopeSource::Elevation, Some(slope_rad)))
}

/// What a vehicle model takes from a piece of a drive.
#[derive(Debug, Clone)]
pub(crate) struct EnergyInput<'a> {
    log: &'a DriveLog,
    slope_rad: Option<Vec<f64>>,
    pub(crate) slope_source: SlopeSource,
    extra_aux_power_w: Option<Vec<f64>>,
    /// The channels of which the auxiliary power is made.
    pub(crate) aux_channels: Vec<Channel>,
    pub(crate) weather: Option<Weather>,
    pub(crate) soc_start_pct: Option<f64>,
    /// Measured at the terminals, per step, W; NaN where there is none.
    pub(crate) power_w: Vec<f64>,
}

impl<'a> EnergyInput<'a> {
    pub(crate) fn of(log: &'a DriveLog, slope_bandwidth_m: f64) -> Result<Self, Error> {
        let aux_channels: Vec<Channel> = [Channel::AuxPower, Channel::HeatingPower]
            .into_iter()
            .filter(|channel| log.channel(*channel).is_some())
            .collect();
        let (slope_source, slope_rad) = slope(log, slope_bandwidth_m)?;
        Ok(Self {
            log,
            slope_rad,
            slope_source,
            extra_aux_power_w: extra_aux_power_w(log, &aux_channels),
            aux_channels,
            weather: weather(log),
            soc_start_pct: soc_start_pct(log),
            power_w: terminal_power_w(log),
        })
    }

    /// The motion, for a vehicle model.
    pub(crate) fn trip(&self) -> Trip<'_> {
        Trip {
            step_s: self.log.step_s(),
            speed_mps: self.log.speed_mps(),
            slope_rad: self.slope_rad.as_deref(),
            extra_aux_power_w: self.extra_aux_power_w.as_deref(),
            weather: self.weather,
            soc_start_pct: self.soc_start_pct,
        }
    }

    /// Terminal energy of a vehicle minus that on the same motion without slope, J.
    pub(crate) fn slope_energy_j(&self, vehicle: &Vehicle, energy_j: f64) -> Result<f64, Error> {
        if self.slope_rad.is_none() {
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

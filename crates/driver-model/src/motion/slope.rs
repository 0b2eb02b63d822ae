use drive_log::{Channel, DriveLog};
use ev_energy::{slope_from_accelerometer, slope_from_elevation};
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

/// Slope at every sample, with where it comes from; `None` for a level road.
pub(super) fn of_log(
    log: &DriveLog,
    bandwidth_m: f64,
) -> Result<(SlopeSource, Option<Vec<f64>>), Error> {
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

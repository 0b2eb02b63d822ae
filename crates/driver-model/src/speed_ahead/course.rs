use drive_log::{Channel, DriveLog};

use crate::Error;
use crate::energy::slope_rad;

/// A drive without a break, as predictions of speed see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Name of the drive.
    pub name: String,
    /// Sampling interval.
    pub step_s: f64,
    /// Measured speed.
    pub speed_mps: Vec<f64>,
    /// Distance from the start.
    pub distance_m: Vec<f64>,
    /// Speed limit where the vehicle is; a missing value is the one before. `None` where the log has none at all.
    pub limit_mps: Option<Vec<f64>>,
    /// Slope where the vehicle is.
    pub slope_rad: Option<Vec<f64>>,
}

impl Course {
    /// Takes what predictions need from a log; elevation is smoothed over `slope_bandwidth_m` to either side.
    ///
    /// # Errors
    /// Whatever computing the slope refuses.
    pub fn of_log(log: &DriveLog, slope_bandwidth_m: f64) -> Result<Self, Error> {
        Ok(Self {
            name: log.name().to_owned(),
            step_s: log.step_s(),
            speed_mps: log.speed_mps().to_vec(),
            distance_m: log.distance_m(),
            limit_mps: log.channel(Channel::SpeedLimit).and_then(held),
            slope_rad: slope_rad(log, slope_bandwidth_m)?,
        })
    }

    /// Number of samples.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a log is never empty")]
    pub fn len(&self) -> usize {
        self.speed_mps.len()
    }

    /// Samples in this many seconds, at least one.
    #[must_use]
    pub fn samples_in(&self, seconds: f64) -> usize {
        ((seconds / self.step_s).round() as usize).max(1)
    }
}

/// The values with gaps filled by what came before, or by the first value at the start. `None` without any value.
fn held(values: &[f64]) -> Option<Vec<f64>> {
    let mut last = *values.iter().find(|value| value.is_finite())?;
    let hold = values.iter().map(|&value| {
        if value.is_finite() {
            last = value;
        }
        last
    });
    Some(hold.collect())
}

//! A drive as models see it, made once from its log.

mod limit;
mod slope;

use std::collections::BTreeMap;
use std::sync::Arc;

use drive_log::{Channel, Drive, DriveLog, Preparation, RawLog};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

use crate::Error;
pub use limit::LimitCover;
pub use slope::SlopeSource;

/// A drive without a break: its log, and what models ask of it besides. A clone shares all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    drive: Arc<str>,
    log: DriveLog,
    distance_m: Arc<[f64]>,
    limit_mps: Option<Arc<[f64]>>,
    limit_cover: Option<LimitCover>,
    slope_source: SlopeSource,
    slope_rad: Option<Arc<[f64]>>,
}

impl Motion {
    /// Of one log; elevation is smoothed over `slope_bandwidth_m` to either side before it gives a slope, by default
    /// [`DEFAULT_SLOPE_BANDWIDTH_M`].
    ///
    /// # Errors
    /// [`Error::Energy`] for a bandwidth out of range, in [`Error::InLog`].
    pub fn of_log(log: &DriveLog, slope_bandwidth_m: f64) -> Result<Self, Error> {
        Self::of_piece(log.name().into(), log, slope_bandwidth_m)
    }

    /// Of every piece of a drive.
    ///
    /// # Errors
    /// As [`of_log`](Self::of_log).
    pub fn of_drive(drive: &Drive, slope_bandwidth_m: f64) -> Result<Vec<Self>, Error> {
        let name: Arc<str> = drive.name.as_str().into();
        let pieces = drive.pieces.iter();
        pieces
            .map(|log| Self::of_piece(Arc::clone(&name), log, slope_bandwidth_m))
            .collect()
    }

    /// Of speed over time alone, which is checked, resampled and smoothed as [`drive_log::prepare`] does by default.
    ///
    /// ```
    /// # use driver_model::Motion;
    /// let time_s: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.1).collect();
    /// let speed_mps: Vec<f64> = time_s.iter().map(|t| 10.0 - 10.0 * (t * 0.2).cos()).collect();
    /// let motion = Motion::from_samples("anna", &time_s, &speed_mps)?;
    /// assert_eq!(motion.len(), 600);
    /// # Ok::<(), driver_model::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Log`] for what is no recording of a speed, [`Error::Broken`] where it has no value for longer than 2 s.
    pub fn from_samples(name: &str, time_s: &[f64], speed_mps: &[f64]) -> Result<Self, Error> {
        let channels = BTreeMap::from([(Channel::Speed, speed_mps.to_vec())]);
        let raw = RawLog::new(name, time_s.to_vec(), channels)?;
        let drive = drive_log::prepare(raw, &Preparation::default())?;
        match &drive.pieces[..] {
            [log] => Self::of_log(log, DEFAULT_SLOPE_BANDWIDTH_M),
            pieces => Err(Error::Broken {
                log: name.to_owned(),
                pieces: pieces.len(),
            }),
        }
    }

    fn of_piece(drive: Arc<str>, log: &DriveLog, slope_bandwidth_m: f64) -> Result<Self, Error> {
        let (slope_source, slope_rad) =
            slope::of_log(log, slope_bandwidth_m).map_err(|error| error.in_log(log.name()))?;
        let recorded = log.channel(Channel::SpeedLimit);
        let (limit_mps, limit_cover) = recorded
            .and_then(|limits| limit::filled(limits, log.step_s()))
            .unzip();
        Ok(Self {
            drive,
            distance_m: log.distance_m().into(),
            limit_mps: limit_mps.flatten(),
            limit_cover,
            slope_source,
            slope_rad: slope_rad.map(Arc::from),
            log: log.clone(),
        })
    }

    /// Name of the drive that it is a piece of.
    #[must_use]
    pub fn drive(&self) -> &str {
        &self.drive
    }

    /// Whether both are pieces of one drive, whatever its name.
    #[must_use]
    pub fn is_same_drive(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.drive, &other.drive)
    }

    /// Every recorded channel.
    #[must_use]
    pub fn log(&self) -> &DriveLog {
        &self.log
    }

    /// Name of the log.
    #[must_use]
    pub fn name(&self) -> &str {
        self.log.name()
    }

    /// Sampling interval.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.log.step_s()
    }

    /// Number of samples, at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a log is never empty")]
    pub fn len(&self) -> usize {
        self.log.len()
    }

    /// Samples in this many seconds, at least one.
    #[must_use]
    pub fn samples_in(&self, seconds: f64) -> usize {
        samples_in(seconds, self.step_s())
    }

    /// From first to last sample.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        (self.len() - 1) as f64 * self.step_s()
    }

    /// Speed.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        self.log.speed_mps()
    }

    /// Distance from the start, see [`DriveLog::distance_m`].
    #[must_use]
    pub fn distance_m(&self) -> &[f64] {
        &self.distance_m
    }

    /// Speed limit where the vehicle is; a missing value is the one before, or the first at the start. `None` where the log has none,
    /// or for less than half of the time.
    #[must_use]
    pub fn limit_mps(&self) -> Option<&[f64]> {
        self.limit_mps.as_deref()
    }

    /// How much of the speed limit is known, and how much filled; `None` where the log has none at all.
    #[must_use]
    pub fn limit_cover(&self) -> Option<LimitCover> {
        self.limit_cover
    }

    /// Slope where the vehicle is; `None` on a level road. As recorded, else from accelerometer and elevation as far as the log has them.
    /// Unknown stretches count as level.
    #[must_use]
    pub fn slope_rad(&self) -> Option<&[f64]> {
        self.slope_rad.as_deref()
    }

    /// Where the slope comes from.
    #[must_use]
    pub fn slope_source(&self) -> SlopeSource {
        self.slope_source
    }

    #[cfg(test)]
    #[allow(clippy::unwrap_used)]
    pub(crate) fn of_channels(
        name: &str,
        step_s: f64,
        channels: impl IntoIterator<Item = (Channel, Vec<f64>)>,
    ) -> Self {
        let channels = channels.into_iter().collect();
        let log = DriveLog::new(name, 0.0, step_s, channels).unwrap();
        Self::of_log(&log, DEFAULT_SLOPE_BANDWIDTH_M).unwrap()
    }

    /// Without speed limits, for models that are not to know them.
    pub(crate) fn without_limits(self) -> Self {
        Self {
            limit_mps: None,
            limit_cover: None,
            ..self
        }
    }
}

/// Steps in this many seconds, at least one.
pub(crate) fn samples_in(seconds: f64, step_s: f64) -> usize {
    ((seconds / step_s).round() as usize).max(1)
}

/// The pieces of each drive.
pub fn drives(motions: &[Motion]) -> impl Iterator<Item = &[Motion]> + Clone {
    motions.chunk_by(Motion::is_same_drive)
}

/// Name of the drive that the pieces are of.
#[must_use]
pub fn name(drive: &[Motion]) -> &str {
    drive.first().map_or("", Motion::drive)
}

/// The values with gaps filled by what came before, or by the first value at the start. `None` without any value.
pub(crate) fn held(values: &[f64]) -> Option<Arc<[f64]>> {
    let mut last = *values.iter().find(|value| value.is_finite())?;
    let hold = values.iter().map(|&value| {
        if value.is_finite() {
            last = value;
        }
        last
    });
    Some(hold.collect())
}

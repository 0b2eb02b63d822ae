//! A drive on a uniform grid.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::{Channel, Error, forward_difference};

/// A drive on the uniform grid `t_i = t0 + i·step`: speed is present and finite everywhere, other
/// channels may miss values (NaN).
///
/// Times are computed from the index, never accumulated, so that no rounding error grows along the
/// drive. A clone shares the channels.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveLog {
    name: String,
    t0_s: f64,
    step_s: f64,
    len: usize,
    channels: Arc<BTreeMap<Channel, Vec<f64>>>,
}

impl DriveLog {
    /// A drive from values that are on the grid already.
    ///
    /// # Errors
    /// [`Error::Option`] for a step that is not positive or a start that is not finite,
    /// [`Error::NoSpeed`] without speed or without samples, [`Error::Length`] for channels of
    /// unequal length, [`Error::NotFinite`] for a missing speed.
    pub fn new(
        name: impl Into<String>,
        t0_s: f64,
        step_s: f64,
        channels: BTreeMap<Channel, Vec<f64>>,
    ) -> Result<DriveLog, Error> {
        let name = name.into();
        positive("step_s", step_s)?;
        if !t0_s.is_finite() {
            return Err(Error::Option {
                option: "t0_s",
                value: t0_s.to_string(),
                expected: "give a finite time",
            });
        }
        let speed = channels
            .get(&Channel::Speed)
            .map(Vec::as_slice)
            .unwrap_or_default();
        let len = speed.len();
        if len == 0 {
            return Err(Error::NoSpeed {
                log: name,
                channel: Channel::Speed.name(),
                samples: 0,
            });
        }
        if let Some(index) = speed.iter().position(|v| !v.is_finite()) {
            let value = speed[index];
            return Err(Error::NotFinite {
                log: name,
                channel: Channel::Speed.name(),
                index,
                value,
            });
        }
        for (channel, values) in &channels {
            if values.len() != len {
                return Err(Error::Length {
                    log: name,
                    channel: channel.name(),
                    found: values.len(),
                    expected: len,
                });
            }
        }
        Ok(DriveLog {
            name,
            t0_s,
            step_s,
            len,
            channels: Arc::new(channels),
        })
    }

    /// Name of the log, with `/1`, `/2`, … after it where a recording was cut into several drives.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Time of the first sample, s, on the recording's own clock.
    #[must_use]
    pub fn t0_s(&self) -> f64 {
        self.t0_s
    }

    /// Distance of two samples, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Number of samples, at least 1.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.len
    }

    /// Time of sample `index`, s: `t0 + index·step`.
    #[must_use]
    pub fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.step_s
    }

    /// Speed, m/s: present and finite in every sample.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        self.channel(Channel::Speed).unwrap_or_default()
    }

    /// Acceleration, m/s²: the forward difference of the speed (thesis eq. 3.21).
    ///
    /// An acceleration that was recorded stays available as [`Channel::Accel`].
    #[must_use]
    pub fn accel_mps2(&self) -> Vec<f64> {
        forward_difference(self.speed_mps(), self.step_s)
    }

    /// The values of a channel, one per sample, NaN where missing.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(&channel).map(Vec::as_slice)
    }

    /// The channels of the drive, in their order.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.channels
            .iter()
            .map(|(channel, values)| (*channel, values.as_slice()))
    }

    /// The drive with these values of a channel in place of those that it has.
    ///
    /// # Errors
    /// As [`DriveLog::new`].
    pub fn with(&self, channel: Channel, values: Vec<f64>) -> Result<DriveLog, Error> {
        let mut channels = (*self.channels).clone();
        channels.insert(channel, values);
        DriveLog::new(self.name.clone(), self.t0_s, self.step_s, channels)
    }

    /// The drive up to its sample number `samples`, or all of it where it is shorter; at least one sample.
    #[must_use]
    pub fn first(&self, samples: usize) -> DriveLog {
        let len = samples.clamp(1, self.len);
        let cut = |(&channel, values): (&Channel, &Vec<f64>)| (channel, values[..len].to_vec());
        DriveLog {
            name: self.name.clone(),
            len,
            channels: Arc::new(self.channels.iter().map(cut).collect()),
            ..*self
        }
    }

    /// Distance driven since the first sample, m: the trapezoidal rule over the magnitude of the speed, so that it never decreases.
    #[must_use]
    pub fn distance_m(&self) -> Vec<f64> {
        self.summed_m(f64::abs)
    }

    /// Place along the road, m from the first sample: as [`Self::distance_m`], but less again where the car goes back.
    #[must_use]
    pub fn place_m(&self) -> Vec<f64> {
        self.summed_m(|travelled_m| travelled_m)
    }

    fn summed_m(&self, counted: fn(f64) -> f64) -> Vec<f64> {
        let steps = self.speed_mps().windows(2);
        let travelled_m = steps.map(|pair| 0.5 * (pair[0] + pair[1]) * self.step_s);
        let sum = travelled_m.scan(0.0, |sum, travelled_m| {
            *sum += counted(travelled_m);
            Some(*sum)
        });
        std::iter::once(0.0).chain(sum).collect()
    }
}

pub(crate) fn positive(option: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::Option {
        option,
        value: value.to_string(),
        expected: "give a positive number of seconds",
    })
}

//! A recording as it was made.

use std::collections::BTreeMap;

use crate::{Channel, Error, Finding};

/// A recording: samples at irregular times, in SI units. NaN is a missing value.
///
/// Time may repeat or run backward and need not be finite; [`crate::check`] repairs it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawLog {
    name: String,
    pub(crate) time_s: Vec<f64>,
    pub(crate) channels: BTreeMap<Channel, Vec<f64>>,
    pub(crate) origin: BTreeMap<String, String>,
    /// What reading already had to repair; `check` hands it on.
    pub(crate) findings: Vec<Finding>,
}

impl RawLog {
    /// A recording of the `channels` at the times `time_s`.
    ///
    /// # Errors
    /// [`Error::Length`] for a channel that has not one value per time,
    /// [`Error::NoSpeed`] without a single finite value of speed.
    pub fn new(
        name: impl Into<String>,
        time_s: Vec<f64>,
        channels: BTreeMap<Channel, Vec<f64>>,
    ) -> Result<RawLog, Error> {
        let name = name.into();
        for (channel, values) in &channels {
            if values.len() != time_s.len() {
                return Err(Error::Length {
                    log: name,
                    channel: channel.name(),
                    found: values.len(),
                    expected: time_s.len(),
                });
            }
        }
        let has_speed = channels
            .get(&Channel::Speed)
            .is_some_and(|speed| speed.iter().any(|v| v.is_finite()));
        if !has_speed {
            return Err(Error::NoSpeed {
                log: name,
                channel: Channel::Speed.name(),
                samples: time_s.len(),
            });
        }
        Ok(RawLog {
            name,
            time_s,
            channels,
            origin: BTreeMap::new(),
            findings: Vec::new(),
        })
    }

    /// Name of the log: the file's stem, then `#` and the column, the car or the values of
    /// [`RawLog::origin`] where a file holds several.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the file says of the whole log: the values of its columns of trips, vehicles and
    /// drivers, by header.
    #[must_use]
    pub fn origin(&self) -> &BTreeMap<String, String> {
        &self.origin
    }

    /// Time of each sample, s.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// The values of a channel, one per sample.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(&channel).map(Vec::as_slice)
    }

    /// The channels that were recorded, in their order.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.channels
            .iter()
            .map(|(channel, values)| (*channel, values.as_slice()))
    }

    /// Number of samples, at least 1.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// The speed; there is one by construction.
    pub(crate) fn speed_mps(&self) -> &[f64] {
        self.channel(Channel::Speed).unwrap_or_default()
    }
}

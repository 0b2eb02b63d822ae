//! What a prepared drive holds, in a few figures.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{Channel, Drive, DriveLog};

/// One channel over all pieces of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// The channel.
    pub channel: Channel,
    /// Smallest value; `None` without a value.
    pub min: Option<f64>,
    /// Mean over the values that are there; `None` without a value.
    pub mean: Option<f64>,
    /// Largest value; `None` without a value.
    pub max: Option<f64>,
    /// Share of samples without a value.
    pub missing_pct: f64,
}

impl From<DriveLog> for Drive {
    /// A log that is prepared already, or was never recorded, as a drive in one piece without findings.
    fn from(log: DriveLog) -> Drive {
        Drive {
            name: log.name().to_owned(),
            origin: BTreeMap::new(),
            samples: log.len(),
            step_s: log.step_s(),
            findings: Vec::new(),
            pieces: vec![log],
        }
    }
}

impl Drive {
    /// Time covered by the pieces, s; what lies between them does not count.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.pieces
            .iter()
            .map(|log| log.time_s(log.len() - 1) - log.t0_s())
            .sum()
    }

    /// Distance driven in the pieces, m.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.pieces
            .iter()
            .filter_map(|log| log.distance_m().last().copied())
            .sum()
    }

    /// Every channel that any piece has, in the order of [`Channel`].
    #[must_use]
    pub fn channel_summaries(&self) -> Vec<ChannelSummary> {
        Channel::ALL
            .into_iter()
            .filter_map(|channel| self.summary(channel))
            .collect()
    }

    fn summary(&self, channel: Channel) -> Option<ChannelSummary> {
        if self.pieces.iter().all(|log| log.channel(channel).is_none()) {
            return None;
        }
        let samples: usize = self.pieces.iter().map(DriveLog::len).sum();
        let values = || {
            let recorded = self.pieces.iter().filter_map(|log| log.channel(channel));
            recorded
                .flatten()
                .copied()
                .filter(|value| value.is_finite())
        };
        let count = values().count();
        Some(ChannelSummary {
            channel,
            min: values().reduce(f64::min),
            mean: (count > 0).then(|| values().sum::<f64>() / count as f64),
            max: values().reduce(f64::max),
            missing_pct: 100.0 * (samples - count) as f64 / samples as f64,
        })
    }
}

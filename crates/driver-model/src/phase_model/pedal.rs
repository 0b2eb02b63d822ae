use serde::{Deserialize, Serialize};
use strum::VariantArray;

use super::conditioned::{ConditionedProfile, Conditioning};
use crate::{DriverChannel, Error, Phase, TrainingSet};

/// A [`ConditionedProfile`] that also knows what the driver does as the phase begins, with one that does not for phases of logs that do not
/// say it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PedalProfile {
    /// What phases must know to be predicted by `told`; not empty.
    pub channels: Vec<DriverChannel>,
    /// Over 12 features.
    pub told: ConditionedProfile,
    /// Over 6 features.
    pub untold: ConditionedProfile,
}

/// A channel that fewer of the phases know is not used.
const LEAST_WITH_CHANNEL: f64 = 0.5;

impl PedalProfile {
    /// Fits both: one to the phases whose logs have all channels that half of the phases have, one to all phases.
    ///
    /// # Errors
    /// As [`ConditionedProfile::fit`].
    pub fn fit(training: &TrainingSet<'_>) -> Result<Self, Error> {
        let phases = &training.phases;
        let channels: Vec<DriverChannel> = DriverChannel::VARIANTS
            .iter()
            .copied()
            .filter(|&channel| {
                let with = phases
                    .iter()
                    .filter(|p| p.curve.outline().input.knows(channel));
                with.count() as f64 > LEAST_WITH_CHANNEL * phases.len() as f64
            })
            .collect();
        let with = |phase: &Phase| !channels.is_empty() && serves(&channels, phase);
        let mut told = TrainingSet::default();
        let with = phases.iter().filter(|p| with(&p.curve.outline()));
        told.phases.extend(with.copied());
        Ok(Self {
            told: ConditionedProfile::fit(Conditioning::Input, &told)?,
            untold: ConditionedProfile::fit(Conditioning::Onset, training)?,
            channels,
        })
    }

    /// The one that a phase is predicted by.
    #[must_use]
    pub fn for_phase(&self, phase: &Phase) -> &ConditionedProfile {
        if self.falls_back(phase) {
            &self.untold
        } else {
            &self.told
        }
    }

    /// Whether the phase's log lacks a channel.
    #[must_use]
    pub fn falls_back(&self, phase: &Phase) -> bool {
        !serves(&self.channels, phase)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        self.told.check(Conditioning::Input)?;
        self.untold.check(Conditioning::Onset)
    }
}

fn serves(channels: &[DriverChannel], phase: &Phase) -> bool {
    channels.iter().all(|&channel| phase.input.knows(channel))
}

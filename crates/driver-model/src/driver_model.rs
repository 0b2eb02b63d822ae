use serde::{Deserialize, Serialize};
use serde_json::Value;
use strum::IntoStaticStr;

use crate::cruise::CruiseModel;
use crate::following::{FollowingModel, FollowingStretch};
use crate::road::Road;
use crate::speed_ahead::DirectModel;
use crate::trip_driver::TripDriver;
use crate::{Error, ModelKind, Motion, Phase, PhaseModel, Subject};

/// What a driver does that a model is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Behaviour {
    /// Acceleration phases.
    Acceleration,
    /// Braking phases.
    Braking,
    /// Holding a speed.
    Cruise,
    /// Keeping the distance to a vehicle ahead.
    Following,
    /// The speed of the next seconds.
    SpeedAhead,
    /// Whole trips.
    Trip,
}

impl Behaviour {
    /// As in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// A model of any behaviour.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DriverModel {
    /// Of acceleration phases.
    Acceleration(PhaseModel),
    /// Of braking phases.
    Braking(PhaseModel),
    /// Of cruising.
    Cruise(CruiseModel),
    /// Of following.
    Following(FollowingModel),
    /// Of the speed of the next seconds.
    SpeedAhead(DirectModel),
    /// Of whole trips.
    Trip(TripDriver),
}

/// What a model is told before it predicts.
#[derive(Debug, Clone, Copy)]
pub enum Situation<'a> {
    /// An acceleration or braking phase.
    Phase(Phase),
    /// From this speed on, under this limit if it is known.
    Cruising {
        /// Speed at the start.
        start_speed_mps: f64,
        /// Limit.
        limit_mps: Option<f64>,
        /// Sampling interval of the answer.
        step_s: f64,
        /// Samples of the answer.
        samples: usize,
    },
    /// Behind this vehicle, from the stretch's first speed and gap.
    Behind(&'a FollowingStretch),
    /// At this sample of a drive; the answer has a speed for each of the model's horizons.
    Moment {
        /// The drive.
        motion: &'a Motion,
        /// The sample, the last one that is known.
        origin: usize,
    },
    /// A road ahead.
    Road {
        /// The road.
        road: &'a Road,
        /// Sampling interval of the answer.
        step_s: f64,
    },
}

impl From<&Phase> for Situation<'_> {
    fn from(phase: &Phase) -> Self {
        Self::Phase(*phase)
    }
}

impl<'a> From<&'a FollowingStretch> for Situation<'a> {
    fn from(stretch: &'a FollowingStretch) -> Self {
        Self::Behind(stretch)
    }
}

impl Situation<'_> {
    fn subject(&self) -> Subject {
        match self {
            Self::Phase(_) => Subject::Phases,
            Self::Cruising { .. } => Subject::Cruise,
            Self::Behind(_) => Subject::Following,
            Self::Moment { .. } => Subject::SpeedAhead,
            Self::Road { .. } => Subject::Trips,
        }
    }
}

impl DriverModel {
    /// Predicted speed in m/s, sample by sample, the first one that of the start; of a [`Situation::Moment`] one per horizon.
    ///
    /// # Errors
    /// [`Error::Subject`] for a situation that the model is not about, and what the model of that behaviour refuses.
    pub fn predict<'a>(&self, situation: impl Into<Situation<'a>>) -> Result<Vec<f64>, Error> {
        let situation = situation.into();
        match (self, &situation) {
            (Self::Acceleration(model) | Self::Braking(model), Situation::Phase(phase)) => {
                Ok(model.predict(phase))
            }
            (
                Self::Cruise(model),
                &Situation::Cruising {
                    start_speed_mps,
                    limit_mps,
                    step_s,
                    samples,
                },
            ) => Ok((0..samples)
                .map(|k| model.speed_mps(start_speed_mps, limit_mps, k as f64 * step_s))
                .collect()),
            (Self::Following(model), Situation::Behind(stretch)) => {
                Ok(model.simulate(stretch).speed_mps)
            }
            (Self::SpeedAhead(model), Situation::Moment { motion, origin }) => {
                let ahead = model.predict(motion, &[*origin])?.into_iter();
                Ok(ahead.flat_map(|ahead| ahead.speed_mps).collect())
            }
            (Self::Trip(driver), Situation::Road { road, step_s }) => {
                Ok(driver.drive(road, *step_s, None)?.speed_mps)
            }
            _ => Err(Error::not_of(situation.subject(), self.kind())),
        }
    }

    /// What the model is about.
    #[must_use]
    pub fn behaviour(&self) -> Behaviour {
        match self {
            Self::Acceleration(_) => Behaviour::Acceleration,
            Self::Braking(_) => Behaviour::Braking,
            Self::Cruise(_) => Behaviour::Cruise,
            Self::Following(_) => Behaviour::Following,
            Self::SpeedAhead(_) => Behaviour::SpeedAhead,
            Self::Trip(_) => Behaviour::Trip,
        }
    }

    /// Which model this is.
    #[must_use]
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Acceleration(model) | Self::Braking(model) => model.kind(),
            Self::Cruise(_) => ModelKind::Cruise,
            Self::Following(model) => model.kind(),
            Self::SpeedAhead(model) => model.kind(),
            Self::Trip(_) => ModelKind::TripDriver,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Acceleration(model) | Self::Braking(model) => model.check(),
            Self::Cruise(model) => model.check(),
            Self::Following(model) => model.check(),
            // Checked when they are parsed.
            Self::SpeedAhead(_) | Self::Trip(_) => Ok(()),
        }
    }

    pub(crate) fn from_value(behaviour: Behaviour, value: Value) -> serde_json::Result<Self> {
        Ok(match behaviour {
            Behaviour::Acceleration => Self::Acceleration(serde_json::from_value(value)?),
            Behaviour::Braking => Self::Braking(serde_json::from_value(value)?),
            Behaviour::Cruise => Self::Cruise(serde_json::from_value(value)?),
            Behaviour::Following => Self::Following(serde_json::from_value(value)?),
            Behaviour::SpeedAhead => Self::SpeedAhead(serde_json::from_value(value)?),
            Behaviour::Trip => Self::Trip(serde_json::from_value(value)?),
        })
    }
}

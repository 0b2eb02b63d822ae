//! What the driver does and the car feels, where a log has it.

use drive_log::Channel;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::Motion;

/// A channel that tells more of the next seconds than speed and limits do.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Serialize,
    Deserialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum DriverChannel {
    /// How far the accelerator pedal is down.
    AcceleratorPedal,
    /// How much the driver brakes.
    Brake,
    /// Torque at the motor shaft.
    MotorTorque,
    /// What the car feels along its way.
    Accelerometer,
}

/// Less of a drive than this share has no value: it counts as known, and is held over the gaps.
const MOST_MISSING: f64 = 0.1;

impl DriverChannel {
    /// The channel of a log.
    #[must_use]
    pub fn channel(self) -> Channel {
        match self {
            Self::AcceleratorPedal => Channel::AcceleratorPedal,
            Self::Brake => Channel::Brake,
            Self::MotorTorque => Channel::MotorTorque,
            Self::Accelerometer => Channel::Accelerometer,
        }
    }

    /// Whether a drive has it, but for a tenth of its samples.
    #[must_use]
    pub fn is_known_in(self, motion: &Motion) -> bool {
        motion.log().channel(self.channel()).is_some_and(|values| {
            let missing = values.iter().filter(|value| !value.is_finite()).count();
            (missing as f64) < MOST_MISSING * values.len() as f64
        })
    }
}

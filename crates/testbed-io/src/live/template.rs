//! Files of links to start from.

use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// Testbeds by name.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum LinkTemplate {
    /// Khepera III under OptiTrack
    Khepera,
    /// Robotarium, over MQTT
    Robotarium,
    /// Robotarium of 2018, commands over UDP
    RobotariumUdp,
    /// JSON lines over UDP
    JsonUdp,
    /// JSON lines to and from a program
    Program,
    /// Poses of a run log
    Recording,
}

impl LinkTemplate {
    /// A file of a [`LinkSpec`](super::LinkSpec) with a comment on every line.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Khepera => include_str!("links/khepera.toml"),
            Self::Robotarium => include_str!("links/robotarium.toml"),
            Self::RobotariumUdp => include_str!("links/robotarium-udp.toml"),
            Self::JsonUdp => include_str!("links/json-udp.toml"),
            Self::Program => include_str!("links/program.toml"),
            Self::Recording => include_str!("links/recording.toml"),
        }
    }
}

//! What a simulated testbed does to poses and commands, and its random numbers.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::error::Error;

/// Bounds of the disturbances; zeros everywhere are none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Disturbances {
    /// Standard deviation of each coordinate of a pose, in m
    pub position_noise_m: f64,
    /// Standard deviation of the heading of a pose, in rad
    pub heading_noise_rad: f64,
    /// Longest time from a pose to its arrival, in s
    pub latency_s: f64,
    /// By how much single poses come earlier than that at most, in s
    pub jitter_s: f64,
    /// Share of poses that never arrive
    pub drop_share: f64,
    /// Spans without poses, of one robot or of all, per minute
    pub outages_per_minute: f64,
    /// Longest span, in s
    pub outage_s: f64,
    /// Relative error of the speed of each wheel
    pub wheel_error: f64,
    /// Relative error of the mass, by which the motors respond slower or faster
    pub mass_error: f64,
    /// Time constant of the motors at the mass that the controller knows, in s
    pub motor_time_constant_s: f64,
    /// Wheel speeds are whole multiples of this, in m/s
    pub wheel_resolution_mps: f64,
}

/// Groups of disturbances, as campaigns tell them apart; with what [`Disturbances::HARD`] makes of them.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Group {
    /// Nothing
    None,
    /// Poses wrong by 3 mm and 0.5° (standard deviations)
    Noise,
    /// Poses 0.05 to 0.1 s late
    Latency,
    /// 30 % of the poses lost
    Drops,
    /// No poses for up to 2 s, about every 20 s
    Outages,
    /// Wheels and mass up to 10 % off, motors that lag by 20 ms, wheel speeds in steps of 0.1 mm/s
    Mismatch,
    /// All of them at once
    All,
}

impl Group {
    /// Every group.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl Disturbances {
    /// Those of a campaign: noise of 3 mm and 0.5°, latency to 0.1 s of which 0.05 s are jitter, 30 % dropped poses, an outage to
    /// 2 s about every 20 s, wheels and mass to 10 % off, and motors that respond in 20 ms.
    pub const HARD: Self = Self {
        position_noise_m: 3e-3,
        heading_noise_rad: 0.5 * std::f64::consts::PI / 180.0,
        latency_s: 0.1,
        jitter_s: 0.05,
        drop_share: 0.3,
        outages_per_minute: 3.0,
        outage_s: 2.0,
        wheel_error: 0.1,
        mass_error: 0.1,
        motor_time_constant_s: 0.02,
        wheel_resolution_mps: 1e-4,
    };

    /// The part of these that belongs to a group.
    #[must_use]
    pub fn only(&self, group: Group) -> Self {
        let none = Self::default();
        match group {
            Group::None => none,
            Group::Noise => Self {
                position_noise_m: self.position_noise_m,
                heading_noise_rad: self.heading_noise_rad,
                ..none
            },
            Group::Latency => Self {
                latency_s: self.latency_s,
                jitter_s: self.jitter_s,
                ..none
            },
            Group::Drops => Self {
                drop_share: self.drop_share,
                ..none
            },
            Group::Outages => Self {
                outages_per_minute: self.outages_per_minute,
                outage_s: self.outage_s,
                ..none
            },
            Group::Mismatch => Self {
                wheel_error: self.wheel_error,
                mass_error: self.mass_error,
                motor_time_constant_s: self.motor_time_constant_s,
                wheel_resolution_mps: self.wheel_resolution_mps,
                ..none
            },
            Group::All => *self,
        }
    }

    /// # Errors
    ///
    /// The first number out of its range.
    pub fn check(&self) -> Result<(), Error> {
        let ranges = [
            ("position_noise_m", self.position_noise_m, 1.0),
            ("heading_noise_rad", self.heading_noise_rad, 1.0),
            ("latency_s", self.latency_s, 5.0),
            ("jitter_s", self.jitter_s, self.latency_s),
            ("drop_share", self.drop_share, 1.0),
            ("outages_per_minute", self.outages_per_minute, 600.0),
            ("outage_s", self.outage_s, 600.0),
            ("wheel_error", self.wheel_error, 0.9),
            ("mass_error", self.mass_error, 0.9),
            ("motor_time_constant_s", self.motor_time_constant_s, 1.0),
            ("wheel_resolution_mps", self.wheel_resolution_mps, 1.0),
        ];
        for (name, value, most) in ranges {
            if !(0.0..=most).contains(&value) {
                return Err(Error::Disturbance { name, value, most });
            }
        }
        Ok(())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Random numbers from a seed, the same on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    source: ChaCha8Rng,
    spare: Option<f64>,
}

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            source: ChaCha8Rng::seed_from_u64(seed),
            spare: None,
        }
    }

    /// Uniform from 0 to below 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.source.random()
    }

    /// Uniform between −1 and 1.
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    /// Standard normal, by the polar method.
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (u, v) = (self.signed(), self.signed());
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(v * factor);
                return u * factor;
            }
        }
    }
}

//! Settings of the controller, the presets, and the literal forms of the thesis.

use serde::{Deserialize, Serialize};
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

use crate::cbf::LaneBarrier;
use crate::error::Error;
use crate::lateral::Deviation;

/// Everything that the quadratic program and its guards can be told.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSettings {
    /// `c1, c2, c3`: rates at which `V1`, `V2`, `V3` shall decay, in 1/s
    pub convergence_1ps: [f64; 3],
    /// `p1 … p5`: weights of `u_l², u_a², δ1², δ2², δ3²`
    pub weights: [f64; 5],
    /// Forms as printed in the thesis, with their errors, for teaching
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub literal: Vec<Literal>,
    /// Distance to the robot ahead
    pub headway: HeadwaySettings,
    /// The lane
    pub lane: LaneSettings,
    /// What keeps the guarantee where poses are sampled, late, lost or wrong; nothing does where it is left out
    #[serde(default = "Hardening::left_out")]
    pub hardening: Hardening,
}

/// `h = D − D0 − τ v`
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeadwaySettings {
    /// `τ`, in s
    pub time_s: f64,
    /// `D0`, in m; with [`Hardening::every_robot`] at least both radii and the clearance
    pub standstill_m: f64,
    /// What has to stay free between two bodies, in m
    #[serde(default = "usual_clearance_m")]
    pub clearance_m: f64,
    /// How `D` is measured
    pub distance: Distance,
    /// `γ1`, in 1/s
    pub rate_1ps: f64,
    /// Taken off the barrier within the quadratic program, in m
    pub margin_m: f64,
}

fn usual_clearance_m() -> f64 {
    HeadwaySettings::CLEARANCE_M
}

/// How the distance between robots is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distance {
    /// Straight from point of interest to point of interest
    Chord,
    /// Along the path
    Path,
}

/// The lane and its barrier.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneSettings {
    /// `d_max`, in m
    pub half_width_m: f64,
    /// Which barrier
    pub barrier: LaneBarrier,
    /// Which distance from the path it bounds
    pub deviation: Deviation,
    /// `γ2`, in 1/s; `k2` of the exponential rows
    pub rate_1ps: f64,
    /// Taken off `d_max` within the quadratic program, in m
    pub margin_m: f64,
}

/// Guards beyond the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hardening {
    /// The limits of the wheels as rows, in place of clipping after the quadratic program
    pub wheel_rows: bool,
    /// Margins for what happens within a period, from its length and the speeds
    pub sampling_margin: bool,
    /// The state is predicted from the newest pose through the commands sent since
    pub predict: bool,
    /// Share of the difference between pose and prediction by which the position is corrected, 0 to 1; 1 trusts the poses
    pub position_gain: f64,
    /// The same for the heading
    pub heading_gain: f64,
    /// Braking while the newest pose is older, in s
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_pose_age_s: Option<f64>,
    /// Bound on the error of positions that margins account for, in m
    pub position_noise_m: f64,
    /// Bound on the error of headings that margins account for, in rad
    pub heading_noise_rad: f64,
    /// Bound on the relative error of each wheel's speed that margins account for
    pub wheel_error: f64,
    /// The robot ahead may have stopped where it was last seen: a second headway row
    pub cautious_leader: bool,
    /// A row for the body of every robot in reach, and whoever is ahead on the path is followed. Left out, where there are wheel rows
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every_robot: Option<bool>,
    /// The heading stays within this angle of the path's direction, in rad
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_course_angle_rad: Option<f64>,
    /// Speeds at the first step are the desired ones (thesis 4.1) and not zero
    pub start_at_desired_speed: bool,
}

impl Hardening {
    /// Nothing beyond the thesis.
    pub const NONE: Self = Self {
        wheel_rows: false,
        sampling_margin: false,
        predict: false,
        position_gain: 1.0,
        heading_gain: 1.0,
        max_pose_age_s: None,
        position_noise_m: 0.0,
        heading_noise_rad: 0.0,
        wheel_error: 0.0,
        cautious_leader: false,
        every_robot: Some(false),
        max_course_angle_rad: None,
        start_at_desired_speed: true,
    };

    /// What is taken where a file has no guards: none.
    const fn left_out() -> Self {
        Self {
            every_robot: None,
            ..Self::NONE
        }
    }

    /// Whether nothing was said of any guard.
    #[must_use]
    pub fn is_left_out(&self) -> bool {
        *self == Self::left_out()
    }
}

/// A form that is wrong as printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Literal {
    /// (2.22): `φ̇` as a root, without its sign
    UnsignedAngleRate,
    /// (2.17): barrier rows `L_f h + L_g h u ≤ γ h`
    BarrierSign,
    /// (3.1): the velocity of the leader left out of `L_f h`
    IgnoredLeader,
    /// (3.2): one row with a sign that jumps at zero lateral speed
    SwitchingLane,
    /// (4.2): `p3` decays in place of `p5`
    DecayingSpeedWeight,
}

/// Named sets of settings.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Preset {
    /// The quadratic program of the thesis, margins set by hand
    #[default]
    Thesis,
    /// With every guard
    Hardened,
}

impl ControllerSettings {
    /// Whether a literal form is asked for.
    #[must_use]
    pub fn is_literal(&self, form: Literal) -> bool {
        self.literal.contains(&form)
    }

    /// # Errors
    ///
    /// The first number out of its range.
    pub fn check(&self) -> Result<(), Error> {
        for rate in self.convergence_1ps {
            Error::within("convergence_1ps", rate, 1e-6, 1e4)?;
        }
        for weight in self.weights {
            Error::within("weights", weight, 1e-12, 1e12)?;
        }
        self.headway.check()?;
        self.lane.check()?;
        self.hardening.check()
    }
}

impl LaneSettings {
    /// With another kind of barrier and the rate that goes with it; unchanged if it is of that kind.
    #[must_use]
    pub fn with(self, barrier: LaneBarrier) -> Self {
        if std::mem::discriminant(&self.barrier) == std::mem::discriminant(&barrier) {
            return self;
        }
        Self {
            barrier,
            rate_1ps: barrier.usual_rate_1ps(),
            ..self
        }
    }
}

impl LaneSettings {
    /// With `k1` and `k2`, or the rate of other barriers.
    pub(crate) fn with_rates(self, [first_1ps, rate_1ps]: [f64; 2]) -> Self {
        let barrier = match self.barrier {
            LaneBarrier::Exponential { .. } => LaneBarrier::Exponential {
                rate_1ps: first_1ps,
            },
            barrier => barrier,
        };
        Self {
            barrier,
            rate_1ps,
            ..self
        }
    }
}

impl Preset {
    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl HeadwaySettings {
    /// The usual clearance between two bodies, in m.
    pub const CLEARANCE_M: f64 = 0.01;

    fn check(&self) -> Result<(), Error> {
        Error::within("headway.time_s", self.time_s, 1e-6, 100.0)?;
        Error::within("headway.standstill_m", self.standstill_m, 0.0, f64::MAX)?;
        Error::within("headway.clearance_m", self.clearance_m, 0.0, 10.0)?;
        Error::positive("headway.rate_1ps", self.rate_1ps)?;
        Error::within("headway.margin_m", self.margin_m, 0.0, f64::MAX)
    }
}

impl LaneSettings {
    fn check(&self) -> Result<(), Error> {
        Error::positive("lane.half_width_m", self.half_width_m)?;
        Error::positive("lane.rate_1ps", self.rate_1ps)?;
        let (name, value) = match self.barrier {
            LaneBarrier::Quadratic {
                reference_speed_mps,
            } => ("lane.barrier.reference_speed_mps", reference_speed_mps),
            LaneBarrier::Braking {
                max_acceleration_mps2,
            } => ("lane.barrier.max_acceleration_mps2", max_acceleration_mps2),
            LaneBarrier::Exponential { rate_1ps } => ("lane.barrier.rate_1ps", rate_1ps),
        };
        Error::positive(name, value)?;
        if (0.0..self.half_width_m).contains(&self.margin_m) {
            return Ok(());
        }
        Err(Error::Contradiction {
            what: format!(
                "lane.margin_m is {}, which leaves nothing of lane.half_width_m {}",
                self.margin_m, self.half_width_m
            ),
        })
    }
}

impl Hardening {
    /// Whether every robot in reach has a row.
    #[must_use]
    pub fn regards_every_robot(&self) -> bool {
        self.every_robot.unwrap_or(self.wheel_rows)
    }

    fn check(&self) -> Result<(), Error> {
        Error::within("hardening.position_gain", self.position_gain, 1e-3, 1.0)?;
        Error::within("hardening.heading_gain", self.heading_gain, 1e-3, 1.0)?;
        if let Some(age_s) = self.max_pose_age_s {
            Error::positive("hardening.max_pose_age_s", age_s)?;
        }
        Error::within(
            "hardening.position_noise_m",
            self.position_noise_m,
            0.0,
            1.0,
        )?;
        Error::within(
            "hardening.heading_noise_rad",
            self.heading_noise_rad,
            0.0,
            1.0,
        )?;
        Error::within("hardening.wheel_error", self.wheel_error, 0.0, 0.5)?;
        match self.max_course_angle_rad {
            Some(angle) => Error::within(
                "hardening.max_course_angle_rad",
                angle,
                0.1,
                std::f64::consts::PI,
            ),
            None => Ok(()),
        }
    }
}

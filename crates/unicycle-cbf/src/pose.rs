//! Where a robot is: the pose of its axle, and the state of its point of interest.

use serde::{Deserialize, Serialize};

/// What a tracker sees: the middle of the axle and the heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// In m
    pub x_m: f64,
    /// In m
    pub y_m: f64,
    /// Counter-clockwise from the x axis, in rad
    pub heading_rad: f64,
}

impl Pose {
    /// Whether no coordinate is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.heading_rad.is_finite()
    }

    /// The state of the point `offset_m` ahead of the axle (thesis 4.1), with speeds that are known otherwise.
    #[must_use]
    pub fn state(&self, offset_m: f64, speeds: Speeds) -> State {
        let (sin, cos) = self.heading_rad.sin_cos();
        State {
            x_m: self.x_m + offset_m * cos,
            y_m: self.y_m + offset_m * sin,
            speed_mps: speeds.speed_mps,
            heading_rad: self.heading_rad,
            turn_rate_rad_s: speeds.turn_rate_rad_s,
        }
    }

    /// Where constant speeds take the axle in `duration_s`: an arc, exact.
    #[must_use]
    pub fn advanced(&self, speeds: Speeds, duration_s: f64) -> Self {
        let turn_rad = speeds.turn_rate_rad_s * duration_s;
        let half = 0.5 * turn_rad;
        let chord_share = if half.abs() < 1e-4 {
            1.0 - half * half / 6.0
        } else {
            half.sin() / half
        };
        let chord_m = speeds.speed_mps * duration_s * chord_share;
        let (sin, cos) = (self.heading_rad + half).sin_cos();
        Self {
            x_m: self.x_m + chord_m * cos,
            y_m: self.y_m + chord_m * sin,
            heading_rad: self.heading_rad + turn_rad,
        }
    }
}

/// Speed and turn rate: what a differential drive is told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Speeds {
    /// Along the heading, in m/s
    pub speed_mps: f64,
    /// Counter-clockwise, in rad/s
    pub turn_rate_rad_s: f64,
}

impl Speeds {
    /// A robot that stands.
    pub const ZERO: Self = Self {
        speed_mps: 0.0,
        turn_rate_rad_s: 0.0,
    };
}

/// The state `[x, y, v, ψ, ω]` of the point of interest (thesis 2.21).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// In m
    pub x_m: f64,
    /// In m
    pub y_m: f64,
    /// `v`, along the heading, in m/s
    pub speed_mps: f64,
    /// `ψ`, in rad
    pub heading_rad: f64,
    /// `ω`, in rad/s
    pub turn_rate_rad_s: f64,
}

impl State {
    /// At the origin, at rest.
    pub const ORIGIN: Self = Self {
        x_m: 0.0,
        y_m: 0.0,
        speed_mps: 0.0,
        heading_rad: 0.0,
        turn_rate_rad_s: 0.0,
    };

    /// Square of the distance to another point of interest, in m².
    #[must_use]
    pub fn square_m2(&self, other: &Self) -> f64 {
        (self.x_m - other.x_m).powi(2) + (self.y_m - other.y_m).powi(2)
    }

    /// Whether no coordinate is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        [
            self.x_m,
            self.y_m,
            self.speed_mps,
            self.heading_rad,
            self.turn_rate_rad_s,
        ]
        .iter()
        .all(|value| value.is_finite())
    }

    /// Speed and turn rate.
    #[must_use]
    pub fn speeds(&self) -> Speeds {
        Speeds {
            speed_mps: self.speed_mps,
            turn_rate_rad_s: self.turn_rate_rad_s,
        }
    }

    /// The velocity of a point `offset_m` ahead of the axle, in m/s.
    #[must_use]
    pub fn velocity_mps(&self, offset_m: f64) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        let across = offset_m * self.turn_rate_rad_s;
        [
            self.speed_mps * cos - across * sin,
            self.speed_mps * sin + across * cos,
        ]
    }
}

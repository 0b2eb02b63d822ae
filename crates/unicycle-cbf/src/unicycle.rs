//! The robot: unicycle dynamics with force and torque as inputs (thesis 2.21), and its wheels.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::pose::{Speeds, State};
use crate::radii;

/// How far a body reaches beyond its wheels where that is not known, in m.
const BESIDE_WHEELS_M: f64 = 0.025;
/// How fast wheels of small robots change their speed, in m/s².
const USUAL_WHEEL_ACCELERATION_MPS2: f64 = 5.0;

/// The sign `s` of the centripetal term in `v̇ = u_l/m − s a ω²`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Centripetal {
    /// `s = 1`, as printed
    #[default]
    Printed,
    /// `s = −1`, what Newton's law gives at the point of interest
    Newton,
}

impl Centripetal {
    /// `s`
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Printed => 1.0,
            Self::Newton => -1.0,
        }
    }
}

/// A rigid body on two driven wheels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// `a`, from the axle forward to the point of interest, in m
    pub offset_m: f64,
    /// `m`, in kg
    pub mass_kg: f64,
    /// `I_z`, in kg m²
    pub inertia_kgm2: f64,
    /// Sign of the centripetal term
    #[serde(default)]
    pub centripetal: Centripetal,
    /// Distance between the wheels, in m
    pub wheel_base_m: f64,
    /// Of the circle about the middle of the axle that nothing of the robot reaches out of, in m; see [`Body::radius_m`]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// What each wheel can do at most, forward and backward, in m/s along the ground
    pub max_wheel_speed_mps: f64,
    /// How fast the robot may turn at most, in rad/s
    pub max_turn_rate_rad_s: f64,
    /// How fast the speed of each wheel may change, in m/s²; see [`Body::wheel_acceleration_mps2`]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_wheel_acceleration_mps2: Option<f64>,
}

/// What the quadratic program decides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// `u_l`, in N
    pub force_n: f64,
    /// `u_a`, in N m
    pub torque_nm: f64,
}

/// Speeds of the two wheels along the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelSpeeds {
    /// In m/s
    pub left_mps: f64,
    /// In m/s
    pub right_mps: f64,
}

/// A quantity that is affine in the inputs: `drift + control · [u_l, u_a]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Its value without inputs
    pub drift: f64,
    /// By force and by torque
    pub control: [f64; 2],
}

impl Affine {
    /// `a·self + b·other + c`
    #[must_use]
    pub(crate) fn combined(self, a: f64, other: Self, b: f64, c: f64) -> Self {
        Self {
            drift: a * self.drift + b * other.drift + c,
            control: [
                a * self.control[0] + b * other.control[0],
                a * self.control[1] + b * other.control[1],
            ],
        }
    }

    /// The value for given inputs.
    #[must_use]
    pub fn at(&self, input: Input) -> f64 {
        self.drift + self.control[0] * input.force_n + self.control[1] * input.torque_nm
    }
}

impl Body {
    /// # Errors
    ///
    /// A length, mass, inertia or speed that is not positive and finite.
    pub fn check(&self) -> Result<(), Error> {
        Error::positive("offset_m", self.offset_m)?;
        Error::positive("mass_kg", self.mass_kg)?;
        Error::positive("inertia_kgm2", self.inertia_kgm2)?;
        Error::positive("wheel_base_m", self.wheel_base_m)?;
        Error::within("radius_m", self.radius_m(), 1e-3, 10.0)?;
        Error::positive("max_wheel_speed_mps", self.max_wheel_speed_mps)?;
        Error::positive("max_turn_rate_rad_s", self.max_turn_rate_rad_s)?;
        Error::positive(
            "max_wheel_acceleration_mps2",
            self.wheel_acceleration_mps2(),
        )
    }

    /// Radius of the body about the middle of the axle, in m. Left out it is that of the testbed with this wheel base, else half the
    /// wheel base and 25 mm.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        let half_m = 0.5 * self.wheel_base_m;
        let of_testbed = || radii::with_wheel_base(self.wheel_base_m);
        // A wheel base that differs in its last digits may have wheels that stand out of the testbed's body.
        let radius_m = self.radius_m.or_else(|| Some(of_testbed()?.max(half_m)));
        radius_m.unwrap_or(half_m + BESIDE_WHEELS_M)
    }

    /// How fast the speed of each wheel may change, in m/s²: 5 where it was left out.
    #[must_use]
    pub fn wheel_acceleration_mps2(&self) -> f64 {
        self.max_wheel_acceleration_mps2
            .unwrap_or(USUAL_WHEEL_ACCELERATION_MPS2)
    }

    /// Speeds after a period of braking: slower on the same arc, no wheel faster than it may.
    #[must_use]
    pub fn braked(&self, speeds: Speeds, duration_s: f64) -> Speeds {
        let wheels = self.wheel_speeds(speeds);
        let fastest_mps = wheels.left_mps.abs().max(wheels.right_mps.abs());
        let slower_mps = fastest_mps - self.wheel_acceleration_mps2() * duration_s;
        if slower_mps.is_nan() || slower_mps <= 0.0 {
            return Speeds::ZERO;
        }
        let share = slower_mps / fastest_mps;
        Speeds {
            speed_mps: share * speeds.speed_mps,
            turn_rate_rad_s: share * speeds.turn_rate_rad_s,
        }
    }

    /// With everything that was left out.
    #[must_use]
    pub fn completed(self) -> Self {
        Self {
            radius_m: Some(self.radius_m()),
            max_wheel_acceleration_mps2: Some(self.wheel_acceleration_mps2()),
            ..self
        }
    }

    /// `v̇`
    #[must_use]
    pub fn acceleration(&self, turn_rate_rad_s: f64) -> Affine {
        let centripetal = self.centripetal.sign() * self.offset_m * turn_rate_rad_s.powi(2);
        Affine {
            drift: -centripetal,
            control: [1.0 / self.mass_kg, 0.0],
        }
    }

    /// Acceleration of the point of interest, along the heading and across it to the left:
    /// `A_t = u_l/m − (1 + s) a ω²`, `A_n = v ω + a u_a/I_z`.
    #[must_use]
    pub fn point_acceleration(&self, speeds: Speeds) -> [Affine; 2] {
        let turn = speeds.turn_rate_rad_s;
        let along = self.acceleration(turn);
        [
            Affine {
                drift: along.drift - self.offset_m * turn * turn,
                ..along
            },
            Affine {
                drift: speeds.speed_mps * turn,
                control: [0.0, self.offset_m / self.inertia_kgm2],
            },
        ]
    }

    /// The right side of (2.21).
    #[must_use]
    pub fn derivative(&self, state: &State, input: Input) -> State {
        let [x_m, y_m] = state.velocity_mps(self.offset_m);
        State {
            x_m,
            y_m,
            speed_mps: self.acceleration(state.turn_rate_rad_s).at(input),
            heading_rad: state.turn_rate_rad_s,
            turn_rate_rad_s: input.torque_nm / self.inertia_kgm2,
        }
    }

    /// The state after `duration_s` of constant inputs, by one fourth-order Runge-Kutta step.
    #[must_use]
    pub fn integrated(&self, state: &State, input: Input, duration_s: f64) -> State {
        let moved = |by: &State, share: f64| State {
            x_m: state.x_m + share * by.x_m,
            y_m: state.y_m + share * by.y_m,
            speed_mps: state.speed_mps + share * by.speed_mps,
            heading_rad: state.heading_rad + share * by.heading_rad,
            turn_rate_rad_s: state.turn_rate_rad_s + share * by.turn_rate_rad_s,
        };
        let k1 = self.derivative(state, input);
        let k2 = self.derivative(&moved(&k1, 0.5 * duration_s), input);
        let k3 = self.derivative(&moved(&k2, 0.5 * duration_s), input);
        let k4 = self.derivative(&moved(&k3, duration_s), input);
        let mean = |part: fn(&State) -> f64| {
            (part(&k1) + 2.0 * part(&k2) + 2.0 * part(&k3) + part(&k4)) / 6.0
        };
        let slope = State {
            x_m: mean(|k| k.x_m),
            y_m: mean(|k| k.y_m),
            speed_mps: mean(|k| k.speed_mps),
            heading_rad: mean(|k| k.heading_rad),
            turn_rate_rad_s: mean(|k| k.turn_rate_rad_s),
        };
        moved(&slope, duration_s)
    }

    /// The speeds after `duration_s` of constant inputs: those of [`Body::integrated`], whose Runge-Kutta step is exact for
    /// them, because `v̇` is quadratic in time and needs no position.
    #[must_use]
    pub fn speeds_after(&self, speeds: Speeds, input: Input, duration_s: f64) -> Speeds {
        let turn_acceleration = input.torque_nm / self.inertia_kgm2;
        let end = speeds.turn_rate_rad_s + turn_acceleration * duration_s;
        let middle = speeds.turn_rate_rad_s + 0.5 * turn_acceleration * duration_s;
        let mean_square =
            (speeds.turn_rate_rad_s.powi(2) + 4.0 * middle.powi(2) + end.powi(2)) / 6.0;
        let centripetal = self.centripetal.sign() * self.offset_m * mean_square;
        Speeds {
            speed_mps: speeds.speed_mps + (input.force_n / self.mass_kg - centripetal) * duration_s,
            turn_rate_rad_s: end,
        }
    }

    /// Wheel speeds that give the speeds of the axle.
    #[must_use]
    pub fn wheel_speeds(&self, speeds: Speeds) -> WheelSpeeds {
        let half = 0.5 * self.wheel_base_m * speeds.turn_rate_rad_s;
        WheelSpeeds {
            left_mps: speeds.speed_mps - half,
            right_mps: speeds.speed_mps + half,
        }
    }

    /// The speeds of the axle that wheel speeds give.
    #[must_use]
    pub fn speeds_of(&self, wheels: WheelSpeeds) -> Speeds {
        Speeds {
            speed_mps: 0.5 * (wheels.left_mps + wheels.right_mps),
            turn_rate_rad_s: (wheels.right_mps - wheels.left_mps) / self.wheel_base_m,
        }
    }

    /// What the robot makes of speeds that it is told: the turn rate and then each wheel are clipped.
    #[must_use]
    pub fn clipped(&self, speeds: Speeds) -> WheelSpeeds {
        let (turn, limit) = (self.max_turn_rate_rad_s, self.max_wheel_speed_mps);
        let WheelSpeeds {
            left_mps,
            right_mps,
        } = self.wheel_speeds(Speeds {
            turn_rate_rad_s: speeds.turn_rate_rad_s.clamp(-turn, turn),
            ..speeds
        });
        WheelSpeeds {
            left_mps: left_mps.clamp(-limit, limit),
            right_mps: right_mps.clamp(-limit, limit),
        }
    }
}

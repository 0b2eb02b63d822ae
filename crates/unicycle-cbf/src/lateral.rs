//! How the point of interest moves across the path: the deviation and its derivatives, affine in the inputs.

use serde::{Deserialize, Serialize};

use crate::path::{PathPoint, PolarPath};
use crate::pose::State;
use crate::unicycle::{Affine, Body};

/// Which distance from the path counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deviation {
    /// Along the ray from the origin, `ρ = r − R_path(φ)`: never shorter than the distance to the path, so on the safe side. On
    /// paths that are not polar the same as `Frenet`
    #[default]
    Radial,
    /// Along the normal of the path
    Frenet,
}

/// Motion across the path, seen from a frame that turns with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lateral {
    /// `ρ`, positive on the outside of a counter-clockwise path and to the right of a straight one, in m
    pub deviation_m: f64,
    /// `ρ̇`, in m/s
    pub rate_mps: f64,
    /// `ρ̈`, in m/s²
    pub acceleration: Affine,
    /// Turn rate of the frame: `φ̇` of a radial deviation, `κ ṡ` of a Frenet one, in rad/s
    pub frame_rate_rad_s: f64,
    /// Its derivative, in rad/s²
    pub frame_acceleration: Affine,
}

/// The heading relative to the direction of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// `θ`, in rad, not wrapped
    pub angle_rad: f64,
    /// `θ̇`, in rad/s
    pub rate_rad_s: f64,
    /// `θ̈`, in rad/s²
    pub acceleration: Affine,
}

/// Position along the path and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// `s`, in m
    pub s_m: f64,
    /// `ṡ`, in m/s
    pub rate_mps: f64,
}

/// The motion across a polar path along the ray from the origin (2.22 and 2.23, corrected). `φ̇` is signed, so that nothing is
/// singular at `v = 0`; `unsigned` takes it as printed, which is undefined at 0.
#[must_use]
pub(crate) fn radial(path: &PolarPath, body: &Body, state: &State, unsigned: bool) -> Lateral {
    let r = state.x_m.hypot(state.y_m);
    let phi = state.y_m.atan2(state.x_m);
    let (sin, cos) = (state.heading_rad - phi).sin_cos();
    let (v, across) = (state.speed_mps, body.offset_m * state.turn_rate_rad_s);
    let r_rate = v * cos - across * sin;
    let phi_rate = (v * sin + across * cos) / r;
    let [along, left] = body.point_acceleration(state.speeds());
    let radial = along.combined(cos, left, -sin, 0.0);
    let phi_acceleration = along.combined(sin / r, left, cos / r, -2.0 * r_rate * phi_rate / r);
    let (phi_rate, phi_acceleration) = if unsigned {
        let sign = phi_rate / phi_rate.abs();
        let flipped = phi_acceleration.combined(sign, phi_acceleration, 0.0, 0.0);
        (sign * phi_rate, flipped)
    } else {
        (phi_rate, phi_acceleration)
    };
    let [radius, r1, r2, _] = path.radius(phi);
    Lateral {
        deviation_m: r - radius,
        rate_mps: r_rate - r1 * phi_rate,
        acceleration: radial.combined(1.0, phi_acceleration, -r1, (r - r2) * phi_rate * phi_rate),
        frame_rate_rad_s: phi_rate,
        frame_acceleration: phi_acceleration,
    }
}

/// The Frenet frame under the point of interest, and how the point moves in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frenet {
    foot: PathPoint,
    deviation_m: f64,
    rate_mps: f64,
    progress_mps: f64,
    /// `p̈` along the tangent and along the normal
    accelerations: [Affine; 2],
}

impl Frenet {
    #[must_use]
    pub(crate) fn new(foot: PathPoint, body: &Body, state: &State) -> Self {
        let ([tx, ty], [nx, ny]) = (foot.tangent, foot.normal());
        let deviation_m = foot.deviation_m(state.x_m, state.y_m);
        let [vx, vy] = state.velocity_mps(body.offset_m);
        let (sin, cos) = state.heading_rad.sin_cos();
        let [along, left] = body.point_acceleration(state.speeds());
        let projected =
            |x: f64, y: f64| along.combined(cos * x + sin * y, left, cos * y - sin * x, 0.0);
        Self {
            foot,
            deviation_m,
            rate_mps: vx * nx + vy * ny,
            progress_mps: (vx * tx + vy * ty) / (1.0 + foot.curvature_1pm * deviation_m),
            accelerations: [projected(tx, ty), projected(nx, ny)],
        }
    }

    /// Of the path, a unit vector
    #[must_use]
    pub(crate) fn tangent(&self) -> [f64; 2] {
        self.foot.tangent
    }

    /// `s` and `ṡ`
    #[must_use]
    pub(crate) fn progress(&self) -> Progress {
        Progress {
            s_m: self.foot.s_m,
            rate_mps: self.progress_mps,
        }
    }

    /// Turn rate of the frame, `κ ṡ`, and its derivative.
    fn turn(&self) -> (f64, Affine) {
        let (kappa, kappa_rate) = (self.foot.curvature_1pm, self.foot.curvature_rate_1pm2);
        let (d, d_rate, s_rate) = (self.deviation_m, self.rate_mps, self.progress_mps);
        let stretch = 1.0 + kappa * d;
        let [along, _] = self.accelerations;
        let drift = -s_rate * (2.0 * kappa * d_rate + kappa_rate * s_rate * d) / stretch;
        let share = kappa / stretch;
        let acceleration = along.combined(
            share,
            along,
            0.0,
            kappa * drift + kappa_rate * s_rate * s_rate,
        );
        (kappa * s_rate, acceleration)
    }

    /// `d̈ = p̈·N + κ (ṗ·T)²/(1 + κ d)`, with N to the right of the path.
    #[must_use]
    pub(crate) fn lateral(&self) -> Lateral {
        let (frame_rate_rad_s, frame_acceleration) = self.turn();
        let stretch = 1.0 + self.foot.curvature_1pm * self.deviation_m;
        let turning = frame_rate_rad_s * self.progress_mps * stretch;
        let [_, across] = self.accelerations;
        Lateral {
            deviation_m: self.deviation_m,
            rate_mps: self.rate_mps,
            acceleration: across.combined(1.0, across, 0.0, turning),
            frame_rate_rad_s,
            frame_acceleration,
        }
    }

    /// The heading against the direction of the path.
    #[must_use]
    pub(crate) fn course(&self, body: &Body, state: &State) -> Course {
        let (turn_rate, turn_acceleration) = self.turn();
        let torque = Affine {
            drift: 0.0,
            control: [0.0, 1.0 / body.inertia_kgm2],
        };
        Course {
            angle_rad: state.heading_rad - self.foot.heading_rad(),
            rate_rad_s: state.turn_rate_rad_s - turn_rate,
            acceleration: torque.combined(1.0, turn_acceleration, -1.0, 0.0),
        }
    }
}

//! Control barrier functions of headway, lane and direction of travel (thesis 3.1 to 3.3).

use serde::{Deserialize, Serialize};

use crate::lateral::{Course, Lateral};
use crate::lie::Lie;
use crate::pose::{Speeds, State};
use crate::unicycle::{Affine, Body};

/// Which barrier keeps the robot in its lane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LaneBarrier {
    /// (3.3) `1 − y²/d² − ½ (ẏ/v_ref)²`; one row
    Quadratic {
        /// `v_ref`, missing in the thesis, in m/s
        reference_speed_mps: f64,
    },
    /// (3.2) as two smooth rows `d ∓ y − max(±ẏ, 0)²/(2 a)`
    Braking {
        /// `a`, in m/s²
        max_acceleration_mps2: f64,
    },
    /// Two rows of second order, `−s ÿ − (k1 + k2) s ẏ + k1 k2 (d − s y) ≥ 0`: for a point ahead of the axle they never lose
    /// their hold on the torque, inside the lane or out
    Exponential {
        /// `k1`, in 1/s; `k2` is the rate of the lane rows
        rate_1ps: f64,
    },
}

impl LaneBarrier {
    /// With a reference speed of 1 m/s.
    pub const QUADRATIC: Self = Self::Quadratic {
        reference_speed_mps: 1.0,
    };
    /// With the acceleration that works on the Robotarium.
    pub const BRAKING: Self = Self::Braking {
        max_acceleration_mps2: 0.3,
    };
    /// With the first rate of the hardened preset.
    pub const EXPONENTIAL: Self = Self::Exponential { rate_1ps: 2.0 };

    /// The rate `γ2` that goes with these, in 1/s.
    #[must_use]
    pub fn usual_rate_1ps(&self) -> f64 {
        match self {
            Self::Quadratic { .. } => 1.0,
            Self::Braking { .. } => 2.0,
            Self::Exponential { .. } => 4.0,
        }
    }
}

/// The barriers of the lane, one or two of them, that of the side that the robot moves to first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneBarriers {
    barriers: [(f64, Lie); 2],
    count: usize,
}

impl LaneBarriers {
    /// The side of each, +1 at positive deviations, −1 at negative ones and 0 for both, and the barrier.
    pub fn iter(&self) -> impl Iterator<Item = (f64, Lie)> {
        self.barriers.into_iter().take(self.count)
    }

    /// The smallest value.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.iter()
            .map(|(_, lie)| lie.value)
            .fold(f64::INFINITY, f64::min)
    }

    fn one(lie: Lie) -> Self {
        Self {
            barriers: [(0.0, lie); 2],
            count: 1,
        }
    }

    fn two(lateral: &Lateral, barrier: impl Fn(f64) -> Lie) -> Self {
        let first = if lateral.rate_mps >= 0.0 { 1.0 } else { -1.0 };
        Self {
            barriers: [(first, barrier(first)), (-first, barrier(-first))],
            count: 2,
        }
    }
}

/// The barriers of a lane whose half width, less all margins, is `half_width_m`.
#[must_use]
pub fn lane(kind: LaneBarrier, half_width_m: f64, lateral: &Lateral) -> LaneBarriers {
    let (y, rate) = (lateral.deviation_m, lateral.rate_mps);
    match kind {
        LaneBarrier::Quadratic {
            reference_speed_mps,
        } => {
            let (by_y, by_rate) = (half_width_m.powi(-2), reference_speed_mps.powi(-2));
            let change = scaled(
                lateral.acceleration,
                -rate * by_rate,
                -2.0 * y * rate * by_y,
            );
            LaneBarriers::one(Lie {
                value: 1.0 - y * y * by_y - 0.5 * rate * rate * by_rate,
                lf: change.drift,
                lg: change.control,
            })
        }
        LaneBarrier::Braking {
            max_acceleration_mps2,
        } => LaneBarriers::two(lateral, |side| {
            let outward = (side * rate).max(0.0);
            let by_acceleration = -side * outward / max_acceleration_mps2;
            let change = scaled(lateral.acceleration, by_acceleration, -side * rate);
            Lie {
                value: half_width_m - side * y - 0.5 * outward * outward / max_acceleration_mps2,
                lf: change.drift,
                lg: change.control,
            }
        }),
        LaneBarrier::Exponential { rate_1ps } => LaneBarriers::two(lateral, |side| {
            let change = scaled(lateral.acceleration, -side, -rate_1ps * side * rate);
            Lie {
                value: rate_1ps * (half_width_m - side * y) - side * rate,
                lf: change.drift,
                lg: change.control,
            }
        }),
    }
}

/// (3.2) as printed, with a sign that jumps at `ẏ = 0`: "h ≥ 0 implies |y| ≤ d" does not hold, because at `y = −2 d` it is
/// positive as long as the robot moves to the other side.
#[must_use]
pub fn lane_as_printed(
    max_acceleration_mps2: f64,
    half_width_m: f64,
    lateral: &Lateral,
) -> LaneBarriers {
    let (y, rate) = (lateral.deviation_m, lateral.rate_mps);
    let side = if rate == 0.0 { 0.0 } else { rate.signum() };
    let change = scaled(
        lateral.acceleration,
        -rate / max_acceleration_mps2,
        -side * rate,
    );
    LaneBarriers::one(Lie {
        value: half_width_m - side * y - 0.5 * rate * rate / max_acceleration_mps2,
        lf: change.drift,
        lg: change.control,
    })
}

fn scaled(affine: Affine, by: f64, plus: f64) -> Affine {
    affine.combined(by, affine, 0.0, plus)
}

/// (3.1) `h = D − D0 − τ v` with the chord `D` between the points of interest:
/// `L_f h = e·(ṗ_L − ṗ_F) + τ s a ω²`, `L_g h = [−τ/m, 0]`, `e` the unit vector from follower to leader.
///
/// A chord is never longer than the way along the path, so it errs on the safe side. The leader's velocity, missing in the
/// thesis, is what makes an approaching leader safe.
#[must_use]
pub fn headway(
    body: &Body,
    state: &State,
    leader_place: [f64; 2],
    leader_velocity_mps: [f64; 2],
    time_s: f64,
    standstill_m: f64,
) -> Lie {
    let (dx, dy) = (leader_place[0] - state.x_m, leader_place[1] - state.y_m);
    let distance_m = dx.hypot(dy);
    let velocity = state.velocity_mps(body.offset_m);
    let opening_mps = (dx * (leader_velocity_mps[0] - velocity[0])
        + dy * (leader_velocity_mps[1] - velocity[1]))
        / distance_m.max(f64::MIN_POSITIVE);
    spaced(body, state, distance_m, opening_mps, time_s, standstill_m)
}

/// The middle of a robot's axle, and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axle {
    /// In m
    pub x_m: f64,
    /// In m
    pub y_m: f64,
    /// Unit vector along the heading
    pub direction: [f64; 2],
    /// Of the robot
    pub speeds: Speeds,
}

impl Axle {
    /// That of a robot whose point of interest is in this state.
    #[must_use]
    pub fn new(body: &Body, state: &State) -> Self {
        let (sin, cos) = state.heading_rad.sin_cos();
        Self {
            x_m: state.x_m - body.offset_m * cos,
            y_m: state.y_m - body.offset_m * sin,
            direction: [cos, sin],
            speeds: state.speeds(),
        }
    }
}

/// `h = D − D_b − T b` of two bodies, with `D` between the middles of their axles and `b = v e·t` the own speed towards the other robot,
/// `e` the unit vector to it and `t` the own heading:
///
/// ```text
/// Ḋ = e·(v_j t_j − v t),   ḃ = v̇ e·t + v ω e·n + v t·ė,   ė = (v_j t_j − v t − Ḋ e)/D
/// ```
///
/// Where both robots keep it, `Ḋ = −(b + b_j) ≥ −2 (D − D_b)/T`: the distance never falls below `D_b`, whatever the headings.
#[must_use]
pub fn apart(body: &Body, own: &Axle, other: &Axle, time_s: f64, least_m: f64) -> Lie {
    let (dx, dy) = (other.x_m - own.x_m, other.y_m - own.y_m);
    let distance_m = (dx * dx + dy * dy).sqrt().max(f64::MIN_POSITIVE);
    let (ex, ey) = (dx / distance_m, dy / distance_m);
    let [cos, sin] = own.direction;
    let (v, turn_rate) = (own.speeds.speed_mps, own.speeds.turn_rate_rad_s);
    let other_mps = other.speeds.speed_mps;
    let (wx, wy) = (
        other_mps * other.direction[0] - v * cos,
        other_mps * other.direction[1] - v * sin,
    );
    let opening_mps = ex * wx + ey * wy;
    let (ahead, beside) = (ex * cos + ey * sin, ey * cos - ex * sin);
    let turning = (cos * wx + sin * wy - opening_mps * ahead) / distance_m;
    let acceleration = body.acceleration(turn_rate);
    let drift = acceleration.drift * ahead + v * (turn_rate * beside + turning);
    Lie {
        value: distance_m - least_m - time_s * v * ahead,
        lf: opening_mps - time_s * drift,
        lg: [-time_s * acceleration.control[0] * ahead, 0.0],
    }
}

/// `h = D − D0 − τ v` for a distance that opens at a rate.
#[must_use]
pub fn spaced(
    body: &Body,
    state: &State,
    distance_m: f64,
    opening_mps: f64,
    time_s: f64,
    standstill_m: f64,
) -> Lie {
    let acceleration = body.acceleration(state.turn_rate_rad_s);
    Lie {
        value: distance_m - standstill_m - time_s * state.speed_mps,
        lf: opening_mps - time_s * acceleration.drift,
        lg: [-time_s * acceleration.control[0], 0.0],
    }
}

/// `ḣ + k h` of `h = cos θ − cos θ_max`: the heading stays within `θ_max` of the path's direction, which (3.7) does not ask for.
#[must_use]
pub fn direction(course: &Course, max_angle_rad: f64, rate_1ps: f64) -> Lie {
    let (sin, cos) = course.angle_rad.sin_cos();
    let rate = course.rate_rad_s;
    let drift = -cos * rate * rate - rate_1ps * sin * rate;
    let change = scaled(course.acceleration, -sin, drift);
    Lie {
        value: -sin * rate + rate_1ps * (cos - max_angle_rad.cos()),
        lf: change.drift,
        lg: change.control,
    }
}

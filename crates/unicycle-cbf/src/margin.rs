//! Margins for what the rows cannot see: the time between samples, noise of the poses, wheels that are not as they should be.

use crate::cbf::LaneBarrier;
use crate::lateral::Lateral;
use crate::pose::State;
use crate::settings::{ControllerSettings, Hardening};

/// Share of the half width that margins may take at most.
const MOST_OF_LANE: f64 = 0.8;

/// What is known of the moment that margins are for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// Length of a period, in s
    pub(crate) hold_s: f64,
    /// Age of the newest pose, in s
    pub(crate) age_s: f64,
    /// From the axle to the point of interest, in m
    pub(crate) offset_m: f64,
    /// Distance between the wheels, in m
    pub(crate) wheel_base_m: f64,
}

impl Moment {
    /// Largest turn rate that wrong wheels can cause, in rad/s.
    fn turn_error_rad_s(&self, hardening: &Hardening, state: &State) -> f64 {
        hardening.wheel_error
            * (2.0 * state.speed_mps.abs() / self.wheel_base_m + state.turn_rate_rad_s.abs())
    }

    /// Largest error of the position of the point of interest from noise, in m.
    fn noise_m(&self, hardening: &Hardening) -> f64 {
        hardening.position_noise_m + self.offset_m * hardening.heading_noise_rad
    }
}

/// Taken off the headway barrier, in m.
///
/// Within a period the distance opens or closes by the speeds of both, after the speed command has taken effect at once. Noise
/// moves both robots; wheels that turn faster than told add to the speed now and since the pose was seen.
///
/// The same for the distance of bodies, with the time that its barrier allows for.
pub(crate) fn headway_m(
    settings: &ControllerSettings,
    moment: &Moment,
    state: &State,
    leader_speed_mps: f64,
    time_s: f64,
) -> f64 {
    let hardening = &settings.hardening;
    let speed = state.speed_mps.abs();
    let sampling = if hardening.sampling_margin {
        moment.hold_s * (speed + leader_speed_mps.abs())
    } else {
        0.0
    };
    let noise = 2.0 * moment.noise_m(hardening);
    let wheels = hardening.wheel_error * speed * (time_s + moment.age_s);
    settings.headway.margin_m + sampling + noise + wheels
}

/// Taken off the half width of the lane, in m.
///
/// An error `e` of `ÿ` moves the place at which exponential rows hold the robot by `e/(k1 k2)`, one of `ẏ` by
/// `e (k1 + k2)/(k1 k2)`.
pub(crate) fn lane_m(
    settings: &ControllerSettings,
    moment: &Moment,
    state: &State,
    lateral: &Lateral,
) -> f64 {
    let (lane, hardening) = (&settings.lane, &settings.hardening);
    let (by_rate_s, by_acceleration_s2) = match lane.barrier {
        LaneBarrier::Exponential { rate_1ps } => {
            let product = rate_1ps * lane.rate_1ps;
            ((rate_1ps + lane.rate_1ps) / product, 1.0 / product)
        }
        LaneBarrier::Quadratic { .. } | LaneBarrier::Braking { .. } => (0.0, 0.0),
    };
    let speed = state.speed_mps.abs();
    let turn_error = moment.turn_error_rad_s(hardening, state);
    let heading_error = hardening.heading_noise_rad + moment.age_s * turn_error;
    let sampling = if hardening.sampling_margin {
        moment.hold_s * lateral.rate_mps.abs()
    } else {
        0.0
    };
    let estimate = moment.noise_m(hardening) + moment.age_s * speed * heading_error;
    let rate_error = speed * heading_error + moment.offset_m * turn_error;
    let disturbance = by_rate_s * rate_error + by_acceleration_s2 * speed * turn_error;
    let total = lane.margin_m + sampling + estimate + disturbance;
    total.min(MOST_OF_LANE * lane.half_width_m)
}

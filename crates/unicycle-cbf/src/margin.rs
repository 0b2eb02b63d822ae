//! Margins of the distances to other robots for what the rows cannot see: the time between samples, noise of the poses, wheels that are
//! not as they should be, and the way that braking takes. Those of the lane do not change within a run: see `limits.rs`.

use crate::pose::State;
use crate::settings::{ControllerSettings, Hardening};

/// What is known of the moment that margins are for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// Length of a period, in s
    pub(crate) hold_s: f64,
    /// Age of the newest pose, in s
    pub(crate) age_s: f64,
    /// From the axle to the point of interest, in m
    pub(crate) offset_m: f64,
    /// How fast wheels slow down, in m/s²
    pub(crate) wheel_acceleration_mps2: f64,
}

impl Moment {
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
    let braking = if hardening.wheel_rows {
        0.5 * speed * speed / moment.wheel_acceleration_mps2
    } else {
        0.0
    };
    settings.headway.margin_m + sampling + noise + wheels + braking
}

//! How well a lag explains the ways of wheels.

use super::Stated;
use crate::live::commanded::Commanded;
use crate::live::line::Line;
use crate::live::moved::Moved;

/// Share of twice the error of a wheel by which two wheels may differ: errors of both that add up are worse than either.
const OPPOSED: f64 = 0.75;

/// How well some lag explains the poses, in squares of m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) lag_s: f64,
    pub(super) wheels: [Line; 2],
    /// With the best gains, and with those as stated
    pub(super) free: f64,
    pub(super) bound: f64,
}

impl Candidate {
    pub(super) fn new<'a>(
        moved: impl Iterator<Item = &'a Moved> + Clone,
        told: &Commanded,
        stated: &Stated,
        lag_s: f64,
    ) -> Self {
        let half_m = 0.5 * stated.wheel_base_m;
        let pairs = moved.map(|own| {
            let way = told.until(own.seen.stamp_s - lag_s);
            (way, own)
        });
        let wheels = [-half_m, half_m].map(|arm_m| {
            Line::through(pairs.clone().map(|(way, own)| {
                let told_m = way.along_m + arm_m * way.turn_rad;
                (told_m, own.along_m + arm_m * own.turned_rad)
            }))
        });
        let [left, right] = wheels;
        let [left_gain, right_gain] = bound(wheels.map(|line| line.slope()), stated.wheel_error);
        Self {
            lag_s,
            wheels,
            free: left.rest(left.slope()) + right.rest(right.slope()),
            bound: left.rest(left_gain) + right.rest(right_gain),
        }
    }
}

/// The nearest gains that wheels as stated can have.
fn bound(gains: [f64; 2], error: f64) -> [f64; 2] {
    let [left, right] = gains.map(|gain| gain.clamp(1.0 - error, 1.0 + error));
    let (middle, half) = (0.5 * (left + right), 0.5 * (right - left));
    let half = half.clamp(-OPPOSED * error, OPPOSED * error);
    [middle - half, middle + half]
}

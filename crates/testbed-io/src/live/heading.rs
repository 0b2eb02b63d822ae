//! How far headings may be off by what is known, and what that makes of the place of a point ahead of the axle.

use unicycle_cbf::Scenario;

use super::fit::CourseAngle;

/// Headings that nobody knows better are taken to be off by this at most, in rad.
pub(super) const UNKNOWN_RAD: f64 = 0.35;
/// How many standard deviations what is measured may be off.
const CERTAIN: f64 = 6.0;
/// How fast a robot goes until its heading is known, in m/s, where the lane does not hold what it may be off.
const UNSURE_MPS: f64 = 0.05;

/// What errors of headings take of the lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    half_width_m: f64,
    /// Within this of the path rows keep a robot
    kept_m: f64,
    offset_m: f64,
}

/// What is known of the heading of a robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading {
    /// By how much it may be off, in rad
    most_rad: f64,
    /// By how much it is, as far as is known
    off_rad: f64,
}

impl Room {
    pub(super) fn of(scenario: &Scenario) -> Self {
        let controller = scenario.controller();
        Self {
            half_width_m: scenario.spec().controller.lane.half_width_m,
            kept_m: controller.limits().half_width_m,
            offset_m: controller.body().offset_m,
        }
    }

    /// How far the point of interest is from where it is taken to be if the heading is off, in m.
    pub(super) fn misplaced_m(&self, off_rad: f64) -> f64 {
        2.0 * self.offset_m * (0.5 * off_rad).sin().abs()
    }
}

impl Heading {
    pub(super) const UNKNOWN: Self = Self {
        most_rad: UNKNOWN_RAD,
        off_rad: 0.0,
    };

    /// What the motion of the last seconds shows.
    pub(super) fn learn(&mut self, course: Option<CourseAngle>) {
        let Some(course) = course else { return };
        let (off_rad, sure_rad) = (course.angle_rad.abs(), CERTAIN * course.sigma_rad);
        if sure_rad < UNKNOWN_RAD {
            self.off_rad = off_rad;
            self.most_rad = (off_rad + sure_rad).min(UNKNOWN_RAD.max(off_rad));
        }
    }

    pub(super) fn off_rad(&self) -> f64 {
        self.off_rad
    }

    /// The most that a robot may drive until more is known, in m/s.
    pub(super) fn most_mps(&self, room: &Room) -> Option<f64> {
        let most_m = room.kept_m + room.misplaced_m(self.most_rad);
        (most_m > room.half_width_m).then_some(UNSURE_MPS)
    }

    /// How far a robot may be from the path that is measured at a deviation, in m, if that is beyond its lane, and what rows keep it within.
    pub(super) fn outside_m(&self, room: &Room, deviation_m: f64, noise_m: f64) -> Option<f64> {
        let most_m = deviation_m.abs() + room.misplaced_m(self.off_rad);
        let is_kept = deviation_m.abs() <= room.kept_m + noise_m;
        (!is_kept && most_m > room.half_width_m).then_some(most_m)
    }
}

//! Whether robots can start where they shall.

use crate::error::Error;
use crate::located::Located;
use crate::pose::Speeds;
use crate::scenario::Scenario;

impl Scenario {
    /// Where a robot starts along the path, in m.
    #[must_use]
    pub fn start_m(&self, robot: usize) -> f64 {
        self.spec().robots[robot].start_foot(self.controller()).s_m
    }

    pub(crate) fn check_order(&self) -> Result<(), Error> {
        let path = self.controller().path();
        for robot in 0..self.starts().len().saturating_sub(1) {
            let gap_m = path.distance_along_m(self.start_m(robot + 1), self.start_m(robot));
            if gap_m > 0.0 {
                continue;
            }
            return Err(Error::Start {
                robot: robot + 1,
                what: format!(
                    "starts {:.3} m ahead of the one before it in the list, which it shall follow; list robots from the front",
                    -gap_m
                ),
            });
        }
        Ok(())
    }

    /// No robot starts on another one; with controllers that regard every robot, all stand apart, and whoever follows has its standstill gap.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        let controller = self.controller();
        if !controller.settings().hardening.regards_every_robot() {
            return self.check_bodies();
        }
        for robot in 0..self.starts().len() {
            for other in 0..robot {
                let margin_m = controller.standing_margin_m();
                let least_m = controller.least_distance_m() + margin_m;
                let (apart_m, headway_m) = self.between_starts_m(robot, other);
                if apart_m >= least_m && headway_m.is_none_or(|h| h >= margin_m) {
                    continue;
                }
                let headway = &controller.settings().headway;
                let way_m = headway.time_s * self.initial_speeds(robot).speed_mps.abs();
                let least_m = least_m.max(controller.standstill_m() + way_m + margin_m);
                return Err(Error::Start {
                    robot,
                    what: format!(
                        "starts {apart_m:.3} m from robot {other}, and {least_m:.3} m are needed: both radii of {:.3} m and `headway.clearance_m` of {:.3} m, \
                         or `headway.standstill_m` of {:.3} m, {way_m:.3} m for the speed at which it starts, and {margin_m:.3} m for stated errors",
                        controller.body().radius_m(),
                        headway.clearance_m,
                        headway.standstill_m,
                    ),
                });
            }
        }
        Ok(())
    }

    /// What two robots have between their axles at the start, and the headway of the first where it follows the other.
    fn between_starts_m(&self, robot: usize, other: usize) -> (f64, Option<f64>) {
        let controller = self.controller();
        let start = |robot: usize, speeds: Speeds| Located {
            state: self.starts()[robot].state(controller.body().offset_m, speeds),
            near_m: Some(self.start_m(robot)),
        };
        let (own, place) = (self.starts()[robot], self.starts()[other]);
        let apart_m = (own.x_m - place.x_m).hypot(own.y_m - place.y_m);
        let ahead = start(other, Speeds::ZERO);
        let moving = start(robot, self.initial_speeds(robot));
        let headway_m = (other + 1 == robot && controller.follows(&moving, &ahead))
            .then(|| controller.headway(&moving, &ahead, None).value);
        (apart_m, headway_m)
    }

    fn check_bodies(&self) -> Result<(), Error> {
        let radius_m = self.controller().body().radius_m();
        for (robot, own) in self.starts().iter().enumerate() {
            for (other, place) in self.starts()[..robot].iter().enumerate() {
                let apart_m = (own.x_m - place.x_m).hypot(own.y_m - place.y_m);
                if apart_m < 2.0 * radius_m {
                    let what = format!(
                        "starts {apart_m:.3} m from robot {other}, and on it: both have a radius of {radius_m:.3} m"
                    );
                    return Err(Error::Start { robot, what });
                }
            }
        }
        Ok(())
    }
}

//! Where robots are on the path, and to each other.

use std::f64::consts::PI;

use crate::controller::Controller;
use crate::crossing::Crossing;
use crate::error::Error;
use crate::lateral::Frenet;
use crate::located::Located;
use crate::pose::State;
use crate::settings::Distance;

/// Along the path two places are apart by more than half a circle of this diameter, in what is near: a bend is no crossing.
const APART: f64 = PI;
/// What bodies have beside each other at a crossing beyond what they need, in m.
const BESIDE_M: f64 = 0.02;
/// Share of the angle between two branches that the heading may be off, and the least angle for which that is asked for, in rad.
const SHARE_OF_ANGLE: f64 = 0.45;
const LEAST_ANGLE_RAD: f64 = 0.5;

impl Controller {
    /// Where the path comes near to itself, for controllers that regard every robot
    #[must_use]
    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Where two branches meet, robots ahead are those ahead along the path.
    pub(crate) fn find_crossings(&mut self) -> Result<(), Error> {
        if !self.settings.hardening.regards_every_robot() {
            return Ok(());
        }
        let near_m = self.room_m();
        self.crossings = Crossing::all(self.path(), near_m, APART * near_m)?;
        self.meetings = self.meetings()?;
        if self.crossings.is_empty() {
            return Ok(());
        }
        self.settings.headway.distance = Distance::Path;
        let angles = self
            .crossings
            .iter()
            .map(|crossing| SHARE_OF_ANGLE * crossing.angle_rad);
        let most = angles.filter(|angle| *angle >= LEAST_ANGLE_RAD);
        let course = &mut self.settings.hardening.max_course_angle_rad;
        *course = course.map(|course| most.fold(course, f64::min));
        Ok(())
    }

    /// Where lanes of two branches have a place in common, or robots of both a crossing.
    fn meetings(&self) -> Result<Vec<Crossing>, Error> {
        let width_m = self.limits().half_width_m;
        let near_m = 2.0 * width_m;
        if near_m <= self.room_m() {
            return Ok(self.crossings.clone());
        }
        let bend_m = 1.0 / self.path().max_curvature_1pm();
        Crossing::all(self.path(), near_m, PI * width_m.max(bend_m))
    }

    /// From how far before a crossing a robot has to know whether it waits, in m.
    #[must_use]
    pub fn approach_m(&self) -> f64 {
        let braking_m = self.limits().wheel_speed_mps * self.body_time_s();
        2.0 * (braking_m + self.standing_margin_m()) + BESIDE_M
    }

    /// From how near on another robot has a row, in m between points of interest: from farther away nobody who goes as fast as wheels
    /// may has to brake yet.
    pub(crate) fn reach_m(&self) -> f64 {
        let speed_mps = self.limits().wheel_speed_mps;
        let closing_s = self.body_time_s() + 2.0 / self.settings.headway.rate_1ps;
        let margin_m = self.margin_at_m(speed_mps);
        self.standstill_m() + margin_m + 2.0 * self.body().offset_m + closing_s * speed_mps
    }

    /// Whether a robot is near enough to have a row.
    #[must_use]
    pub fn reaches(&self, state: &State, other: &State) -> bool {
        state.square_m2(other) <= self.reach_m2
    }

    /// What a robot needs behind the next one to stand there, in m along the path.
    #[must_use]
    pub fn room_m(&self) -> f64 {
        self.standstill_m() + self.standing_margin_m() + BESIDE_M
    }

    pub(crate) fn frenet(&self, robot: &Located) -> Frenet {
        let foot = self.foot_near(&robot.state, robot.near_m);
        Frenet::new(foot, self.body(), &robot.state)
    }

    /// Where a robot is along the path, in m.
    #[must_use]
    pub fn s_m(&self, robot: &Located) -> f64 {
        self.foot_near(&robot.state, robot.near_m).s_m
    }

    /// Whether a robot is behind another and keeps a headway to it: where every robot is regarded, to one ahead, and on a loop by
    /// less than half a lap.
    #[must_use]
    pub fn follows(&self, robot: &Located, ahead: &Located) -> bool {
        self.follows_along(self.s_m(robot), self.s_m(ahead))
    }

    /// The same of two places along the path, in m.
    #[must_use]
    pub fn follows_along(&self, s_m: f64, ahead_m: f64) -> bool {
        self.is_followed(self.path().distance_along_m(s_m, ahead_m))
    }

    /// Whether a robot that is so far ahead along the path is followed.
    fn is_followed(&self, distance_m: f64) -> bool {
        if !self.settings.hardening.regards_every_robot() {
            return true;
        }
        let most_m = self
            .path()
            .length_m()
            .map_or(f64::INFINITY, |lap_m| 0.5 * lap_m);
        (0.0..most_m).contains(&distance_m)
    }

    /// How far another robot is ahead along the path, in m, if it is: on a loop by less than half a lap.
    pub(crate) fn ahead_m(&self, own: &Located, other: &Located) -> Option<f64> {
        let ahead_m = self.path().distance_along_m(own.near_m?, other.near_m?);
        (ahead_m > 0.0 && self.is_followed(ahead_m)).then_some(ahead_m)
    }

    /// Whom of some others a robot follows: of those ahead along the path, on a loop by less than half a lap, the next, or one beside that
    /// in the lane to which the chord is shorter where headway is a chord.
    #[must_use]
    pub fn leader(
        &self,
        own: &Located,
        others: impl Iterator<Item = (usize, Option<Located>)> + Clone,
    ) -> Option<usize> {
        let ahead = others.filter_map(|(robot, other)| {
            let other = other?;
            Some((self.ahead_m(own, &other)?, robot, other))
        });
        let (mut next_m, mut second_m, mut next) = (f64::INFINITY, f64::INFINITY, None);
        for (ahead_m, robot, _) in ahead.clone() {
            if ahead_m < next_m {
                (next_m, second_m, next) = (ahead_m, next_m, Some(robot));
            } else {
                second_m = second_m.min(ahead_m);
            }
        }
        let most_m = next_m + 2.0 * self.settings.lane.half_width_m;
        if self.settings.headway.distance == Distance::Path || second_m > most_m {
            return next;
        }
        let square_m2 = |other: &Located| own.state.square_m2(&other.state);
        ahead
            .filter(|(ahead_m, ..)| *ahead_m <= most_m)
            .map(|(_, robot, other)| (square_m2(&other), robot))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, robot)| robot)
    }

    /// What has to lie between the middles of the axles of two robots, in m: both radii and the clearance.
    #[must_use]
    pub fn least_distance_m(&self) -> f64 {
        2.0 * self.body().radius_m() + self.settings.headway.clearance_m
    }
}

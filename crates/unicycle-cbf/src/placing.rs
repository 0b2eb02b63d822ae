//! Where robots are on the path, and to each other.

use crate::controller::Controller;
use crate::crossing::Crossing;
use crate::lateral::Frenet;
use crate::path::PathPoint;
use crate::pose::State;
use crate::settings::Distance;

/// What bodies have beside each other at a crossing beyond what they need, in m.
const BESIDE_M: f64 = 0.02;
/// By how much more a robot heads along one branch than along another for that to be its own, as a cosine.
const MORE_ALONG: f64 = 0.005;
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
    pub(crate) fn find_crossings(&mut self) {
        if !self.settings.hardening.regards_every_robot() {
            return;
        }
        self.crossings = Crossing::all(self.path(), self.room_m());
        if self.crossings.is_empty() {
            return;
        }
        self.settings.headway.distance = Distance::Path;
        let angles = self
            .crossings
            .iter()
            .map(|crossing| SHARE_OF_ANGLE * crossing.angle_rad);
        let most = angles.filter(|angle| *angle >= LEAST_ANGLE_RAD);
        let course = &mut self.settings.hardening.max_course_angle_rad;
        *course = course.map(|course| most.fold(course, f64::min));
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
        let (dx, dy) = (other.x_m - state.x_m, other.y_m - state.y_m);
        dx * dx + dy * dy <= self.reach_m2
    }

    /// What a robot needs behind the next one to stand there, in m along the path.
    #[must_use]
    pub fn room_m(&self) -> f64 {
        self.standstill_m() + self.standing_margin_m() + BESIDE_M
    }

    /// The foot of the point of interest on the path; where branches meet, on the one that goes where the robot heads.
    #[must_use]
    pub fn foot(&self, state: &State) -> PathPoint {
        let foot = self.path().nearest(state.x_m, state.y_m);
        let (sin, cos) = state.heading_rad.sin_cos();
        let along = |point: &PathPoint| cos * point.tangent[0] + sin * point.tangent[1];
        let mut best = foot;
        for crossing in &self.crossings {
            let [a, b] = &crossing.branches;
            for (own, other) in [(a, b), (b, a)] {
                if !own.contains(self.path(), foot.s_m) {
                    continue;
                }
                let beside = self.path().nearest_within(other, state.x_m, state.y_m);
                let is_in_lane = beside.deviation_m(state.x_m, state.y_m).abs()
                    <= self.settings.lane.half_width_m;
                if is_in_lane && along(&beside) > along(&best) + MORE_ALONG {
                    best = beside;
                }
            }
        }
        best
    }

    pub(crate) fn frenet(&self, state: &State) -> Frenet {
        Frenet::new(self.foot(state), self.body(), state)
    }

    /// Where a robot is along the path, in m.
    #[must_use]
    pub fn s_m(&self, state: &State) -> f64 {
        self.foot(state).s_m
    }

    /// Whether a robot is behind another and keeps a headway to it: on a loop, where every robot is regarded, by less than half a lap.
    #[must_use]
    pub fn follows(&self, state: &State, ahead: &State) -> bool {
        self.follows_along(self.s_m(state), self.s_m(ahead))
    }

    /// The same of two places along the path, in m.
    #[must_use]
    pub fn follows_along(&self, s_m: f64, ahead_m: f64) -> bool {
        let every_robot = self.settings.hardening.regards_every_robot();
        let length_m = self.path().length_m().filter(|_| every_robot);
        length_m.is_none_or(|length_m| self.path().distance_along_m(s_m, ahead_m) < 0.5 * length_m)
    }

    /// What has to lie between the middles of the axles of two robots, in m: both radii and the clearance.
    #[must_use]
    pub fn least_distance_m(&self) -> f64 {
        2.0 * self.body().radius_m() + self.settings.headway.clearance_m
    }
}

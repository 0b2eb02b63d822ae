//! Robots followed along the path from one moment to the next: where branches meet, only that tells on which one a robot is.

use std::f64::consts::FRAC_PI_2;

use crate::controller::{Controller, Safety};
use crate::located::Located;
use crate::path::PathPoint;
use crate::path::Span;
use crate::pose::State;
use crate::scenario::Scenario;

/// By how much more a robot heads along one branch than along another for that to be its own, as a cosine.
const MORE_ALONG: f64 = 0.005;
/// A place of the path is the foot of a point that is no farther off its normal, in m.
const OFF_NORMAL_M: f64 = 1e-3;
/// A robot that is farther from its place than this many half widths of the lane was carried elsewhere.
const MOST_HALF_WIDTHS: f64 = 2.0;

/// Slower robots stand, in m/s.
const STANDING_MPS: f64 = 5e-3;

/// All robots over time, from the front.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks(Vec<Track>);

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Track {
    start_m: f64,
    last: Option<Located>,
    has_headway: bool,
}

impl Tracks {
    /// At the start of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let robots = 0..scenario.starts().len();
        let starting = |robot| Track {
            start_m: scenario.start_m(robot),
            last: None,
            has_headway: true,
        };
        Self(robots.map(starting).collect())
    }

    /// Nothing is known any more of where a robot was.
    pub fn reset(&mut self, robot: usize) {
        let track = &mut self.0[robot];
        track.last = None;
        track.has_headway = true;
    }

    /// The foot of a robot that is in this state now.
    pub fn foot(&mut self, controller: &Controller, robot: usize, state: &State) -> PathPoint {
        let track = &mut self.0[robot];
        let foot = match track.last {
            Some(last) => controller.foot_near(state, last.near_m),
            None => {
                let planned = controller.foot_near(state, Some(track.start_m));
                controller.more_along(state, planned, controller.foot(state))
            }
        };
        if foot.s_m.is_finite() {
            track.last = Some(Located {
                state: *state,
                near_m: Some(foot.s_m),
            });
        }
        foot
    }

    /// A robot that is in this state now, with its place.
    pub fn located(&mut self, controller: &Controller, robot: usize, state: State) -> Located {
        let near_m = Some(self.foot(controller, robot, &state).s_m);
        Located { state, near_m }
    }

    /// The same where it was last.
    #[must_use]
    pub fn last(&self, robot: usize, state: State) -> Located {
        let near_m = self.0[robot].last.and_then(|last| last.near_m);
        Located { state, near_m }
    }

    /// Looks whether a robot follows the one before it in the list and keeps a headway to it. Where every robot is regarded and it has
    /// just begun to follow that one, which was beside or behind it, the headway counts as soon as there is some.
    pub fn follow(
        &mut self,
        controller: &Controller,
        robot: usize,
        own: &Located,
        ahead: &Located,
    ) {
        let has_some = || {
            let h_m = controller.safety_of(own, Some(ahead)).headway_m;
            let backwards_m = controller.settings().headway.time_s * own.state.speed_mps.min(0.0);
            h_m.is_some_and(|h_m| h_m + backwards_m >= 0.0)
        };
        let follows = self.follows_named(controller, robot, own, ahead);
        self.0[robot].has_headway = follows && (self.0[robot].has_headway || has_some());
    }

    fn follows_named(
        &self,
        controller: &Controller,
        robot: usize,
        own: &Located,
        ahead: &Located,
    ) -> bool {
        if !controller.settings().hardening.regards_every_robot() {
            return true;
        }
        let others = self.0.iter().map(|track| track.last).enumerate();
        let others = others.filter(|(other, _)| *other != robot);
        let leader = controller.leader(own, others);
        let ahead_m = controller.ahead_m(own, ahead);
        // Beside one another neither follows the other.
        let is_ahead = ahead_m.is_some_and(|ahead_m| ahead_m >= controller.body().radius_m());
        is_ahead && leader == robot.checked_sub(1)
    }

    /// What has to stay at or above zero, without margins, behind the robot before it in the list where it follows that one. A robot
    /// that stands or backs off does not lose its headway by itself: there the distance of bodies decides.
    #[must_use]
    pub fn safety(
        &self,
        controller: &Controller,
        robot: usize,
        own: &Located,
        ahead: Option<&Located>,
    ) -> Safety {
        let mut safety = controller.safety_of(own, ahead.filter(|_| self.0[robot].has_headway));
        let every_robot = controller.settings().hardening.regards_every_robot();
        if every_robot && own.state.speed_mps < STANDING_MPS {
            safety.headway_m = safety.headway_m.filter(|h_m| *h_m >= 0.0);
        }
        safety
    }
}

impl Controller {
    /// The foot of the point of interest on the path where nothing is known of the time before: where branches meet, on the one that
    /// goes where the robot heads.
    #[must_use]
    pub fn foot(&self, state: &State) -> PathPoint {
        let foot = self.path().nearest(state.x_m, state.y_m);
        let mut best = foot;
        for meeting in &self.meetings {
            let [a, b] = &meeting.branches;
            for (own, other) in [(a, b), (b, a)] {
                if !own.contains(self.path(), foot.s_m) {
                    continue;
                }
                let beside = self.path().nearest_within(other, state.x_m, state.y_m);
                let is_in_lane = beside.deviation_m(state.x_m, state.y_m).abs()
                    <= self.settings.lane.half_width_m;
                if is_in_lane {
                    best = self.more_along(state, best, beside);
                }
            }
        }
        best
    }

    /// The first of two places, unless the robot heads more along the path at the second.
    fn more_along(&self, state: &State, first: PathPoint, second: PathPoint) -> PathPoint {
        let (sin, cos) = state.heading_rad.sin_cos();
        let along = |point: &PathPoint| cos * point.tangent[0] + sin * point.tangent[1];
        if along(&second) > along(&first) + MORE_ALONG {
            second
        } else {
            first
        }
    }

    /// The foot of a robot that was near to a place of the path a moment before. Within the radius `R` of the tightest bend from the
    /// path, two feet of one point are at least `π R` apart along it, so that within half of that there is one.
    #[must_use]
    pub fn foot_near(&self, state: &State, near_m: Option<f64>) -> PathPoint {
        let Some(near_m) = near_m.filter(|near_m| near_m.is_finite()) else {
            return self.foot(state);
        };
        let nearest = self.path().nearest(state.x_m, state.y_m);
        let within_m = FRAC_PI_2 / self.path().max_curvature_1pm();
        let ahead_m = self.path().distance_along_m(near_m, nearest.s_m);
        let lap_m = self.path().length_m().unwrap_or(0.0);
        if ahead_m.min(lap_m - ahead_m) <= within_m {
            return nearest;
        }
        let around = Span {
            from_m: near_m - within_m,
            length_m: 2.0 * within_m,
        };
        let own = self.path().nearest_within(&around, state.x_m, state.y_m);
        if self.is_foot(&own, state) {
            own
        } else {
            self.foot(state)
        }
    }

    fn is_foot(&self, place: &PathPoint, state: &State) -> bool {
        let (dx, dy) = (state.x_m - place.x_m, state.y_m - place.y_m);
        let along_m = dx * place.tangent[0] + dy * place.tangent[1];
        let most_m = MOST_HALF_WIDTHS * self.settings.lane.half_width_m;
        along_m.abs() <= OFF_NORMAL_M && dx.hypot(dy) <= most_m
    }
}

//! From a state to the functions and rows of its program.

use crate::cbf::{self, Axle, LaneBarrier, LaneBarriers};
use crate::clf;
use crate::controller::{Around, Controller, Leader, Objectives};
use crate::decision::Terms;
use crate::lateral::{Deviation, Frenet, Lateral, radial};
use crate::lie::Lie;
use crate::margin::{self, Moment};
use crate::path::Path;
use crate::pose::State;
use crate::qp::Solution;
use crate::rows::{RowKind, Rows};
use crate::settings::{Distance, Literal};
use crate::track::Located;
use crate::unicycle::Affine;

/// Rates of the rows for the direction of travel, in 1/s.
const DIRECTION_RATES_1PS: [f64; 2] = [4.0, 4.0];
/// The largest angle to the path of a robot that goes backwards, in rad: there a point ahead of the axle does not align by itself.
const BACKWARDS_ANGLE_RAD: f64 = 0.5;
/// Robots whose bodies have a row, that of the robot ahead among them.
const MOST_BODIES: usize = 5;
/// The time that the barrier between bodies allows for, in s, and in periods at least.
const BODY_TIME_S: f64 = 0.5;
const BODY_PERIODS: f64 = 4.0;

impl Controller {
    pub(crate) fn terms(
        &self,
        state: &State,
        around: Around,
        objectives: &Objectives,
        age_s: f64,
    ) -> Terms {
        let leader = around.leader;
        let settings = self.settings();
        let unsigned = settings.is_literal(Literal::UnsignedAngleRate);
        let frenet = self
            .needs_foot()
            .then(|| around.foot.unwrap_or_else(|| self.foot(state)))
            .map(|foot| Frenet::new(foot, self.body(), state));
        let tracked = match (self.path(), &frenet) {
            (Path::Polar(path), _) => radial(path, self.body(), state, unsigned),
            (_, Some(frenet)) => frenet.lateral(),
            (_, None) => self.frenet(&(*state).into()).lateral(),
        };
        let lateral = match (&frenet, settings.lane.deviation) {
            (Some(frenet), Deviation::Frenet) => frenet.lateral(),
            _ => tracked,
        };
        let lyapunov = [
            clf::speed(self.body(), state, objectives.desired_speed_mps),
            clf::turn_rate(self.body(), state),
            clf::tracking(&tracked),
        ];
        let moment = self.moment(age_s);
        let mut rows = self.lyapunov_rows(&lyapunov, objectives);
        let headway = leader
            .map(|leader| self.headway_rows(&mut rows, state, leader, frenet.as_ref(), &moment));
        if settings.hardening.regards_every_robot() {
            let leader = leader.map(Leader::located);
            let axle = Axle::new(self.body(), state);
            let near = |other: &&Located| self.reaches(state, &other.state);
            for other in leader
                .iter()
                .chain(around.others)
                .take(MOST_BODIES)
                .filter(near)
            {
                self.body_row(&mut rows, state, other, &axle, frenet.as_ref(), &moment);
            }
        }
        if let (Some(line_m), Some(frenet)) = (around.stop_line_m, &frenet) {
            self.give_way_row(&mut rows, state, frenet, line_m, &moment);
        }
        let taken_m = settings.lane.half_width_m - self.limits().half_width_m;
        self.lane_rows(&mut rows, &lateral, taken_m);
        let direction = self.direction(state, frenet.as_ref());
        if let Some(h) = &direction {
            rows.barrier(RowKind::Direction, h, DIRECTION_RATES_1PS[1], 0.0);
        }
        if settings.hardening.wheel_rows {
            self.wheel_rows(&mut rows, state);
        }
        Terms {
            lyapunov,
            headway,
            direction,
            lane: self.lane_barriers(&lateral, 0.0),
            lateral,
            rows,
            solution: Solution::default(),
        }
    }

    /// Whether decisions need the foot on the path.
    #[must_use]
    pub fn needs_foot(&self) -> bool {
        let settings = self.settings();
        !matches!(self.path(), Path::Polar(_))
            || settings.lane.deviation == Deviation::Frenet
            || settings.headway.distance == Distance::Path
            || settings.hardening.max_course_angle_rad.is_some()
            || !self.crossings().is_empty()
    }

    fn direction(&self, state: &State, frenet: Option<&Frenet>) -> Option<Lie> {
        let mut angle_rad = self.settings().hardening.max_course_angle_rad?;
        if state.speed_mps < 0.0 {
            angle_rad = angle_rad.min(BACKWARDS_ANGLE_RAD);
        }
        let course = frenet?.course(self.body(), state);
        Some(cbf::direction(&course, angle_rad, DIRECTION_RATES_1PS[0]))
    }

    fn moment(&self, age_s: f64) -> Moment {
        Moment {
            hold_s: self.hold_s(),
            age_s,
            offset_m: self.body().offset_m,
            wheel_acceleration_mps2: self.body().wheel_acceleration_mps2(),
        }
    }

    fn lyapunov_rows(&self, [speed, turn, path]: &[Lie; 3], objectives: &Objectives) -> Rows {
        let [c1, c2, _] = self.settings().convergence_1ps;
        let mut rows = Rows::new();
        rows.lyapunov(RowKind::Speed, 0, speed, c1);
        rows.lyapunov(RowKind::TurnRate, 1, turn, c2);
        if let Some(tracking) = objectives.tracking {
            rows.lyapunov(RowKind::Tracking, 2, path, tracking.rate_1ps);
        }
        rows
    }

    pub(crate) fn headway(
        &self,
        robot: &Located,
        leader: &Located,
        frenet: Option<&Frenet>,
    ) -> Lie {
        let state = &robot.state;
        let settings = &self.settings().headway;
        if settings.distance == Distance::Path {
            let own = frenet.map_or_else(|| self.frenet(robot).progress(), Frenet::progress);
            let ahead = self.frenet(leader).progress();
            let distance_m = self.path().distance_along_m(own.s_m, ahead.s_m);
            let opening = ahead.rate_mps - own.rate_mps;
            let (time_s, standstill_m) = (settings.time_s, self.standstill_m());
            return cbf::spaced(
                self.body(),
                state,
                distance_m,
                opening,
                time_s,
                standstill_m,
            );
        }
        let velocity = if self.settings().is_literal(Literal::IgnoredLeader) {
            [0.0; 2]
        } else {
            leader.state.velocity_mps(self.body().offset_m)
        };
        let place = [leader.state.x_m, leader.state.y_m];
        let (time_s, standstill_m) = (settings.time_s, self.standstill_m());
        cbf::headway(self.body(), state, place, velocity, time_s, standstill_m)
    }

    fn headway_rows(
        &self,
        rows: &mut Rows,
        state: &State,
        leader: &Leader,
        frenet: Option<&Frenet>,
        moment: &Moment,
    ) -> Lie {
        let settings = self.settings();
        let rate_1ps = settings.headway.rate_1ps;
        let (leader_mps, time_s) = (leader.state.speed_mps, settings.headway.time_s);
        let margin_m = margin::headway_m(settings, moment, state, leader_mps, time_s);
        let robot = Located::from(*state);
        let h = self.headway(&robot, &leader.located(), frenet);
        if settings.is_literal(Literal::BarrierSign) {
            rows.barrier_as_printed(RowKind::Headway, &h, rate_1ps, margin_m);
        } else {
            rows.barrier(RowKind::Headway, &h, rate_1ps, margin_m);
        }
        if settings.hardening.cautious_leader {
            let [x_m, y_m] = leader.last_seen_m;
            let stopped = State {
                x_m,
                y_m,
                speed_mps: 0.0,
                turn_rate_rad_s: 0.0,
                ..leader.state
            };
            let stopped = Located {
                state: stopped,
                ..leader.located()
            };
            let stopped = self.headway(&robot, &stopped, frenet);
            rows.barrier(RowKind::HeadwayStopped, &stopped, rate_1ps, margin_m);
        }
        h
    }

    /// Along the path the offsets of two points of interest cancel, so that bodies are apart there by what their points are.
    pub(crate) fn standstill_m(&self) -> f64 {
        let standstill_m = self.settings().headway.standstill_m;
        if self.settings().hardening.regards_every_robot() {
            standstill_m.max(self.least_distance_m())
        } else {
            standstill_m
        }
    }

    fn body_row(
        &self,
        rows: &mut Rows,
        state: &State,
        other: &Located,
        axle: &Axle,
        frenet: Option<&Frenet>,
        moment: &Moment,
    ) {
        let settings = self.settings();
        let time_s = self.body_time_s();
        let margin_m = margin::headway_m(settings, moment, state, other.state.speed_mps, time_s);
        let other_axle = Axle::new(self.body(), &other.state);
        let apart = |least_m: f64| cbf::apart(self.body(), axle, &other_axle, time_s, least_m);
        let mut h = apart(self.least_distance_m());
        // Only what is near is worth a search of its place along the path.
        let is_near = h.value < 2.0 * self.body().offset_m + self.room_m();
        let backwards = frenet.filter(|_| is_near && state.speed_mps < 0.0);
        let behind = backwards.and_then(|frenet| self.behind(state, frenet, other, time_s));
        if let Some(behind) = behind {
            let points = apart(self.standstill_m() + self.between_points_m(state, &other.state));
            h = if behind.value < points.value {
                behind
            } else {
                points
            };
        }
        rows.barrier(RowKind::Apart, &h, settings.headway.rate_1ps, margin_m);
    }

    /// `h = D − D0 + T v` to a robot behind, along the path: whoever goes backwards leaves it its headway. Where that one measures a
    /// chord it is never the smaller one.
    fn behind(&self, state: &State, frenet: &Frenet, other: &Located, time_s: f64) -> Option<Lie> {
        let (own, behind) = (frenet.progress(), self.frenet(other).progress());
        let distance_m = self.path().distance_along_m(behind.s_m, own.s_m);
        if distance_m <= 0.0 || !self.follows_along(behind.s_m, own.s_m) {
            return None;
        }
        let along = self.settings().headway.distance == Distance::Path;
        let (body, standstill_m) = (self.body(), self.standstill_m());
        let distance_m = if along { distance_m } else { f64::INFINITY };
        let opening_mps = own.rate_mps - behind.rate_mps;
        Some(cbf::spaced(
            body,
            state,
            distance_m,
            opening_mps,
            -time_s,
            standstill_m,
        ))
    }

    /// `h = s_line − s − T v cos θ`, as if a robot stood beyond the line.
    fn give_way_row(
        &self,
        rows: &mut Rows,
        state: &State,
        frenet: &Frenet,
        line_m: f64,
        moment: &Moment,
    ) {
        let settings = self.settings();
        let time_s = self.body_time_s();
        let margin_m = margin::headway_m(settings, moment, state, 0.0, time_s);
        let progress = frenet.progress();
        // Whoever is too near to the line stands, and does not back off.
        let line_m = line_m.max(margin_m);
        let h = cbf::spaced(self.body(), state, line_m, -progress.rate_mps, time_s, 0.0);
        rows.barrier(RowKind::GiveWay, &h, settings.headway.rate_1ps, margin_m);
    }

    /// What margins take of the distance between two robots that stand, in m.
    pub(crate) fn standing_margin_m(&self) -> f64 {
        self.margin_at_m(0.0)
    }

    /// The same of two robots at a speed.
    pub(crate) fn margin_at_m(&self, speed_mps: f64) -> f64 {
        let moment = self.moment(0.0);
        let state = State {
            speed_mps,
            ..State::ORIGIN
        };
        margin::headway_m(
            self.settings(),
            &moment,
            &state,
            speed_mps,
            self.body_time_s(),
        )
    }

    /// The time that barriers between bodies allow for, in s.
    pub(crate) fn body_time_s(&self) -> f64 {
        BODY_TIME_S.max(BODY_PERIODS * self.hold_s())
    }

    /// By how much two points of interest can be nearer to each other than the axles, in m: whoever follows keeps its headway from
    /// point to point.
    fn between_points_m(&self, state: &State, other: &State) -> f64 {
        let turn_rad = other.heading_rad - state.heading_rad;
        2.0 * self.body().offset_m * (0.5 * turn_rad).sin().abs()
    }

    pub(crate) fn lane_barriers(&self, lateral: &Lateral, margin_m: f64) -> LaneBarriers {
        let lane = &self.settings().lane;
        let half_width_m = lane.half_width_m - margin_m;
        match lane.barrier {
            LaneBarrier::Braking {
                max_acceleration_mps2,
            } if self.settings().is_literal(Literal::SwitchingLane) => {
                cbf::lane_as_printed(max_acceleration_mps2, half_width_m, lateral)
            }
            barrier => cbf::lane(barrier, half_width_m, lateral),
        }
    }

    fn lane_rows(&self, rows: &mut Rows, lateral: &Lateral, margin_m: f64) {
        let rate_1ps = self.settings().lane.rate_1ps;
        for (side, h) in self.lane_barriers(lateral, margin_m).iter() {
            let kind = RowKind::lane(side);
            if self.settings().is_literal(Literal::BarrierSign) {
                rows.barrier_as_printed(kind, &h, rate_1ps, 0.0);
            } else {
                rows.barrier(kind, &h, rate_1ps, 0.0);
            }
        }
    }

    /// Wheel speeds and turn rate of the next command stay within the limits, and wheels change no faster than they may: linear in the
    /// inputs but for the change of `ω²` within the period.
    fn wheel_rows(&self, rows: &mut Rows, state: &State) {
        let body = self.body();
        let change = body.acceleration(state.turn_rate_rad_s);
        let speed = change.combined(self.hold_s(), change, 0.0, state.speed_mps);
        let turn = Affine {
            drift: state.turn_rate_rad_s,
            control: [0.0, self.hold_s() / body.inertia_kgm2],
        };
        let half_m = 0.5 * body.wheel_base_m;
        let wheels = body.wheel_speeds(state.speeds());
        let [right, left] = [wheels.right_mps, wheels.left_mps];
        let turn_limit = body.max_turn_rate_rad_s;
        let limits = [
            (
                RowKind::RightForward,
                [1.0, half_m],
                self.next_at_most_mps(right),
            ),
            (
                RowKind::RightBackward,
                [-1.0, -half_m],
                self.next_at_most_mps(-right),
            ),
            (
                RowKind::LeftForward,
                [1.0, -half_m],
                self.next_at_most_mps(left),
            ),
            (
                RowKind::LeftBackward,
                [-1.0, half_m],
                self.next_at_most_mps(-left),
            ),
            (RowKind::TurnLeft, [0.0, 1.0], turn_limit),
            (RowKind::TurnRight, [0.0, -1.0], turn_limit),
        ];
        for (kind, [by_speed, by_turn], limit) in limits {
            rows.at_most(kind, speed.combined(by_speed, turn, by_turn, 0.0), limit);
        }
    }

    /// The most that a wheel of this speed may do in the next period, in m/s: its limit, as far as it can get there.
    fn next_at_most_mps(&self, wheel_mps: f64) -> f64 {
        let change_mps = self.body().wheel_acceleration_mps2() * self.hold_s();
        let limit_mps = self.limits().wheel_speed_mps;
        limit_mps.clamp(wheel_mps - change_mps, wheel_mps + change_mps)
    }
}

//! Rows for other robots: headway, bodies, right of way. Where every robot is regarded none of them asks a robot for more than a stand, so
//! that nobody makes way by leaving its lane.

use crate::cbf::{self, Axle};
use crate::controller::{Around, Controller, Leader};
use crate::lateral::Frenet;
use crate::lie::Lie;
use crate::located::Located;
use crate::margin::{self, Moment};
use crate::pose::State;
use crate::rows::{RowKind, Rows};
use crate::settings::{Distance, Literal};

/// Robots whose bodies have a row, that of the robot ahead among them.
const MOST_BODIES: usize = 5;
/// The time that the barrier between bodies allows for, in s, and in periods at least.
const BODY_TIME_S: f64 = 0.5;
const BODY_PERIODS: f64 = 4.0;

/// A robot at one moment, among others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Own<'a> {
    pub(crate) state: &'a State,
    pub(crate) frenet: Option<&'a Frenet>,
    pub(crate) moment: Moment,
}

/// What is left of the gap between the points of two robots of which one follows the other, and where the other one is.
#[derive(Debug, Clone, Copy)]
struct Gap {
    left_m: f64,
    /// Unit vector to the other one
    towards: [f64; 2],
}

impl Controller {
    /// The rows for all robots around, and the headway without margins.
    pub(crate) fn rows_for_others(
        &self,
        rows: &mut Rows,
        own: &Own,
        around: Around,
    ) -> Option<Lie> {
        let headway = around
            .leader
            .map(|leader| self.headway_rows(rows, own, leader));
        if self.settings().hardening.regards_every_robot() {
            self.body_rows(rows, own, around, headway.as_ref());
        }
        if let (Some(line_m), Some(frenet)) = (around.stop_line_m, own.frenet) {
            self.give_way_row(rows, own, frenet, line_m);
        }
        headway
    }

    pub(crate) fn headway(
        &self,
        robot: &Located,
        leader: &Located,
        frenet: Option<&Frenet>,
    ) -> Lie {
        let state = &robot.state;
        let settings = &self.settings().headway;
        let (time_s, standstill_m) = (settings.time_s, self.standstill_m());
        if settings.distance == Distance::Path {
            let own = frenet.map_or_else(|| self.frenet(robot).progress(), Frenet::progress);
            let ahead = self.frenet(leader).progress();
            let distance_m = self.path().distance_along_m(own.s_m, ahead.s_m);
            let opening_mps = ahead.rate_mps - own.rate_mps;
            return cbf::spaced(
                self.body(),
                state,
                distance_m,
                opening_mps,
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
        cbf::headway(self.body(), state, place, velocity, time_s, standstill_m)
    }

    fn headway_rows(&self, rows: &mut Rows, own: &Own, leader: &Leader) -> Lie {
        let settings = self.settings();
        let robot = Located::from(*own.state);
        let h = self.headway(&robot, &leader.located(), own.frenet);
        let (leader_mps, time_s) = (leader.state.speed_mps, settings.headway.time_s);
        let margin_m = margin::headway_m(settings, &own.moment, own.state, leader_mps, time_s);
        if settings.is_literal(Literal::BarrierSign) {
            let rate_1ps = settings.headway.rate_1ps;
            rows.barrier_as_printed(RowKind::Headway, &h, rate_1ps, margin_m);
        } else {
            self.row_for_other(rows, own.state, RowKind::Headway, &h, margin_m);
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
            let stopped = self.headway(&robot, &stopped, own.frenet);
            self.row_for_other(rows, own.state, RowKind::HeadwayStopped, &stopped, margin_m);
        }
        h
    }

    /// A barrier row; where every robot is regarded it never excludes to stand after a period.
    fn row_for_other(&self, rows: &mut Rows, state: &State, kind: RowKind, h: &Lie, margin_m: f64) {
        let rate_1ps = self.settings().headway.rate_1ps;
        if self.settings().hardening.regards_every_robot() {
            rows.barrier_up_to(kind, h, rate_1ps, margin_m, self.standing_force_n(state));
        } else {
            rows.barrier(kind, h, rate_1ps, margin_m);
        }
    }

    /// The force after a period of which the robot stands.
    fn standing_force_n(&self, state: &State) -> f64 {
        let drift_mps2 = self.body().acceleration(state.turn_rate_rad_s).drift;
        -self.body().mass_kg * (drift_mps2 + state.speed_mps / self.hold_s())
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

    /// Of each robot in reach one for its body, and before it one for the points where one of both follows the other.
    fn body_rows(&self, rows: &mut Rows, own: &Own, around: Around, headway: Option<&Lie>) {
        let axle = Axle::new(self.body(), own.state);
        let leader = around.leader.map(|leader| (leader.located(), headway));
        let others = around.others.iter().map(|other| (*other, None));
        let bodies = leader.into_iter().chain(others).take(MOST_BODIES);
        for (other, headway) in bodies.filter(|(other, _)| self.reaches(own.state, &other.state)) {
            self.body_row(rows, own, &axle, &other, headway);
        }
    }

    /// `headway` is that to the robot ahead.
    fn body_row(
        &self,
        rows: &mut Rows,
        own: &Own,
        axle: &Axle,
        other: &Located,
        headway: Option<&Lie>,
    ) {
        let (time_s, state) = (self.body_time_s(), own.state);
        let other_mps = other.state.speed_mps;
        let margin_m = margin::headway_m(self.settings(), &own.moment, state, other_mps, time_s);
        let other_axle = Axle::new(self.body(), &other.state);
        let apart = |least_m: f64| cbf::apart(self.body(), axle, &other_axle, time_s, least_m);
        let mut h = apart(self.least_distance_m());
        if let Some(headway) = headway {
            self.point_row(
                rows,
                state,
                &self.gap_ahead(own, &other.state, headway, margin_m),
            );
        } else if let Some((gap, behind)) = self.follower(own, other, margin_m) {
            self.point_row(rows, state, &gap);
            if state.speed_mps < 0.0 {
                let points =
                    apart(self.standstill_m() + self.between_points_m(state, &other.state));
                h = if behind.value < points.value {
                    behind
                } else {
                    points
                };
            }
        }
        self.row_for_other(rows, state, RowKind::Apart, &h, margin_m);
    }

    /// The gap to a robot behind that follows this one, and `h = D − D0 + T v` to it along the path: whoever goes backwards leaves it its
    /// headway. Where that one measures a chord it is never the smaller one. None where the robot cannot come nearer to it: only what
    /// is near is worth a search of its place along the path.
    fn follower(&self, own: &Own, other: &Located, margin_m: f64) -> Option<(Gap, Lie)> {
        let (state, frenet) = (own.state, own.frenet?);
        let chord = self.chord(state, &other.state, margin_m);
        let body = self.body();
        let change_mps = body.wheel_acceleration_mps2() * self.hold_s();
        let nearing_mps = body.offset_m * body.max_turn_rate_rad_s + change_mps - state.speed_mps;
        if chord.left_m >= self.body_time_s() * nearing_mps {
            return None;
        }
        let (ahead, behind) = (frenet.progress(), self.frenet(other).progress());
        let distance_m = self.path().distance_along_m(behind.s_m, ahead.s_m);
        if distance_m <= 0.0 || !self.follows_along(behind.s_m, ahead.s_m) {
            return None;
        }
        let along = self.settings().headway.distance == Distance::Path;
        let standstill_m = self.standstill_m();
        let opening_mps = ahead.rate_mps - behind.rate_mps;
        let spaced_m = if along { distance_m } else { f64::INFINITY };
        let time_s = -self.body_time_s();
        let h = cbf::spaced(body, state, spaced_m, opening_mps, time_s, standstill_m);
        let gap = if along {
            let [x, y] = frenet.tangent();
            Gap {
                left_m: distance_m - standstill_m - margin_m,
                towards: [-x, -y],
            }
        } else {
            chord
        };
        Some((gap, h))
    }

    /// The gap to the robot ahead.
    fn gap_ahead(&self, own: &Own, leader: &State, headway: &Lie, margin_m: f64) -> Gap {
        let settings = &self.settings().headway;
        let along = settings.distance == Distance::Path;
        match own.frenet.filter(|_| along) {
            Some(frenet) => Gap {
                left_m: headway.value + settings.time_s * own.state.speed_mps - margin_m,
                towards: frenet.tangent(),
            },
            None => self.chord(own.state, leader, margin_m),
        }
    }

    fn chord(&self, state: &State, other: &State, margin_m: f64) -> Gap {
        let (dx, dy) = (other.x_m - state.x_m, other.y_m - state.y_m);
        let distance_m = dx.hypot(dy).max(f64::MIN_POSITIVE);
        Gap {
            left_m: distance_m - self.standstill_m() - margin_m,
            towards: [dx / distance_m, dy / distance_m],
        }
    }

    /// The point of interest comes nearer to that of another robot by what is left within the time for bodies at most, as the next
    /// speeds move it: `v e·t + a ω e·n ≤ (D − D0 − margin)/T`. Where nothing is left neither of two that stand turns towards the other.
    fn point_row(&self, rows: &mut Rows, state: &State, gap: &Gap) {
        let (body, left_mps) = (self.body(), gap.left_m.max(0.0) / self.body_time_s());
        let fastest_mps = self.limits().wheel_speed_mps + body.offset_m * body.max_turn_rate_rad_s;
        if left_mps >= fastest_mps {
            return;
        }
        let ([x, y], (sin, cos)) = (gap.towards, state.heading_rad.sin_cos());
        let (ahead, beside) = (x * cos + y * sin, y * cos - x * sin);
        let [speed, turn] = self.next_speeds(state);
        let nearing = speed.combined(ahead, turn, body.offset_m * beside, 0.0);
        rows.at_most(RowKind::Point, nearing, left_mps);
    }

    /// `h = s_line − s − T v cos θ`, as if a robot stood beyond the line.
    fn give_way_row(&self, rows: &mut Rows, own: &Own, frenet: &Frenet, line_m: f64) {
        let time_s = self.body_time_s();
        let margin_m = margin::headway_m(self.settings(), &own.moment, own.state, 0.0, time_s);
        let opening_mps = -frenet.progress().rate_mps;
        let h = cbf::spaced(self.body(), own.state, line_m, opening_mps, time_s, 0.0);
        self.row_for_other(rows, own.state, RowKind::GiveWay, &h, margin_m);
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
}

//! From a state to the functions and rows of its program.

use crate::cbf::{self, LaneBarrier, LaneBarriers};
use crate::clf;
use crate::controller::{Around, Controller, Objectives};
use crate::decision::Terms;
use crate::lateral::{Deviation, Frenet, Lateral, radial};
use crate::lie::Lie;
use crate::margin::Moment;
use crate::others::Own;
use crate::path::Path;
use crate::pose::State;
use crate::qp::Solution;
use crate::rows::{RowKind, Rows};
use crate::settings::{Distance, Literal};
use crate::unicycle::Affine;

/// Rates of the rows for the direction of travel, in 1/s.
const DIRECTION_RATES_1PS: [f64; 2] = [4.0, 4.0];
/// The largest angle to the path of a robot that goes backwards, in rad: there a point ahead of the axle does not align by itself.
const BACKWARDS_ANGLE_RAD: f64 = 0.5;

impl Controller {
    pub(crate) fn terms(
        &self,
        state: &State,
        around: Around,
        objectives: &Objectives,
        age_s: f64,
    ) -> Terms {
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
        let own = Own {
            state,
            frenet: frenet.as_ref(),
            moment,
        };
        let headway = self.rows_for_others(&mut rows, &own, around);
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

    /// Whether decisions need the foot on the path: where every robot is regarded, whoever is ahead is found by it.
    #[must_use]
    pub fn needs_foot(&self) -> bool {
        let settings = self.settings();
        !matches!(self.path(), Path::Polar(_))
            || settings.lane.deviation == Deviation::Frenet
            || settings.headway.distance == Distance::Path
            || settings.hardening.max_course_angle_rad.is_some()
            || settings.hardening.regards_every_robot()
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

    pub(crate) fn moment(&self, age_s: f64) -> Moment {
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

    /// Speed and turn rate after the period.
    pub(crate) fn next_speeds(&self, state: &State) -> [Affine; 2] {
        let body = self.body();
        let change = body.acceleration(state.turn_rate_rad_s);
        let turn = Affine {
            drift: state.turn_rate_rad_s,
            control: [0.0, self.hold_s() / body.inertia_kgm2],
        };
        [
            change.combined(self.hold_s(), change, 0.0, state.speed_mps),
            turn,
        ]
    }

    /// Wheel speeds and turn rate of the next command stay within the limits, and wheels change no faster than they may: linear in the
    /// inputs but for the change of `ω²` within the period.
    fn wheel_rows(&self, rows: &mut Rows, state: &State) {
        let body = self.body();
        let [speed, turn] = self.next_speeds(state);
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

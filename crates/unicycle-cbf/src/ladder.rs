//! What is done where rows contradict each other: a robot stands before it leaves its lane.

use crate::controller::Controller;
use crate::decision::{Brake, Decision, Outcome, Terms};
use crate::pose::State;
use crate::qp::{self, MAX_ROWS, Row, Solution, Status};
use crate::rows::RowKind;

/// Weight of the slack that lane rows share on the second rung, against 1 of the inputs.
const RELAXATION_WEIGHT: f64 = 1e9;

/// By how much more the row of the direction gives way than those of the lane.
const DIRECTION_SHARE: f64 = 10.0;

/// A robot that stands is not faster than this, in m/s.
const STILL_MPS: f64 = 1e-3;

impl Controller {
    /// Whether a robot whose rows contradict each other stands before anything gives way: within its lane, where every robot is regarded,
    /// unless it stands after a period anyway.
    pub(crate) fn is_to_stand(&self, state: &State, terms: &Terms) -> bool {
        let change_mps = self.body().wheel_acceleration_mps2() * self.hold_s();
        self.keeps_place(terms) && state.speed_mps.abs() > change_mps
    }

    /// Whether a robot is where it may stay: within its lane, where every robot is regarded.
    fn keeps_place(&self, terms: &Terms) -> bool {
        let deviation_m = terms.lateral.deviation_m.abs();
        self.settings().hardening.regards_every_robot()
            && deviation_m <= self.settings().lane.half_width_m
    }

    /// Zero speed after the period, in place of the wishes for a speed and for no turning: a robot may turn where it stands, and what
    /// gives way cannot be had by driving.
    fn stand(&self, state: &State, terms: &mut Terms) {
        let [speed, _] = self.next_speeds(state);
        for (kind, side) in [(RowKind::Speed, 1.0), (RowKind::TurnRate, -1.0)] {
            let [force, torque] = speed.control.map(|share| side * share);
            let row = Row {
                a: [force, torque, 0.0, 0.0, 0.0],
                b: STILL_MPS - side * speed.drift,
            };
            terms.rows.replace(kind, row);
        }
    }

    /// The second rung: lane rows and that of the direction share a slack, and a robot within its lane stands. Then the last: braking.
    pub(crate) fn relaxed(&self, state: &State, mut terms: Terms, weights: &[f64; 5]) -> Decision {
        if self.keeps_place(&terms) {
            self.stand(state, &mut terms);
        }
        let none = Row::<6> {
            a: [0.0; 6],
            b: 0.0,
        };
        let mut soft = [none; MAX_ROWS];
        let rows = terms.rows.as_slice();
        for (soft, (row, kind)) in soft.iter_mut().zip(rows.iter().zip(terms.rows.kinds())) {
            let [a0, a1, a2, a3, a4] = row.a;
            let slack = match kind {
                RowKind::Direction => -DIRECTION_SHARE,
                kind if kind.is_lane() => -1.0,
                _ => 0.0,
            };
            soft.a = [a0, a1, a2, a3, a4, slack];
            soft.b = row.b;
        }
        let [w0, w1, w2, w3, w4] = *weights;
        let weights = [w0, w1, w2, w3, w4, RELAXATION_WEIGHT];
        let solution = qp::solve(&weights, &soft[..rows.len()]);
        let [z0, z1, z2, z3, z4, _] = solution.z;
        terms.solution = Solution {
            status: solution.status,
            z: [z0, z1, z2, z3, z4],
            multipliers: solution.multipliers,
            active: solution.active,
            iterations: solution.iterations,
        };
        let reason = match solution.status {
            Status::Optimal => {
                let (row, by) = most_violated(&terms);
                return self.decided(Outcome::Relaxed { row, by }, state, terms);
            }
            Status::Infeasible => Brake::Infeasible,
            Status::IterationLimit => Brake::Solver,
            Status::NotFinite | Status::TooManyRows => Brake::NotFinite,
        };
        Decision::braking(reason, Some(*state), Some(terms))
    }
}

/// The row whose left side exceeds its right side most.
fn most_violated(terms: &Terms) -> (RowKind, f64) {
    let z = &terms.solution.z;
    let excess = |row: &Row| row.a.iter().zip(z).map(|(a, z)| a * z).sum::<f64>() - row.b;
    let rows = terms.rows.as_slice().iter().zip(terms.rows.kinds());
    rows.filter(|(_, kind)| kind.is_lane() || **kind == RowKind::Direction)
        .map(|(row, kind)| (*kind, excess(row)))
        .fold((RowKind::Lane, 0.0), |most, next| {
            if next.1 > most.1 { next } else { most }
        })
}

//! The ladder, the watchdog, the predictor and the limits of the wheels.

use proptest::prelude::*;
use unicycle_cbf::{
    Brake, Controller, Input, Leader, Outcome, Pilot, Pose, Predictor, Preset, RowKind, Speeds,
    StampedPose, State, Testbed, pilot::Ahead,
};

use crate::states::{controller, state};

fn hardened() -> Controller {
    controller(Testbed::Khepera, "on-off", Preset::Hardened, |_| {})
}

fn thesis(testbed: Testbed) -> Controller {
    controller(testbed, "on-off", Preset::Thesis, |_| {})
}

/// On a path of the controller, so far to its outside, moving outward at a lateral speed of zero.
fn beside(controller: &Controller, deviation_m: f64, speed_mps: f64) -> State {
    let foot = controller.path().nearest(1.0, 0.3);
    let [nx, ny] = foot.normal();
    State {
        x_m: foot.x_m + deviation_m * nx,
        y_m: foot.y_m + deviation_m * ny,
        speed_mps,
        heading_rad: foot.heading_rad(),
        turn_rate_rad_s: 0.0,
    }
}

fn far_ahead() -> Leader {
    Leader::known(State {
        x_m: -3.0,
        y_m: 0.0,
        speed_mps: 0.0,
        heading_rad: 0.0,
        turn_rate_rad_s: 0.0,
    })
}

#[test]
fn outside_the_lane_the_thesis_barriers_give_way_and_say_so() {
    for &testbed in Testbed::ALL {
        let controller = thesis(testbed);
        let lane_m = controller.settings().lane.half_width_m;
        let own = beside(&controller, 2.0 * lane_m, 0.0);
        let own = State {
            heading_rad: controller.path().nearest(own.x_m, own.y_m).heading_rad(),
            ..own
        };
        let decision =
            controller.decide(&own, Some(&far_ahead()), &controller.objectives(0.1), 0.0);
        let Outcome::Relaxed { row, by } = decision.outcome else {
            panic!("{:?}", decision.outcome);
        };
        assert!(row.is_lane() && by > 0.0, "{row:?} {by}");
        // Multipliers belong to the relaxed program: its lane row pushes, and is counted as active.
        let terms = decision.terms.unwrap();
        let relaxed = terms
            .rows
            .kinds()
            .iter()
            .position(|kind| *kind == row)
            .unwrap();
        assert!(terms.solution.is_active(relaxed) && terms.solution.multipliers[relaxed] > 0.0);
    }
}

#[test]
fn outside_the_lane_exponential_rows_still_steer() {
    let controller = hardened();
    let own = beside(&controller, 0.2, 0.05);
    let decision = controller.decide(&own, Some(&far_ahead()), &controller.objectives(0.2), 0.0);
    assert_eq!(decision.outcome, Outcome::Optimal);
    let outward = controller.lateral(&own).acceleration.at(decision.input);
    assert!(outward < 0.0, "{outward}");
}

#[test]
fn contradicting_wheel_limits_brake() {
    // It turns far faster than it may, and wheels do not slow down to that in a period.
    let controller = hardened();
    let own = State {
        turn_rate_rad_s: 20.0,
        ..beside(&controller, 0.0, 0.3)
    };
    let decision = controller.decide(&own, None, &controller.objectives(0.2), 0.0);
    assert_eq!(
        decision.outcome,
        Outcome::Braking {
            reason: Brake::Infeasible
        }
    );
    assert_eq!(decision.speeds, Speeds::ZERO);
}

#[test]
fn a_leader_behind_is_kept_at_a_distance_like_any_other() {
    let controller = hardened();
    let own = beside(&controller, 0.0, 0.2);
    let (sin, cos) = own.heading_rad.sin_cos();
    let behind = Leader::known(State {
        x_m: own.x_m - 0.2 * cos,
        y_m: own.y_m - 0.2 * sin,
        ..own
    });
    let decision = controller.decide(&own, Some(&behind), &controller.objectives(0.2), 0.0);
    assert!(decision.speeds.speed_mps < own.speed_mps);
    assert!(decision.terms.unwrap().headway.unwrap().value < 0.0);
}

#[test]
fn numbers_that_are_none_stop_the_robot() {
    for preset in [Preset::Thesis, Preset::Hardened] {
        let controller = controller(Testbed::Robotarium, "track", preset, |_| {});
        let good = beside(&controller, 0.0, 0.1);
        let bad = [
            State {
                x_m: f64::NAN,
                ..good
            },
            State {
                speed_mps: f64::INFINITY,
                ..good
            },
            State {
                x_m: 1e308,
                y_m: -1e308,
                ..good
            },
            State {
                turn_rate_rad_s: 1e200,
                ..good
            },
            State {
                x_m: 0.0,
                y_m: 0.0,
                ..good
            },
        ];
        for own in bad {
            for leader in [good, own] {
                let leader = Leader::known(leader);
                let decision =
                    controller.decide(&own, Some(&leader), &controller.objectives(0.1), 0.0);
                let finite = decision.speeds.speed_mps.is_finite()
                    && decision.speeds.turn_rate_rad_s.is_finite();
                assert!(finite, "{own:?}");
                if !own.is_finite() {
                    let reason = Brake::NotFinite;
                    assert_eq!(decision.outcome, Outcome::Braking { reason });
                }
            }
        }
    }
}

#[test]
fn without_poses_the_robot_stands() {
    let controller = hardened();
    let objectives = controller.objectives(0.2);
    let mut pilot = Pilot::new(0.0, Speeds::ZERO);
    let reason = |decision: unicycle_cbf::Decision| match decision.outcome {
        Outcome::Braking { reason } => Some(reason),
        _ => None,
    };
    assert_eq!(
        reason(pilot.decide(&controller, 0.0, Ahead::Nobody, &objectives)),
        Some(Brake::NoPose)
    );
    let own = beside(&controller, 0.0, 0.0);
    let pose = Pose {
        x_m: own.x_m,
        y_m: own.y_m,
        heading_rad: own.heading_rad,
    };
    let nan = Pose {
        x_m: f64::NAN,
        ..pose
    };
    pilot.observe(
        &controller,
        StampedPose {
            stamp_s: 0.1,
            pose: nan,
        },
    );
    assert_eq!(
        reason(pilot.decide(&controller, 0.1, Ahead::Nobody, &objectives)),
        Some(Brake::NoPose)
    );
    pilot.observe(&controller, StampedPose { stamp_s: 0.2, pose });
    assert_eq!(
        reason(pilot.decide(&controller, 0.2, Ahead::Nobody, &objectives)),
        None
    );
    assert_eq!(
        reason(pilot.decide(&controller, 0.2, Ahead::Unseen, &objectives)),
        Some(Brake::LeaderLost)
    );
    let late_s = 0.2 + controller.settings().hardening.max_pose_age_s.unwrap() + 1e-9;
    assert_eq!(
        reason(pilot.decide(&controller, late_s, Ahead::Nobody, &objectives)),
        Some(Brake::StalePose)
    );
    let stop = unicycle_cbf::Objectives {
        stop: true,
        ..objectives
    };
    assert_eq!(
        reason(pilot.decide(&controller, 0.2, Ahead::Nobody, &stop)),
        Some(Brake::Asked)
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_state_gives_a_decision_that_the_wheels_can_do(
        own in state(),
        ahead in state(),
        hardened in any::<bool>(),
        desired in -0.5..0.5,
        age_s in 0.0..0.3,
    ) {
        let preset = if hardened { Preset::Hardened } else { Preset::Thesis };
        let controller = controller(Testbed::Khepera, "decay", preset, |_| {});
        let decision = controller.decide(&own, Some(&Leader::known(ahead)), &controller.objectives(desired), age_s);
        let body = controller.body();
        let most = body.max_wheel_speed_mps * (1.0 + 1e-12);
        prop_assert!(decision.wheels.left_mps.abs() <= most && decision.wheels.right_mps.abs() <= most);
        prop_assert_eq!(decision.speeds, body.speeds_of(decision.wheels));
        let terms = decision.terms.unwrap();
        let rows = terms.rows.as_slice();
        let violated = |kind: &RowKind, row: &unicycle_cbf::qp::Row| {
            let left: f64 = row.a.iter().zip(&terms.solution.z).map(|(a, z)| a * z).sum();
            let size = row.a.iter().fold(row.b.abs(), |most, a| most.max(a.abs()));
            left > row.b + 1e-7 * size.max(1.0) && !kind.is_lane() && *kind != RowKind::Direction
        };
        if !matches!(decision.outcome, Outcome::Braking { .. }) {
            let any = terms.rows.kinds().iter().zip(rows).any(|(kind, row)| violated(kind, row));
            prop_assert!(!any, "{:?}", decision.outcome);
        }
    }

    /// With wheel rows nothing is left to clip but the change of ω² within the period.
    #[test]
    fn wheel_rows_leave_little_to_clip(own in state(), ahead in state()) {
        let controller = hardened();
        let decision = controller.decide(&own, Some(&Leader::known(ahead)), &controller.objectives(0.3), 0.0);
        prop_assume!(!matches!(decision.outcome, Outcome::Braking { .. }));
        let speeds = controller.body().speeds_after(own.speeds(), decision.input, controller.hold_s());
        let before = controller.body().wheel_speeds(speeds);
        let turned = decision.speeds.turn_rate_rad_s - own.turn_rate_rad_s;
        let change = controller.body().offset_m * controller.hold_s()
            * (2.0 * own.turn_rate_rad_s.abs() + turned.abs()) * turned.abs();
        prop_assert!((before.left_mps - decision.wheels.left_mps).abs() <= change + 1e-9);
        prop_assert!((before.right_mps - decision.wheels.right_mps).abs() <= change + 1e-9);
    }

    /// A pose of any age, carried through the commands sent since, is where the robot is.
    #[test]
    fn the_predictor_follows_the_commands(
        commands in prop::collection::vec((-0.3..0.3, -2.0..2.0), 1..40),
        seen_at in 0.0..1.0,
        heading_rad in -3.0..3.0,
    ) {
        let period_s = 0.02;
        let mut predictor = Predictor::default();
        let mut pose = Pose { x_m: 0.3, y_m: -0.2, heading_rad };
        let end_s = period_s * commands.len() as f64;
        let stamp_s: f64 = seen_at * end_s;
        let mut seen = None;
        for (i, (speed_mps, turn_rate_rad_s)) in commands.iter().enumerate() {
            let start_s = period_s * i as f64;
            let speeds = Speeds { speed_mps: *speed_mps, turn_rate_rad_s: *turn_rate_rad_s };
            predictor.sent(start_s, speeds);
            if seen.is_none() && stamp_s < start_s + period_s {
                seen = Some(pose.advanced(speeds, (stamp_s - start_s).max(0.0)));
            }
            pose = pose.advanced(speeds, period_s);
        }
        predictor.observe(StampedPose { stamp_s, pose: seen.unwrap_or(pose) }, [1.0, 1.0], 1.0);
        let found = predictor.at(end_s).unwrap();
        prop_assert!((found.x_m - pose.x_m).abs() < 1e-9 && (found.y_m - pose.y_m).abs() < 1e-9);
        prop_assert!((found.heading_rad - pose.heading_rad).abs() < 1e-9);
    }

    #[test]
    fn an_arc_is_what_the_dynamics_give(own in state(), duration_s in 0.0..1.0) {
        let body = Testbed::Khepera.body();
        let still = unicycle_cbf::Body { offset_m: 1e-12, ..body };
        let pose = Pose { x_m: own.x_m, y_m: own.y_m, heading_rad: own.heading_rad };
        let arc = pose.advanced(own.speeds(), duration_s);
        let mut steps = own;
        for _ in 0..100 {
            steps = still.integrated(&steps, Input::default(), duration_s / 100.0);
        }
        prop_assert!((arc.x_m - steps.x_m).abs() < 1e-8 && (arc.y_m - steps.y_m).abs() < 1e-8);
    }

    #[test]
    fn old_poses_and_repeated_ones_change_nothing(newer in 0.1..1.0, older in 0.0..1.0) {
        let pose = Pose { x_m: 1.0, y_m: 0.0, heading_rad: 0.0 };
        let other = Pose { x_m: 9.0, y_m: 9.0, heading_rad: 1.0 };
        let mut predictor = Predictor::default();
        predictor.observe(StampedPose { stamp_s: newer, pose }, [0.5, 0.5], 1.0);
        predictor.observe(StampedPose { stamp_s: newer * older, pose: other }, [0.5, 0.5], 1.0);
        prop_assert_eq!(predictor.at(newer), Some(pose));
    }
}

/// A leader that laps comes up from behind: then it is not the one that is followed, and a short chord to it is no headway.
#[test]
fn a_robot_more_than_half_a_lap_ahead_is_not_followed() {
    let controller = hardened();
    let at = |share: f64| {
        let length_m = controller.path().length_m().unwrap();
        let point = controller.path().at(share * length_m);
        State {
            x_m: point.x_m,
            y_m: point.y_m,
            heading_rad: point.heading_rad(),
            ..State::ORIGIN
        }
    };
    for (ahead, is_followed) in [(0.2, true), (0.45, true), (0.55, false), (0.97, false)] {
        let follows = controller.follows(&at(0.0).into(), &at(ahead).into());
        assert_eq!(follows, is_followed, "{ahead}");
    }
}

//! Every derivative in closed form against finite differences along the dynamics.

use proptest::prelude::*;
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::path::Path;
use unicycle_cbf::{
    Centripetal, Controller, Input, Leader, Lie, Preset, State, Testbed, lateral::Deviation,
    settings::Distance,
};

use crate::states::{controller, ellipse, state};

/// Half the step of the central differences, in s.
const STEP_S: f64 = 2e-6;

/// Differences of values of about one over twice the step have an error of 1e-10; beside the kink of the braking barrier of some
/// times the step.
const TOLERANCE: f64 = 2e-5;

fn paths() -> impl Strategy<Value = Path> {
    prop_oneof![
        Just(Path::polar(0.9, 0.23, 3).unwrap()),
        Just(Path::polar(0.8, 0.0, 0).unwrap()),
        Just(Path::straight(0.2, -0.1, 0.7).unwrap()),
        Just(ellipse()),
    ]
}

fn any_controller() -> impl Strategy<Value = Controller> {
    let barrier = prop_oneof![
        Just(LaneBarrier::Quadratic {
            reference_speed_mps: 0.7
        }),
        Just(LaneBarrier::Braking {
            max_acceleration_mps2: 0.4
        }),
        Just(LaneBarrier::Exponential { rate_1ps: 2.5 }),
    ];
    (
        paths(),
        barrier,
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(|(path, barrier, frenet, newton, along)| {
            let base = controller(Testbed::Khepera, "on-off", Preset::Hardened, |settings| {
                settings.lane.barrier = barrier;
                settings.hardening.sampling_margin = false;
                settings.hardening.cautious_leader = false;
                settings.hardening.position_noise_m = 0.0;
                settings.hardening.heading_noise_rad = 0.0;
                settings.hardening.wheel_error = 0.0;
                settings.headway.margin_m = 0.0;
                settings.lane.margin_m = 0.0;
                if frenet {
                    settings.lane.deviation = Deviation::Frenet;
                }
                if along {
                    settings.headway.distance = Distance::Path;
                }
            });
            let mut body = *base.body();
            if newton {
                body.centripetal = Centripetal::Newton;
            }
            Controller::new(path, body, base.settings().clone(), base.hold_s()).unwrap()
        })
}

/// All functions of the state that have rows: `V`, headway, direction, lane.
fn functions(controller: &Controller, own: &State, ahead: &State) -> Vec<Lie> {
    let decision = controller.decide(
        own,
        Some(&Leader::known(*ahead)),
        &controller.objectives(0.2),
        0.0,
    );
    let terms = decision.terms.unwrap();
    let mut all = terms.lyapunov.to_vec();
    all.extend(terms.headway);
    all.extend(terms.direction);
    let mut lane: Vec<(f64, Lie)> = terms.lane.iter().collect();
    lane.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.extend(lane.into_iter().map(|(_, lie)| lie));
    all
}

/// The state so much later, or earlier.
fn moved(controller: &Controller, own: &State, input: Input, by_s: f64) -> State {
    controller.body().integrated(own, input, by_s)
}

/// Far from the path's centres of curvature, where the nearest point jumps, and from the joints of a spline, where `dκ/ds` does.
fn is_smooth(controller: &Controller, state: &State) -> bool {
    let foot = |by_s: f64| {
        let state = moved(controller, state, Input::default(), by_s);
        let foot = controller.path().nearest(state.x_m, state.y_m);
        (foot, foot.deviation_m(state.x_m, state.y_m))
    };
    let ((now, deviation), (after, _), (before, _)) = (foot(0.0), foot(STEP_S), foot(-STEP_S));
    let jump = (after.curvature_rate_1pm2 - before.curvature_rate_1pm2).abs();
    (now.curvature_1pm * deviation).abs() < 0.5 && jump < 1e-3
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn lie_derivatives_are_those_of_the_dynamics(
        controller in any_controller(),
        own in state(),
        ahead in state(),
        force_n in -0.1..0.1,
        torque_nm in -2e-3..2e-3,
    ) {
        let input = Input { force_n, torque_nm };
        prop_assume!(is_smooth(&controller, &own));
        prop_assume!(is_smooth(&controller, &ahead));
        prop_assume!((own.x_m - ahead.x_m).hypot(own.y_m - ahead.y_m) > 0.05);

        let at = |by_s: f64| {
            let own = moved(&controller, &own, input, by_s);
            let ahead = moved(&controller, &ahead, Input::default(), by_s);
            functions(&controller, &own, &ahead)
        };
        let (now, after, before) = (at(0.0), at(STEP_S), at(-STEP_S));
        prop_assert_eq!(now.len(), after.len());
        for ((now, after), before) in now.iter().zip(&after).zip(&before) {
            let change = (after.value - before.value) / (2.0 * STEP_S);
            if change.abs() > 100.0 {
                continue; // The distance along a closed path wraps.
            }
            let rate = now.rate([force_n, torque_nm]);
            let size = now.lf.abs() + (now.lg[0] * force_n).abs() + (now.lg[1] * torque_nm).abs();
            prop_assert!(
                (rate - change).abs() <= TOLERANCE * size.max(1.0),
                "{} in place of {}", rate, change
            );
        }
    }

    #[test]
    fn accelerations_are_those_of_the_dynamics(
        controller in any_controller(),
        own in state(),
        force_n in -0.1..0.1,
        torque_nm in -2e-3..2e-3,
    ) {
        let input = Input { force_n, torque_nm };
        prop_assume!(is_smooth(&controller, &own));
        let at = |by_s: f64| controller.lateral(&moved(&controller, &own, input, by_s));
        let (now, after, before) = (at(0.0), at(STEP_S), at(-STEP_S));
        let pairs = [
            (now.rate_mps, after.deviation_m - before.deviation_m),
            (now.acceleration.at(input), after.rate_mps - before.rate_mps),
            (now.frame_acceleration.at(input), after.frame_rate_rad_s - before.frame_rate_rad_s),
        ];
        for (rate, difference) in pairs {
            let change = difference / (2.0 * STEP_S);
            prop_assert!((rate - change).abs() <= TOLERANCE * rate.abs().max(1.0), "{} in place of {}", rate, change);
        }
    }

    /// The function of the direction is the derivative of the angle's cosine, and four times what is left of it.
    #[test]
    fn the_direction_is_that_of_the_path(controller in any_controller(), own in state()) {
        prop_assume!(is_smooth(&controller, &own));
        let cosine = |by_s: f64| {
            let state = moved(&controller, &own, Input::default(), by_s);
            let foot = controller.path().nearest(state.x_m, state.y_m);
            (state.heading_rad - foot.heading_rad()).cos()
        };
        let change = (cosine(STEP_S) - cosine(-STEP_S)) / (2.0 * STEP_S);
        let set_rad = controller.settings().hardening.max_course_angle_rad.unwrap();
        let angle_rad = if own.speed_mps < 0.0 { 0.5 } else { set_rad };
        let expected = change + 4.0 * (cosine(0.0) - angle_rad.cos());
        let decision = controller.decide(&own, None, &controller.objectives(0.2), 0.0);
        let found = decision.terms.unwrap().direction.unwrap().value;
        prop_assert!((found - expected).abs() < TOLERANCE * found.abs().max(1.0), "{} in place of {}", found, expected);
    }

    #[test]
    fn speeds_need_no_position(own in state(), force_n in -1.0..1.0, torque_nm in -0.01..0.01, newton in any::<bool>()) {
        let mut body = Testbed::Khepera.body();
        if newton {
            body.centripetal = Centripetal::Newton;
        }
        let input = Input { force_n, torque_nm };
        let whole = body.integrated(&own, input, 0.02);
        let speeds = body.speeds_after(own.speeds(), input, 0.02);
        prop_assert!((whole.speed_mps - speeds.speed_mps).abs() < 1e-12);
        prop_assert!((whole.turn_rate_rad_s - speeds.turn_rate_rad_s).abs() < 1e-12);
    }
}

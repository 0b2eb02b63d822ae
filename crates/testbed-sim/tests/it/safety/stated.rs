//! The guarantee: errors within what a scenario states take no robot out of its lane.

use proptest::prelude::*;
use testbed_sim::{Disturbances, Simulation};
use unicycle_cbf::{
    Error, PathSpec, RobotSpec, Scenario, ScenarioSpec, Testbed, Tracker, lateral::Deviation,
};

use super::hardened;

fn paths() -> impl Strategy<Value = PathSpec> {
    let straight = (-3.0..3.0_f64).prop_map(|heading_rad| PathSpec::Straight {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad,
    });
    let polar = (0.5..1.5_f64, 0.0..0.25_f64, 2..4_u32).prop_map(|(radius_m, share, periods)| {
        PathSpec::Polar {
            radius_m,
            amplitude_m: share * radius_m,
            periods,
        }
    });
    let closed = prop::collection::vec(0.8..1.2_f64, 8).prop_map(|radii_m| {
        let turn = |at: usize| std::f64::consts::TAU * at as f64 / 8.0;
        let points = radii_m.iter().enumerate();
        PathSpec::Closed {
            points_m: points
                .map(|(at, r)| [r * turn(at).cos(), r * turn(at).sin()])
                .collect(),
        }
    });
    prop_oneof![straight, polar, closed]
}

/// A hardened scenario of one robot, and disturbances that are what it states.
fn stated() -> impl Strategy<Value = (ScenarioSpec, Disturbances)> {
    let world = (
        prop::sample::select(Testbed::ALL.to_vec()),
        paths(),
        prop::sample::select(vec![10.0, 20.0, 30.0, 50.0, 100.0]),
        0.01..0.25_f64,
        0.05..0.35_f64,
        any::<[bool; 2]>(),
    );
    let errors = (
        0.0..0.15_f64,
        0.0..5e-3_f64,
        0.0..0.015_f64,
        0.1..0.4_f64,
        0.0..1.0_f64,
    );
    (world, errors).prop_map(|(world, errors)| {
        let (testbed, path, rate_hz, half_width_m, speed_mps, [frenet, is_off]) = world;
        let (wheel_error, position_noise_m, heading_noise_rad, age_s, late_share) = errors;
        let mut robot = RobotSpec::steady(0.0, speed_mps);
        if is_off {
            robot.tracker = Tracker::Off {
                from_s: 1.0,
                to_s: 10.0,
            };
        }
        let mut spec = hardened(testbed, "on-off", vec![robot]);
        (spec.path, spec.rate_hz, spec.duration_s) = (path, rate_hz, 10.0);
        spec.controller.lane.half_width_m = half_width_m;
        spec.controller.lane.margin_m = 0.0;
        if frenet {
            spec.controller.lane.deviation = Deviation::Frenet;
        }
        let hardening = &mut spec.controller.hardening;
        hardening.wheel_error = wheel_error;
        hardening.position_noise_m = position_noise_m;
        hardening.heading_noise_rad = heading_noise_rad;
        hardening.max_pose_age_s = Some(age_s);
        let latency_s = late_share * age_s;
        let disturbances = Disturbances {
            position_noise_m,
            heading_noise_rad,
            wheel_error,
            latency_s,
            jitter_s: 0.5 * latency_s,
            drop_share: 0.2,
            outages_per_minute: 6.0,
            outage_s: 1.0,
            motor_time_constant_s: 0.02,
            ..Disturbances::default()
        };
        (spec, disturbances)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn no_run_within_what_is_stated_leaves_its_lane((spec, disturbances) in stated(), seed in any::<u64>()) {
        let half_width_m = spec.controller.lane.half_width_m;
        let scenario = match Scenario::new(spec) {
            Ok(scenario) => scenario,
            Err(error @ Error::DoesNotFit { .. }) => {
                prop_assert!(error.to_string().contains("too narrow"), "{error}");
                return Ok(());
            }
            Err(error) => panic!("{error}"),
        };
        let simulation = Simulation { scenario: &scenario, disturbances, seed };
        let summary = simulation.run(|_| {}).unwrap();
        prop_assert!(summary.max_abs_lateral_m <= half_width_m, "{summary:?}");
    }
}

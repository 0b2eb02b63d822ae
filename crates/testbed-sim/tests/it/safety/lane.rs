//! Lanes that are narrow for what the wheels do, and robots that start outside.

use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Demands, RobotSpec, Scenario, ScenarioSpec, Testbed};

use super::{driven, driven_with, hardened};

/// One robot at 0.25 m/s on a straight lane, a tenth of which is margin by hand.
fn narrow(half_width_m: f64) -> ScenarioSpec {
    let robots = vec![RobotSpec::steady(0.0, 0.25)];
    let mut scenario = hardened(Testbed::Khepera, "straight", robots);
    scenario.duration_s = 30.0;
    scenario.controller.lane.half_width_m = half_width_m;
    scenario.controller.lane.margin_m = 0.1 * half_width_m;
    scenario
}

#[test]
fn narrow_lanes_are_driven_slowly_and_kept_with_wheels_that_are_off() {
    let wheels = Disturbances {
        wheel_error: 0.1,
        ..Disturbances::default()
    };
    for half_width_m in [0.02, 0.03, 0.04, 0.05] {
        let demands = Demands::new(&Scenario::new(narrow(half_width_m)).unwrap());
        assert!(demands.is_slowed(), "{half_width_m}");
        assert!(demands.margin_at_full_speed_m > 0.8 * half_width_m);
        assert!(demands.margin_m <= 0.8 * half_width_m);
        for seed in [3, 11, 12, 29] {
            let summary = driven_with(narrow(half_width_m), wheels, seed).summary;
            let what = format!("±{half_width_m} m, seed {seed}: {summary:?}");
            assert_eq!(summary.verdict, Verdict::Safe, "{what}");
            assert!(summary.max_abs_lateral_m <= half_width_m, "{what}");
            let limit_mps = demands.driven_wheel_limit_mps;
            assert!(
                (0.2 * limit_mps..1.11 * limit_mps).contains(&summary.final_speed_mps),
                "{what}"
            );
        }
    }
}

#[test]
fn a_lane_that_is_too_narrow_at_any_speed_is_refused_with_both_numbers() {
    let text = Scenario::new(narrow(0.005)).unwrap_err().to_string();
    for words in [
        "half width of 5.0 mm",
        "mm off its half width",
        "lane.half_width_m",
        "wheel_error",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
}

#[test]
fn a_robot_that_starts_far_outside_comes_back_and_stays() {
    let mut outside = RobotSpec::steady(0.0, 0.2);
    outside.start_deviation_m = 0.3;
    let scenario = hardened(
        Testbed::Khepera,
        "on-off",
        vec![RobotSpec::steady(0.25, 0.1), outside],
    );
    let half_width_m = scenario.controller.lane.half_width_m;
    let driven = driven(scenario);
    assert_eq!(driven.summary.verdict, Verdict::Unsafe);
    assert_eq!(driven.summary.first_unsafe_s, Some(0.0));
    let late = driven.ticks.iter().filter(|tick| tick.time_s > 10.0);
    let deviations = late.map(|tick| tick.truth.unwrap().safety.deviation_m.abs());
    assert!(deviations.fold(0.0, f64::max) < half_width_m);
    assert!(!driven.summary.bodies_were_near);
}

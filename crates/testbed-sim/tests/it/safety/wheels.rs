//! Wheels change their speed no faster than they may.

use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Body, Centripetal, PathSpec, Preset, RobotSpec, ScenarioSpec, Testbed};

use super::{Driven, driven_with, hardened};

/// Two robots of 20 kg, the faster one at 2.5 m/s.
fn fast() -> ScenarioSpec {
    let robots = vec![RobotSpec::steady(0.25, 1.0), RobotSpec::steady(0.0, 2.5)];
    let mut scenario = hardened(Testbed::Khepera, "on-off", robots);
    scenario.path = PathSpec::Polar {
        radius_m: 8.0,
        amplitude_m: 1.0,
        periods: 3,
    };
    scenario.body = Body {
        offset_m: 0.2,
        mass_kg: 20.0,
        inertia_kgm2: 1.0,
        centripetal: Centripetal::Newton,
        wheel_base_m: 0.5,
        radius_m: None,
        max_wheel_speed_mps: 3.0,
        max_turn_rate_rad_s: 6.0,
        max_wheel_acceleration_mps2: None,
    };
    scenario.controller.headway.time_s = 1.5;
    scenario.controller.headway.standstill_m = 1.0;
    scenario.controller.lane.half_width_m = 0.6;
    scenario.controller.lane.margin_m = 0.06;
    scenario
}

/// The largest change of a commanded wheel speed from a step to the next, from a stand on.
fn largest_change_mps(driven: &Driven, robot: usize) -> f64 {
    let (mut left_mps, mut right_mps, mut largest_mps) = (0.0_f64, 0.0_f64, 0.0_f64);
    for tick in driven.of(robot) {
        let wheels = tick.decision.wheels;
        let changes = [wheels.left_mps - left_mps, wheels.right_mps - right_mps];
        largest_mps = changes
            .iter()
            .fold(largest_mps, |most, change| most.max(change.abs()));
        (left_mps, right_mps) = (wheels.left_mps, wheels.right_mps);
    }
    largest_mps
}

fn assert_no_jumps(scenario: &ScenarioSpec, seed: u64) -> Driven {
    let most_mps = scenario.body.wheel_acceleration_mps2() / scenario.rate_hz;
    let driven = driven_with(scenario.clone(), Disturbances::HARD, seed);
    for robot in 0..scenario.robots.len() {
        let change_mps = largest_change_mps(&driven, robot);
        assert!(
            change_mps <= most_mps + 1e-9,
            "robot {robot}, seed {seed}: {change_mps}"
        );
    }
    driven
}

#[test]
fn fast_robots_are_safe_and_their_wheels_do_not_jump() {
    for seed in 1..4 {
        let driven = assert_no_jumps(&fast(), seed);
        assert_eq!(
            driven.summary.verdict,
            Verdict::Safe,
            "{:?}",
            driven.summary
        );
        assert!(
            driven.summary.outcomes.braking > 0,
            "outages are braked for"
        );
    }
}

/// With a tenth of the usual acceleration a stop takes several periods.
#[test]
fn slow_wheels_do_not_jump_where_a_scenario_stops_a_robot() {
    for &testbed in Testbed::ALL {
        for name in ["stop", "chain"] {
            let mut scenario = testbed.scenario(name, Preset::Hardened).unwrap();
            scenario.body.max_wheel_acceleration_mps2 = Some(0.5);
            let driven = assert_no_jumps(&scenario, 5);
            assert_eq!(
                driven.summary.verdict,
                Verdict::Safe,
                "{name}: {:?}",
                driven.summary
            );
        }
    }
}

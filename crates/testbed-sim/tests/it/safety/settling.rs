//! Commands that are held for so long that the heading would swing to and fro.

use testbed_sim::{Adaptation, Disturbances, Simulation, Verdict};
use unicycle_cbf::{Demands, PathSpec, Preset, RobotSpec, Scenario, ScenarioSpec, Testbed};

/// A ring that is driven at 5 Hz with a point of interest hardly ahead of the axle.
fn ring(radius_m: f64, offset_m: f64, limit_mps: f64, half_width_m: f64) -> ScenarioSpec {
    let mut spec = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    spec.rate_hz = 5.0;
    spec.duration_s = 60.0;
    spec.path = PathSpec::Polar {
        radius_m,
        amplitude_m: 0.0,
        periods: 1,
    };
    spec.body.offset_m = offset_m;
    spec.body.wheel_base_m = 0.06;
    spec.body.max_wheel_speed_mps = limit_mps;
    spec.body.max_turn_rate_rad_s = 2.0 * limit_mps / 0.06;
    spec.controller.lane.half_width_m = half_width_m;
    spec.controller.hardening.wheel_error = 0.0;
    spec.robots = vec![RobotSpec::steady(0.0, 0.9 * limit_mps)];
    spec
}

#[test]
fn few_commands_are_driven_at_the_speed_at_which_the_heading_settles() {
    for (radius_m, offset_m, limit_mps, half_width_m) in
        [(8.0, 0.06, 1.0, 0.08), (1.0, 0.0354, 1.5, 0.3)]
    {
        let scenario = Scenario::new(ring(radius_m, offset_m, limit_mps, half_width_m)).unwrap();
        let demands = Demands::new(&scenario);
        let settling_mps = demands.settling_wheel_speed_mps.unwrap();
        // 0.22 s, of which half is for the rates of the lane.
        let expected_mps = 0.5 * offset_m / 0.22;
        assert!((settling_mps - expected_mps).abs() < 1e-9, "{settling_mps}");
        assert!(demands.driven_wheel_limit_mps <= settling_mps);
        let notes = Adaptation::all(scenario.spec(), &demands);
        let said = notes.iter().any(|note| {
            let text = note.to_string();
            text.contains(&format!("up to {settling_mps:.3} m/s"))
                && text.contains(&format!("not at {limit_mps:.3} m/s"))
        });
        assert!(said, "{notes:?}");
        for disturbances in [Disturbances::default(), Disturbances::HARD] {
            let simulation = Simulation {
                scenario: &scenario,
                disturbances: Disturbances {
                    wheel_error: 0.0,
                    ..disturbances
                },
                seed: 1,
            };
            let summary = simulation.run(|_| {}).unwrap();
            assert_eq!(summary.verdict, Verdict::Safe, "{radius_m} {summary:?}");
        }
    }
}

#[test]
fn commands_that_are_too_few_for_any_speed_are_refused() {
    let error = Scenario::new(ring(1.0, 0.004, 1.5, 0.3)).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("commands are held for too long"), "{text}");
}

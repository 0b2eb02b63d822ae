//! Robots that turn slowly: what is left of the turn rate has to undo errors.

use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Demands, PathSpec, RobotSpec, Scenario, ScenarioSpec, Testbed, Tracker};

use super::{driven_with, hardened};

fn round(turn_rate_rad_s: f64, tracker: Tracker) -> ScenarioSpec {
    let mut robot = RobotSpec::steady(0.0, 0.3);
    robot.tracker = tracker;
    let mut scenario = hardened(Testbed::Khepera, "on-off", vec![robot]);
    scenario.body.max_turn_rate_rad_s = turn_rate_rad_s;
    scenario.path = PathSpec::Polar {
        radius_m: 1.0,
        amplitude_m: 0.0,
        periods: 0,
    };
    scenario
}

/// At 0.2 m/s the bend alone would take all of 0.2 rad/s.
#[test]
fn robots_that_turn_slowly_are_driven_slowly_and_stay_in_their_lane() {
    let off = Tracker::Off {
        from_s: 5.0,
        to_s: 40.0,
    };
    for (turn_rate_rad_s, tracker) in [
        (0.1, Tracker::On),
        (0.2, Tracker::On),
        (0.2, off),
        (0.5, off),
        (1.0, Tracker::On),
    ] {
        let scenario = round(turn_rate_rad_s, tracker);
        let demands = Demands::new(&Scenario::new(scenario.clone()).unwrap());
        let limit_mps = demands.driven_wheel_limit_mps;
        assert!(limit_mps < 0.5 * turn_rate_rad_s, "{limit_mps} m/s");
        for seed in [1, 7, 11, 12] {
            let summary = driven_with(scenario.clone(), Disturbances::HARD, seed).summary;
            assert_eq!(
                summary.verdict,
                Verdict::Safe,
                "{turn_rate_rad_s} rad/s, seed {seed}: {summary:?}"
            );
        }
    }
}

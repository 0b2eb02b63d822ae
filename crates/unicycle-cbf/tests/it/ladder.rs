//! Where rows contradict each other.

use unicycle_cbf::{Outcome, Preset, Scenario, Speeds, Testbed};

/// Within its lane it may turn where it stands, and does not drive out of it for its direction's sake.
#[test]
fn a_robot_within_its_lane_whose_rows_contradict_each_other_stands() {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Hardened)
        .unwrap();
    spec.rate_hz = 8.0;
    spec.body.max_wheel_acceleration_mps2 = Some(0.4);
    let scenario = Scenario::new(spec).unwrap();
    let controller = scenario.controller();
    let change_mps = 0.4 / 8.0;
    let start = scenario.starts()[0].state(controller.body().offset_m, Speeds::ZERO);
    let [dx, dy] = [-start.heading_rad.sin(), start.heading_rad.cos()];
    let grid = |count: i32| (-count..=count).map(move |at| f64::from(at) / f64::from(count));
    let mut relaxed = 0;
    for aside in grid(4) {
        for angle in grid(12) {
            for speed in grid(2) {
                for turn in grid(2) {
                    let mut state = start;
                    state.x_m += 0.95 * 0.15 * aside * dx;
                    state.y_m += 0.95 * 0.15 * aside * dy;
                    state.heading_rad += 2.4 * angle;
                    state.speed_mps = 0.9 * change_mps * speed;
                    state.turn_rate_rad_s = 1.2 * turn;
                    let objectives = controller.objectives(-0.2);
                    let decision = controller.decide(&state, None, &objectives, 0.0);
                    if matches!(decision.outcome, Outcome::Relaxed { .. }) {
                        relaxed += 1;
                        let next_mps = decision.speeds.speed_mps;
                        // The square of the turn rate changes within the period.
                        assert!(next_mps.abs() < 0.015, "{state:?} {next_mps}");
                    }
                }
            }
        }
    }
    assert!(relaxed > 0, "{relaxed}");
}

//! What the pictures of a run are drawn from.

use testbed_sim::{Disturbances, RunFigures, RunSpec, Tick};
use unicycle_cbf::{Preset, Scenario, ScenarioSpec, Testbed};

/// A session at 50 Hz whose poses come at 10 Hz.
fn session() -> (Scenario, Vec<Tick>) {
    let spec = RunSpec {
        seed: 3,
        scenario: ScenarioSpec {
            duration_s: 2.0,
            ..Testbed::Khepera
                .scenario("on-off", Preset::Hardened)
                .unwrap()
        },
        disturbances: Disturbances::HARD,
    };
    let mut ticks = spec.simulate().unwrap().0.ticks;
    for tick in &mut ticks {
        tick.truth = tick.truth.filter(|_| tick.tick % 5 == 3);
    }
    (Scenario::new(spec.scenario).unwrap(), ticks)
}

#[test]
fn between_poses_the_edge_of_the_lane_is_as_far_as_last_measured() {
    let (scenario, ticks) = session();
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    let figures = serde_json::to_value(RunFigures::new(&scenario, &ticks, None)).unwrap();
    for robot in [0, 1] {
        let line = &figures["robots"][robot]["lane_clearance_m"];
        let own = ticks.iter().filter(|tick| tick.robot == robot);
        let mut newest = None;
        for (index, tick) in own.enumerate() {
            newest = tick.lane_clearance_m(half_width_m).or(newest);
            let Some(newest_m) = newest else {
                assert!(line[index].is_null(), "not known before the first pose");
                continue;
            };
            assert!((line[index].as_f64().unwrap() - newest_m).abs() < 1e-5);
            assert!(newest_m <= half_width_m);
        }
        assert!(newest.is_some());
    }
}

#[test]
fn the_edge_of_the_lane_is_not_known_of_a_place_that_was_not_seen() {
    let (scenario, ticks) = session();
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    for tick in ticks {
        let clearance_m = tick.lane_clearance_m(half_width_m);
        assert_eq!(clearance_m.is_some(), tick.truth.is_some());
        if let Some(truth) = tick.truth {
            assert_eq!(
                clearance_m,
                Some(half_width_m - truth.safety.deviation_m.abs())
            );
        }
    }
}

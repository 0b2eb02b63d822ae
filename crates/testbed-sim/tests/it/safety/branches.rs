//! Where lanes of two branches overlap a robot keeps to its own, and is judged by that one.

use std::f64::consts::TAU;

use testbed_sim::{Disturbances, Simulation};
use unicycle_cbf::path::Path;
use unicycle_cbf::{
    PathSpec, RobotSpec, Scenario, ScenarioSpec, Testbed, Tracker, settings::Distance,
};

use super::{driven, eight, hardened};

/// How far along the path a robot can have come between two looks, in m.
const REACH_M: f64 = 0.06;
const STEP_M: f64 = 2e-3;

/// The distance to the part of the path on which the robot was the time before, by looking at all of it.
struct Branch {
    at_m: f64,
}

impl Branch {
    fn distance_m(&mut self, path: &Path, [x_m, y_m]: [f64; 2]) -> f64 {
        let steps = (REACH_M / STEP_M) as i32;
        let places = (-steps..=steps).map(|step| path.at(self.at_m + f64::from(step) * STEP_M));
        let from = places.map(|place| (place, (place.x_m - x_m).hypot(place.y_m - y_m)));
        let (nearest, distance_m) = from.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        self.at_m = nearest.s_m;
        distance_m
    }
}

/// The largest distance of any robot from its own branch, in m, and whether the run was called safe.
fn farthest_m(scenario: &Scenario, disturbances: Disturbances, seed: u64) -> (f64, Option<bool>) {
    let path = scenario.controller().path();
    let robots = 0..scenario.starts().len();
    let mut branches: Vec<Branch> = robots
        .map(|robot| Branch {
            at_m: scenario.start_m(robot),
        })
        .collect();
    let mut farthest_m = 0.0_f64;
    let simulation = Simulation {
        scenario,
        disturbances,
        seed,
    };
    let summary = simulation
        .run(|tick| {
            let state = tick.truth.unwrap().state;
            let place_m = [state.x_m, state.y_m];
            farthest_m = farthest_m.max(branches[tick.robot].distance_m(path, place_m));
        })
        .unwrap();
    (farthest_m, summary.safe)
}

fn assert_kept(spec: ScenarioSpec, disturbances: Disturbances, seeds: u64) {
    let scenario = Scenario::new(spec).unwrap();
    let half_width_m = scenario.spec().controller.lane.half_width_m;
    for seed in 1..=seeds {
        let (farthest_m, safe) = farthest_m(&scenario, disturbances, seed);
        assert_eq!(safe, Some(true), "seed {seed}");
        assert!(
            farthest_m <= half_width_m + STEP_M,
            "seed {seed}: {farthest_m} m"
        );
    }
}

/// Lanes of ±250 mm on an eight whose branches cross at 53°.
fn narrow_crossing(tracker: Tracker) -> ScenarioSpec {
    let robots = [0.45, 0.92].map(|start| RobotSpec {
        tracker,
        ..RobotSpec::steady(start, 0.2)
    });
    let mut spec = hardened(Testbed::Khepera, "on-off", robots.to_vec());
    spec.path = eight(1.2, 1.2);
    spec.duration_s = 60.0;
    spec.controller.lane.half_width_m = 0.25;
    spec.controller.headway.distance = Distance::Path;
    spec
}

#[test]
fn robots_keep_to_their_branch_of_a_crossing_of_53_degrees() {
    let off = Tracker::Off {
        from_s: 0.0,
        to_s: 60.0,
    };
    for tracker in [Tracker::On, off] {
        assert_kept(narrow_crossing(tracker), Disturbances::HARD, 12);
    }
}

/// Two laps about the origin, the second within the first: they cross at a small angle.
fn two_laps(radius_m: f64, change_m: f64) -> PathSpec {
    let point = |at: usize| {
        let turn = TAU * at as f64 / 80.0;
        let r = radius_m + change_m * (0.5 * turn).cos();
        [r * turn.cos(), r * turn.sin()]
    };
    PathSpec::Closed {
        points_m: (0..160).map(point).collect(),
    }
}

#[test]
fn robots_keep_to_their_lap_where_two_laps_cross() {
    let robot = |start, speed_mps| RobotSpec::steady(start, speed_mps);
    let robots = vec![robot(0.55, 0.15), robot(0.3, 0.2), robot(0.02, 0.25)];
    let mut spec = hardened(Testbed::Khepera, "on-off", robots);
    spec.path = two_laps(0.7, 0.2);
    spec.duration_s = 80.0;
    spec.controller.lane.half_width_m = 0.25;
    assert_kept(spec.clone(), Disturbances::default(), 1);
    assert_kept(spec, Disturbances::HARD, 8);
}

#[test]
fn crossings_of_long_paths_are_found() {
    for half_length_m in [2.0, 200.0, 400.0] {
        let robots = vec![RobotSpec::steady(0.48, 0.2), RobotSpec::steady(0.1, 0.2)];
        let mut spec = hardened(Testbed::Khepera, "on-off", robots);
        spec.path = eight(half_length_m, 0.5 * half_length_m);
        let scenario = Scenario::new(spec).unwrap();
        let crossings = scenario.controller().crossings();
        assert_eq!(crossings.len(), 1, "{half_length_m} m");
        let path = scenario.controller().path();
        let branches = &crossings[0].branches;
        for place_m in [0.0, 0.5 * path.length_m().unwrap()] {
            assert!(branches.iter().any(|branch| branch.contains(path, place_m)));
        }
        assert!(branches.iter().all(|branch| branch.length_m < 1.0));
    }
}

#[test]
fn of_two_that_meet_at_the_crossing_of_a_long_path_one_waits() {
    let mut spec = hardened(Testbed::Khepera, "on-off", Vec::new());
    spec.path = eight(200.0, 100.0);
    spec.duration_s = 30.0;
    spec.robots = vec![RobotSpec::steady(0.4, 0.2)];
    let lone = Scenario::new(spec.clone()).unwrap();
    let share = 1.0 / lone.controller().path().length_m().unwrap();
    spec.robots = vec![
        RobotSpec::steady(1.0 - share, 0.2),
        RobotSpec::steady(0.5 - share, 0.2),
    ];
    let driven = driven(spec);
    driven.assert_safe(0.01, "long eight");
    assert!(driven.summary.outcomes.waiting > 0);
    assert_eq!(driven.summary.outcomes.deadlock, 0);
}

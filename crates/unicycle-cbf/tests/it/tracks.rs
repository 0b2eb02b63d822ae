//! Where robots are along a path that crosses itself.

use unicycle_cbf::{Controller, PathSpec, Preset, RobotSpec, Scenario, State, Testbed, Tracks};

/// A hardened controller on a figure eight whose branches cross at 53°, lanes of ±250 mm.
fn on_eight() -> Scenario {
    let mut spec = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    let point = |at: usize| {
        let turn = std::f64::consts::TAU * at as f64 / 80.0;
        [1.2 * turn.sin(), 1.2 * (2.0 * turn).sin()]
    };
    spec.path = PathSpec::Closed {
        points_m: (0..80).map(point).collect(),
    };
    spec.controller.lane.half_width_m = 0.25;
    spec.robots = vec![RobotSpec::steady(0.4, 0.1)];
    Scenario::new(spec).unwrap()
}

/// On a path, so far to its right, in its direction.
fn along(controller: &Controller, s_m: f64, right_m: f64) -> State {
    let point = controller.path().at(s_m);
    let [nx, ny] = point.normal();
    State {
        x_m: point.x_m + right_m * nx,
        y_m: point.y_m + right_m * ny,
        heading_rad: point.heading_rad(),
        ..State::ORIGIN
    }
}

#[test]
fn a_foot_stays_on_its_branch_also_where_the_other_is_nearer() {
    let scenario = on_eight();
    let controller = scenario.controller();
    let length_m = controller.path().length_m().unwrap();
    for right_m in [-0.09, 0.0, 0.09] {
        let mut tracks = Tracks::new(&scenario);
        for step in 0..2000 {
            let s_m = (0.4 + 2e-4 * f64::from(step)) * length_m;
            let foot = tracks.foot(controller, 0, &along(controller, s_m, right_m));
            let off_m = controller.path().distance_along_m(s_m, foot.s_m + 0.5);
            assert!((off_m - 0.5).abs() < 1e-6, "{right_m} m, step {step}");
        }
    }
}

#[test]
fn who_turns_onto_the_other_branch_has_left_its_lane() {
    let scenario = on_eight();
    let controller = scenario.controller();
    let length_m = controller.path().length_m().unwrap();
    let mut tracks = Tracks::new(&scenario);
    let mut least_m = f64::INFINITY;
    // Up to the crossing after half a lap, and on along the branch that crosses there, which begins the lap.
    for share in [
        0.4, 0.42, 0.44, 0.46, 0.48, 0.5, 1.01, 1.03, 1.05, 1.07, 1.09,
    ] {
        let state = along(controller, share * length_m, 0.0);
        let own = tracks.located(controller, 0, state);
        least_m = least_m.min(tracks.safety(controller, 0, &own, None).lane);
    }
    assert!(least_m < 0.0, "{least_m} m");
}

#[test]
fn a_robot_that_was_carried_elsewhere_is_found_there() {
    let scenario = on_eight();
    let controller = scenario.controller();
    let length_m = controller.path().length_m().unwrap();
    let mut tracks = Tracks::new(&scenario);
    for share in [0.4, 0.45, 0.8, 0.2, 0.99] {
        let foot = tracks.foot(controller, 0, &along(controller, share * length_m, 0.05));
        assert!((foot.s_m - share * length_m).abs() < 1e-6, "{share}");
    }
}

#[test]
fn a_robot_of_which_nothing_is_known_is_on_the_branch_along_which_it_heads() {
    let scenario = on_eight();
    let controller = scenario.controller();
    let length_m = controller.path().length_m().unwrap();
    let mut tracks = Tracks::new(&scenario);
    for share in [0.495, 0.99, 0.495] {
        let state = along(controller, share * length_m, 0.0);
        tracks.reset(0);
        let foot = tracks.foot(controller, 0, &state);
        assert!((foot.s_m - share * length_m).abs() < 1e-6, "{share}");
    }
}

/// Two robots in a straight lane of ±400 mm.
fn on_straight() -> Scenario {
    let mut spec = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    spec.path = PathSpec::Straight {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad: 0.0,
    };
    spec.controller.lane.half_width_m = 0.4;
    spec.robots = [1.0, 0.0]
        .map(|start| RobotSpec::steady(start, 0.2))
        .to_vec();
    Scenario::new(spec).unwrap()
}

/// The headway of the second robot, at 0.2 m/s in the middle of the lane, to the first at each of these places in turn.
fn headways_m(ahead: &[[f64; 2]]) -> Vec<Option<f64>> {
    let scenario = on_straight();
    let controller = scenario.controller();
    let mut tracks = Tracks::new(&scenario);
    let at = |[x_m, y_m]: [f64; 2]| State {
        x_m,
        y_m,
        speed_mps: 0.2,
        ..State::ORIGIN
    };
    let headway_m = |place: &[f64; 2]| {
        let ahead = tracks.located(controller, 0, at(*place));
        let own = tracks.located(controller, 1, at([0.0, 0.0]));
        tracks.follow(controller, 1, &own, &ahead);
        tracks.safety(controller, 1, &own, Some(&ahead)).headway_m
    };
    ahead.iter().map(headway_m).collect()
}

#[test]
fn who_comes_too_near_to_the_one_ahead_loses_its_headway() {
    let headways_m = headways_m(&[[1.0, 0.0], [0.6, 0.1], [0.3, 0.1]]);
    assert!(headways_m[0].unwrap() > headways_m[1].unwrap());
    assert!(headways_m[2].unwrap() < 0.0);
}

#[test]
fn who_is_passed_has_a_headway_as_soon_as_there_is_some() {
    let headways_m = headways_m(&[[-0.1, 0.3], [0.01, 0.3], [0.2, 0.3], [0.9, 0.3], [0.3, 0.1]]);
    assert_eq!(headways_m[..3], [None; 3]);
    assert!(headways_m[3].unwrap() > 0.0);
    assert!(headways_m[4].unwrap() < 0.0);
}

//! Robots beside each other in wide lanes: whoever passes with room to spare is not too close.

use testbed_sim::Disturbances;
use unicycle_cbf::{PathSpec, RobotSpec, ScenarioSpec, Testbed, Tracker};

use super::{Driven, driven, driven_with, hardened};

/// Along a straight lane; for each robot its start, how far it is to the right, and its speed.
fn straight(half_width_m: f64, robots: &[[f64; 3]], tracker: Tracker) -> ScenarioSpec {
    let robots = robots.iter().map(|[start, right_m, speed_mps]| RobotSpec {
        start_deviation_m: *right_m,
        tracker,
        ..RobotSpec::steady(*start, *speed_mps)
    });
    let mut spec = hardened(Testbed::Khepera, "on-off", robots.collect());
    spec.path = PathSpec::Straight {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad: 0.0,
    };
    spec.duration_s = 40.0;
    spec.controller.lane.half_width_m = half_width_m;
    spec
}

const NO_TRACKER: Tracker = Tracker::Off {
    from_s: 0.0,
    to_s: 100.0,
};

/// Which of two robots is ahead at the end on a path along x.
fn is_ahead(driven: &Driven, robot: usize, other: usize) -> bool {
    let last_x_m = |robot| {
        let last = driven.of(robot).next_back().unwrap();
        last.truth.unwrap().state.x_m
    };
    last_x_m(robot) > last_x_m(other)
}

#[test]
fn overtaking_with_room_to_spare_is_safe() {
    let spec = straight(0.8, &[[0.01, 0.2, 0.1], [0.0, -0.2, 0.25]], NO_TRACKER);
    let driven = driven(spec);
    driven.assert_safe(0.2, "overtaking");
    assert!(is_ahead(&driven, 1, 0));
}

#[test]
fn being_passed_again_with_room_to_spare_is_safe() {
    let mut spec = straight(0.8, &[[0.01, 0.2, 0.0], [0.0, -0.2, 0.15]], NO_TRACKER);
    spec.controller.headway.time_s = 0.6;
    spec.robots[0].desired_speed_mps.push([8.0, 0.25]);
    let driven = driven(spec);
    driven.assert_safe(0.2, "passed again");
    assert!(is_ahead(&driven, 0, 1));
}

#[test]
fn six_beside_each_other_are_safe_as_long_as_no_two_touch() {
    let robot = |robot: usize| {
        let speed_mps = if robot.is_multiple_of(2) { 0.25 } else { 0.1 };
        let place = robot as f64;
        [0.06 - 0.01 * place, 0.2 * place - 0.5, speed_mps]
    };
    let robots: Vec<[f64; 3]> = (0..6).map(robot).collect();
    let mut spec = straight(0.8, &robots, Tracker::On);
    spec.controller.headway.time_s = 0.3;
    for seed in 1..=20 {
        let driven = driven_with(spec.clone(), Disturbances::HARD, seed);
        driven.assert_safe(0.01, &format!("seed {seed}"));
    }
}

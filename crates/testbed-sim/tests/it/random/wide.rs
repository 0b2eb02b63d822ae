//! Wide lanes: paths that cross themselves at angles of 30 to 90 degrees, and robots that begin beside each other.

use std::f64::consts::{PI, TAU};

use testbed_sim::Disturbances;
use unicycle_cbf::{
    PathSpec, Preset, RobotSpec, ScenarioSpec, Testbed, Tracker, settings::Distance,
};

use super::generator::{Draw, Drawn};

pub(super) fn drawn(seed: u64) -> Drawn {
    let mut draw = Draw::new(seed ^ (1 << 40));
    let testbed = draw.one_of(&[Testbed::Khepera, Testbed::Robotarium]);
    let mut spec = testbed.scenario("on-off", Preset::Hardened).unwrap();
    spec.name = format!("wide {seed}");
    spec.rate_hz = draw.one_of(&[10.0, 30.0, 50.0]);
    spec.duration_s = 60.0;
    spec.controller.lane.half_width_m = draw.between(0.1, 0.3);
    spec.controller.headway.time_s = draw.between(0.3, 2.0);
    spec.controller.headway.distance = draw.one_of(&[Distance::Chord, Distance::Path]);
    let most_mps = spec.body.max_wheel_speed_mps;
    if draw.chance(0.3) {
        beside_each_other(&mut draw, &mut spec, most_mps);
    } else {
        crossing(&mut draw, &mut spec, most_mps);
    }
    Drawn {
        spec,
        disturbances: Disturbances::HARD,
        is_easy: false,
    }
}

/// On a path that crosses itself, all around it.
fn crossing(draw: &mut Draw, spec: &mut ScenarioSpec, most_mps: f64) {
    spec.path = match draw.whole(0, 5) {
        0 => loop_in_loop(draw.between(0.4, 1.0), draw.between(1.2, 1.7)),
        1 => laps(
            draw.whole(2, 3),
            draw.between(0.7, 1.5),
            draw.between(0.1, 0.4),
        ),
        _ => eight(draw.between(PI / 6.0, PI / 2.0), draw.between(0.7, 2.5)),
    };
    let robots = draw.whole(1, 3);
    let first = draw.between(0.0, 1.0);
    let robots = (0..robots).map(|robot| {
        let start = first - (robot as f64 + draw.between(-0.15, 0.15)) / robots as f64;
        moving(draw, start.rem_euclid(1.0), 0.0, most_mps)
    });
    spec.robots = robots.collect();
}

/// A figure eight of this angle between its branches.
fn eight(angle_rad: f64, half_length_m: f64) -> PathSpec {
    let half_height_m = 0.5 * half_length_m / (0.5 * angle_rad).tan();
    let point = |at: usize| {
        let t = TAU * at as f64 / 80.0;
        [half_length_m * t.sin(), half_height_m * (2.0 * t).sin()]
    };
    PathSpec::Closed {
        points_m: (0..80).map(point).collect(),
    }
}

/// A limaçon, whose small loop lies within the large one.
fn loop_in_loop(radius_m: f64, share: f64) -> PathSpec {
    let point = |at: usize| {
        let t = TAU * at as f64 / 120.0;
        let r = radius_m * (1.0 + share * t.cos());
        [r * t.cos(), r * t.sin()]
    };
    PathSpec::Closed {
        points_m: (0..120).map(point).collect(),
    }
}

/// Laps about the origin, which cross each other at small angles.
fn laps(laps: usize, radius_m: f64, change: f64) -> PathSpec {
    let point = |at: usize| {
        let turn = TAU * at as f64 / 80.0;
        let r = radius_m * (1.0 + change * (turn / laps as f64).cos());
        [r * turn.cos(), r * turn.sin()]
    };
    PathSpec::Closed {
        points_m: (0..80 * laps).map(point).collect(),
    }
}

/// On a straight path, across its lane.
fn beside_each_other(draw: &mut Draw, spec: &mut ScenarioSpec, most_mps: f64) {
    let half_width_m = draw.between(0.25, 0.8);
    spec.controller.lane.half_width_m = half_width_m;
    spec.path = PathSpec::Straight {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad: draw.between(-PI, PI),
    };
    let robots = draw.whole(2, 6);
    let step_m = 1.3 * half_width_m / (robots - 1) as f64;
    let across_m = |robot: usize| robot as f64 * step_m - 0.65 * half_width_m;
    let robots = (0..robots).map(|robot| {
        let start_m = draw.between(0.005, 0.015) - 0.02 * robot as f64;
        moving(draw, start_m, across_m(robot), most_mps)
    });
    spec.robots = robots.collect();
}

fn moving(draw: &mut Draw, start: f64, start_deviation_m: f64, most_mps: f64) -> RobotSpec {
    let mut robot = RobotSpec::steady(start, most_mps * draw.between(0.2, 0.9));
    robot.start_deviation_m = start_deviation_m;
    if draw.chance(0.5) {
        let from_s = draw.between(0.0, 15.0);
        let to_s = from_s + draw.between(5.0, 60.0);
        robot.tracker = Tracker::Off { from_s, to_s };
    }
    robot
}

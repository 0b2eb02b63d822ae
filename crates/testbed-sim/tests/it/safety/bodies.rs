//! Robots that would drive into each other: at a stand, on a loop, backwards.

use testbed_sim::{Adaptation, Convoy, RunSpec, Tick, Verdict};
use unicycle_cbf::{
    Brake, Demands, Error, Outcome, Preset, RobotSpec, Scenario, ScenarioSpec, StampedPose, State,
    Testbed,
    lateral::Deviation,
    settings::{Distance, HeadwaySettings},
};

use super::{Driven, driven, hardened, then};

const CLEARANCE_M: f64 = HeadwaySettings::CLEARANCE_M;
/// The Robotarium's own rule: points 25 mm ahead of the axles are 0.135 m apart.
const ROBOTARIUM_AHEAD_M: f64 = 0.025;
const ROBOTARIUM_APART_M: f64 = 0.135;

fn built_in(testbed: Testbed, name: &str, preset: Preset) -> ScenarioSpec {
    testbed.scenario(name, preset).unwrap()
}

#[test]
fn hardened_built_in_scenarios_leave_the_clearance_between_bodies() {
    for &testbed in Testbed::ALL {
        for name in testbed.scenarios() {
            let scenario = built_in(testbed, name, Preset::Hardened);
            let clearance_m = scenario.controller.headway.clearance_m;
            driven(scenario).assert_safe(clearance_m, &format!("{} {name}", testbed.name()));
        }
    }
}

/// Whom a robot follows is found by its place along the path, also where no other row needs that.
#[test]
fn robots_without_a_limit_on_the_angle_to_the_path_keep_their_headway() {
    for deviation in [Deviation::Radial, Deviation::Frenet] {
        for distance in [Distance::Chord, Distance::Path] {
            let mut spec = built_in(Testbed::Khepera, "on-off", Preset::Hardened);
            spec.controller.hardening.max_course_angle_rad = None;
            spec.controller.lane.deviation = deviation;
            spec.controller.headway.distance = distance;
            let what = format!("{deviation:?} {distance:?}");
            let driven = driven(spec);
            driven.assert_safe(CLEARANCE_M, &what);
            let mut followers = driven.ticks.iter().filter(|tick| tick.robot == 1);
            let has_row = |tick: &Tick| tick.decision.terms.is_none_or(|t| t.headway.is_some());
            assert!(followers.all(has_row), "{what}");
        }
    }
}

/// From point to point its headway holds in all of them.
#[test]
fn the_thesis_scenarios_with_slow_or_standing_leaders_are_unsafe_by_bodies() {
    for (testbed, near) in [
        (Testbed::Khepera, &["brake", "stop"][..]),
        (
            Testbed::Robotarium,
            &["on-off", "decay", "chain", "brake", "stop"],
        ),
    ] {
        for name in testbed.scenarios() {
            let driven = driven(built_in(testbed, name, Preset::Thesis));
            let (summary, is_near) = (&driven.summary, near.contains(name));
            let what = format!("{} {name}: {summary:?}", testbed.name());
            assert_eq!(summary.bodies_were_near, is_near, "{what}");
            assert_eq!(summary.verdict == Verdict::Unsafe, is_near, "{what}");
            assert!(summary.min_h_headway_m.unwrap() >= 0.0, "{what}");
            let touch = ["brake", "stop"].contains(name);
            assert!(!touch || driven.gap_m() < -0.07, "{what}");
        }
    }
}

/// A point ahead of the axle of every robot at every step.
fn points_m(driven: &Driven, offset_m: f64, robots: usize) -> Vec<Vec<[f64; 2]>> {
    let point = |state: State| {
        let (sin, cos) = state.heading_rad.sin_cos();
        let back_m = offset_m - ROBOTARIUM_AHEAD_M;
        [state.x_m - back_m * cos, state.y_m - back_m * sin]
    };
    let steps = driven.ticks.chunks(robots);
    let of_step = |ticks: &[testbed_sim::Tick]| {
        let points = ticks.iter().map(|tick| point(tick.truth.unwrap().state));
        points.collect()
    };
    steps.map(of_step).collect()
}

fn least_m(points: &[[f64; 2]]) -> f64 {
    let mut least_m = f64::INFINITY;
    for (own, [x, y]) in points.iter().enumerate() {
        for [other_x, other_y] in &points[..own] {
            least_m = least_m.min((x - other_x).hypot(y - other_y));
        }
    }
    least_m
}

#[test]
fn the_rule_of_the_robotarium_accepts_every_hardened_scenario_of_it() {
    for name in Testbed::Robotarium.scenarios() {
        let scenario = built_in(Testbed::Robotarium, name, Preset::Hardened);
        let (offset_m, robots) = (scenario.body.offset_m, scenario.robots.len());
        let driven = driven(scenario);
        let too_near = points_m(&driven, offset_m, robots)
            .iter()
            .filter(|points| least_m(points) < ROBOTARIUM_APART_M)
            .count();
        assert_eq!(too_near, 0, "{name}");
    }
}

/// The same rule, so that it is seen to refuse: `stop` and `brake` of the thesis.
#[test]
fn the_rule_of_the_robotarium_refuses_the_thesis_scenarios_that_it_refuses() {
    for name in ["stop", "brake"] {
        let scenario = built_in(Testbed::Robotarium, name, Preset::Thesis);
        let (offset_m, robots) = (scenario.body.offset_m, scenario.robots.len());
        let driven = driven(scenario);
        let points = points_m(&driven, offset_m, robots);
        let too_near = points.iter().filter(|at| least_m(at) < ROBOTARIUM_APART_M);
        assert!(too_near.count() > 100, "{name}");
    }
}

/// The first in the list comes up behind the last, follows it from there on and ends at its speed.
#[test]
fn a_leader_that_laps_the_tail_follows_it() {
    let robots = vec![RobotSpec::steady(0.45, 0.25), RobotSpec::steady(0.0, 0.05)];
    let driven = driven(hardened(Testbed::Khepera, "on-off", robots));
    driven.assert_safe(CLEARANCE_M, "ring lap");
    let follows = |tick: &&testbed_sim::Tick| tick.decision.terms.unwrap().headway.is_some();
    let first = driven.of(0).find(follows).unwrap();
    assert!(
        first.time_s > 1.0,
        "at the start it is nearly half a lap ahead"
    );
    assert!((driven.final_speed_mps(0) - 0.05).abs() < 0.01);
}

#[test]
fn a_follower_comes_to_rest_clear_of_a_leader_that_stopped_for_good() {
    let leader = then(RobotSpec::steady(0.6, 0.1), 15.0, 0.0);
    let robots = vec![leader, RobotSpec::steady(0.0, 0.2)];
    let scenario = hardened(Testbed::Khepera, "straight", robots);
    assert_eq!(scenario.controller.headway.standstill_m, 0.0);
    let driven = driven(scenario);
    driven.assert_safe(CLEARANCE_M, "standstill");
    assert!(driven.final_speed_mps(1).abs() < 5e-3);
    assert!(driven.gap_m() < 0.05, "{:?}", driven.summary.least_distance);
}

#[test]
fn a_leader_that_reverses_stops_before_its_follower() {
    let leader = then(RobotSpec::steady(0.6, 0.1), 15.0, -0.1);
    let robots = vec![leader, RobotSpec::steady(0.0, 0.2)];
    let driven = driven(hardened(Testbed::Khepera, "straight", robots));
    driven.assert_safe(CLEARANCE_M, "leader reverses");
    let x_m = |robot| {
        driven
            .of(robot)
            .next_back()
            .unwrap()
            .truth
            .unwrap()
            .state
            .x_m
    };
    assert!(x_m(0) > x_m(1), "nobody drove through the other");
}

/// On a loop a robot that backs off comes to the one that follows it.
#[test]
fn a_follower_that_reverses_stops_before_who_comes_round() {
    let robots = vec![RobotSpec::steady(0.3, 0.1), RobotSpec::steady(0.0, -0.1)];
    let driven = driven(hardened(Testbed::Khepera, "on-off", robots));
    driven.assert_safe(CLEARANCE_M, "follower reverses");
    assert!(driven.gap_m() < 0.3, "they met");
}

#[test]
fn robots_that_start_on_each_other_are_refused_with_both_distances() {
    let robots = vec![RobotSpec::steady(0.05, 0.1), RobotSpec::steady(0.0, 0.1)];
    let error = Scenario::new(hardened(Testbed::Khepera, "straight", robots)).unwrap_err();
    let text = error.to_string();
    for words in [
        "starts 0.050 m from robot 0",
        "0.149 m are needed",
        "0.065 m",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
}

/// A body that says nothing has that of its testbed, any other half its wheel base and 25 mm; all of it stands in what is run.
#[test]
fn a_body_without_a_radius_is_given_one() {
    for (testbed, wheel_base_m, radius_m) in [
        (Testbed::Khepera, 0.0885, 0.065),
        (Testbed::Robotarium, 0.11, 0.055),
        (Testbed::Robotarium, 0.105, 0.055),
        (Testbed::Khepera, 0.3, 0.175),
    ] {
        let mut scenario = built_in(testbed, "straight", Preset::Hardened);
        scenario.body.radius_m = None;
        scenario.body.wheel_base_m = wheel_base_m;
        let scenario = Scenario::new(scenario).unwrap();
        assert_eq!(scenario.spec().body.radius_m, Some(radius_m));
        let least_m = 2.0 * radius_m + scenario.spec().controller.headway.clearance_m;
        assert!((scenario.controller().least_distance_m() - least_m).abs() < 1e-12);
    }
}

/// Files of before radius, clearance, acceleration and `every_robot`.
#[test]
fn files_without_the_newer_keys_are_read_and_hold_the_same_guards() {
    const NEWER: [&str; 4] = [
        "radius_m = 0.065",
        "clearance_m",
        "max_wheel_acceleration_mps2",
        "every_robot",
    ];
    for (preset, every_robot) in [(Preset::Thesis, false), (Preset::Hardened, true)] {
        let spec = RunSpec {
            seed: 1,
            scenario: built_in(Testbed::Khepera, "on-off", preset),
            disturbances: testbed_sim::Disturbances::default(),
        };
        let text = toml::to_string(&spec).unwrap();
        let is_newer = |line: &&str| NEWER.iter().any(|key| line.starts_with(key));
        assert_eq!(text.lines().filter(is_newer).count(), NEWER.len());
        let older: Vec<&str> = text.lines().filter(|line| !is_newer(line)).collect();
        let older: RunSpec = toml::from_str(&older.join("\n")).unwrap();
        let (new, old) = (
            Scenario::new(spec.scenario).unwrap(),
            Scenario::new(older.scenario).unwrap(),
        );
        assert_eq!(new.controller().body(), old.controller().body());
        let hardening = &old.controller().settings().hardening;
        assert_eq!(hardening.regards_every_robot(), every_robot);
        assert_eq!(old.spec().controller.headway.clearance_m, CLEARANCE_M);
    }
}

/// Of three robots in a straight lane the last was not seen yet, and the second wants to go back.
#[test]
fn nobody_drives_towards_a_robot_that_was_never_seen() {
    let robots = vec![
        RobotSpec::steady(0.9, 0.2),
        RobotSpec::steady(0.3, -0.2),
        RobotSpec::steady(0.0, 0.2),
    ];
    let mut spec = hardened(Testbed::Khepera, "straight", robots);
    spec.rate_hz = 20.0;
    let scenario = Scenario::new(spec).unwrap();
    let mut convoy = Convoy::new(&scenario);
    let see = |convoy: &mut Convoy, robot: usize| {
        let pose = scenario.starts()[robot];
        convoy.observe(robot, StampedPose { stamp_s: 0.0, pose });
    };
    see(&mut convoy, 0);
    see(&mut convoy, 1);
    let unseen = convoy.decide(1, 0.05);
    let reason = Brake::LeaderLost;
    assert_eq!(unseen.outcome, Outcome::Braking { reason });
    see(&mut convoy, 2);
    let seen = convoy.decide(1, 0.05);
    assert!(seen.speeds.speed_mps < 0.0, "{seen:?}");
}

fn starting(start_m: f64, beside_m: f64) -> Result<Scenario, Error> {
    let mut robots = vec![RobotSpec::steady(start_m, 0.2), RobotSpec::steady(0.0, 0.2)];
    robots[1].start_deviation_m = beside_m;
    Scenario::new(hardened(Testbed::Khepera, "straight", robots))
}

#[test]
fn starts_nearer_than_errors_allow_are_refused() {
    let error = starting(0.143, 0.0).unwrap_err().to_string();
    assert!(error.contains("for stated errors"), "{error}");
}

#[test]
fn starts_beyond_what_rows_keep_are_noted() {
    let is_noted = |beside_m: f64| {
        let scenario = starting(1.0, beside_m).unwrap();
        let notes = Adaptation::all(scenario.spec(), &Demands::new(&scenario));
        let is_beyond = |note: &Adaptation| matches!(note, Adaptation::StartsBeyondRows { .. });
        notes.iter().any(is_beyond)
    };
    assert!(!is_noted(0.0) && is_noted(0.149));
}

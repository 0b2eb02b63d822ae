//! Robots that have no room: they stand, and do not leave their lane to make way.

use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Body, PathSpec, RobotSpec, ScenarioSpec, Testbed, Tracker, lateral::Deviation};

use super::{driven, driven_with, eight, hardened, then};

/// Forward, backward from 8 to 18 s, and forward again, beside the path at the start.
fn to_and_fro(start: f64, start_deviation_m: f64, speed_mps: f64) -> RobotSpec {
    let mut robot = then(
        then(RobotSpec::steady(start, speed_mps), 8.0, -speed_mps),
        18.0,
        speed_mps,
    );
    robot.start_deviation_m = start_deviation_m;
    robot.stops_s = vec![[10.0, 14.0]];
    robot
}

/// A robot of 35 cm whose point of interest is 9 cm ahead.
fn large() -> Body {
    Body {
        offset_m: 0.09,
        mass_kg: 1.8,
        inertia_kgm2: 0.045,
        wheel_base_m: 0.266,
        radius_m: Some(0.173),
        max_wheel_speed_mps: 0.5,
        max_turn_rate_rad_s: 2.65,
        max_wheel_acceleration_mps2: Some(4.35),
        ..Testbed::Khepera.body()
    }
}

/// One waits obliquely before a crossing and wants to go back when another one comes near.
fn at_a_crossing() -> ScenarioSpec {
    let mut beside = RobotSpec::steady(0.42, 0.177);
    beside.start_deviation_m = -0.13;
    let robots = vec![
        beside,
        to_and_fro(0.28, -0.16, 0.207),
        RobotSpec::steady(0.14, 0.203),
        to_and_fro(0.0, -0.15, 0.175),
    ];
    let mut scenario = hardened(Testbed::Khepera, "on-off", robots);
    (scenario.body, scenario.rate_hz) = (large(), 100.0);
    (scenario.path, scenario.duration_s) = (eight(2.1, 1.13), 25.0);
    scenario.controller.lane.half_width_m = 0.3;
    scenario.controller.lane.margin_m = 0.015;
    scenario.controller.lane.deviation = Deviation::Frenet;
    scenario.controller.headway.time_s = 1.9;
    scenario
}

#[test]
fn robots_that_wait_at_a_crossing_do_not_back_out_of_their_lane() {
    for seed in 1..9 {
        let driven = driven_with(at_a_crossing(), Disturbances::HARD, seed);
        assert_eq!(
            driven.summary.verdict,
            Verdict::Safe,
            "seed {seed}: {:?}",
            driven.summary
        );
    }
}

/// Two straights side by side, driven in opposite directions, nearer to each other than two bodies, with a loop at each end.
fn side_by_side(half_gap_m: f64) -> PathSpec {
    let straight = |at: usize| -1.0 + 2.0 * at as f64 / 12.0;
    let turn = |at: usize| {
        let angle = std::f64::consts::PI * (2.0 * at as f64 / 24.0 - 1.0);
        [0.25 * angle.cos(), 0.25 * angle.sin()]
    };
    let loop_at = |x_m: f64, side: f64| {
        (3..22).map(move |at| {
            let [along, across] = turn(at);
            [x_m + side * (0.25 + along), side * across]
        })
    };
    let mut points_m: Vec<[f64; 2]> = (1..12).map(|at| [straight(at), -half_gap_m]).collect();
    points_m.extend(loop_at(1.0, 1.0));
    points_m.extend((1..12).map(|at| [-straight(at), half_gap_m]));
    points_m.extend(loop_at(-1.0, -1.0));
    PathSpec::Closed { points_m }
}

#[test]
fn robots_on_branches_beside_each_other_stay_in_their_lanes() {
    for (half_gap_m, seeds) in [(0.06, 1..5), (0.025, 1..5)] {
        let robots = vec![
            RobotSpec::steady(0.62, 0.15),
            RobotSpec::steady(0.45, 0.2),
            RobotSpec::steady(0.1, 0.25),
        ];
        let mut scenario = hardened(Testbed::Khepera, "on-off", robots);
        (scenario.path, scenario.duration_s) = (side_by_side(half_gap_m), 40.0);
        scenario.controller.lane.half_width_m = 0.08;
        scenario.controller.lane.margin_m = 0.015;
        scenario.controller.lane.deviation = Deviation::Frenet;
        for seed in seeds {
            let driven = driven_with(scenario.clone(), Disturbances::HARD, seed);
            assert_eq!(
                driven.summary.verdict,
                Verdict::Safe,
                "{half_gap_m} m, seed {seed}: {:?}",
                driven.summary
            );
        }
    }
}

/// Six in a wide lane, a few centimetres apart, with others that go back: a robot that stands does not turn into the headway of its
/// follower, nor towards the one ahead.
#[test]
fn robots_that_stand_close_behind_each_other_keep_their_headway_when_one_turns() {
    let step = 0.052;
    let robot = |place: usize, deviation_m: f64, speed_mps: f64| {
        let mut robot = RobotSpec::steady(step * place as f64, speed_mps);
        robot.start_deviation_m = deviation_m;
        robot
    };
    let mut first = then(robot(5, 0.036, 0.048), 8.0, -0.048);
    first.tracker = Tracker::Off {
        from_s: 5.0,
        to_s: 30.0,
    };
    let mut fifth = then(robot(1, 0.14, 0.036), 8.0, -0.036);
    fifth.stops_s = vec![[10.0, 14.0]];
    let robots = vec![
        first,
        robot(4, 0.068, 0.137),
        robot(3, -0.134, 0.041),
        robot(2, 0.04, 0.31),
        fifth,
        robot(0, 0.027, 0.323),
    ];
    let mut scenario = hardened(Testbed::Khepera, "on-off", robots);
    scenario.body = Body {
        offset_m: 0.095,
        mass_kg: 4.9,
        inertia_kgm2: 0.0193,
        wheel_base_m: 0.139,
        radius_m: Some(0.097),
        max_wheel_speed_mps: 0.231,
        max_turn_rate_rad_s: 2.42,
        max_wheel_acceleration_mps2: Some(2.0),
        ..Testbed::Khepera.body()
    };
    scenario.path = PathSpec::Polar {
        radius_m: 0.646,
        amplitude_m: 0.0,
        periods: 0,
    };
    scenario.duration_s = 20.0;
    scenario.controller.lane.half_width_m = 0.25;
    scenario.controller.lane.margin_m = 0.015;
    let undisturbed = driven(scenario.clone());
    let headway_m = undisturbed.summary.min_h_headway_m.unwrap();
    assert!(headway_m > 0.005, "{:?}", undisturbed.summary);
    for seed in 1..6 {
        let summary = driven_with(scenario.clone(), Disturbances::HARD, seed).summary;
        assert_eq!(summary.verdict, Verdict::Safe, "seed {seed}: {summary:?}");
    }
}

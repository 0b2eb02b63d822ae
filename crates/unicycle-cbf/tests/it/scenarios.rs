//! What scenarios refuse, and what they say.

use unicycle_cbf::{
    Error, PathSpec, Preset, Scenario, ScenarioSpec, Testbed, Tracker, lateral::Deviation,
};

fn spec() -> ScenarioSpec {
    Testbed::Khepera.scenario("on-off", Preset::Thesis).unwrap()
}

fn refusal(change: impl FnOnce(&mut ScenarioSpec)) -> String {
    let mut spec = spec();
    change(&mut spec);
    Scenario::new(spec).unwrap_err().to_string()
}

#[test]
fn every_built_in_scenario_can_be_run() {
    for &testbed in Testbed::ALL {
        for name in testbed.scenarios() {
            for preset in [Preset::Thesis, Preset::Hardened] {
                let spec = testbed.scenario(name, preset).unwrap();
                let scenario = Scenario::new(spec.clone()).unwrap();
                let text = serde_json::to_string(&spec).unwrap();
                assert_eq!(serde_json::from_str::<ScenarioSpec>(&text).unwrap(), spec);
                let offset_m = spec.body.offset_m;
                for (robot, start) in scenario.starts().iter().enumerate() {
                    let state = start.state(offset_m, scenario.initial_speeds(robot));
                    let lateral = scenario.controller().lateral(&state);
                    assert!(lateral.deviation_m.abs() < 1e-9, "{name} {robot}");
                }
            }
        }
    }
}

#[test]
fn numbers_out_of_range_are_named() {
    for (found, words) in [
        (
            refusal(|s| s.rate_hz = 0.0),
            "`rate_hz` is 0; it must be from 1 to 1000",
        ),
        (refusal(|s| s.rate_hz = f64::NAN), "`rate_hz` is NaN"),
        (refusal(|s| s.duration_s = -1.0), "`duration_s` is -1"),
        (
            refusal(|s| s.body.mass_kg = 0.0),
            "`mass_kg` is 0; it must be positive",
        ),
        (
            refusal(|s| s.body.wheel_base_m = 1e-300),
            "`body.wheel_base_m` is 0.0000",
        ),
        (refusal(|s| s.controller.weights[4] = 0.0), "`weights` is 0"),
        (
            refusal(|s| s.controller.headway.time_s = -1.0),
            "`headway.time_s` is -1",
        ),
        (
            refusal(|s| s.controller.lane.margin_m = 0.15),
            "leaves nothing of lane.half_width_m 0.15",
        ),
        (
            refusal(|s| s.controller.lane.half_width_m = f64::INFINITY),
            "`lane.half_width_m` is inf",
        ),
        (
            refusal(|s| s.controller.hardening.position_gain = 0.0),
            "`hardening.position_gain` is 0",
        ),
        (
            refusal(|s| s.robots.clear()),
            "`number of robots` is 0; it must be from 1 to 64",
        ),
        (
            refusal(|s| s.robots[1].start = f64::NAN),
            "robot 1 starts at a place that is no number",
        ),
        (
            refusal(|s| s.robots[0].desired_speed_mps.clear()),
            "robot 0 has no desired speed at 0 s",
        ),
        (
            refusal(|s| s.robots[0].desired_speed_mps = vec![[0.0, 0.1], [5.0, 0.2], [4.0, 0.1]]),
            "not in the order of time",
        ),
        (
            refusal(|s| s.robots[0].stops_s = vec![[5.0, 4.0]]),
            "a stop that ends before it begins",
        ),
        (
            refusal(|s| {
                s.robots[1].tracker = Tracker::Off {
                    from_s: 9.0,
                    to_s: 8.0,
                };
            }),
            "on again before it is off",
        ),
        (
            refusal(|s| {
                s.path = PathSpec::Polar {
                    radius_m: 0.2,
                    amplitude_m: 0.3,
                    periods: 3,
                };
            }),
            "path: ",
        ),
        (
            refusal(|s| s.duration_s = 86_400.0),
            "2 robots for 86400 s at 50 Hz are 8640000 decisions, and a run has at most 1000000",
        ),
        (
            refusal(|s| s.path = PathSpec::Closed { points_m: vec![] }),
            "path: ",
        ),
    ] {
        assert!(found.contains(words), "`{found}` does not say `{words}`");
    }
}

#[test]
fn a_leader_that_starts_behind_is_refused() {
    let mut spec = Testbed::Khepera
        .scenario("straight", Preset::Thesis)
        .unwrap();
    spec.robots.swap(0, 1);
    let error = Scenario::new(spec).unwrap_err();
    assert!(matches!(error, Error::Start { robot: 1, .. }));
    let text = error.to_string();
    assert!(
        text.contains("0.600 m ahead of the one before it"),
        "{text}"
    );
}

#[test]
fn a_lane_wider_than_the_tightest_bend_is_known() {
    let track = || {
        Testbed::Robotarium
            .scenario("track", Preset::Thesis)
            .unwrap()
    };
    let bend_m = |spec| Scenario::new(spec).unwrap().tight_bend_m();
    assert_eq!(bend_m(track()), None);
    let mut frenet = track();
    frenet.controller.lane.deviation = Deviation::Frenet;
    assert!((bend_m(frenet.clone()).unwrap() - 0.09).abs() < 0.001);
    frenet.controller.lane.half_width_m = 0.08;
    assert_eq!(bend_m(frenet), None);
}

#[test]
fn unknown_scenarios_are_refused_with_those_that_there_are() {
    let error = Testbed::Khepera
        .scenario("track", Preset::Thesis)
        .unwrap_err();
    assert!(
        error.to_string().contains("on-off, decay, straight"),
        "{error}"
    );
}

#[test]
fn trackers_are_off_and_decay_in_time() {
    let scenario = Scenario::new(spec()).unwrap();
    let on = |time_s| scenario.objectives(1, time_s).tracking.is_some();
    assert!(on(19.99) && !on(20.0) && !on(44.99) && on(45.0));
    let decay = Testbed::Khepera.scenario("decay", Preset::Thesis).unwrap();
    let scenario = Scenario::new(decay).unwrap();
    let at = |time_s| scenario.objectives(1, time_s).tracking.unwrap();
    assert_eq!((at(9.9).rate_1ps, at(9.9).weight), (1.0, 1e3));
    assert!((at(11.0).rate_1ps - (-1.0_f64).exp()).abs() < 1e-12);
    assert!((at(60.0).weight - 1e-6).abs() < 1e-15);
}

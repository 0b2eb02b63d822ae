//! Numbers of scenarios that are in another unit are refused, and the message says which.

use unicycle_cbf::{Error, PathSpec, Preset, Scenario, ScenarioSpec, Testbed};

/// What is changed in a scenario.
type Change = fn(&mut ScenarioSpec);

fn straight() -> ScenarioSpec {
    let testbed = Testbed::Khepera;
    testbed.scenario("straight", Preset::Hardened).unwrap()
}

fn on_off() -> ScenarioSpec {
    Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap()
}

fn refused(mut spec: ScenarioSpec, change: fn(&mut ScenarioSpec)) -> String {
    change(&mut spec);
    Scenario::new(spec).unwrap_err().to_string()
}

#[test]
fn lengths_in_millimetres_are_refused() {
    let cases: [(&str, Change); 12] = [
        ("body.wheel_base_m", |spec| spec.body.wheel_base_m = 88.5),
        ("body.offset_m", |spec| spec.body.offset_m = 50.0),
        ("body.radius_m", |spec| spec.body.radius_m = Some(65.0)),
        ("lane.half_width_m", |spec| {
            spec.controller.lane.half_width_m = 150.0;
        }),
        ("lane.margin_m", |spec| spec.controller.lane.margin_m = 15.0),
        ("headway.standstill_m", |spec| {
            spec.controller.headway.standstill_m = 140.0;
        }),
        ("headway.clearance_m", |spec| {
            spec.controller.headway.clearance_m = 10.0;
        }),
        ("headway.margin_m", |spec| {
            spec.controller.headway.margin_m = 2.5;
        }),
        ("hardening.position_noise_m", |spec| {
            spec.controller.hardening.position_noise_m = 3.0;
        }),
        ("starts 20 m beside", |spec| {
            spec.robots[1].start_deviation_m = 20.0;
        }),
        ("path.radius_m", |spec| {
            spec.path = PathSpec::Polar {
                radius_m: 900.0,
                amplitude_m: 230.0,
                periods: 3,
            };
        }),
        ("path.points_m", |spec| {
            let points = [[0.0, 0.0], [900.0, 0.0], [900.0, 900.0], [0.0, 900.0]];
            spec.path = PathSpec::Closed {
                points_m: points.to_vec(),
            };
        }),
    ];
    for (name, change) in cases {
        let text = refused(on_off(), change);
        assert!(text.contains(name) && text.contains("mm"), "{name}: {text}");
    }
}

#[test]
fn angles_in_degrees_are_refused() {
    let heading = |spec: &mut ScenarioSpec| {
        spec.path = PathSpec::Straight {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 90.0,
        };
    };
    let cases: [(&str, Change); 4] = [
        ("path.heading_rad", heading),
        ("body.max_turn_rate_rad_s", |spec| {
            spec.body.max_turn_rate_rad_s = 130.0;
        }),
        ("hardening.heading_noise_rad", |spec| {
            spec.controller.hardening.heading_noise_rad = 0.5;
        }),
        ("hardening.max_course_angle_rad", |spec| {
            spec.controller.hardening.max_course_angle_rad = Some(80.0);
        }),
    ];
    for (name, change) in cases {
        let text = refused(straight(), change);
        assert!(
            text.contains(name) && text.contains("degrees"),
            "{name}: {text}"
        );
    }
    let text = refused(straight(), |spec| spec.robots[0].start = 1e300);
    assert!(
        text.contains("`start` 1e300") && text.contains("from -442 to 442"),
        "{text}"
    );
    refused(straight(), |spec| spec.robots[1].start = -600.0);
    let text = refused(on_off(), |spec| spec.robots[1].start = 90.0);
    assert!(text.contains("revolutions"), "{text}");
}

#[test]
fn speeds_masses_times_and_shares_in_another_unit_are_refused() {
    let cases: [(&str, &str, Change); 9] = [
        ("body.max_wheel_speed_mps", "mm/s", |spec| {
            spec.body.max_wheel_speed_mps = 314.8;
        }),
        ("body.max_wheel_acceleration_mps2", "mm/s²", |spec| {
            spec.body.max_wheel_acceleration_mps2 = Some(5000.0);
        }),
        ("is wanted to go at 20 m/s", "cm/s", |spec| {
            spec.robots[0].desired_speed_mps[0][1] = 20.0;
        }),
        ("body.mass_kg", "were g meant", |spec| {
            spec.body.mass_kg = 690.0;
        }),
        ("body.mass_kg", "kg", |spec| spec.body.mass_kg = 1e-9),
        ("body.inertia_kgm2", "kg cm²", |spec| {
            spec.body.inertia_kgm2 = 15.0;
        }),
        ("hardening.max_pose_age_s", "ms", |spec| {
            spec.controller.hardening.max_pose_age_s = Some(300.0);
        }),
        ("hardening.wheel_error", "percent", |spec| {
            spec.controller.hardening.wheel_error = 10.0;
        }),
        ("rate_hz", "time between two", |spec| spec.rate_hz = 0.02),
    ];
    for (name, help, change) in cases {
        let text = refused(on_off(), change);
        assert!(text.contains(name) && text.contains(help), "{name}: {text}");
    }
}

#[test]
fn a_radius_out_of_which_the_wheels_stand_is_refused() {
    let text = refused(on_off(), |spec| spec.body.radius_m = Some(0.03));
    for words in [
        "body.radius_m` is 0.03",
        "0.04425",
        "wheels stand out of it",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
}

/// As large or small as robots of these testbeds' kind are, and larger ones.
#[test]
fn what_robots_have_is_believed() {
    for &testbed in Testbed::ALL {
        for name in testbed.scenarios() {
            for preset in [Preset::Thesis, Preset::Hardened] {
                Scenario::new(testbed.scenario(name, preset).unwrap()).unwrap();
            }
        }
    }
    let mut large = straight();
    large.body.wheel_base_m = 0.6;
    (large.body.radius_m, large.body.offset_m) = (Some(0.45), 0.3);
    (large.body.mass_kg, large.body.inertia_kgm2) = (60.0, 4.0);
    (
        large.body.max_wheel_speed_mps,
        large.body.max_turn_rate_rad_s,
    ) = (1.5, 5.0);
    large.controller.lane.half_width_m = 1.5;
    large.robots[0].start = 4.0;
    let scenario = Scenario::new(large);
    assert!(!matches!(scenario, Err(Error::Unit { .. })), "{scenario:?}");
    scenario.unwrap();
}

#[test]
fn a_robot_that_turns_too_slowly_for_the_stated_errors_is_slowed_and_then_refused() {
    let slow = |turn_rate_rad_s: f64| {
        let mut spec = on_off();
        spec.path = PathSpec::Polar {
            radius_m: 1.0,
            amplitude_m: 0.0,
            periods: 0,
        };
        spec.robots.truncate(1);
        spec.body.max_turn_rate_rad_s = turn_rate_rad_s;
        Scenario::new(spec)
    };
    let limits = *slow(0.2).unwrap().controller().limits();
    // 1/R, two wheels that are off, and what the heading is wrong by then, undone at 2 1/s; noise of half a degree, twice.
    let wheels_1pm = 2.0 * 0.1 / 0.0885;
    let by_speed_1pm = 1.0 + wheels_1pm * (1.0 + 2.0 * (0.3 + 0.02));
    let left_rad_s = 0.2 - 2.0 * 2.0 * 0.5_f64.to_radians();
    let expected_mps = left_rad_s / by_speed_1pm;
    assert!(
        (limits.wheel_speed_mps - expected_mps).abs() < 1e-9,
        "{limits:?}"
    );
    assert!((limits.agile_mps - expected_mps).abs() < 1e-9);
    let error = slow(0.03).unwrap_err();
    assert!(matches!(error, Error::DoesNotFit { .. }), "{error}");
    for words in ["turns too slowly", "is 0.030", "rad/s even with wheels"] {
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn bounds_and_numbers_are_said_in_a_few_digits() {
    let mut spec = on_off();
    spec.controller.headway.standstill_m = -0.5;
    let text = Scenario::new(spec).unwrap_err().to_string();
    assert!(text.ends_with("is -0.5; it must be at least 0"), "{text}");
    let mut spec = on_off();
    spec.robots[0].start = 1e300;
    let text = Scenario::new(spec).unwrap_err().to_string();
    assert!(text.contains("1e300") && text.len() < 200, "{text}");
}

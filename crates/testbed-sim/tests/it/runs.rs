//! The five runs of the thesis, and what disturbances do to them.

use testbed_sim::{Disturbances, Group, RunSpec, Summary};
use unicycle_cbf::{Preset, ScenarioSpec, Testbed};

/// Testbed, scenario, and figures of an independent simulation: least headway barrier, least lane barrier, largest deviation,
/// mean speed of the last 5 s.
pub(crate) const THESIS: [(Testbed, &str, [f64; 4]); 5] = [
    (Testbed::Khepera, "on-off", [0.0042, 0.077, 0.144, 0.095]),
    (Testbed::Khepera, "decay", [0.0041, 0.056, 0.146, 0.113]),
    (
        Testbed::Robotarium,
        "on-off",
        [0.0021, 0.0013, 0.0387, 0.045],
    ),
    (
        Testbed::Robotarium,
        "decay",
        [0.0021, 0.0013, 0.0388, 0.046],
    ),
    (Testbed::Robotarium, "track", [0.0027, 0.134, 0.0159, 0.092]),
];

pub(crate) fn run(scenario: ScenarioSpec, disturbances: Disturbances, seed: u64) -> Summary {
    let spec = RunSpec {
        seed,
        scenario,
        disturbances,
    };
    spec.simulate().unwrap().1
}

pub(crate) fn undisturbed(scenario: ScenarioSpec) -> Summary {
    run(scenario, Disturbances::default(), 1)
}

/// Off stretches depend on the last digits of every solution, so bounds and signs are compared and not runs.
#[test]
fn the_five_runs_of_the_thesis_are_safe_without_a_fallback() {
    for (testbed, name, [headway_m, _, _, _]) in THESIS {
        let scenario = testbed.scenario(name, Preset::Thesis).unwrap();
        let half_width_m = scenario.controller.lane.half_width_m;
        let summary = undisturbed(scenario);
        println!("{} {name}: {summary:?}", testbed.name());
        assert!(
            !summary.bodies_were_near || testbed == Testbed::Robotarium,
            "{name}"
        );
        assert!(summary.min_h_lane >= 0.0 && summary.max_abs_lateral_m < half_width_m);
        assert_eq!((summary.outcomes.relaxed, summary.outcomes.braking), (0, 0));
        let least = summary.min_h_headway_m.unwrap();
        assert!(
            least >= 0.0 && (least - headway_m).abs() < 5e-4,
            "{name}: {least}"
        );
        assert!((0.03..0.13).contains(&summary.final_speed_mps));
    }
}

/// What is not sensitive: the run in which the tracker stays on, to the last digit of the table, whose simulation had rows for
/// the wheels. Without them wheels are clipped after the program, and the robot strays almost twice as far.
#[test]
fn the_run_with_the_tracker_on_is_that_of_an_independent_simulation() {
    let (testbed, name, [headway_m, lane, deviation_m, speed_mps]) = THESIS[4];
    let mut scenario = testbed.scenario(name, Preset::Thesis).unwrap();
    let clipped = undisturbed(scenario.clone());
    scenario.controller.hardening.wheel_rows = true;
    scenario.body.max_wheel_acceleration_mps2 = Some(1e3);
    let summary = undisturbed(scenario);
    for (found, expected, digit) in [
        (summary.min_h_headway_m.unwrap(), headway_m, 1e-4),
        (summary.min_h_lane, lane, 1e-3),
        (summary.max_abs_lateral_m, deviation_m, 1e-4),
        (summary.final_speed_mps, speed_mps, 1e-3),
    ] {
        assert!(
            (found - expected).abs() < 0.55 * digit,
            "{found} in place of {expected}"
        );
    }
    assert!(clipped.max_abs_lateral_m > 1.7 * deviation_m);
}

#[test]
fn a_leader_a_quarter_ahead_makes_the_track_run_start_unsafe() {
    let mut scenario = Testbed::Robotarium
        .scenario("track", Preset::Thesis)
        .unwrap();
    scenario.robots[0].start = 0.25;
    let summary = undisturbed(scenario);
    assert_eq!(summary.first_unsafe_s, Some(0.0));
    assert!((summary.min_h_headway_m.unwrap() + 0.006).abs() < 1e-3);
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let scenario = Testbed::Khepera
        .scenario("decay", Preset::Hardened)
        .unwrap();
    let spec = RunSpec {
        seed: 5,
        scenario,
        disturbances: Disturbances::HARD,
    };
    let (mut first, _) = spec.simulate().unwrap();
    let (mut second, _) = spec.simulate().unwrap();
    for tick in first.ticks.iter_mut().chain(&mut second.ticks) {
        tick.step_us = 0.0;
    }
    // NaN is not equal to itself, so the text is compared.
    assert_eq!(format!("{:?}", first.ticks), format!("{:?}", second.ticks));
}

#[test]
fn without_disturbances_the_seed_does_not_matter() {
    let scenario = || {
        Testbed::Robotarium
            .scenario("on-off", Preset::Thesis)
            .unwrap()
    };
    let none = Disturbances::default();
    assert_eq!(run(scenario(), none, 1), run(scenario(), none, 2));
}

#[test]
fn disturbances_out_of_range_are_named() {
    let scenario = Testbed::Robotarium
        .scenario("track", Preset::Thesis)
        .unwrap();
    for (disturbances, words) in [
        (
            Disturbances {
                drop_share: 1.5,
                ..Disturbances::default()
            },
            "disturbance `drop_share` is 1.5; it must be from 0 to 1",
        ),
        (
            Disturbances {
                position_noise_m: f64::NAN,
                ..Disturbances::default()
            },
            "`position_noise_m` is NaN",
        ),
        (
            Disturbances {
                jitter_s: 0.1,
                latency_s: 0.05,
                ..Disturbances::default()
            },
            "`jitter_s` is 0.1; it must be from 0 to 0.05",
        ),
    ] {
        let spec = RunSpec {
            seed: 1,
            scenario: scenario.clone(),
            disturbances,
        };
        let error = spec.simulate().unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_robot_that_starts_outside_its_lane_comes_back_and_the_run_says_so() {
    for (testbed, preset) in [
        (Testbed::Khepera, Preset::Thesis),
        (Testbed::Robotarium, Preset::Thesis),
        (Testbed::Khepera, Preset::Hardened),
    ] {
        let mut scenario = testbed.scenario("on-off", preset).unwrap();
        let half_width_m = scenario.controller.lane.half_width_m;
        scenario.duration_s = 9.0;
        scenario.robots[1].start_deviation_m = 1.3 * half_width_m;
        let spec = RunSpec {
            seed: 1,
            scenario,
            disturbances: Disturbances::default(),
        };
        let (run, summary) = spec.simulate().unwrap();
        assert_eq!(
            (summary.safe, summary.first_unsafe_s),
            (Some(false), Some(0.0))
        );
        let last = run.ticks.iter().rev().find(|tick| tick.robot == 1).unwrap();
        let deviation_m = last.truth.unwrap().safety.deviation_m;
        assert!(
            deviation_m.abs() < half_width_m,
            "{preset:?}: {deviation_m}"
        );
    }
}

/// Latency, in the thesis's controller and with a predictor.
#[test]
fn prediction_removes_what_latency_does() {
    let late = Disturbances {
        latency_s: 0.2,
        ..Disturbances::default()
    };
    let scenario = Testbed::Robotarium
        .scenario("track", Preset::Thesis)
        .unwrap();
    let mut predicted = scenario.clone();
    predicted.controller.hardening.predict = true;
    let (plain, predicted) = (run(scenario, late, 1), run(predicted, late, 1));
    assert!(plain.min_h_headway_m.unwrap() < -1e-3, "{plain:?}");
    assert!(predicted.min_h_headway_m.unwrap() > 0.0, "{predicted:?}");
}

/// Clipping after the program is not needed where the limits are rows.
#[test]
fn hardened_runs_survive_every_group_of_disturbances() {
    for &testbed in Testbed::ALL {
        for name in testbed.scenarios() {
            for &group in Group::ALL {
                let scenario = testbed.scenario(name, Preset::Hardened).unwrap();
                let summary = run(scenario, Disturbances::HARD.only(group), 11);
                assert!(
                    summary.safe == Some(true),
                    "{} {name} {}: {summary:?}",
                    testbed.name(),
                    group.name()
                );
            }
        }
    }
}

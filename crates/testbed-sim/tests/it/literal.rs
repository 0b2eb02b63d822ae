//! The forms of the thesis as printed, and what each of them breaks.

use testbed_sim::Summary;
use unicycle_cbf::{
    Brake, Controller, ControllerSettings, Input, Leader, Outcome, Pose, Preset, Scenario, Speeds,
    State, Testbed, settings::Literal,
};

use crate::runs::{THESIS, undisturbed};

fn with(testbed: Testbed, name: &str, form: Literal) -> Summary {
    let mut scenario = testbed.scenario(name, Preset::Thesis).unwrap();
    scenario.controller.literal = vec![form];
    undisturbed(scenario)
}

fn controller(
    testbed: Testbed,
    name: &str,
    change: impl Fn(&mut ControllerSettings),
) -> Controller {
    let mut scenario = testbed.scenario(name, Preset::Thesis).unwrap();
    change(&mut scenario.controller);
    Scenario::new(scenario).unwrap().controller().clone()
}

/// A condition on `ḣ` that holds at the sample does not hold until the next: the speed jumps at the start of a period, the
/// distance grows over all of it.
#[test]
fn without_margins_every_run_dips_below_zero_between_samples() {
    for (testbed, name, _) in THESIS {
        let mut scenario = testbed.scenario(name, Preset::Thesis).unwrap();
        scenario.controller.headway.margin_m = 0.0;
        scenario.controller.lane.margin_m = 0.0;
        let least = undisturbed(scenario.clone()).min_h_headway_m.unwrap();
        assert!((-1.1e-3..-0.2e-3).contains(&least), "{name}: {least}");
        // A margin from the period does the same as one by hand.
        scenario.controller.hardening.sampling_margin = true;
        let least = undisturbed(scenario).min_h_headway_m.unwrap();
        assert!(least > 0.0, "{name}: {least}");
    }
}

/// `L_f h + L_g h u ≤ γ h` limits how fast the barrier may grow and lets it fall: robots leave the lane and run into their leader.
#[test]
fn the_printed_sign_of_barrier_rows_protects_from_safety() {
    for (testbed, name, _) in THESIS {
        let summary = with(testbed, name, Literal::BarrierSign);
        assert!(
            summary.safe == Some(false) && summary.min_h_headway_m.unwrap() < -0.05,
            "{name}: {summary:?}"
        );
    }
}

/// A leader that comes nearer is taken to stand.
#[test]
fn without_the_leaders_velocity_an_approaching_leader_is_unsafe() {
    let least = |literal: &[Literal]| {
        let controller = controller(Testbed::Khepera, "straight", |settings| {
            settings.literal = literal.to_vec();
        });
        let objectives = controller.objectives(0.2);
        let mut pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        let mut speeds = Speeds {
            speed_mps: 0.2,
            turn_rate_rad_s: 0.0,
        };
        let mut least = f64::INFINITY;
        for step in 0..150 {
            let ahead = State {
                x_m: 1.2 - 0.2 * f64::from(step) * controller.hold_s(),
                y_m: 0.0,
                speed_mps: 0.2,
                heading_rad: std::f64::consts::PI,
                turn_rate_rad_s: 0.0,
            };
            let own = pose.state(controller.body().offset_m, speeds);
            let decision = controller.decide(&own, Some(&Leader::known(ahead)), &objectives, 0.0);
            speeds = decision.speeds;
            pose = pose.advanced(speeds, controller.hold_s());
            least = least.min(decision.terms.unwrap().headway.unwrap().value);
        }
        least
    };
    let (literal, corrected) = (least(&[Literal::IgnoredLeader]), least(&[]));
    assert!(literal < -0.05 && corrected > 0.0, "{literal} {corrected}");
}

/// `|φ̇|` has the wrong sign clockwise, where the derivative of V3 is then that of nothing, and none at all at rest.
#[test]
fn an_angle_rate_without_a_sign_is_wrong_clockwise_and_undefined_at_rest() {
    let own = State {
        x_m: 0.85,
        y_m: 0.1,
        speed_mps: 0.15,
        heading_rad: -1.2,
        turn_rate_rad_s: 0.3,
    };
    let error = |literal: &[Literal]| {
        let controller = controller(Testbed::Khepera, "on-off", |settings| {
            settings.literal = literal.to_vec();
        });
        let step_s = 1e-5;
        let at = |by_s: f64| {
            let state = controller.body().integrated(&own, Input::default(), by_s);
            controller.lateral(&state)
        };
        let change = (at(step_s).deviation_m - at(-step_s).deviation_m) / (2.0 * step_s);
        (at(0.0).rate_mps - change).abs()
    };
    assert!(error(&[Literal::UnsignedAngleRate]) > 0.1);
    assert!(error(&[]) < 1e-9);

    let still = State {
        speed_mps: 0.0,
        turn_rate_rad_s: 0.0,
        ..own
    };
    let outcome = |literal: &[Literal]| {
        let controller = controller(Testbed::Khepera, "on-off", |settings| {
            settings.literal = literal.to_vec();
        });
        controller
            .decide(&still, None, &controller.objectives(0.2), 0.0)
            .outcome
    };
    let reason = Brake::NotFinite;
    assert_eq!(
        outcome(&[Literal::UnsignedAngleRate]),
        Outcome::Braking { reason }
    );
    assert_eq!(outcome(&[]), Outcome::Optimal);
}

/// "h ≥ 0 implies |y| ≤ d" is false: two half widths to the left and moving right, h is positive. And it jumps at `ẏ = 0`.
#[test]
fn the_switching_lane_barrier_is_positive_outside_the_lane() {
    let value = |literal: &[Literal], speed_mps: f64| {
        let controller = controller(Testbed::Robotarium, "track", |settings| {
            settings.literal = literal.to_vec();
        });
        let foot = controller.path().nearest(0.35, 0.0);
        let [nx, ny] = foot.normal();
        let half_width_m = controller.settings().lane.half_width_m;
        let state = State {
            x_m: foot.x_m - 1.2 * half_width_m * nx,
            y_m: foot.y_m - 1.2 * half_width_m * ny,
            speed_mps,
            heading_rad: ny.atan2(nx),
            turn_rate_rad_s: 0.0,
        };
        let safety = controller.safety(&state, None);
        assert!(safety.deviation_m < -half_width_m);
        safety.lane
    };
    let literal = |speed| value(&[Literal::SwitchingLane], speed);
    assert!(literal(0.05) > 0.0 && value(&[], 0.05) < 0.0);
    assert!((literal(1e-9) - literal(-1e-9)).abs() > 0.3);
}

/// The weight of `δ3` is `p5`: with `p3` decaying in its place the robot gives up its speed and never leaves the path.
#[test]
fn decaying_the_third_weight_gives_up_the_speed_and_not_the_path() {
    let corrected = undisturbed(
        Testbed::Robotarium
            .scenario("decay", Preset::Thesis)
            .unwrap(),
    );
    let literal = with(Testbed::Robotarium, "decay", Literal::DecayingSpeedWeight);
    assert!(corrected.max_abs_lateral_m > 0.038 && literal.max_abs_lateral_m < 0.01);
    assert!(corrected.final_speed_mps > 0.04 && literal.final_speed_mps < 0.01);
}

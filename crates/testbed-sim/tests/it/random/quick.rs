//! Small robots with fast wheels that are told seldom what to do: with their point of interest hardly ahead of the axle a command that is
//! held turns them far.

use std::f64::consts::TAU;

use testbed_sim::Disturbances;
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{
    Body, Centripetal, PathSpec, Preset, RobotSpec, ScenarioSpec, Testbed, Tracker,
    lateral::Deviation, settings::Distance,
};

use super::generator::{Draw, Drawn};

pub(super) fn drawn(seed: u64) -> Drawn {
    let mut draw = Draw::new(seed ^ (1 << 41));
    let mut spec = Testbed::Khepera
        .scenario("on-off", Preset::Hardened)
        .unwrap();
    spec.name = format!("quick {seed}");
    spec.rate_hz = draw.one_of(&[5.0, 8.0, 10.0, 12.0, 15.0]);
    spec.duration_s = 40.0;
    spec.body = body(&mut draw);
    let controller = &mut spec.controller;
    controller.lane.half_width_m = draw.between(10.0_f64.ln(), 300.0_f64.ln()).exp() * 1e-3;
    controller.lane.margin_m = 0.1 * controller.lane.half_width_m;
    controller.lane.deviation = draw.one_of(&[Deviation::Frenet, Deviation::Radial]);
    controller.lane.rate_1ps = draw.one_of(&[2.0, 4.0, 8.0]);
    controller.lane.barrier = LaneBarrier::Exponential {
        rate_1ps: draw.one_of(&[1.0, 2.0, 4.0]),
    };
    controller.headway.distance = draw.one_of(&[Distance::Chord, Distance::Path]);
    controller.headway.time_s = draw.between(0.3, 2.0);
    let stated = &mut controller.hardening;
    stated.max_pose_age_s = Some(draw.one_of(&[0.3, 0.5]));
    stated.position_noise_m = draw.one_of(&[0.0, 1e-3, 3e-3]);
    stated.heading_noise_rad = draw.one_of(&[2e-3, 8.7e-3]);
    stated.wheel_error = draw.one_of(&[0.0, 0.0, 0.01, 0.1]);
    let disturbances = Disturbances {
        position_noise_m: stated.position_noise_m,
        heading_noise_rad: stated.heading_noise_rad,
        wheel_error: stated.wheel_error,
        ..Disturbances::HARD
    };
    spec.path = path(&mut draw);
    spec.robots = robots(&mut draw, &spec);
    Drawn {
        spec,
        disturbances,
        is_easy: false,
    }
}

fn body(draw: &mut Draw) -> Body {
    let wheel_base_m = draw.between(0.04, 0.09);
    let mass_kg = draw.between(0.05, 1.0);
    let max_wheel_speed_mps = draw.between(0.8, 1.7);
    Body {
        offset_m: draw.between(0.01, 0.06),
        mass_kg,
        inertia_kgm2: mass_kg * wheel_base_m.powi(2) * draw.between(0.04, 0.15),
        centripetal: draw.one_of(&[Centripetal::Printed, Centripetal::Newton]),
        wheel_base_m,
        radius_m: None,
        max_wheel_speed_mps,
        max_turn_rate_rad_s: 1.5 * max_wheel_speed_mps / wheel_base_m,
        max_wheel_acceleration_mps2: Some(draw.between(2.0, 10.0)),
    }
}

fn path(draw: &mut Draw) -> PathSpec {
    let size_m = draw.between(1.0_f64.ln(), 8.0_f64.ln()).exp();
    match draw.whole(0, 2) {
        0 => PathSpec::Polar {
            radius_m: size_m,
            amplitude_m: 0.0,
            periods: 1,
        },
        1 => {
            let height_m = size_m * draw.between(0.5, 0.9);
            let point = |at: usize| {
                let t = TAU * at as f64 / 160.0;
                [1.6 * size_m * t.sin(), height_m * (2.0 * t).sin()]
            };
            let points_m = (0..160).map(point).collect();
            PathSpec::Closed { points_m }
        }
        _ => PathSpec::Polar {
            radius_m: size_m,
            amplitude_m: size_m * draw.between(0.0, 0.15),
            periods: 2,
        },
    }
}

fn robots(draw: &mut Draw, spec: &ScenarioSpec) -> Vec<RobotSpec> {
    let (count, most_mps) = (draw.whole(1, 3), spec.body.max_wheel_speed_mps);
    let half_width_m = spec.controller.lane.half_width_m;
    let robots = (0..count).map(|robot| {
        let start = 0.9 - 0.8 * robot as f64 / count as f64;
        let mut own = RobotSpec::steady(start, most_mps * draw.between(0.2, 1.0));
        own.start_deviation_m = half_width_m * draw.between(-0.1, 0.1);
        if draw.chance(0.2) {
            own.desired_speed_mps
                .push([draw.between(5.0, 20.0), -0.3 * most_mps]);
        }
        if draw.chance(0.3) {
            let from_s = draw.between(1.0, 10.0);
            let to_s = from_s + draw.between(5.0, 30.0);
            own.tracker = Tracker::Off { from_s, to_s };
        }
        own
    });
    robots.collect()
}

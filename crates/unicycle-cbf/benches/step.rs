//! One whole step of the controller, from a pose to wheel speeds, and the distribution of its time.
#![allow(clippy::print_stderr)]

use std::hint::black_box;
use std::time::Instant;

use divan::Bencher;
use unicycle_cbf::{
    Controller, Leader, Pilot, Pose, Preset, Scenario, Speeds, StampedPose, State, Testbed,
    pilot::{Ahead, Sighting},
};

fn main() {
    distribution();
    divan::main();
}

/// The hardened controller of the Khepera, which has more rows than any other.
fn controller(preset: Preset) -> Controller {
    let spec = Testbed::Khepera.scenario("on-off", preset).ok();
    let scenario = spec.and_then(|spec| Scenario::new(spec).ok());
    scenario.map_or_else(
        || unreachable!("built in"),
        |scenario| scenario.controller().clone(),
    )
}

/// States along a lap, inside the lane and at its edge, fast and slow.
fn states() -> Vec<(State, Leader)> {
    (0..1000)
        .map(|i| {
            let (i, angle) = (f64::from(i), 0.0063 * f64::from(i));
            let place = |angle: f64, radius_m: f64, speed_mps: f64| State {
                x_m: radius_m * angle.cos(),
                y_m: radius_m * angle.sin(),
                speed_mps,
                heading_rad: angle + 1.571 + 0.4 * (1.7 * i).sin(),
                turn_rate_rad_s: 0.5 * (0.3 * i).sin(),
            };
            let radius_m = 0.9 + 0.23 * (3.0 * angle).sin() + 0.12 * (0.9 * i).sin();
            let own = place(angle, radius_m, 0.1 + 0.1 * (0.5 * i).sin());
            let ahead = place(angle + 0.35, 0.9 + 0.23 * (3.0 * angle + 1.05).sin(), 0.1);
            (own, Leader::known(ahead))
        })
        .collect()
}

#[divan::bench(args = [Preset::Thesis, Preset::Hardened])]
fn decide(bencher: Bencher, preset: Preset) {
    let controller = controller(preset);
    let objectives = controller.objectives(0.2);
    let states = states();
    let mut next = (0..states.len()).cycle();
    bencher.bench_local(|| {
        let (own, leader) = &states[next.next().unwrap_or(0)];
        controller.decide(black_box(own), Some(leader), &objectives, 0.05)
    });
}

/// With the predictor through 0.1 s of commands.
#[divan::bench]
fn pose_to_wheel_speeds(bencher: Bencher) {
    let controller = controller(Preset::Hardened);
    let objectives = controller.objectives(0.2);
    let mut pilot = Pilot::new(0.0, Speeds::ZERO);
    let mut step = 0u32;
    bencher.bench_local(|| {
        step += 1;
        one_step(&controller, &objectives, &mut pilot, step)
    });
}

fn one_step(
    controller: &Controller,
    objectives: &unicycle_cbf::Objectives,
    pilot: &mut Pilot,
    step: u32,
) -> unicycle_cbf::WheelSpeeds {
    let now_s = f64::from(step) * controller.hold_s();
    let (stamp_s, angle) = (now_s - 0.1, 0.002 * f64::from(step % 3000));
    let radius_m = 0.9 + 0.23 * (3.0 * angle).sin();
    let pose = Pose {
        x_m: radius_m * angle.cos(),
        y_m: radius_m * angle.sin(),
        heading_rad: angle + 1.5,
    };
    let ahead = pose.advanced(
        Speeds {
            speed_mps: 1.0,
            turn_rate_rad_s: 0.0,
        },
        0.4,
    );
    let state = ahead.state(
        0.05,
        Speeds {
            speed_mps: 0.1,
            turn_rate_rad_s: 0.1,
        },
    );
    pilot.observe(controller, StampedPose { stamp_s, pose });
    let sighting = Sighting {
        leader: Leader::known(state),
        age_s: 0.1,
    };
    let decision = pilot.decide(controller, now_s, Ahead::Seen(sighting), objectives);
    pilot.sent(now_s, decision.speeds);
    decision.wheels
}

/// Median and tail of single steps, each timed on its own.
fn distribution() {
    if std::env::args().any(|arg| arg == "--test" || arg == "--list") {
        return;
    }
    let controller = controller(Preset::Hardened);
    let objectives = controller.objectives(0.2);
    let mut pilot = Pilot::new(0.0, Speeds::ZERO);
    let mut nanoseconds: Vec<u128> = (1..200_000)
        .map(|step| {
            let start = Instant::now();
            black_box(one_step(
                &controller,
                &objectives,
                &mut pilot,
                black_box(step),
            ));
            start.elapsed().as_nanos()
        })
        .collect();
    nanoseconds.sort_unstable();
    let at =
        |share: f64| nanoseconds[(share * (nanoseconds.len() - 1) as f64) as usize] as f64 / 1e3;
    eprintln!(
        "pose to wheel speeds, single steps: median {:.2} µs, p99 {:.2} µs, p99.9 {:.2} µs, max {:.1} µs",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}

//! Scenarios of the kinds that users write.

use std::f64::consts::{PI, TAU};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use testbed_sim::Disturbances;
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{
    Body, Centripetal, ControllerSettings, PathSpec, Preset, RobotSpec, ScenarioSpec, Testbed,
    Tracker,
    lateral::Deviation,
    settings::{Distance, Hardening, HeadwaySettings, LaneSettings},
};

/// A scenario, and the disturbances that it states.
pub(super) struct Drawn {
    pub(super) spec: ScenarioSpec,
    pub(super) disturbances: Disturbances,
    /// Lane of ±80 mm at least, the slowest robot in front, and robots that turn by half a radian a second
    pub(super) is_easy: bool,
}

pub(super) struct Draw(ChaCha8Rng);

impl Draw {
    pub(super) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(super) fn whole(&mut self, least: usize, most: usize) -> usize {
        self.0.random_range(least..=most)
    }

    pub(super) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.0.random::<f64>()
    }

    pub(super) fn chance(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }

    pub(super) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.random_range(0..choices.len())]
    }
}

pub(super) fn drawn(seed: u64) -> Drawn {
    let mut draw = Draw::new(seed);
    let body = body(&mut draw);
    let robots = draw.whole(1, 6);
    let headway_s = draw.between(0.3, 2.0);
    let standstill_m = draw.between(0.0, 0.2);
    let radius_m = body.radius_m();
    let least_m = (2.0 * radius_m + 0.01).max(standstill_m);
    let gap_m = least_m + draw.between(0.05, 0.4);
    let round_m = 1.6 * gap_m * robots as f64;
    let path = path(&mut draw, radius_m, round_m);
    let half_width_m = draw.between(10.0_f64.ln(), 300.0_f64.ln()).exp() * 1e-3;
    let own = hardening(&mut draw);
    let settings = ControllerSettings {
        convergence_1ps: [1.0; 3],
        weights: [1.0, 1.0, 1e5, 1.0, 1e3],
        literal: Vec::new(),
        headway: HeadwaySettings {
            time_s: headway_s,
            standstill_m,
            clearance_m: 0.01,
            distance: if draw.chance(0.3) {
                Distance::Path
            } else {
                Distance::Chord
            },
            rate_1ps: draw.between(0.5, 2.0),
            margin_m: 2e-3,
        },
        lane: LaneSettings {
            half_width_m,
            barrier: LaneBarrier::EXPONENTIAL,
            deviation: if draw.chance(0.5) {
                Deviation::Frenet
            } else {
                Deviation::Radial
            },
            rate_1ps: 4.0,
            margin_m: 0.1 * half_width_m,
        },
        hardening: own,
    };
    let (front_slowest, fleet) = fleet(&mut draw, robots, body.max_wheel_speed_mps);
    let spec = ScenarioSpec {
        name: format!("random {seed}"),
        testbed: "own".to_owned(),
        rate_hz: draw.one_of(&[5.0, 10.0, 20.0, 30.0, 50.0, 100.0, 200.0]),
        duration_s: 30.0,
        controller: Preset::Hardened.applied_to(&settings, &body),
        path: path.0,
        body,
        robots: placed(&mut draw, fleet, [least_m, gap_m], half_width_m, path.1),
    };
    let hardening = &spec.controller.hardening;
    let disturbances = Disturbances {
        position_noise_m: hardening.position_noise_m,
        heading_noise_rad: hardening.heading_noise_rad,
        wheel_error: hardening.wheel_error,
        ..Disturbances::HARD
    };
    Drawn {
        is_easy: half_width_m >= 0.08 && front_slowest && spec.body.max_turn_rate_rad_s >= 0.5,
        spec,
        disturbances,
    }
}

fn body(draw: &mut Draw) -> Body {
    match draw.0.random_range(0..3_u8) {
        0 => Testbed::Khepera.body(),
        1 => Testbed::Robotarium.body(),
        _ => {
            let wheel_base_m = draw.between(0.08, 0.3);
            let mass_kg = draw.between(0.1, 4.0);
            Body {
                offset_m: wheel_base_m * draw.between(0.25, 0.6),
                mass_kg,
                inertia_kgm2: mass_kg * wheel_base_m.powi(2) * draw.between(0.1, 0.4),
                centripetal: draw.one_of(&[Centripetal::Printed, Centripetal::Newton]),
                wheel_base_m,
                radius_m: draw.chance(0.5).then_some(0.5 * wheel_base_m + 0.02),
                max_wheel_speed_mps: draw.between(0.15, 0.8),
                max_turn_rate_rad_s: draw.between(0.2_f64.ln(), 5.0_f64.ln()).exp(),
                max_wheel_acceleration_mps2: draw.chance(0.3).then_some(3.0),
            }
        }
    }
}

fn hardening(draw: &mut Draw) -> Hardening {
    let usual = draw.chance(0.5);
    Hardening {
        position_noise_m: if usual {
            3e-3
        } else {
            draw.between(1e-3, 6e-3)
        },
        heading_noise_rad: if usual {
            PI / 360.0
        } else {
            draw.between(1e-3, 0.02)
        },
        wheel_error: if usual { 0.1 } else { draw.between(0.02, 0.15) },
        ..Hardening::NONE
    }
}

/// A path on which the robots have room, and its length in m where it has one.
fn path(draw: &mut Draw, radius_m: f64, round_m: f64) -> (PathSpec, Option<f64>) {
    let least_m = (0.5 * round_m / PI).max(5.0 * radius_m);
    let mean_m = least_m * draw.between(1.2, 3.0);
    match draw.0.random_range(0..5_u8) {
        0 => {
            let straight = PathSpec::Straight {
                x_m: draw.between(-1.0, 1.0),
                y_m: draw.between(-1.0, 1.0),
                heading_rad: draw.between(-PI, PI),
            };
            (straight, None)
        }
        1 => {
            let periods = draw.0.random_range(0..=4_u32);
            let polar = PathSpec::Polar {
                radius_m: mean_m,
                amplitude_m: mean_m * draw.between(0.0, 0.3) / f64::from(periods.max(1)),
                periods,
            };
            (polar, Some(TAU * mean_m))
        }
        2 | 3 => {
            let count = draw.whole(6, 14);
            let point = |corner: usize| {
                let angle = TAU * corner as f64 / count as f64;
                let r = mean_m * draw.between(0.75, 1.25);
                [r * angle.cos(), r * angle.sin()]
            };
            let points_m = (0..count).map(point).collect();
            (PathSpec::Closed { points_m }, Some(TAU * mean_m))
        }
        _ => {
            let (x_m, y_m) = (1.6 * mean_m, mean_m * draw.between(0.5, 0.9));
            let point = |at: usize| {
                let t = TAU * at as f64 / 48.0;
                [x_m * t.sin(), y_m * (2.0 * t).sin()]
            };
            let points_m = (0..48).map(point).collect();
            (PathSpec::Closed { points_m }, Some(9.0 * mean_m))
        }
    }
}

/// Whether the slowest is in front, and robots without places.
fn fleet(draw: &mut Draw, robots: usize, most_mps: f64) -> (bool, Vec<RobotSpec>) {
    let front_slowest = draw.chance(0.5);
    let front_mps = most_mps * draw.between(0.2, 0.5);
    let fleet = (0..robots).map(|robot| {
        let speed_mps = if front_slowest && robot > 0 {
            front_mps * draw.between(1.0, 1.7)
        } else if robot > 0 {
            most_mps * draw.between(0.1, 0.9)
        } else {
            front_mps
        };
        let mut spec = RobotSpec::steady(0.0, speed_mps);
        if !front_slowest && draw.chance(if robot == 0 { 0.5 } else { 0.2 }) {
            let slower = draw.one_of(&[0.0, 0.3, -0.5, -1.0]);
            spec.desired_speed_mps
                .push([draw.between(5.0, 12.0), slower * speed_mps]);
            spec.desired_speed_mps
                .push([draw.between(15.0, 22.0), speed_mps]);
        }
        if draw.chance(0.2) {
            let from_s = draw.between(3.0, 15.0);
            spec.stops_s = vec![[from_s, from_s + draw.between(1.0, 8.0)]];
        }
        spec.tracker = match draw.0.random_range(0..4_u8) {
            0 => Tracker::Off {
                from_s: draw.between(3.0, 10.0),
                to_s: draw.between(12.0, 30.0),
            },
            1 => Tracker::Decay {
                from_s: draw.between(3.0, 10.0),
                rate_1ps: 0.0,
                weight: 1e-6,
            },
            _ => Tracker::On,
        };
        spec
    });
    let fleet: Vec<RobotSpec> = fleet.collect();
    (front_slowest, fleet)
}

/// From the back, at least a gap apart, or hardly more than bodies need; on loops often all around.
fn placed(
    draw: &mut Draw,
    mut fleet: Vec<RobotSpec>,
    [least_m, gap_m]: [f64; 2],
    half_width_m: f64,
    length_m: Option<f64>,
) -> Vec<RobotSpec> {
    let (around, crowded) = (draw.chance(0.3), draw.chance(0.2));
    let count = fleet.len() as f64;
    let mut at_m = 0.0;
    for robot in fleet.iter_mut().rev() {
        robot.start = length_m.map_or(at_m, |length_m| at_m / length_m);
        robot.start_deviation_m = if draw.chance(0.2) {
            half_width_m * draw.between(-0.4, 0.4)
        } else {
            0.0
        };
        at_m += match length_m {
            Some(length_m) if around => length_m / count,
            _ if crowded => least_m + draw.between(0.02, 0.05),
            _ => gap_m * draw.between(1.1, 1.5),
        };
    }
    fleet
}

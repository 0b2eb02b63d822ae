//! Plans for random roads: none may fail, and every gap is reported.
//!
//! `cargo run --release --example random_roads -- [ROADS] [SEED]`

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::time::Instant;

use ev_energy::{StepModel, Vehicle, library};
use speed_plan::{Answer, Demand, Envelope, Problem, Road, Settings, plan};

/// xorshift64*
struct Random(u64);

impl Random {
    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        from + (to - from) * bits as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.uniform(0.0, count as f64) as usize).min(count - 1)
    }
}

fn road(random: &mut Random) -> Road {
    let length_m = 1000.0 * 50.0_f64.powf(random.uniform(0.0, 1.0));
    let speeds = [30.0, 50.0, 70.0, 80.0, 100.0, 120.0, 130.0];
    let mut limits = vec![(0.0, speeds[random.below(7)] / 3.6)];
    let mut at = 0.0;
    loop {
        at += random.uniform(200.0, 4000.0);
        if at >= length_m - 1.0 {
            break;
        }
        limits.push((at, speeds[random.below(7)] / 3.6));
    }
    let stops = (0..random.below(21).min((length_m / 300.0) as usize))
        .map(|_| {
            (
                random.uniform(50.0, length_m - 50.0),
                random.uniform(0.0, 30.0),
            )
        })
        .collect();
    let steepest = random.uniform(0.0, 0.1);
    let mut elevation = vec![(0.0, 300.0)];
    let (mut at, mut height) = (0.0, 300.0);
    while at < length_m {
        let length = random.uniform(50.0, 1500.0);
        height += length * random.uniform(-steepest, steepest);
        at += length;
        elevation.push((at, height));
    }
    let mut signals: Vec<(f64, Vec<[f64; 2]>)> = Vec::new();
    for _ in 0..random.below(5) {
        let at = random.uniform(100.0, length_m - 60.0);
        if signals.iter().any(|signal| (signal.0 - at).abs() < 50.0) {
            continue;
        }
        let cycle = random.uniform(40.0, 120.0);
        let green = cycle * random.uniform(0.2, 0.7);
        let offset = random.uniform(0.0, cycle);
        signals.push((
            at,
            (-1..200)
                .map(|k| f64::from(k) * cycle + offset)
                .map(|from| [from, from + green])
                .collect(),
        ));
    }
    Road {
        length_m,
        limits,
        stops,
        elevation,
        signals,
        ..Road::default()
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(20, |n| n.parse().unwrap());
    let seed: u64 = arguments.next().map_or(1, |n| n.parse().unwrap());
    let cars: Vec<Vehicle> = library::names()
        .map(|name| Vehicle::builtin(name).unwrap())
        .collect();
    let (mut gaps, mut times) = (Vec::new(), Vec::new());
    let mut outcomes: BTreeMap<String, usize> = BTreeMap::new();
    let only: Option<usize> = arguments.next().map(|n| n.parse().unwrap());
    for k in 0..count {
        if only.is_some_and(|only| only != k) {
            continue;
        }
        let mut random = Random(
            seed.wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .wrapping_add(k as u64 * 7919)
                | 1,
        );
        (0..8).for_each(|_| {
            random.uniform(0.0, 1.0);
        });
        let road = road(&mut random);
        let car = &cars[random.below(cars.len())];
        let slack = random.uniform(1.02, 1.6);
        let mut columns = match road.columns() {
            Ok(columns) => columns,
            Err(error) => {
                println!("road {k}: {error}");
                continue;
            }
        };
        // A stop that falls on a light is none.
        columns
            .signals
            .retain(|signal| columns.max_mps[signal.node] > 0.0);
        let problem = match Problem::new(StepModel::new(car), Envelope::default(), columns) {
            Ok(problem) => problem,
            Err(error) => {
                println!("road {k}: {error}");
                continue;
            }
        };
        let settings = Settings {
            budget_s: Some(2.0),
            ..Settings::default()
        };
        let latest_s = match plan(&problem, Demand::Arrival(0.0), &settings).unwrap() {
            Answer::Obstacle(speed_plan::Obstacle::TooLate { earliest_arrival_s }) => {
                slack * earliest_arrival_s
            }
            other => {
                println!("road {k}: {other:?}");
                continue;
            }
        };
        let started = Instant::now();
        let answer = plan(&problem, Demand::Arrival(latest_s), &settings).unwrap();
        let ms = 1e3 * started.elapsed().as_secs_f64();
        let name = match &answer {
            Answer::Plan(plan) => {
                if plan.gap_pct > 1.0
                    || !plan.gap_pct.is_finite()
                    || ms > 500.0
                    || plan.gap_pct < -1e-6
                {
                    println!(
                        "road {k}: {} nodes {} signals gap {:.4} % {ms:.1} ms solved {} {:?} {}",
                        problem.nodes(),
                        problem.columns().signals.len(),
                        plan.gap_pct,
                        plan.solved,
                        plan.arrival,
                        car.spec().name
                    );
                }
                gaps.push(plan.gap_pct);
                times.push(ms / problem.nodes() as f64);
                format!("{:?}", plan.arrival)
            }
            Answer::Obstacle(obstacle) => {
                // The fastest through the lights, nearly: it must be later than what was allowed.
                let hurry = plan(&problem, Demand::Price(1e5), &settings).unwrap();
                let hurry_s = hurry.plan().map_or(f64::INFINITY, |plan| plan.run.time_s);
                let verdict = if hurry_s <= latest_s {
                    "WRONG"
                } else {
                    "right"
                };
                println!(
                    "road {k}: {obstacle:?}, {verdict}: in a hurry {hurry_s:.1} s, allowed {latest_s:.1} s, {ms:.1} ms"
                );
                format!("{obstacle:?}")
                    .split(' ')
                    .next()
                    .unwrap_or("")
                    .to_owned()
            }
        };
        *outcomes.entry(name).or_default() += 1;
    }
    println!("{outcomes:?}");
    for (name, values) in [("gap_pct", &mut gaps), ("ms per node", &mut times)] {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            values
                .get(((values.len() as f64 - 1.0) * share) as usize)
                .copied()
                .unwrap_or(f64::NAN)
        };
        println!(
            "{name}: median {:.6} 90 % {:.6} 99 % {:.6} 99.9 % {:.6} most {:.6}",
            at(0.5),
            at(0.9),
            at(0.99),
            at(0.999),
            at(1.0)
        );
    }
}

//! Scenarios of users' kind: each is refused with a reason, or safe under all that it states.

mod generator;

use std::collections::BTreeMap;

use rayon::prelude::*;
use testbed_io::{Simulation, Verdict};
use unicycle_cbf::{Error, Scenario};

use generator::drawn;

#[derive(Debug, Clone, PartialEq)]
enum Outcome {
    Refused(String),
    Safe { slowed: bool },
    Unsafe(String),
}

fn outcome(seed: u64) -> Outcome {
    let drawn = drawn(seed);
    let scenario = match Scenario::new(drawn.spec) {
        Ok(scenario) => scenario,
        Err(error) if drawn.is_easy && !matches!(error, Error::Start { .. }) => {
            return Outcome::Unsafe(format!("refused: {error}"));
        }
        Err(error) => return Outcome::Refused(error.to_string()),
    };
    let simulation = Simulation {
        scenario: &scenario,
        disturbances: drawn.disturbances,
        seed,
    };
    let summary = simulation.run(|_| {}).unwrap();
    let limits = scenario.controller().limits();
    if summary.verdict == Verdict::Safe {
        let slowed = limits.wheel_speed_mps < scenario.spec().body.max_wheel_speed_mps;
        return Outcome::Safe { slowed };
    }
    let gap_mm = summary
        .least_distance
        .map(|least| (least.robots, (1e3 * least.gap_m).round()));
    let spec = scenario.spec();
    Outcome::Unsafe(format!(
        "{} Hz, {} robots, {}, lane ±{:.0} mm: clearance {:.1} mm, headway {:.1?} mm, gap {gap_mm:?} mm, first at {:.2?} s, {:?}",
        spec.rate_hz,
        spec.robots.len(),
        kind(&spec.path),
        1e3 * spec.controller.lane.half_width_m,
        1e3 * summary.lane_clearance_m,
        summary.min_h_headway_m.map(|h| 1e3 * h),
        summary.first_unsafe_s,
        summary.outcomes,
    ))
}

fn kind(path: &unicycle_cbf::PathSpec) -> &'static str {
    match path {
        unicycle_cbf::PathSpec::Straight { .. } => "straight",
        unicycle_cbf::PathSpec::Polar { .. } => "polar",
        unicycle_cbf::PathSpec::Closed { points_m } if points_m.len() == 48 => "eight",
        unicycle_cbf::PathSpec::Closed { .. } => "loop",
    }
}

/// `DRIVEKIT_RANDOM_SCENARIOS` sets how many and `DRIVEKIT_RANDOM_SEED` the first seed.
#[test]
fn random_scenarios_are_refused_with_a_reason_or_safe() {
    let number =
        |name: &str, usual: u64| std::env::var(name).map_or(usual, |text| text.parse().unwrap());
    let count = number("DRIVEKIT_RANDOM_SCENARIOS", 300);
    let first = number("DRIVEKIT_RANDOM_SEED", 1);
    let outcomes: Vec<(u64, Outcome)> = (first..first + count)
        .into_par_iter()
        .map(|seed| (seed, outcome(seed)))
        .collect();
    let mut refused = BTreeMap::<String, usize>::new();
    let (mut slowed, mut driven, mut bad) = (0, 0, Vec::new());
    for (seed, outcome) in outcomes {
        match outcome {
            Outcome::Refused(why) => {
                *refused
                    .entry(
                        why.chars()
                            .filter(|c| !c.is_ascii_digit())
                            .take(60)
                            .collect(),
                    )
                    .or_default() += 1
            }
            Outcome::Safe { slowed: true } => slowed += 1,
            Outcome::Safe { slowed: false } => driven += 1,
            Outcome::Unsafe(why) => bad.push(format!("seed {seed}: {why}")),
        }
    }
    println!(
        "seeds {first} to {}: {} refused, {slowed} slowed, {driven} driven, {} unsafe",
        first + count - 1,
        refused.values().sum::<usize>(),
        bad.len()
    );
    println!("{refused:#?}");
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

#[test]
#[ignore]
fn debug_seed() {
    let seed: u64 = std::env::var("SEED").unwrap().parse().unwrap();
    let from: f64 = std::env::var("FROM").unwrap().parse().unwrap();
    let to: f64 = std::env::var("TO").unwrap().parse().unwrap();
    let every: usize = std::env::var("EVERY").unwrap().parse().unwrap();
    let drawn = drawn(seed);
    println!(
        "{:?}\n{:?}\n{:?}",
        drawn.spec.robots, drawn.spec.controller, drawn.spec.body
    );
    let scenario = Scenario::new(drawn.spec).unwrap();
    println!("{:?}", scenario.controller().limits());
    let simulation = Simulation {
        scenario: &scenario,
        disturbances: drawn.disturbances,
        seed,
    };
    let _ = simulation.run(|t| {
        if t.time_s >= from && t.time_s <= to && t.tick % every == 0 {
            let d = &t.decision;
            let tr = t.truth.unwrap();
            let act: Vec<&str> = d
                .terms
                .iter()
                .flat_map(|x| {
                    x.rows
                        .kinds()
                        .iter()
                        .enumerate()
                        .filter(|(i, _)| x.solution.active & (1 << i) != 0)
                        .map(|(_, k)| k.name())
                        .collect::<Vec<_>>()
                })
                .collect();
            println!(
                "{:.2} r{} v {:.3} w {:.2} true v {:.3} y {:.4} h {:.4?} hbel {:.4?} {} {act:?}",
                t.time_s,
                t.robot,
                d.speeds.speed_mps,
                d.speeds.turn_rate_rad_s,
                tr.state.speed_mps,
                tr.safety.deviation_m,
                tr.safety.headway_m,
                d.terms.as_ref().and_then(|x| x.headway.map(|h| h.value)),
                d.outcome.name()
            );
        }
    });
}

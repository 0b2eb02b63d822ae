//! Scenarios of users' kind: each is refused with a reason, or safe under all that it states.

mod generator;
mod quick;
mod wide;

use std::collections::BTreeMap;

use rayon::prelude::*;
use testbed_sim::{Simulation, Verdict};
use unicycle_cbf::{Demands, Error, PathSpec, Scenario};

use generator::Drawn;

#[derive(Debug, Clone, PartialEq)]
enum Outcome {
    Refused(String),
    Safe { slowed: bool },
    Unsafe(String),
}

fn outcome(drawn: Drawn, seed: u64) -> Outcome {
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
    if summary.verdict == Verdict::Safe {
        let slowed = Demands::new(&scenario).is_slowed();
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

fn kind(path: &PathSpec) -> &'static str {
    match path {
        PathSpec::Straight { .. } => "straight",
        PathSpec::Polar { .. } => "polar",
        PathSpec::Closed { points_m } if points_m.len() == 48 => "eight",
        PathSpec::Closed { .. } => "loop",
    }
}

/// `DRIVEKIT_RANDOM_SCENARIOS` sets how many and `DRIVEKIT_RANDOM_SEED` the first seed.
fn are_refused_or_safe(drawn: impl Fn(u64) -> Drawn + Sync, usual: u64) {
    let number =
        |name: &str, usual: u64| std::env::var(name).map_or(usual, |text| text.parse().unwrap());
    let count = number("DRIVEKIT_RANDOM_SCENARIOS", usual);
    let first = number("DRIVEKIT_RANDOM_SEED", 1);
    let outcomes: Vec<(u64, Outcome)> = (first..first + count)
        .into_par_iter()
        .map(|seed| (seed, outcome(drawn(seed), seed)))
        .collect();
    let mut refused = BTreeMap::<String, usize>::new();
    let (mut slowed, mut driven, mut bad) = (0, 0, Vec::new());
    for (seed, outcome) in outcomes {
        match outcome {
            Outcome::Refused(why) => *refused.entry(reason(&why)).or_default() += 1,
            Outcome::Safe { slowed: true } => slowed += 1,
            Outcome::Safe { slowed: false } => driven += 1,
            Outcome::Unsafe(why) => bad.push(format!("seed {seed}: {why}")),
        }
    }
    println!(
        "seeds {first} to {}: {slowed} slowed, {driven} driven as asked, {} unsafe, refused: {refused:#?}",
        first + count - 1,
        bad.len()
    );
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

#[test]
fn random_scenarios_are_refused_with_a_reason_or_safe() {
    are_refused_or_safe(generator::drawn, 2000);
}

#[test]
fn crossings_and_overtaking_in_wide_lanes_are_refused_with_a_reason_or_safe() {
    are_refused_or_safe(wide::drawn, 300);
}

#[test]
fn small_robots_with_fast_wheels_and_few_commands_are_refused_with_a_reason_or_safe() {
    are_refused_or_safe(quick::drawn, 1000);
}

/// Its first words, without numbers.
fn reason(why: &str) -> String {
    let letters = why.chars().filter(|c| !c.is_ascii_digit());
    letters.take(60).collect()
}

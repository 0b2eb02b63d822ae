//! Differential evolution as an independent referee of fits, and stretches that make them hard.

use std::collections::BTreeMap;

use drive_log::{Channel, DriveLog};
use driver_model::following::{
    ConstantTimeGap, FollowingModel, FollowingObjective, FollowingSettings, FollowingStretch, Idm,
    following_stretches,
};
use driver_model::{ModelKind, Motion};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// How long the referee looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    pub(crate) population: usize,
    pub(crate) generations: usize,
}

/// Place of a value: its logarithm, but for gaps that may be negative.
fn place(value: f64, low: f64) -> f64 {
    if low > 0.0 { value.ln() } else { value }
}

/// The least objective that differential evolution finds (R. Storn, K. Price, Journal of Global Optimization 11, 1997; the
/// variants rand/1/bin and current-to-best/1/bin in turn), over the logarithms of parameters.
pub(crate) fn least(
    kind: ModelKind,
    objective: &FollowingObjective<'_>,
    effort: Effort,
    seed: u64,
) -> f64 {
    let ranges = ranges(kind);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let value = |(x, (low, _)): (&f64, &(f64, f64))| if *low > 0.0 { x.exp() } else { *x };
    let cost = |places: &[f64]| {
        let values: Vec<f64> = places.iter().zip(&ranges).map(value).collect();
        objective.mean_square(&model_of(kind, &values))
    };
    let mut places: Vec<Vec<f64>> = (0..effort.population)
        .map(|_| {
            let of = |(low, high): &(f64, f64)| {
                let (low, high) = (place(*low, *low), place(*high, *low));
                low + (high - low) * random.random::<f64>()
            };
            ranges.iter().map(of).collect()
        })
        .collect();
    let mut costs: Vec<f64> = places.iter().map(|place| cost(place)).collect();
    for generation in 0..effort.generations {
        for i in 0..places.len() {
            let best = (0..costs.len())
                .min_by(|a, b| costs[*a].total_cmp(&costs[*b]))
                .unwrap();
            let [a, b, c] = std::array::from_fn(|_| random.random_range(0..places.len()));
            let to_best = generation % 2 == 1;
            let factor = 0.4 + 0.5 * random.random::<f64>();
            let always = random.random_range(0..ranges.len());
            let mut trial = places[i].clone();
            for (k, (low, high)) in ranges.iter().enumerate() {
                if k != always && random.random::<f64>() > 0.9 {
                    continue;
                }
                let difference = places[b][k] - places[c][k];
                let moved = if to_best {
                    places[i][k] + factor * (places[best][k] - places[i][k] + difference)
                } else {
                    places[a][k] + factor * difference
                };
                trial[k] = moved.clamp(place(*low, *low), place(*high, *low));
            }
            let trial_cost = cost(&trial);
            if trial_cost <= costs[i] {
                (places[i], costs[i]) = (trial, trial_cost);
            }
        }
    }
    costs.into_iter().fold(f64::INFINITY, f64::min)
}

/// Bounds of the parameters.
fn ranges(kind: ModelKind) -> Vec<(f64, f64)> {
    match kind {
        ModelKind::Idm => vec![(0.3, 5.0), (0.3, 5.0), (0.1, 5.0), (0.5, 8.0), (5.0, 70.0)],
        _ => vec![(0.1, 5.0), (-20.0, 20.0), (0.0001, 5.0)],
    }
}

pub(crate) fn model_of(kind: ModelKind, values: &[f64]) -> FollowingModel {
    match (kind, values) {
        (
            ModelKind::Idm,
            &[
                max_accel_mps2,
                decel_mps2,
                headway_s,
                standstill_m,
                desired_speed_mps,
            ],
        ) => FollowingModel::Idm {
            idm: Idm {
                max_accel_mps2,
                comfortable_decel_mps2: decel_mps2,
                time_headway_s: headway_s,
                standstill_gap_m: standstill_m,
            },
            desired_speed_mps,
        },
        (_, &[time_gap_s, standstill_gap_m, gap_gain_per_s]) => {
            FollowingModel::ConstantTimeGap(ConstantTimeGap {
                time_gap_s,
                standstill_gap_m,
                gap_gain_per_s,
            })
        }
        _ => panic!("{kind:?} has other parameters"),
    }
}

const STEP_S: f64 = 0.1;

/// Stretches that make a fit hard: leaders who stop and go, drivers who differ and are no model, noise, short stretches among
/// long ones. Odd ones are the hardest: leaders who brake harder than any law, drivers who are too near and too fast from the start
/// and react up to 1.5 s late.
pub(crate) fn hard_stretches(seed: u64) -> Vec<FollowingStretch> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut between = move |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let is_hardest = seed % 2 == 1;
    let mut found = Vec::new();
    for number in 0..3 + seed % 5 {
        let is_long = number % 2 == 0 && !(is_hardest && number > 0);
        let duration_s = if is_long {
            between(60.0, 200.0)
        } else {
            between(6.0, 15.0)
        };
        let lead_mps = leader(&mut between, (duration_s / STEP_S) as usize, is_hardest);
        let noise_m = 0.4 * (seed % 3) as f64;
        let rows = driver(&mut between, &lead_mps, noise_m, is_hardest);
        let channels = BTreeMap::from([
            (Channel::Speed, rows.iter().map(|row| row[0]).collect()),
            (Channel::LeadGap, rows.iter().map(|row| row[1]).collect()),
            (Channel::LeadSpeed, lead_mps),
        ]);
        let log = DriveLog::new(format!("driver-{number}"), 0.0, STEP_S, channels).unwrap();
        let motion = Motion::of_log(&log, 100.0).unwrap();
        let settings = FollowingSettings {
            min_duration_s: 3.0,
        };
        found.extend(following_stretches(&motion, &settings));
    }
    found
}

fn leader(between: &mut impl FnMut(f64, f64) -> f64, samples: usize, slams: bool) -> Vec<f64> {
    let mut speed_mps = between(0.0, 20.0);
    let (mut aim_mps, mut accel_mps2, mut until) = (speed_mps, 1.0, 0);
    let (hardest_mps2, longest) = if slams { (12.0, 80.0) } else { (8.0, 150.0) };
    (0..samples)
        .map(|k| {
            if k >= until {
                let stops = between(0.0, 1.0) < 0.4;
                aim_mps = if stops { 0.0 } else { between(2.0, 25.0) };
                let brakes = aim_mps < speed_mps;
                accel_mps2 = if brakes {
                    between(1.0, hardest_mps2)
                } else {
                    between(0.5, 3.0)
                };
                until = k + between(30.0, longest) as usize;
            }
            let step_mps = accel_mps2 * STEP_S;
            speed_mps += (aim_mps - speed_mps).clamp(-step_mps, step_mps);
            speed_mps
        })
        .collect()
}

/// Speed and gap, with noise, of a driver between two models who reacts late.
fn driver(
    between: &mut impl FnMut(f64, f64) -> f64,
    lead_mps: &[f64],
    noise_m: f64,
    is_hardest: bool,
) -> Vec<[f64; 2]> {
    let mut around = |low: f64, high: f64| low * (high / low).powf(between(0.0, 1.0));
    let idm = [
        around(0.4, 5.0),
        around(0.4, 5.0),
        around(0.2, 3.0),
        around(0.5, 7.0),
        around(9.0, 50.0),
    ];
    let law = [around(0.2, 3.0), around(0.5, 7.0), around(0.02, 1.0)];
    let models = [
        model_of(ModelKind::Idm, &idm),
        model_of(ModelKind::ConstantTimeGap, &law),
    ];
    let share = between(0.0, 1.0);
    let late = between(0.0, if is_hardest { 15.0 } else { 8.0 }) as usize;
    let (mut speed_mps, mut gap_m) = if is_hardest {
        (
            lead_mps[0] + between(0.0, 8.0),
            between(0.5, 3.0) + lead_mps[0] * between(0.05, 0.6),
        )
    } else {
        (
            lead_mps[0],
            between(1.0, 6.0) + lead_mps[0] * between(0.4, 2.0),
        )
    };
    let mut accels_mps2 = Vec::with_capacity(lead_mps.len());
    let mut rows = Vec::with_capacity(lead_mps.len());
    for (k, &lead) in lead_mps.iter().enumerate() {
        rows.push([
            (speed_mps + 0.2 * between(-noise_m, noise_m)).max(0.0),
            (gap_m + between(-noise_m, noise_m)).max(0.3),
        ]);
        let [a, b] = models.map(|model| model.accel_mps2(speed_mps, gap_m, lead));
        accels_mps2.push(share * a + (1.0 - share) * b);
        let next_mps = (speed_mps + accels_mps2[k.saturating_sub(late)] * STEP_S).max(0.0);
        gap_m = (gap_m + STEP_S * (lead - 0.5 * (speed_mps + next_mps))).max(0.3);
        speed_mps = next_mps;
    }
    rows
}

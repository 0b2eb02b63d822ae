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
    let model = |place: &[f64]| model_of(kind, &place.iter().map(|x| x.exp()).collect::<Vec<_>>());
    let cost = |place: &[f64]| objective.mean_square(&model(place));
    let mut places: Vec<Vec<f64>> = (0..effort.population)
        .map(|_| {
            let of =
                |(low, high): &(f64, f64)| low.ln() + (high / low).ln() * random.random::<f64>();
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
                trial[k] = moved.clamp(low.ln(), high.ln());
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
        _ => vec![(0.1, 5.0), (0.01, 30.0), (0.0001, 5.0)],
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

/// Stretches that make a fit hard: leaders who stop and go and brake at up to 8 m/s², drivers who differ, react late and
/// are no model, gaps close to a collision, noise, short stretches among long ones.
pub(crate) fn hard_stretches(seed: u64) -> Vec<FollowingStretch> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut between = move |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let mut found = Vec::new();
    let stretches = 3 + (seed % 4) as usize;
    for number in 0..stretches {
        let duration_s = if number % 2 == 0 {
            between(60.0, 200.0)
        } else {
            between(6.0, 15.0)
        };
        let lead_mps = leader(&mut between, (duration_s / STEP_S) as usize);
        let rows = driver(&mut between, &lead_mps, seed % 3);
        let channels = BTreeMap::from([
            (Channel::Speed, rows.iter().map(|row| row[0]).collect()),
            (Channel::LeadGap, rows.iter().map(|row| row[1]).collect()),
            (Channel::LeadSpeed, lead_mps),
        ]);
        let name = format!("driver-{number}");
        let log = DriveLog::new(&name, 0.0, STEP_S, channels).unwrap();
        let motion = Motion::of_log(&log, 100.0).unwrap();
        let settings = FollowingSettings {
            min_duration_s: 5.0,
        };
        found.extend(following_stretches(&motion, &settings));
    }
    found
}

fn leader(between: &mut impl FnMut(f64, f64) -> f64, samples: usize) -> Vec<f64> {
    let mut speed_mps = between(0.0, 20.0);
    let (mut aim_mps, mut accel_mps2, mut until) = (speed_mps, 1.0, 0);
    (0..samples)
        .map(|k| {
            if k >= until {
                let stops = between(0.0, 1.0) < 0.4;
                aim_mps = if stops { 0.0 } else { between(2.0, 25.0) };
                accel_mps2 = if aim_mps < speed_mps {
                    between(1.0, 8.0)
                } else {
                    between(0.5, 3.0)
                };
                until = k + between(30.0, 150.0) as usize;
            }
            let step_mps = accel_mps2 * STEP_S;
            speed_mps += (aim_mps - speed_mps).clamp(-step_mps, step_mps);
            speed_mps
        })
        .collect()
}

/// Speed and gap of a driver between two models, who reacts late by up to 0.8 s, recorded with noise.
fn driver(
    between: &mut impl FnMut(f64, f64) -> f64,
    lead_mps: &[f64],
    noise: u64,
) -> Vec<[f64; 2]> {
    let idm = model_of(
        ModelKind::Idm,
        &[
            between(0.5, 4.0),
            between(0.6, 4.0),
            between(0.3, 2.5),
            between(0.6, 6.0),
            between(12.0, 40.0),
        ],
    );
    let law = model_of(
        ModelKind::ConstantTimeGap,
        &[between(0.4, 2.5), between(0.8, 6.0), between(0.03, 0.6)],
    );
    let share = between(0.0, 1.0);
    let late = between(0.0, 8.0) as usize;
    let (mut speed_mps, mut gap_m) = (
        lead_mps[0],
        between(1.0, 6.0) + lead_mps[0] * between(0.4, 2.0),
    );
    let mut accels_mps2 = Vec::with_capacity(lead_mps.len());
    let mut rows = Vec::with_capacity(lead_mps.len());
    for (k, &lead) in lead_mps.iter().enumerate() {
        let off = noise as f64 * 0.4;
        rows.push([
            (speed_mps + 0.2 * between(-off, off)).max(0.0),
            (gap_m + between(-off, off)).max(0.3),
        ]);
        let [a, b] = [idm, law].map(|model| model.accel_mps2(speed_mps, gap_m, lead));
        accels_mps2.push(share * a + (1.0 - share) * b);
        let next_mps = (speed_mps + accels_mps2[k.saturating_sub(late)] * STEP_S).max(0.0);
        gap_m = (gap_m + STEP_S * (lead - 0.5 * (speed_mps + next_mps))).max(0.3);
        speed_mps = next_mps;
    }
    rows
}

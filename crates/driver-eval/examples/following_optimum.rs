//! Fits of car following beside the optimum that differential evolution finds, on recorded files, made stretches and short pieces of
//! such. Takes minutes.
//!
//! `cargo run --release -p driver-eval --example following_optimum -- [LOG]…`

#![allow(missing_docs, clippy::print_stdout, clippy::unwrap_used, clippy::panic)]

use std::time::Instant;

use drive_log::{LayoutChoice, Preparation, prepare, read_file};
use driver_model::following::{
    FollowingModel, FollowingObjective, FollowingSettings, FollowingStretch, following_stretches,
};
use driver_model::{ModelKind, Motion};
use rayon::prelude::*;

#[allow(dead_code)]
#[path = "../tests/it/referee.rs"]
mod referee;

const MADE: u64 = 90;
const SHORT: u64 = 30;
const PIECE_S: f64 = 15.0;

const EFFORT: referee::Effort = referee::Effort {
    population: 50,
    generations: 140,
};

fn main() {
    let mut sets: Vec<(String, Vec<FollowingStretch>)> = std::env::args()
        .skip(1)
        .map(|file| (file.clone(), recorded(&file)))
        .collect();
    let files = sets.len();
    sets.extend((0..MADE).map(|seed| (format!("made {seed}"), referee::hard_stretches(seed))));
    sets.extend((0..SHORT).map(|seed| {
        let made = referee::hard_stretches(1000 + seed);
        let pieces = made.iter().flat_map(|stretch| stretch.pieces(PIECE_S));
        (format!("short {seed}"), pieces.take(5).collect())
    }));
    for kind in [ModelKind::Idm, ModelKind::ConstantTimeGap] {
        let mut above: Vec<(f64, &str)> = Vec::new();
        for (number, (name, stretches)) in sets.iter().enumerate() {
            let (above_pct, seconds) = compared(kind, stretches);
            if number < files {
                println!("{kind}, {name}: {above_pct:+.4} % in {seconds:.3} s");
            }
            above.push((above_pct, name));
        }
        above.sort_by(|a, b| b.0.total_cmp(&a.0));
        let over = |limit_pct: f64| above.iter().filter(|(a, _)| *a > limit_pct).count();
        println!(
            "{kind}, {} sets: {} over 1 %, {} over 0.1 %, most {:?}, least {:?}",
            above.len(),
            over(1.0),
            over(0.1),
            above.first(),
            above.last()
        );
    }
}

fn recorded(file: &str) -> Vec<FollowingStretch> {
    let mut found = Vec::new();
    for log in read_file(file.as_ref(), &LayoutChoice::Auto).unwrap().logs {
        for piece in prepare(log, &Preparation::default()).unwrap().pieces {
            let motion = Motion::of_log(&piece, 100.0).unwrap();
            found.extend(following_stretches(&motion, &FollowingSettings::default()));
        }
    }
    found
}

/// By how much the fit is above the best of two seeds, in %, and the seconds that it took.
fn compared(kind: ModelKind, stretches: &[FollowingStretch]) -> (f64, f64) {
    let stretches: Vec<&FollowingStretch> = stretches.iter().collect();
    let objective = FollowingObjective::new(&stretches);
    let clock = Instant::now();
    let fit = FollowingModel::fit(kind, &stretches).unwrap();
    let seconds = clock.elapsed().as_secs_f64();
    let least = (0..2_u64)
        .into_par_iter()
        .map(|seed| referee::least(kind, &objective, EFFORT, seed))
        .reduce(|| f64::INFINITY, f64::min);
    (100.0 * (fit.mean_square / least - 1.0), seconds)
}

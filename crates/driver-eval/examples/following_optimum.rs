//! Fits of car following beside the optimum that differential evolution finds, on made stretches and on recorded files.
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

const SEEDS: u64 = 24;

const EFFORT: referee::Effort = referee::Effort {
    population: 60,
    generations: 150,
};

fn main() {
    for kind in [ModelKind::Idm, ModelKind::ConstantTimeGap] {
        println!("\n{}", kind.name());
        for file in std::env::args().skip(1) {
            compare(kind, &file, &recorded(&file));
        }
        for seed in 0..SEEDS {
            compare(
                kind,
                &format!("made {seed}"),
                &referee::hard_stretches(seed),
            );
        }
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

fn compare(kind: ModelKind, name: &str, stretches: &[FollowingStretch]) {
    let stretches: Vec<&FollowingStretch> = stretches.iter().collect();
    let objective = FollowingObjective::new(&stretches);
    let clock = Instant::now();
    let fit = FollowingModel::fit(kind, &stretches);
    let seconds = clock.elapsed().as_secs_f64();
    let least = (0..2_u64)
        .into_par_iter()
        .map(|seed| referee::least(kind, &objective, EFFORT, seed))
        .reduce(|| f64::INFINITY, f64::min);
    match fit {
        Ok(fit) => println!(
            "{name:40} {:2} stretches  fit {:.6}  referee {least:.6}  {:+.3} %  {seconds:.3} s {:?} {:?}",
            stretches.len(),
            fit.mean_square,
            100.0 * (fit.mean_square / least - 1.0),
            fit.at_bound,
            fit.model
        ),
        Err(error) => println!("{name:40} {error}; referee {least:.6}"),
    }
}

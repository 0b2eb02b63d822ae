//! How many segments: the least cost along a path of penalties, and its knee.
//!
//! `cargo run --release -p tseg --example choose_k`

#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;

use tseg::{Cost, Error, PenaltyPath, Series};

fn main() -> Result<(), Error> {
    // Twelve levels with a ripple on them.
    let level = |i: i32| f64::from((i / 50) * 7 % 12);
    let samples: Vec<f64> = (0..600)
        .map(|i| level(i) + 0.2 * (f64::from(i) * 1.3).sin())
        .collect();
    let series = Series::new(&[(&samples, 1.0)])?;
    let path = PenaltyPath::new(Cost::SquaredError, 5, &series, &|_| {
        ControlFlow::Continue(())
    })?;
    println!("{:>12}{:>10}{:>12}", "penalty", "segments", "cost");
    for (i, point) in path.points.iter().enumerate() {
        let mark = if i == path.knee { "  knee" } else { "" };
        let segments = point.segmentation.segment_count();
        println!(
            "{:>12.3}{segments:>10}{:>12.3}{mark}",
            point.penalty, point.cost
        );
    }
    println!(
        "boundaries at the knee: {:?}",
        path.at_knee().segmentation.boundaries()
    );
    Ok(())
}

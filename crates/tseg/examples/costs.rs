//! What each cost sees: shapes of twenty samples, whole, twice as high, and cut in two where that is cheapest.
//!
//! `cargo run -p tseg --example costs`

#![allow(clippy::print_stdout)]

use tseg::{Cost, Dynamic, Error, Series};

const SAMPLES: i32 = 20;

/// The value at a sample.
type Shape = fn(i32) -> f64;

fn main() -> Result<(), Error> {
    let shapes: [(&str, Shape); 5] = [
        ("constant", |_| 3.0),
        ("ramp", |i| f64::from(i) / 10.0),
        ("step in the middle", |i| f64::from(i / 10)),
        ("one sample off", |i| f64::from(i32::from(i == 10))),
        ("alternating", |i| f64::from(i % 2)),
    ];
    println!(
        "{:<20}{:<18}{:>8}{:>14}{:>12}  cut at",
        "shape", "cost", "whole", "twice as high", "cut in two"
    );
    for (name, shape) in shapes {
        let samples: Vec<f64> = (0..SAMPLES).map(shape).collect();
        let doubled: Vec<f64> = samples.iter().map(|x| 2.0 * x).collect();
        let (series, higher) = (
            Series::new(&[(&samples, 1.0)])?,
            Series::new(&[(&doubled, 1.0)])?,
        );
        for (label, cost) in [
            ("z-scale", Cost::ZScale),
            ("mean-deviation", Cost::MeanDeviation),
            ("squared-error", Cost::SquaredError),
        ] {
            let whole = cost.of_segment(&series, 0..series.len())?;
            let twice = cost.of_segment(&higher, 0..series.len())?;
            let cut = Dynamic::new(cost, 2)?.segment(&series)?;
            let place = cut.segmentation.boundaries()[1];
            println!(
                "{name:<20}{label:<18}{whole:>8.3}{twice:>14.3}{:>12.3}  {place}",
                cut.cost
            );
        }
    }
    Ok(())
}

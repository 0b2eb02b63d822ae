//! Segments a drive while it happens: `cargo run --example streaming -p tseg`.

#![allow(clippy::print_stdout)]

use tseg::{Cost, Error, Swab};

/// Speed in m/s at 1 Hz: standing, pulling away, cruising, braking, standing.
const SPEED: [f64; 28] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 1.6, 3.3, 4.9, 6.4, 8.1, 9.7, 11.2, 12.1, 12.5, 12.4, 12.6, 12.5,
    12.5, 12.3, 12.5, 10.4, 7.9, 5.6, 3.1, 0.9, 0.0, 0.0, 0.0,
];

fn main() -> Result<(), Error> {
    let swab = Swab::new(Cost::MeanDeviation, 1.5, 8)?;
    let mut stream = swab.stream(&[1.0])?;
    for (second, speed) in SPEED.into_iter().enumerate() {
        if let Some(segment) = stream.push(&[speed])? {
            println!("at {second:2} s: {segment:?} is a segment");
        }
    }
    for segment in stream.finish() {
        println!("at the end: {segment:?}");
    }
    Ok(())
}

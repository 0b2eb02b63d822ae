//! The engine alone, for a model of one's own: how hard a driver brakes, predicted by the mean of all others.
//!
//! `cargo run -p driver-eval --example own_hold_out`

#![allow(clippy::print_stdout)]

use std::error::Error;

use driver_eval::HoldOut;
use driver_model::statistics::mean;

const BRAKINGS: [(&str, f64); 6] = [
    ("anna", 1.1),
    ("anna", 1.3),
    ("ben", 2.0),
    ("ben", 1.8),
    ("ben", 1.9),
    ("cleo", 1.5),
];

fn main() -> Result<(), Box<dyn Error>> {
    let hold_out = HoldOut::by_unit(&BRAKINGS.map(|(driver, _)| driver));
    hold_out.at_least(2)?;

    // What a fold learns from never holds an item of the driver that it is judged on.
    let folds = hold_out.run(&|| {}, |split| {
        let known = split.rest().map(|item| BRAKINGS[item].1);
        let predicted = mean(known).unwrap_or(f64::NAN);
        let errors = split
            .held_out()
            .map(|item| (predicted - BRAKINGS[item].1).abs());
        Ok((predicted, mean(errors).unwrap_or(f64::NAN)))
    })?;
    for (driver, (predicted, error)) in hold_out.units().iter().zip(folds) {
        println!("{driver:5} {predicted:.2} m/s² predicted, off by {error:.2} m/s²");
    }
    Ok(())
}

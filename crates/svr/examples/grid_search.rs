//! Kernel scale, tube and box constraint chosen by the error on samples held out in five blocks.
//!
//! `cargo run -p svr --example grid_search`

#![allow(clippy::print_stdout)]

use std::error::Error;

use svr::{Grid, Kernel, Response, Samples, Settings, blocked_folds, search};

fn main() -> Result<(), Box<dyn Error>> {
    // Places between 0 and 10 in no order, so that every block has some from everywhere.
    let x: Vec<f64> = (0..200)
        .map(|i| (f64::from(i) * 6.18).rem_euclid(10.0))
        .collect();
    let y: Vec<f64> = x.iter().map(|x| x.sin() + 0.1 * (31.0 * x).cos()).collect();
    let (samples, response) = (Samples::new(&x, 1)?, Response::new(&y)?);

    let settings = Settings {
        kernel: Kernel::Rbf,
        ..Settings::default()
    };
    let grid = Grid {
        kernel_scales: vec![Some(0.1), Some(0.5), Some(2.0)],
        tube_epsilons: vec![Some(0.01), Some(0.1)],
        box_constraints: vec![Some(0.1), Some(1.0), Some(10.0)],
    };
    let folds = blocked_folds(samples.len(), 5, 0)?;
    let value = |given: Option<f64>| given.unwrap_or(f64::NAN);

    println!("   scale    tube     box    RMSE");
    for candidate in search(&samples, &response, &settings, &grid, &folds)? {
        println!(
            "{:8.2}{:8.2}{:8.1}{:8.3}",
            value(candidate.kernel_scale),
            value(candidate.penalty.tube_epsilon),
            value(candidate.penalty.box_constraint),
            candidate.rmse
        );
    }
    Ok(())
}

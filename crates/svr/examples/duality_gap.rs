//! How good a fit is as an optimum, by kernel: the optimum lies between the dual and the primal objective.
//!
//! `cargo run -p svr --example duality_gap`

#![allow(clippy::print_stdout)]

use std::error::Error;

use svr::{Kernel, Penalty, Response, Samples, Settings, fit};

fn main() -> Result<(), Box<dyn Error>> {
    let row = |i: i32| [f64::from(i % 20) / 20.0, f64::from(i / 20) / 15.0];
    let predictors: Vec<f64> = (0..300).flat_map(row).collect();
    let response: Vec<f64> = predictors
        .chunks_exact(2)
        .map(|x| (4.0 * x[0]).sin() + x[0] * x[1] + 0.1 * (97.0 * x[1]).sin())
        .collect();
    let (samples, response) = (Samples::new(&predictors, 2)?, Response::new(&response)?);

    println!("kernel          dual    primal      gap       KKT  vectors  status");
    for (name, kernel) in [
        ("linear", Kernel::Linear),
        ("quadratic", Kernel::Quadratic),
        ("cubic", Kernel::Cubic),
        ("rbf", Kernel::Rbf),
    ] {
        let settings = Settings {
            kernel,
            ..Settings::default()
        };
        let fit = fit(&samples, &response, &settings, &Penalty::default())?;
        println!(
            "{name:<10}{:10.4}{:10.4}{:9.1e}{:10.1e}{:9}  {:?}",
            fit.dual_objective,
            fit.primal_objective,
            fit.duality_gap(),
            fit.kkt_residual,
            fit.support_vectors,
            fit.status
        );
    }
    Ok(())
}

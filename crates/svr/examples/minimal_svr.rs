//! A sine learnt from 200 samples with a Gaussian kernel.
//!
//! `cargo run -p svr --example minimal_svr`

#![allow(clippy::print_stdout)]

use std::error::Error;

use svr::{Kernel, Penalty, Response, Samples, Settings, fit};

fn main() -> Result<(), Box<dyn Error>> {
    let x: Vec<f64> = (0..200).map(|i| f64::from(i) / 20.0).collect();
    let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
    let samples = Samples::new(&x, 1)?;
    let settings = Settings {
        kernel: Kernel::Rbf,
        kernel_scale: Some(0.5),
        ..Settings::default()
    };
    let fit = fit(
        &samples,
        &Response::new(&y)?,
        &settings,
        &Penalty::default(),
    )?;
    println!("{:?}, {} support vectors", fit.status, fit.support_vectors);

    let asked: [f64; 5] = [0.5, 2.5, 4.5, 6.5, 8.5];
    let predicted = fit.model.predict(&Samples::new(&asked, 1)?)?;
    for (x, predicted) in asked.iter().zip(predicted) {
        println!("x = {x}: {predicted:6.3}, the sine is {:6.3}", x.sin());
    }
    Ok(())
}

//! The cheapest way over two kilometres with a stop, in 200 seconds.

#![allow(clippy::print_stdout)]

use std::error::Error;

use ev_energy::{StepModel, Vehicle};
use speed_plan::{Answer, Demand, Envelope, Problem, Road, Settings, plan};

fn main() -> Result<(), Box<dyn Error>> {
    let car = Vehicle::builtin("b250e")?;
    let road = Road {
        length_m: 2000.0,
        stops: vec![(1200.0, 10.0)],
        ..Road::default()
    };
    let problem = Problem::new(StepModel::new(&car), Envelope::default(), road.columns()?)?;
    match plan(&problem, Demand::Arrival(200.0), &Settings::default())? {
        Answer::Plan(plan) => println!(
            "{:.1} kJ in {:.1} s, at most {:.4} % too much; a second later saves {:.2} kJ",
            plan.run.energy_j / 1e3,
            plan.run.time_s,
            plan.gap_pct,
            plan.price_w.unwrap_or(f64::NAN) / 1e3
        ),
        Answer::Obstacle(obstacle) => println!("{obstacle}"),
    }
    Ok(())
}

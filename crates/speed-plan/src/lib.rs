//! Energy-optimal speed.

mod bound;
mod case;
mod envelope;
mod error;
#[allow(missing_docs)]
pub mod interior_point;
mod outcome;
mod problem;
mod reachable;
mod tridiagonal;

pub use case::Case;
pub use envelope::{Envelope, EnvelopePoint};
pub use error::Error;
pub use outcome::Obstacle;
pub use problem::{Columns, Problem, Signal};

#[doc(hidden)]
pub fn try_ip(case: &Case) {
    use interior_point::*;
    let problem = Problem::new(ev_energy::StepModel::new(&case.vehicle), case.envelope.clone(), case.columns.clone()).unwrap();
    let reachable = match reachable::Reachable::new(&problem) { Ok(r) => r, Err(o) => { println!("{o:?}"); return; } };
    let t_up: f64 = (0..problem.nodes()-1).map(|k| problem.columns.dwell_s[k] + problem.steps[k].length_m()/problem::mean_speed(reachable.high[k], reachable.high[k+1])).sum();
    println!("earliest {t_up:.9}");
    let task = Task { price_w: 0.0, time_bounds: case.latest_arrival_s.iter().map(|t| TimeBound { node: problem.nodes()-1, after_wait: false, at_most: true, time_s: *t }).collect(), waits: vec![] };
    let gentle = reachable::Reachable::gentle(&problem, 0.7).unwrap();
    let start: Vec<f64> = gentle.low.iter().zip(&gentle.high).map(|(l, h)| l + 0.6*(h-l)).collect();
    let f = problem.model.formula().unwrap();
    let begun = std::time::Instant::now();
    let Some(ip) = InteriorPoint::new(&problem, f, &reachable, &task, start, 300.0) else { println!("no start"); return; };
    let s = ip.solve(Precision::default());
    let el = begun.elapsed();
    let e: f64 = (0..problem.nodes()-1).map(|k| problem.model.energy_j(&problem.steps[k], s.z[k].sqrt(), s.z[k+1].sqrt())).sum::<f64>() + (0..problem.nodes()-1).map(|k| problem.columns.dwell_s[k]*problem.standing_power_w(k)).sum::<f64>();
    let t: f64 = (0..problem.nodes()-1).map(|k| problem.columns.dwell_s[k] + problem.steps[k].length_m()/problem::mean_speed(s.z[k], s.z[k+1])).sum();
    println!("it {} conv {} E {e:.3} t {t:.6} price {:?} in {el:?}", s.iterations, s.converged, s.multipliers_w);
    let begun = std::time::Instant::now();
    let (lb, cells) = bound::lower_bound_j(&problem, &f, &reachable, &task, &s, 1e-5*e.abs());
    println!("    bound {lb:.3} gap {:.6} % cells {cells} of {} steps in {:?}", 100.0*(e-lb)/e.abs(), problem.steps.len(), begun.elapsed());
}

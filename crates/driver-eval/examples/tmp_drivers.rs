#![allow(
    missing_docs,
    clippy::all,
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::panic
)]
use drive_log::{LayoutChoice, Preparation, prepare, read_file};
use driver_eval::HoldOut;
use driver_eval::following::evaluate_following;
use driver_model::Motion;
use driver_model::following::{FollowingPopulation, FollowingSettings, following_stretches};
fn main() {
    let (mut stretches, mut files) = (Vec::new(), Vec::new());
    for file in std::env::args().skip(1) {
        for log in read_file(file.as_ref(), &LayoutChoice::Auto).unwrap().logs {
            for piece in prepare(log, &Preparation::default()).unwrap().pieces {
                let m = Motion::of_log(&piece, 100.0).unwrap();
                let found = following_stretches(&m, &FollowingSettings::default());
                files.extend(found.iter().map(|_| file.clone()));
                stretches.extend(found);
            }
        }
    }
    for s in &stretches {
        if false {
            println!(
                "{} {:.1} max speed {:.1}",
                s.log(),
                s.duration_s(),
                s.speed_mps().iter().fold(0.0_f64, |a, b| a.max(*b))
            );
        }
    }
    let t = std::time::Instant::now();
    let e = evaluate_following(&stretches, &HoldOut::by_unit(&files)).unwrap();
    println!("{:?}", t.elapsed());
    println!(
        "HELD {:?}\n{:?}\nfit s {:?}",
        e.held_out,
        e.in_sample,
        e.folds.iter().map(|f| f.fit_seconds).collect::<Vec<_>>()
    );
    for f in &e.folds {
        println!("{:?} {:?}", f.fits.idm.model, f.fits.idm.mean_square);
    }
    for c in &e.drivers {
        println!(
            "{:13} {:8} {:14} {:2} {:3} gap {:.3} speed {:.3} rel {:.1} coll {}  {:?}",
            format!("{:?}", c.held_out),
            c.model.name(),
            format!("{:?}", c.parameters_of),
            c.drivers,
            c.stretches,
            c.errors.gap_rmse_m,
            c.errors.speed_rmse_mps,
            100.0 * c.errors.gap_rmse_relative,
            c.errors.collisions,
            c.against_all.map(|p| (
                format!("{:.2} {:.2} {:.2}", p.gap_rmse_m, p.low_m, p.high_m),
                p.better_drivers
            ))
        );
    }
    for kind in [
        driver_model::ModelKind::Idm,
        driver_model::ModelKind::ConstantTimeGap,
    ] {
        let mut names: Vec<&str> = stretches.iter().map(|s| s.driver()).collect();
        names.sort();
        names.dedup();
        let d: Vec<Vec<_>> = names
            .iter()
            .map(|n| stretches.iter().filter(|s| s.driver() == *n).collect())
            .collect();
        let p = FollowingPopulation::fit(kind, &d).unwrap();
        println!("{:?} {:?}", p.typical, p.spread);
        for (n, f) in names.iter().zip(&p.drivers) {
            println!("   {n} {:.4} {:?} {:?}", f.mean_square, f.at_bound, f.model);
        }
    }
}

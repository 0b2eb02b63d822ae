//! Try.
use speed_plan::*;
use std::time::Instant;
fn road(km: f64) -> Road {
    let n = (km / 10.0).round() as usize;
    let mut limits = vec![];
    let mut stops = vec![];
    for k in 0..n {
        let o = k as f64 * 10000.0;
        for (p, l) in [(0.0, 50.0), (1500.0, 100.0), (6000.0, 70.0), (8500.0, 50.0)] {
            limits.push((o + p, l / 3.6));
        }
        stops.push((o + 6000.0, 10.0));
    }
    let elevation = (0..=(km * 10.0) as usize)
        .map(|k| {
            let s = k as f64 * 100.0;
            (
                s,
                1000.0 * 0.03 / (2.0 * std::f64::consts::PI)
                    * (2.0 * std::f64::consts::PI * s / 1000.0).sin(),
            )
        })
        .collect();
    Road {
        length_m: km * 1000.0,
        limits,
        stops,
        elevation,
        ..Road::default()
    }
}
fn main() {
    let vehicle = ev_energy::Vehicle::builtin("b250e").unwrap();
    for km in [10.0, 100.0] {
        let problem = Problem::new(
            ev_energy::StepModel::new(&vehicle),
            Envelope::default(),
            road(km).columns().unwrap(),
        )
        .unwrap();
        let Answer::Plan(first) = plan(&problem, Demand::Price(0.0), &Settings::default()).unwrap()
        else {
            panic!()
        };
        for demand in [
            Demand::Arrival(first.earliest_arrival_s * 1.08),
            Demand::Price(5000.0),
        ] {
            let mut best = f64::INFINITY;
            let mut out = String::new();
            for _ in 0..15 {
                let t = Instant::now();
                match plan(&problem, demand, &Settings::default()).unwrap() {
                    Answer::Plan(p) => {
                        out = format!(
                            "E {:.1} t {:.6} price {:.2} gap {:.6} % solved {}",
                            p.energy_j, p.time_s, p.price_w, p.gap_pct, p.solved
                        )
                    }
                    Answer::Obstacle(o) => out = format!("{o:?}"),
                }
                best = best.min(t.elapsed().as_secs_f64());
            }
            if let Answer::Plan(p) = plan(&problem, demand, &Settings::default()).unwrap() {
                let mut b = f64::INFINITY;
                let mut g = 0.0;
                for _ in 0..15 {
                    let t = Instant::now();
                    if let Answer::Plan(q) =
                        replan(&problem, demand, &Settings::default(), &p.speed_mps).unwrap()
                    {
                        g = q.gap_pct;
                    }
                    b = b.min(t.elapsed().as_secs_f64());
                }
                println!("replan {:.3} ms gap {g:.6}", b * 1e3);
            }
            println!(
                "{km} km {} steps {demand:?}: {:.3} ms {out}",
                problem.nodes() - 1,
                best * 1e3
            );
        }
    }
}

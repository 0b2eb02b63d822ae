//! hard
use speed_plan::*;
use std::time::Instant;
fn main() {
    let car = ev_energy::Vehicle::builtin("b250e").unwrap();
    let mut pos = vec![(0.0, 45.0)];
    let mut s = 45.0;
    // stop and go
    for k in 1..800 {
        let t = k as f64 * 0.5;
        let cyc = t % 60.0;
        let v = if cyc < 15.0 {
            12.0
        } else if cyc < 21.0 {
            12.0 - 2.0 * (cyc - 15.0)
        } else if cyc < 45.0 {
            0.0
        } else {
            0.8 * (cyc - 45.0)
        };
        s += v * 0.5;
        pos.push((t, s));
    }
    let leader = Leader {
        positions: pos,
        standstill_gap_m: 3.0,
        headway_s: 1.4,
    };
    let base = Road {
        length_m: 1500.0,
        ..Road::default()
    };
    let mut cases: Vec<(String, Road, f64)> = vec![];
    cases.push((
        "stop-and-go".into(),
        Road {
            leader: Some(leader),
            ..base.clone()
        },
        300.0,
    ));
    for (a, b) in [(60.0, 90.0), (90.0, 120.0), (120.0, 150.0), (200.0, 230.0)] {
        cases.push((
            format!("long red till {a}"),
            Road {
                signals: vec![(600.0, vec![[-10.0, 5.0], [a, b]])],
                ..base.clone()
            },
            320.0,
        ));
        cases.push((
            format!("long red till {a}, tight"),
            Road {
                signals: vec![(600.0, vec![[-10.0, 5.0], [a, b]])],
                ..base.clone()
            },
            a + 85.0,
        ));
    }
    for g in [0.04, 0.06, 0.08, 0.1] {
        cases.push((
            format!("descent {g}"),
            Road {
                length_m: 3000.0,
                limits: vec![(0.0, 100.0 / 3.6)],
                elevation: vec![
                    (0.0, 0.0),
                    (500.0, 0.0),
                    (2500.0, -2000.0 * g),
                    (3000.0, -2000.0 * g),
                ],
                ..Road::default()
            },
            170.0,
        ));
    }
    for (name, road, latest) in cases {
        let problem = Problem::new(
            ev_energy::StepModel::new(&car),
            Envelope::default(),
            road.columns().unwrap(),
        )
        .unwrap();
        let t = Instant::now();
        match plan(&problem, Demand::Arrival(latest), &Settings::default()).unwrap() {
            Answer::Plan(p) => println!(
                "{name:28} {:?} E {:.1} t {:.3} price {:.1} gap {:.4} % solved {} in {:?} stood {:?}",
                p.arrival,
                p.energy_j,
                p.time_s,
                p.price_w,
                p.gap_pct,
                p.solved,
                t.elapsed(),
                problem
                    .columns()
                    .signals
                    .iter()
                    .map(|s| p.stood_s[s.node])
                    .collect::<Vec<_>>()
            ),
            Answer::Obstacle(o) => println!("{name:28} {o}"),
        }
    }
}

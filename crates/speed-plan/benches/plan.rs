//! Plans beside the same problem, relaxed, by Clarabel: processor time of one core, ratio, gap.
//!
//! `cargo bench --workspace --bench plan` measures, with ` -- --test` every job runs once. A job is repeated for a quarter of a second,
//! three times; the least mean counts. Processor time is that of this thread as Linux tells it, elsewhere the time that passed.
//! ` -- --export FOLDER` writes the first two problems as cases for `drivekit plan --case`, with which `compare_ipopt.py` goes on.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use ev_energy::{StepModel, Vehicle};
use serde_json::json;
use speed_plan::{
    Answer, Columns, Demand, Envelope, Leader, Plan, Problem, Road, Settings, certify, plan, replan,
};

const BATCHES: usize = 3;
const BATCH_S: f64 = 0.25;
/// Arrival of the plans in multiples of the earliest.
const SLACK: f64 = 1.08;
const PRICE_W: f64 = 4000.0;

fn main() {
    let measured = !std::env::args().any(|argument| argument == "--test");
    let car = Vehicle::builtin("b250e").unwrap();
    let ten = problem(&car, zones(1, vec![(6800.0, 10.0)]).columns().unwrap());
    let stops = (1..=10).map(|k| (f64::from(k) * 10_000.0 - 3200.0, 10.0));
    let hundred = problem(&car, zones(10, stops.collect()).columns().unwrap());
    if let Some(folder) = after("--export") {
        for (name, problem) in [("10-km", &ten), ("100-km", &hundred)] {
            std::fs::write(
                Path::new(&folder).join(format!("{name}.json")),
                case(name, problem),
            )
            .unwrap();
        }
        return;
    }
    println!("job: nodes, ms, gap; Clarabel: ms, ratio, gap");
    let bench = Bench { measured };
    for (name, problem, demand) in [
        ("10 km, exact arrival", &ten, in_time(&ten)),
        (
            "100 km, ten stops, exact arrival",
            &hundred,
            in_time(&hundred),
        ),
        ("10 km, fixed price", &ten, Demand::Price(PRICE_W)),
    ] {
        bench.beside_clarabel(name, problem, demand);
    }
    bench.warm(&car, &ten);
    for (name, road, arrival_s) in [
        ("three signals on 1.5 km", three_signals(), 160.0),
        ("long red", long_red(), 150.0),
        ("stop-and-go leader", stop_and_go(), 220.0),
    ] {
        let problem = problem(&car, road.columns().unwrap());
        let demand = Demand::Arrival(arrival_s);
        bench.alone(name, &problem, || {
            made(plan(&problem, demand, &Settings::default()))
        });
    }
}

fn after(flag: &str) -> Option<String> {
    std::env::args()
        .skip_while(|argument| argument != flag)
        .nth(1)
}

/// A problem as a case, with the arrival of the benchmark.
fn case(name: &str, problem: &Problem) -> String {
    let spec = problem.model().vehicle().spec();
    let car = problem.model().formula().unwrap();
    let loss = spec.motor.loss.as_ref().unwrap();
    let columns = problem.columns();
    let Demand::Arrival(latest_arrival_s) = in_time(problem) else {
        unreachable!("it is an arrival");
    };
    let stops = (0..problem.nodes()).filter(|node| columns.dwell_s[*node] > 0.0);
    let stops = stops.map(|node| json!({ "node": node, "dwell_s": columns.dwell_s[node] }));
    let case = json!({
        "schema": "drivekit/planning-vector/1",
        "name": name,
        "vehicle": {
            "mass_kg": spec.mass_kg,
            "rotating_inertia_kg_m2": spec.rotating_inertia_kg_m2,
            "wheel_radius_m": spec.wheel_radius_m,
            "gear_ratio": spec.gear_ratio,
            "gear_efficiency": spec.gear_efficiency,
            "auxiliary_power_w": spec.auxiliary_power_w,
            "road_load": {
                "constant_n": car.rolling_n,
                "linear_n_per_mps": car.linear_n_per_mps,
                "quadratic_n_per_mps2": car.quadratic_n_per_mps2,
            },
            "motor": {
                "max_torque_nm": spec.motor.max_torque_nm,
                "max_power_w": spec.motor.max_power_w,
                "max_speed_rad_s": spec.motor.max_speed_rad_s,
                "copper_w_per_nm2": loss.copper_w_per_nm2,
                "iron_w_per_rad_s": loss.iron_w_per_rad_s,
                "windage_w_per_rad3_s3": loss.windage_w_per_rad3_s3,
                "constant_w": loss.constant_w,
                "spin_share_in_road_load": loss.spin_share_in_road_load,
            },
            "regeneration": spec.regeneration,
            "battery": {
                "open_circuit_voltage_v": spec.battery.open_circuit_voltage_v,
                "resistance_ohm": spec.battery.resistance_ohm,
            },
        },
        "position_m": columns.position_m,
        "slope_rad": columns.slope_rad,
        "speed_min_mps": columns.min_mps,
        "speed_max_mps": columns.max_mps,
        "stops": stops.collect::<Vec<_>>(),
        "latest_arrival_s": latest_arrival_s,
    });
    case.to_string()
}

struct Bench {
    measured: bool,
}

impl Bench {
    fn beside_clarabel(&self, name: &str, problem: &Problem, demand: Demand) {
        let solve = || made(plan(problem, demand, &Settings::default()));
        let own_ms = self.ms(solve);
        let found = solve();
        let certificate = certify(problem, demand, &found.run).unwrap();
        let rival_ms = self.ms(|| certify(problem, demand, &found.run).unwrap());
        println!(
            "{name}: {} nodes, {own_ms:.2} ms, {:.4} %; {rival_ms:.1} ms, {:.1} times, {:.4} % ({:?})",
            problem.nodes(),
            found.gap_pct,
            rival_ms / own_ms,
            certificate.gap_pct.unwrap_or(f64::NAN),
            certificate.convergence
        );
    }

    fn alone(&self, name: &str, problem: &Problem, solve: impl Fn() -> Plan) {
        let ms = self.ms(&solve);
        let gap_pct = solve().gap_pct;
        println!(
            "{name}: {} nodes, {ms:.2} ms, {gap_pct:.4} %",
            problem.nodes()
        );
    }

    /// From a third of the way at the price of time, 1 m/s off the plan.
    fn warm(&self, car: &Vehicle, whole: &Problem) {
        let first = made(plan(whole, Demand::Price(PRICE_W), &Settings::default()));
        let here = whole.nodes() / 3;
        let left = whole.columns();
        let mut columns = Columns {
            position_m: left.position_m[here..].to_vec(),
            slope_rad: left.slope_rad[here..].to_vec(),
            min_mps: left.min_mps[here..].to_vec(),
            max_mps: left.max_mps[here..].to_vec(),
            dwell_s: left.dwell_s[here..].to_vec(),
            ..left.clone()
        };
        let near_mps = &first.run.speed_mps[here..];
        columns.min_mps[0] = near_mps[0] - 1.0;
        columns.max_mps[0] = near_mps[0] - 1.0;
        let rest = problem(car, columns);
        let settings = Settings::default();
        for (name, near_mps) in [("replan, warm", Some(near_mps)), ("the same, cold", None)] {
            self.alone(name, &rest, || {
                let demand = Demand::Price(PRICE_W);
                made(match near_mps {
                    Some(near_mps) => replan(&rest, demand, &settings, near_mps),
                    None => plan(&rest, demand, &settings),
                })
            });
        }
    }

    /// Milliseconds of a job; 0 where nothing is measured.
    fn ms<T>(&self, job: impl Fn() -> T) -> f64 {
        black_box(job());
        if !self.measured {
            return 0.0;
        }
        let batch = || {
            let (started, before_s) = (Instant::now(), processor_s());
            let mut runs = 0.0;
            while started.elapsed().as_secs_f64() < BATCH_S {
                black_box(job());
                runs += 1.0;
            }
            let passed_s = started.elapsed().as_secs_f64();
            let used_s = before_s.zip(processor_s()).map(|(from, to)| to - from);
            1e3 * used_s.unwrap_or(passed_s) / runs
        };
        (0..BATCHES).map(|_| batch()).fold(f64::INFINITY, f64::min)
    }
}

/// Processor time of this thread, s.
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

fn made(answer: Result<Answer, speed_plan::Error>) -> Plan {
    answer.unwrap().plan().unwrap().clone()
}

fn problem(car: &Vehicle, columns: Columns) -> Problem<'_> {
    Problem::new(StepModel::new(car), Envelope::default(), columns).unwrap()
}

fn in_time(problem: &Problem) -> Demand {
    let hurry = made(plan(problem, Demand::Price(0.0), &Settings::default()));
    Demand::Arrival(SLACK * hurry.earliest_arrival_s)
}

/// Ten kilometres or several times as many: zones of 50, 100, 70 and 50 km/h, waves of 3 %.
fn zones(times: u32, stops: Vec<(f64, f64)>) -> Road {
    let zones = [(0.0, 50.0), (2500.0, 100.0), (5500.0, 70.0), (8000.0, 50.0)];
    let limits = (0..times).flat_map(|k| {
        let from = 10_000.0 * f64::from(k);
        let own = if k == 0 { 0 } else { 1 };
        zones[own..]
            .iter()
            .map(move |(at, kmh)| (from + at, kmh / 3.6))
    });
    let height = |at: f64| 15.0 * (at / 500.0).sin();
    let places = (0..=200 * times).map(|k| 50.0 * f64::from(k));
    Road {
        length_m: 10_000.0 * f64::from(times),
        limits: limits.collect(),
        elevation: places.map(|at| (at, height(at))).collect(),
        stops,
        ..Road::default()
    }
}

fn three_signals() -> Road {
    let cycle = |first_s: f64| (0..6).map(move |k| first_s + 60.0 * f64::from(k));
    let signal = |at, first_s| (at, cycle(first_s).map(|from| [from, from + 25.0]).collect());
    Road {
        length_m: 1500.0,
        signals: vec![
            signal(400.0, 20.0),
            signal(800.0, -10.0),
            signal(1200.0, 35.0),
        ],
        ..Road::default()
    }
}

fn long_red() -> Road {
    Road {
        signals: vec![(500.0, vec![[-10.0, 5.0], [90.0, 120.0]])],
        ..Road::default()
    }
}

/// 10 m/s for half a minute, then a stand of 15 s, and again.
fn stop_and_go() -> Road {
    let mut at = 20.0;
    let positions = (0..300).map(|t| {
        let here = (f64::from(t), at);
        at += if t % 45 < 30 { 10.0 } else { 0.0 };
        here
    });
    Road {
        length_m: 1200.0,
        leader: Some(Leader {
            positions: positions.collect(),
            standstill_gap_m: 2.0,
            headway_s: 1.5,
        }),
        ..Road::default()
    }
}

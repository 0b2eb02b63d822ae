//! No plan that a search over all speeds of a grid finds may cost less than the bound.

use ev_energy::{StepModel, Vehicle, library};
use proptest::prelude::*;
use speed_plan::{Answer, Columns, Demand, Envelope, Problem, Settings, Signal, plan};

use crate::assert_drivable;

/// Speeds per node.
const GRID: usize = 24;

#[derive(Debug, Clone)]
struct Small {
    car: String,
    regeneration: [f64; 2],
    lengths_m: Vec<f64>,
    slopes_rad: Vec<f64>,
    top_mps: Vec<f64>,
    ends_mps: [f64; 2],
    slack: f64,
    light: Option<(usize, f64, f64)>,
}

fn small() -> impl Strategy<Value = Small> {
    let names: Vec<String> = library::names().map(str::to_owned).collect();
    let steps = 4;
    let per_step = (
        prop::collection::vec(3.0..60.0_f64, steps),
        prop::collection::vec(-0.09..0.09_f64, steps),
        prop::collection::vec(4.0..30.0_f64, steps + 1),
    );
    let ends = prop::array::uniform2(prop_oneof![Just(0.0), 3.0..9.0_f64]);
    let light = prop::option::of((1..steps, 0.0..1.5_f64, 0.05..0.6_f64));
    (
        prop::sample::select(names),
        [0.0..1.0_f64, 5e3..60e3_f64],
        per_step,
        ends,
        1.0..2.0_f64,
        light,
    )
        .prop_map(
            |(car, regeneration, (lengths_m, slopes_rad, top_mps), ends_mps, slack, light)| Small {
                car,
                regeneration,
                lengths_m,
                slopes_rad,
                top_mps,
                ends_mps,
                slack,
                light,
            },
        )
}

impl Small {
    fn car(&self) -> Vehicle {
        let mut spec = Vehicle::builtin(&self.car).unwrap().spec().clone();
        spec.sources.clear();
        spec.regeneration.torque_fraction = self.regeneration[0];
        spec.regeneration.max_power_w = self.regeneration[1];
        Vehicle::new(spec).unwrap()
    }

    fn columns(&self) -> Columns {
        let mut at = 0.0;
        let later = self.lengths_m.iter().map(|length| {
            at += length;
            at
        });
        let position_m: Vec<f64> = std::iter::once(0.0).chain(later).collect();
        let nodes = position_m.len();
        let mut max_mps = self.top_mps.clone();
        let mut min_mps = vec![0.5; nodes];
        for (node, end) in [(0, self.ends_mps[0]), (nodes - 1, self.ends_mps[1])] {
            max_mps[node] = end.min(max_mps[node]);
            min_mps[node] = max_mps[node];
        }
        Columns {
            position_m,
            slope_rad: self.slopes_rad.clone(),
            min_mps,
            max_mps,
            dwell_s: vec![0.0; nodes],
            signals: Vec::new(),
            earliest_s: Vec::new(),
        }
    }
}

/// The least of energy over every path through a grid of speeds that arrives in time and at green.
fn least_j(problem: &Problem, latest_s: f64, low: &[f64], high: &[f64]) -> f64 {
    struct Walk<'a> {
        problem: &'a Problem<'a>,
        latest_s: f64,
        grids: Vec<Vec<f64>>,
        best_j: f64,
    }
    impl Walk<'_> {
        fn on(&mut self, node: usize, v: f64, time_s: f64, energy_j: f64) {
            let columns = self.problem.columns();
            let green = |signal: &Signal| {
                signal
                    .green_s
                    .iter()
                    .any(|window| window[0] <= time_s && time_s <= window[1])
            };
            if time_s > self.latest_s
                || columns
                    .signals
                    .iter()
                    .any(|signal| signal.node == node && !green(signal))
            {
                return;
            }
            if node + 1 == self.problem.nodes() {
                self.best_j = self.best_j.min(energy_j);
                return;
            }
            let length_m = columns.position_m[node + 1] - columns.position_m[node];
            let road = ev_energy::RoadStep::new(length_m, columns.slope_rad[node]);
            for next in self.grids[node + 1].clone() {
                let accel = (next * next - v * v) / (2.0 * length_m);
                if v + next <= 0.0 || !(-2.0..=1.5).contains(&accel) {
                    continue;
                }
                let step_j = self.problem.model().energy_j(&road, v, next);
                if step_j.is_finite() {
                    self.on(
                        node + 1,
                        next,
                        time_s + 2.0 * length_m / (v + next),
                        energy_j + step_j,
                    );
                }
            }
        }
    }
    let grids = low
        .iter()
        .zip(high)
        .map(|(low, high)| {
            let count = if high - low < 1e-12 { 1 } else { GRID };
            let last = (count.max(2) - 1) as f64;
            (0..count)
                .map(|k| low + (high - low) * k as f64 / last)
                .collect()
        })
        .collect();
    let mut walk = Walk {
        problem,
        latest_s,
        grids,
        best_j: f64::INFINITY,
    };
    walk.on(0, low[0], 0.0, 0.0);
    walk.best_j
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn no_path_of_a_grid_costs_less_than_the_bound(small in small()) {
        let car = small.car();
        let mut columns = small.columns();
        let free = Problem::new(StepModel::new(&car), Envelope::default(), columns.clone()).unwrap();
        let Answer::Plan(fastest) = plan(&free, Demand::Price(1e5), &Settings::default()).unwrap() else {
            return Ok(());
        };
        if let Some((node, from, long)) = small.light {
            let from_s = from * fastest.run.arrival_s[node];
            columns.signals = vec![Signal { node, green_s: vec![[from_s, from_s + long * fastest.run.time_s]] }];
        }
        let problem = Problem::new(StepModel::new(&car), Envelope::default(), columns).unwrap();
        let latest_s = small.slack * fastest.earliest_arrival_s + 1e-3;
        let (low, high) = (&problem.columns().min_mps, &problem.columns().max_mps);
        let brute_j = least_j(&problem, latest_s, low, high);
        match plan(&problem, Demand::Arrival(latest_s), &Settings::default()).unwrap() {
            Answer::Plan(found) => {
                assert_drivable(&problem, &found);
                prop_assert!(found.lower_bound_j <= brute_j + 1e-9 * found.run.energy_scale_j(),
                    "bound {} above {brute_j}", found.lower_bound_j);
                prop_assert!(found.lower_bound_j <= found.run.energy_j + 1e-9 * found.run.energy_scale_j());
            }
            Answer::Obstacle(obstacle) => prop_assert!(brute_j.is_infinite(), "{obstacle:?}, but {brute_j} J"),
        }
    }
}

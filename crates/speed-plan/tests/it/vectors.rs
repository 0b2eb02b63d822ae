//! Reference plans.

use ev_energy::StepModel;
use serde::Deserialize;
use speed_plan::{Answer, Arrival, Case, Demand, Obstacle, Problem, Settings, plan};

use crate::assert_drivable;
use crate::shared::shared;

#[derive(Deserialize)]
struct Vector {
    expect: Expect,
}

#[derive(Deserialize)]
struct Expect {
    outcome: String,
    energy_j: Option<f64>,
    time_s: Option<f64>,
    lower_bound_j: Option<f64>,
    earliest_arrival_s: Option<f64>,
    tolerance: Tolerance,
}

#[derive(Deserialize)]
struct Tolerance {
    energy_relative: f64,
    bound_relative: f64,
    time_s: f64,
}

#[test]
fn every_reference_plan_is_met() {
    let Some(folder) = shared("vectors/planning") else {
        return;
    };
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let case = Case::from_json(&text, &name).unwrap();
        let expect = serde_json::from_str::<Vector>(&text).unwrap().expect;
        let model = StepModel::new(&case.vehicle);
        let problem = Problem::new(model, case.envelope.clone(), case.columns.clone()).unwrap();
        let demand = case
            .latest_arrival_s
            .map_or(Demand::Price(0.0), Demand::Arrival);
        let within = |found: f64, wanted: f64, tolerance: f64| (found - wanted).abs() <= tolerance;
        match plan(&problem, demand, &Settings::default()).unwrap() {
            Answer::Plan(plan) => {
                assert_drivable(&problem, &plan);
                let outcome = if plan.arrival == Arrival::Early {
                    "early"
                } else {
                    "optimal"
                };
                assert_eq!(outcome, expect.outcome, "{name}");
                let (energy_j, bound_j) = (expect.energy_j.unwrap(), expect.lower_bound_j.unwrap());
                let tolerance_j = expect.tolerance.energy_relative * energy_j.abs();
                assert!(
                    within(plan.run.energy_j, energy_j, tolerance_j),
                    "{name}: {}",
                    plan.run.energy_j
                );
                let below_j = expect.tolerance.bound_relative * energy_j.abs();
                assert!(
                    plan.run.energy_j >= bound_j - below_j,
                    "{name}: {}",
                    plan.run.energy_j
                );
                // A bound is a bound on their plan too.
                assert!(
                    plan.lower_bound_j <= energy_j + below_j,
                    "{name}: {}",
                    plan.lower_bound_j
                );
                assert!(plan.gap_pct < 0.01, "{name}: {} %", plan.gap_pct);
                if outcome == "optimal" {
                    let time_s = expect.time_s.unwrap();
                    assert!(
                        within(plan.run.time_s, time_s, expect.tolerance.time_s),
                        "{name}: {}",
                        plan.run.time_s
                    );
                }
                if let Some(earliest_s) = expect.earliest_arrival_s {
                    assert!(within(plan.earliest_arrival_s, earliest_s, 1e-5), "{name}");
                }
            }
            Answer::Obstacle(Obstacle::TooLate { earliest_arrival_s }) => {
                assert_eq!(expect.outcome, "too_late", "{name}");
                assert!(within(
                    earliest_arrival_s,
                    expect.earliest_arrival_s.unwrap(),
                    expect.tolerance.time_s
                ));
            }
            Answer::Obstacle(obstacle) => panic!("{name}: {obstacle:?}"),
        }
    }
}

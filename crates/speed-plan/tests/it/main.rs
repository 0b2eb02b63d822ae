#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stderr,
    missing_docs
)]

mod bound_holds;
mod brute_force;
#[cfg(feature = "convex")]
mod convex;
mod outcomes;
mod roads;
#[path = "../../../../fixtures/shared.rs"]
mod shared;
mod vectors;

use ev_energy::Vehicle;
use speed_plan::{Answer, Demand, Plan, Problem, Road, Settings, plan};

fn vehicle(name: &str) -> Vehicle {
    Vehicle::builtin(name).unwrap()
}

fn planned(problem: &Problem, demand: Demand) -> Plan {
    match plan(problem, demand, &Settings::default()).unwrap() {
        Answer::Plan(plan) => *plan,
        Answer::Obstacle(obstacle) => panic!("{obstacle:?}"),
    }
}

/// A kilometre at 50 km/h.
fn kilometre() -> Road {
    Road {
        elevation: vec![(0.0, 0.0), (400.0, 8.0), (1000.0, 2.0)],
        ..Road::default()
    }
}

/// Limits and accelerations are kept, and times and energies add up.
fn assert_drivable(problem: &Problem, plan: &Plan) {
    let columns = problem.columns();
    let mut time_s = 0.0;
    let mut energy_j = 0.0;
    for k in 0..problem.nodes() {
        let v = plan.run.speed_mps[k];
        assert!(
            v <= columns.max_mps[k] * (1.0 + 1e-9) + 1e-9,
            "limit at node {k}: {v}"
        );
        assert!(
            (plan.run.arrival_s[k] - time_s).abs() < 1e-6 * (1.0 + time_s),
            "time at node {k}"
        );
        assert!(
            plan.run.stood_s[k] == 0.0 || v == 0.0,
            "stands at {v} m/s at node {k}"
        );
        time_s += plan.run.stood_s[k];
        energy_j += if plan.run.stood_s[k] > 0.0 {
            problem.standing_power_w(k) * plan.run.stood_s[k]
        } else {
            0.0
        };
        if k + 1 == problem.nodes() {
            break;
        }
        let next = plan.run.speed_mps[k + 1];
        let length_m = columns.position_m[k + 1] - columns.position_m[k];
        let accel = (next * next - v * v) / (2.0 * length_m);
        let allowed = allowed(problem, 0.5 * (v + next));
        assert!(
            allowed[0] - 1e-6 <= accel && accel <= allowed[1] + 1e-6,
            "step {k}: {accel} m/s²"
        );
        time_s += 2.0 * length_m / (v + next);
        energy_j += plan.run.step_energy_j[k];
    }
    assert!((plan.run.energy_j - energy_j).abs() < 1e-6 * plan.run.energy_scale_j());
    assert!((plan.run.time_s - time_s).abs() < 1e-6);
    for signal in &columns.signals {
        let leaves_s = plan.run.arrival_s[signal.node] + plan.run.stood_s[signal.node];
        let green =
            |window: &[f64; 2]| window[0] - 1e-5 <= leaves_s && leaves_s <= window[1] + 1e-5;
        assert!(
            signal.green_s.iter().any(green),
            "red at node {}: {leaves_s} s",
            signal.node
        );
    }
    for (k, earliest_s) in columns.earliest_s.iter().enumerate() {
        assert!(
            plan.run.arrival_s[k] >= earliest_s - 1e-5,
            "behind the leader at node {k}"
        );
    }
}

fn allowed(problem: &Problem, speed_mps: f64) -> [f64; 2] {
    let points = problem.envelope().points();
    let after = points.partition_point(|point| point.speed_mps <= speed_mps);
    let (Some(from), Some(to)) = (after.checked_sub(1).map(|k| points[k]), points.get(after))
    else {
        let point = points[after.min(points.len() - 1)];
        return [point.min_mps2, point.max_mps2];
    };
    let share = (speed_mps - from.speed_mps) / (to.speed_mps - from.speed_mps);
    [
        from.min_mps2 + share * (to.min_mps2 - from.min_mps2),
        from.max_mps2 + share * (to.max_mps2 - from.max_mps2),
    ]
}

//! Where a bound could be wrong: single motions, lights at stops and at the end, lights where standing is open.

use ev_energy::StepModel;
use speed_plan::{Columns, Demand, Envelope, EnvelopePoint, Plan, Problem, Signal};

use crate::{assert_drivable, planned, vehicle};

fn columns(lengths_m: &[f64], min_mps: &[f64], max_mps: &[f64]) -> Columns {
    let mut at = 0.0;
    let later = lengths_m.iter().map(|length_m| {
        at += length_m;
        at
    });
    Columns {
        position_m: std::iter::once(0.0).chain(later).collect(),
        slope_rad: vec![0.0; lengths_m.len()],
        min_mps: min_mps.to_vec(),
        max_mps: max_mps.to_vec(),
        dwell_s: vec![0.0; lengths_m.len() + 1],
        signals: Vec::new(),
        earliest_s: Vec::new(),
    }
}

fn plan_of(columns: Columns, envelope: Envelope, demand: Demand) -> Plan {
    let car = vehicle("b250e");
    let problem = Problem::new(StepModel::new(&car), envelope, columns).unwrap();
    let plan = planned(&problem, demand);
    assert_drivable(&problem, &plan);
    plan
}

#[test]
fn a_single_motion_costs_no_less_than_its_bound() {
    let table = Envelope::new(
        [(0.0, 1.5), (20.0, 0.8)]
            .map(|(speed_mps, max_mps2)| EnvelopePoint {
                speed_mps,
                min_mps2: -2.0,
                max_mps2,
            })
            .to_vec(),
    );
    for envelope in [Envelope::default(), table.unwrap()] {
        // Braked by friction: below the speed where regeneration begins.
        for speeds in [[1.0, 0.6], [8.0, 9.0], [0.0, 1.2], [1.2, 0.0]] {
            let columns = columns(&[1.0], &speeds, &speeds);
            let columns = if speeds[1] > 2.0 {
                Columns {
                    position_m: vec![0.0, 10.0],
                    ..columns
                }
            } else {
                columns
            };
            let plan = plan_of(columns, envelope.clone(), Demand::Price(1000.0));
            assert!(plan.gap_pct < 5.0, "{speeds:?}: {} %", plan.gap_pct);
            assert!(
                plan.lower_bound_j <= plan.run.energy_j + 1e-9 * plan.run.energy_scale_j(),
                "{speeds:?}: {} J of {} J",
                plan.lower_bound_j,
                plan.run.energy_j
            );
        }
    }
}

/// A road of 300 m with a stop of 20 s at 150 m.
fn with_a_stop() -> Columns {
    let lengths_m = [
        1.0, 9.0, 40.0, 60.0, 39.0, 1.0, 1.0, 9.0, 40.0, 60.0, 39.0, 1.0,
    ];
    let (mut min_mps, mut max_mps) = (vec![0.5; 13], vec![14.0; 13]);
    for still in [0, 6, 12] {
        (min_mps[still], max_mps[still]) = (0.0, 0.0);
    }
    let mut columns = columns(&lengths_m, &min_mps, &max_mps);
    columns.dwell_s[6] = 20.0;
    columns
}

#[test]
fn a_light_at_a_stop_is_left_at_green() {
    let free = plan_of(with_a_stop(), Envelope::default(), Demand::Price(2000.0));
    // Red when the car would leave, green three seconds later.
    let green_s = free.run.arrival_s[6] + 23.0;
    let mut columns = with_a_stop();
    columns.signals = vec![Signal {
        node: 6,
        green_s: vec![[green_s, 1000.0]],
    }];
    let plan = plan_of(columns, Envelope::default(), Demand::Price(2000.0));
    assert!((plan.run.arrival_s[6] + plan.run.stood_s[6] - green_s).abs() < 1e-3);
    assert!(plan.gap_pct < 0.1, "{} %", plan.gap_pct);
    // The free plan that stands for three seconds more is one of those that the bound speaks of.
    let car = vehicle("b250e");
    let waiting_j = 3.0 * StepModel::new(&car).standing_power_w(0.0);
    let cost_j = free.run.energy_j + waiting_j + 2000.0 * (free.run.time_s + 3.0);
    let bound_j = plan.lower_bound_j + 2000.0 * plan.run.time_s;
    assert!(
        bound_j <= cost_j + 1e-6 * cost_j,
        "{bound_j} J of {cost_j} J"
    );
    assert!(plan.run.energy_j + 2000.0 * plan.run.time_s <= cost_j * (1.0 + 1e-4));
}

#[test]
fn a_light_at_a_stop_does_not_count_the_stand_twice() {
    let free = plan_of(with_a_stop(), Envelope::default(), Demand::Price(2000.0));
    let green_s = free.run.arrival_s[6] + 23.0;
    let mut columns = with_a_stop();
    columns.signals = vec![Signal {
        node: 6,
        green_s: vec![[green_s, 1000.0]],
    }];
    // With the stand counted twice the arrival would be 20 s later.
    let latest_s = free.run.time_s + 4.0;
    let plan = plan_of(columns, Envelope::default(), Demand::Arrival(latest_s));
    assert!(plan.run.time_s <= latest_s + 1e-6);
}

#[test]
fn a_light_at_the_end_is_reached_at_green() {
    let free = plan_of(with_a_stop(), Envelope::default(), Demand::Price(2000.0));
    for offset_s in [-5.0, 4.0] {
        let mut columns = with_a_stop();
        columns.signals = vec![Signal {
            node: 12,
            green_s: vec![[free.run.time_s + offset_s, 1000.0]],
        }];
        let plan = plan_of(columns, Envelope::default(), Demand::Price(2000.0));
        assert!(plan.lower_bound_j <= plan.run.energy_j + 1e-9 * plan.run.energy_scale_j());
    }
}

#[test]
fn who_may_stand_at_one_light_is_not_too_early_for_the_next() {
    // Nobody may be slower than 8 m/s beyond the first light, which is green all the time and where the car may stand. The second is red for long.
    let lengths_m = [1.0, 1.0, 2.0, 4.0, 8.0, 16.0, 30.0, 30.0, 15.0];
    let mut min_mps = vec![1.0; 10];
    let max_mps = vec![1.5, 1.5, 14.0, 14.0, 14.0, 14.0, 14.0, 14.0, 14.0, 8.0];
    min_mps[0] = 1.5;
    (6..10).for_each(|node| min_mps[node] = 8.0);
    let mut columns = columns(&lengths_m, &min_mps, &max_mps);
    columns.signals = vec![
        Signal {
            node: 1,
            green_s: vec![[-1.0, 1000.0]],
        },
        Signal {
            node: 8,
            green_s: vec![[100.0, 1000.0]],
        },
    ];
    // After a stand at the second it could not be as fast as it has to be at the end.
    let plan = plan_of(columns, Envelope::default(), Demand::Arrival(300.0));
    assert!(plan.run.stood_s[1] > 50.0, "{:?}", plan.run.stood_s);
}

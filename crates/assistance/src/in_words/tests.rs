use ev_energy::{RoadStep, StepModel, Vehicle};

use super::*;

/// A run over nodes 20 m apart on a level road, as the car has it.
fn run(speed_mps: Vec<f64>) -> Nodes {
    let car = Vehicle::builtin("b250e").unwrap();
    let model = StepModel::new(&car);
    let step = RoadStep::new(20.0, 0.0);
    let points: Vec<_> = speed_mps
        .windows(2)
        .map(|ends| model.operating_point(&step, ends[0], ends[1]))
        .collect();
    let steps = points.len();
    Nodes {
        position_m: (0..=steps).map(|k| 20.0 * k as f64).collect(),
        arrival_s: vec![0.0; steps + 1],
        stood_s: vec![0.0; steps + 1],
        limit_mps: vec![30.0; steps + 1],
        slope_rad: vec![0.0; steps],
        force_n: points.iter().map(|point| point.wheel_force_n).collect(),
        effort: points
            .iter()
            .map(|point| Effort::of(point, car.effective_mass_kg()))
            .collect(),
        energy_j: points
            .iter()
            .map(|point| point.battery_power_w * 20.0 / point.speed_mps)
            .collect(),
        speed_mps,
    }
}

/// From one speed to another at a constant acceleration, no faster than `most_mps`, braking in time for `end_mps`.
fn over(
    steps: usize,
    [start_mps, most_mps, end_mps]: [f64; 3],
    [accel, brake]: [f64; 2],
) -> Vec<f64> {
    (0..=steps)
        .map(|k| {
            let (done_m, left_m) = (20.0 * k as f64, 20.0 * (steps - k) as f64);
            let speeding = (start_mps * start_mps + 2.0 * accel * done_m).sqrt();
            let slowing = (end_mps * end_mps + 2.0 * brake * left_m).sqrt();
            speeding.min(slowing).min(most_mps)
        })
        .collect()
}

#[test]
fn leaving_the_pedal_earlier_is_seen() {
    let own = run(over(50, [20.0, 20.0, 5.0], [1.0, 2.0]));
    let plan = run(over(50, [20.0, 20.0, 5.0], [1.0, 0.25]));
    let savings = savings_in_words(&plan, &own, 3);
    assert_eq!(savings.len(), 1);
    let Difference::LiftsOffEarlier { by_m } = savings[0].difference else {
        unreachable!("{savings:?}")
    };
    assert!((500.0..700.0).contains(&by_m), "{by_m}");
    assert!(
        savings[0].saved_j > 1e4 && savings[0].later_s > 0.0,
        "{savings:?}"
    );
    assert!(
        savings[0].words.ends_with("m earlier before km 1.00"),
        "{}",
        savings[0].words
    );
}

#[test]
fn a_slower_cruise_and_a_gentler_start_are_told_apart() {
    let own = run(vec![20.0; 151]);
    // Down by 5 m/s and up again, a tenth from node to node.
    let dip =
        |k: usize| f64::min(0.1 * (k as f64 - 20.0), 0.1 * (130.0 - k as f64)).clamp(0.0, 5.0);
    let slower = run((0..=150).map(|k| 20.0 - dip(k)).collect());
    let savings = savings_in_words(&slower, &own, 3);
    assert!(
        matches!(savings[0].difference, Difference::Slower { .. }),
        "{savings:?}"
    );
    assert!(
        (savings[0].from_m - 400.0).abs() < 50.0 && (savings[0].to_m - 2600.0).abs() < 50.0,
        "{savings:?}"
    );

    let own = run(over(30, [3.0, 15.0, 15.0], [1.3, 1.0]));
    let plan = run(over(30, [3.0, 15.0, 15.0], [0.6, 1.0]));
    // A gentle start need not save anything; this one is about its name.
    let pieces = pieces(&plan.speed_mps, &own.speed_mps);
    let [(from, to)] = pieces[..] else {
        unreachable!("{pieces:?}")
    };
    let saving = Piece {
        plan: &plan,
        own: &own,
        from,
        to,
    }
    .saving();
    assert_eq!(saving.difference, Difference::AcceleratesLess);
    assert_eq!(saving.words, "Accelerate less hard from km 0.00 on");
}

#[test]
fn pieces_end_where_speeds_meet_and_where_both_stand() {
    let own = vec![0.0, 5.0, 9.0, 9.0, 5.0, 0.0, 6.0, 9.0, 9.0];
    let plan = vec![0.0, 4.0, 8.0, 9.5, 6.0, 0.0, 5.0, 8.0, 9.0];
    assert_eq!(pieces(&plan, &own), [(0, 3), (3, 5), (5, 8)]);
    assert!(pieces(&own, &own).is_empty() && pieces(&[], &[]).is_empty());
    assert_eq!(pieces(&[10.0, 10.0], &[12.0, 12.0]), [(0, 1)]);
}

#[test]
fn energy_of_the_pieces_adds_up() {
    let own = run(over(80, [1.0, 20.0, 1.0], [1.5, 2.0]));
    let plan = run(over(80, [1.0, 18.0, 1.0], [1.0, 0.5]));
    let savings = savings_in_words(&plan, &own, 10);
    let sum = |run: &Nodes| run.energy_j.iter().sum::<f64>();
    let saved_j: f64 = savings.iter().map(|saving| saving.saved_j).sum();
    assert!(
        (saved_j - (sum(&own) - sum(&plan))).abs() < 1.0,
        "{savings:?}"
    );
}

#[test]
fn runs_over_other_nodes_say_nothing() {
    let own = run(over(50, [20.0, 20.0, 5.0], [1.0, 2.0]));
    let mut shifted = own.clone();
    shifted.position_m[3] += 1.0;
    assert!(savings_in_words(&shifted, &own, 3).is_empty());
    let mut short = own.clone();
    short.energy_j.pop();
    assert!(savings_in_words(&short, &own, 3).is_empty());
}

use ev_energy::Vehicle;

use super::*;

const STEP_S: f64 = 0.1;

/// From rest to a speed, held, down to another, held, and to rest, between stands of 5 s.
fn trip(fast_mps: f64, slow_mps: f64) -> Vec<f64> {
    let mut speed_mps = vec![0.0; 50];
    let mut to = |target: f64, accel: f64, hold_s: f64| {
        let mut v = speed_mps.last().copied().unwrap();
        while (target - v).abs() > 1e-9 {
            v += (target - v).clamp(-accel * STEP_S, accel * STEP_S);
            speed_mps.push(v);
        }
        speed_mps.extend(std::iter::repeat_n(target, (hold_s / STEP_S) as usize));
    };
    to(fast_mps, 1.5, 40.0);
    to(slow_mps, 2.0, 2.0);
    to(fast_mps, 1.5, 20.0);
    to(0.0, 2.0, 10.0);
    to(fast_mps, 1.5, 30.0);
    to(0.0, 2.0, 5.0);
    speed_mps
}

fn of(motion: &RecordedMotion) -> Result<Potential, NotPlanned> {
    let car = Vehicle::builtin("b250e").unwrap();
    let model = StepModel::new(&car);
    potential(
        motion,
        &model,
        &PotentialSettings::default(),
        &Settings::default(),
    )
}

fn motion(speed_mps: &[f64]) -> RecordedMotion<'_> {
    RecordedMotion {
        step_s: STEP_S,
        speed_mps,
        slope_rad: None,
        limit_mps: None,
    }
}

#[test]
fn a_hasty_trip_could_have_cost_less_in_its_own_time() {
    let speed_mps = trip(20.0, 8.0);
    let found = of(&motion(&speed_mps)).unwrap();
    assert!(
        (5.0..40.0).contains(&found.saving_pct()),
        "{}",
        found.saving_pct()
    );
    assert!(
        (0.0..0.02).contains(&found.gap_pct()),
        "{}",
        found.gap_pct()
    );
    assert!(found.lower_bound_j <= found.plan_energy_j);
    let driven_s = (speed_mps.len() - 1) as f64 * STEP_S;
    assert!((found.time_s - driven_s).abs() < 1e-9);
    assert_eq!(found.bound, Bound::Proven);
}

#[test]
fn stops_slow_points_and_speeds_near_by_are_kept() {
    let speed_mps = trip(20.0, 8.0);
    let legs = Legs::of(&motion(&speed_mps));
    assert_eq!(legs.stands.len(), 3);
    let columns = road::columns(&legs, &PotentialSettings::default()).unwrap();
    let stops: Vec<f64> = columns
        .dwell_s
        .iter()
        .copied()
        .filter(|dwell| *dwell > 0.0)
        .collect();
    // At the start and on the way; the last one lies beyond the arrival.
    assert_eq!(stops.len(), 2);
    assert!((stops[1] - 10.1).abs() < 0.3, "{stops:?}");
    assert!(columns.max_mps.iter().all(|max| *max <= 20.0));
    let low = columns
        .max_mps
        .iter()
        .filter(|max| (*max - 8.0).abs() < 1e-6)
        .count();
    assert_eq!(low, 1);
    let [from, to] = legs.around(400.0);
    assert!(to == from + 1 && legs.distance_m[from] <= 400.0 && 400.0 <= legs.distance_m[to]);
}

#[test]
fn limits_hold_but_where_the_driver_was_faster() {
    let speed_mps = trip(20.0, 8.0);
    let low_mps = vec![15.0; speed_mps.len()];
    let limited = RecordedMotion {
        limit_mps: Some(&low_mps),
        ..motion(&speed_mps)
    };
    let legs = Legs::of(&limited);
    let columns = road::columns(&legs, &PotentialSettings::default()).unwrap();
    for (at_m, max_mps) in columns.position_m.iter().zip(&columns.max_mps) {
        assert!(*max_mps <= legs.speed_at(*at_m).max(15.0) + 1e-9, "{at_m}");
    }
    let found = of(&limited).unwrap();
    assert!(
        (80.0..110.0).contains(&found.faster_than_limit_s),
        "{}",
        found.faster_than_limit_s
    );
    // What is allowed beside the recorded motion is less, and so is what can be saved.
    assert!(found.saving_pct() < of(&motion(&speed_mps)).unwrap().saving_pct());
}

#[test]
fn hills_are_climbed_as_recorded() {
    let speed_mps = trip(15.0, 10.0);
    let slope_rad: Vec<f64> = (0..speed_mps.len())
        .map(|k| 0.03 * (k as f64 / 200.0).sin())
        .collect();
    let hilly = RecordedMotion {
        slope_rad: Some(&slope_rad),
        ..motion(&speed_mps)
    };
    let legs = Legs::of(&hilly);
    let columns = road::columns(&legs, &PotentialSettings::default()).unwrap();
    let steps = columns.position_m.windows(2).zip(&columns.slope_rad);
    let climbed_m: f64 = steps
        .map(|(ends, slope)| (ends[1] - ends[0]) * slope.tan())
        .sum();
    let samples = legs.distance_m.windows(2).zip(slope_rad.windows(2));
    let recorded_m: f64 = samples
        .map(|(ends, slope)| (ends[1] - ends[0]) * (0.5 * (slope[0] + slope[1])).tan())
        .sum();
    assert!(
        (climbed_m - recorded_m).abs() < 0.05,
        "{climbed_m} {recorded_m}"
    );
    assert!(of(&hilly).unwrap().saving_pct() > 0.0);
}

#[test]
fn a_trip_between_moving_ends_is_planned_between_them() {
    let whole = trip(20.0, 8.0);
    let found = of(&motion(&whole[300..1100])).unwrap();
    assert!(found.saving_pct() > 0.0 && found.gap_pct() < 0.02);
}

#[test]
fn what_cannot_be_planned_says_why() {
    for (speed_mps, part) in [
        (vec![], "does not move"),
        (vec![0.0; 100], "does not move"),
        (vec![f64::NAN; 100], "speed_mps"),
        (vec![-3.0; 100], "does not move"),
        (vec![10.0; 100], "acceleration"),
    ] {
        let error = of(&motion(&speed_mps)).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    let speed_mps = trip(20.0, 8.0);
    let wrong = RecordedMotion {
        limit_mps: Some(&[10.0]),
        ..motion(&speed_mps)
    };
    assert!(of(&wrong).unwrap_err().to_string().contains("limit_mps"));
}

#[test]
fn trips_add_up() {
    let speed_mps = trip(20.0, 8.0);
    let one = of(&motion(&speed_mps)).unwrap();
    let mut two = one;
    two += one;
    assert!((two.saving_pct() - one.saving_pct()).abs() < 1e-9);
    assert!((two.distance_m - 2.0 * one.distance_m).abs() < 1e-9);
}

#[test]
fn a_piece_that_stands_costs_what_it_did() {
    let car = Vehicle::builtin("b250e").unwrap();
    let model = StepModel::new(&car);
    let (settings, search) = (PotentialSettings::default(), Settings::default());
    let of = |pieces: &[&[f64]]| {
        let pieces = pieces.iter().map(|speed_mps| motion(speed_mps));
        potential_of_pieces(pieces, &model, &settings, &search)
    };
    let (moving, standing) = (trip(20.0, 8.0), vec![0.0; 601]);
    let one = of(&[&moving]).unwrap();
    let both = of(&[&standing, &moving]).unwrap();
    let stood_j = 60.0 * model.standing_power_w(0.0);
    assert!((both.own_energy_j - one.own_energy_j - stood_j).abs() < 1.0);
    assert!((both.plan_energy_j - one.plan_energy_j - stood_j).abs() < 1.0);
    assert!(matches!(
        of(&[&standing, &standing]),
        Err(NotPlanned::Standing)
    ));
    assert!(matches!(of(&[]), Err(NotPlanned::Standing)));
}

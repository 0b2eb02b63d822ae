//! Laws that hold for any driver on any road, and logs from nowhere.

use drive_log::Channel;
use proptest::prelude::*;

use super::tests::{driver, log_of, stop};
use super::*;
use crate::road::*;

/// Table, line and laws anywhere in or near what a fit gives.
fn drivers() -> impl Strategy<Value = TripDriver> {
    let laws = (
        0.2..4.0_f64,
        0.3..4.0_f64,
        0.1..3.0_f64,
        0.0..1.0_f64,
        0.5..4.0_f64,
    );
    let habit = (-3.0..3.0_f64, -0.2..0.2_f64, 0.0..0.004_f64, 0.0..1.0_f64);
    (laws, habit).prop_map(
        |((a, a_max, c, gamma, b_max), (offset, per_limit, per_m, share))| {
            let mut driver = driver();
            driver.acceleration.scale_mps2 = a;
            driver.acceleration.max_mps2 = a_max;
            driver.braking.scale_mps2 = c;
            driver.braking.exponent = gamma;
            driver.braking.max_mps2 = b_max;
            driver.wanted.line.offset_mps = offset;
            driver.wanted.line.per_limit = per_limit;
            driver.slowdowns.per_m = per_m;
            driver.slowdowns.at_change_share = share;
            driver
        },
    )
}

fn maps() -> impl Strategy<Value = RoadMap> {
    let limits = proptest::collection::vec((1.0..400.0_f64, 1.0..45.0_f64), 1..12);
    let stops = proptest::collection::vec((0.0..1.0_f64, 0.0..30.0_f64), 0..6);
    let slow = proptest::collection::vec((0.0..1.0_f64, 0.3..30.0_f64), 0..6);
    (
        limits,
        stops,
        proptest::option::of(slow),
        0.0..40.0_f64,
        any::<bool>(),
    )
        .prop_map(|(limits, mut stops, slow, start_speed_mps, stands)| {
            let mut length_m = 0.0;
            let limits = limits.into_iter().map(|(m, limit_mps)| {
                let position_m = length_m;
                length_m += m;
                LimitFrom {
                    position_m,
                    limit_mps,
                }
            });
            let limits = limits.collect();
            stops.sort_by(|a, b| a.0.total_cmp(&b.0));
            RoadMap {
                length_m,
                start_speed_mps: if stands { 0.0 } else { start_speed_mps },
                limits,
                stops: stops
                    .into_iter()
                    .map(|(s, dwell_s)| stop(s * length_m, dwell_s))
                    .collect(),
                slow_points: slow.map(|points| {
                    let point = |(s, speed_mps): (f64, f64)| SlowPoint {
                        position_m: s * length_m,
                        speed_mps,
                    };
                    points.into_iter().map(point).collect()
                }),
                slope: vec![],
            }
        })
}

/// Every event looks all the way back.
fn plain_ceiling(driver: &TripDriver, road: &Road, cap_mps: &[f64]) -> Vec<f64> {
    let wanted: Vec<f64> = road
        .limit_mps()
        .iter()
        .map(|&l| driver.wanted().mps(l))
        .collect();
    let mut ceiling: Vec<f64> = wanted.iter().zip(cap_mps).map(|(w, c)| w.min(*c)).collect();
    for q in 1..ceiling.len() {
        let lower = (wanted[q] < wanted[q - 1] - 0.01).then_some(wanted[q]);
        for u in [Some(cap_mps[q]), lower].into_iter().flatten() {
            if wanted[q - 1] - u > 0.01 {
                let d = driver.braking().mps2(wanted[q - 1] - u);
                for (i, v) in ceiling[..q].iter_mut().enumerate() {
                    *v = v.min((u * u + 2.0 * d * (q - i) as f64).sqrt());
                }
            }
        }
    }
    ceiling
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn plans_keep_to_limits_caps_and_laws(driver in drivers(), map in maps()) {
        let road = Road::new(map).unwrap();
        let mut cap_mps = road.cap_mps().to_vec();
        road.cap_at(&driver.expected_slowdowns(&road), &mut cap_mps);
        let plan = driver.plan(&road, &cap_mps);
        let ceiling = plain_ceiling(&driver, &road, &cap_mps);
        let (a_max, b_max) = (
            driver.acceleration().max_mps2.min(driver.acceleration().scale_mps2),
            // A drop of the wanted speed by 0.01 m/s is no event.
            driver.braking().max_mps2 + 0.01 * 60.0,
        );
        for (k, v) in plan.iter().enumerate() {
            prop_assert!(*v >= 0.0 && *v <= ceiling[k] + 1e-9);
            prop_assert!(road.dwell_s()[k] == 0.0 || *v == 0.0);
            let Some(next) = plan.get(k + 1) else { break };
            let accel_mps2 = (next * next - v * v) / (2.0 * road.spacing_m());
            prop_assert!(accel_mps2 <= a_max + 1e-9, "{accel_mps2} > {a_max} at {k}");
            prop_assert!(accel_mps2 >= -b_max - 1e-9, "{accel_mps2} < -{b_max} at {k}");
            prop_assert!(v + next > 0.0, "stands for ever at {k}");
            // Where it does not accelerate as the law says, the ceiling is the reason.
            let wanted = driver.wanted().mps(road.limit_mps()[k]);
            let free = 2.0 * driver.acceleration().mps2(*v, wanted) * road.spacing_m();
            let held = (next - ceiling[k + 1]).abs() < 1e-9;
            prop_assert!(held || (next * next - v * v - free).abs() < 1e-6);
        }
    }

    #[test]
    fn runs_never_reverse_and_keep_to_the_laws(driver in drivers(), map in maps(), step_s in 0.05..2.0_f64) {
        let road = Road::new(map).unwrap();
        let run = driver.drive(&road, step_s, None).unwrap();
        let (a_max, b_max) = (
            driver.acceleration().max_mps2.min(driver.acceleration().scale_mps2),
            driver.braking().max_mps2 + 0.01 * 60.0,
        );
        prop_assert!(run.position_m[0] == 0.0 && run.speed_mps.iter().all(|v| *v >= 0.0));
        for (v, s) in run.speed_mps.windows(2).zip(run.position_m.windows(2)) {
            let accel_mps2 = (v[1] - v[0]) / step_s;
            prop_assert!((-b_max - 1e-6..=a_max + 1e-6).contains(&accel_mps2), "{accel_mps2}");
            prop_assert!(s[1] >= s[0]);
        }
        let last_m = *run.position_m.last().unwrap();
        prop_assert!(last_m <= (road.nodes() - 1) as f64 * road.spacing_m());
        prop_assert!(run.end_s - step_s * (run.speed_mps.len() - 1) as f64 <= step_s + 1e-6);
    }

    #[test]
    fn hostile_logs_never_panic(
        rows in proptest::collection::vec(
            ((prop_oneof![8 => 0.0..40.0_f64, 1 => Just(-3.0), 1 => Just(0.0), 1 => Just(1e300)], 0.6..60.0_f64), 1..40_usize),
            1..30,
        ),
        step_s in prop_oneof![Just(0.1), Just(1.0), Just(7.0), Just(0.01)],
    ) {
        let rows: Vec<(f64, f64)> = rows.into_iter().flat_map(|(row, n)| vec![row; n]).collect();
        let (speed, limit) = rows.into_iter().unzip();
        let log = log_of(vec![(Channel::Speed, speed), (Channel::SpeedLimit, limit)], step_s);
        let Ok(driver) = TripDriver::fit(&[&log]) else { return Ok(()) };
        let json = serde_json::to_string(&driver).unwrap();
        prop_assert_eq!(&serde_json::from_str::<TripDriver>(&json).unwrap(), &driver);
        for knowledge in [RoadKnowledge::Stops, RoadKnowledge::StopsAndSlowdowns] {
            let road = Road::of_motion(&log, knowledge).unwrap();
            let run = driver.drive(&road, 0.5, None).unwrap();
            prop_assert!(run.end_s.is_finite() && run.speed_mps.iter().all(|v| *v >= 0.0));
        }
    }
}

//! How a driver holds a speed.

use drive_log::{Channel, DriveLog};
use driver_eval::HoldOut;
use driver_eval::cruise::evaluate_cruise;
use driver_model::Error;
use driver_model::cruise::{CruiseModel, CruiseSettings, CruiseStretch, cruise_stretches};
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::support::motion_of;

const STEP_S: f64 = 0.1;
const BIAS: f64 = 1.2;
const SPREAD: f64 = 0.5;
const DEVIATION: f64 = 0.4;
const CORRELATION_S: f64 = 6.0;

/// A standard normal number, near enough: the sum of twelve uniform ones.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// A log of one stretch around 90 km/h by the model itself, every step of which stays calm.
fn log(random: &mut ChaCha8Rng, limit: bool) -> DriveLog {
    let (n, level) = (600, 25.0 + BIAS + SPREAD * normal(random));
    let decay = (-STEP_S / CORRELATION_S).exp();
    let mut x = DEVIATION * normal(random);
    let speed: Vec<f64> = (0..n)
        .map(|_| {
            x = decay * x + DEVIATION * (1.0 - decay * decay).sqrt() * normal(random);
            level + x
        })
        .collect();
    let mut channels = vec![(Channel::Speed, speed)];
    if limit {
        channels.push((Channel::SpeedLimit, vec![25.0; n]));
    }
    DriveLog::new("cruise", 0.0, STEP_S, channels.into_iter().collect()).unwrap()
}

/// The process is rougher than a car, so that every acceleration counts as calm here.
const CALM: CruiseSettings = CruiseSettings {
    accel_threshold_mps2: 100.0,
    least_speed_mps: 5.0,
    min_duration_s: 10.0,
};

/// Stretches of so many trips, five logs each.
fn stretches(seed: u64, limit: bool, trips: usize) -> (Vec<CruiseStretch>, HoldOut) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut stretches, mut names) = (Vec::new(), Vec::new());
    for k in 0..5 * trips {
        let found = cruise_stretches(&motion_of(&log(&mut random, limit)), &CALM);
        names.extend(found.iter().map(|_| format!("trip {}", k / 5)));
        stretches.extend(found);
    }
    (stretches, HoldOut::by_unit(&names))
}

fn fit((stretches, _): &(Vec<CruiseStretch>, HoldOut)) -> CruiseModel {
    CruiseModel::fit(&stretches.iter().collect::<Vec<_>>()).unwrap()
}

#[test]
fn bias_spread_deviation_and_correlation_are_found_again() {
    let model = fit(&stretches(1, true, 40));
    let bias = model.bias.unwrap();
    assert!((bias.mean_mps - BIAS).abs() < 0.1, "{model:?}");
    assert!((bias.spread_mps - SPREAD).abs() < 0.1, "{model:?}");
    assert!((model.deviation_mps - DEVIATION).abs() < 0.04, "{model:?}");
    assert!(
        (model.correlation_time_s / CORRELATION_S - 1.0).abs() < 0.3,
        "{model:?}"
    );
    assert_eq!(model.random_walk_mps(), None);
}

#[test]
fn without_limits_there_is_no_bias_and_the_variation_is_the_same() {
    let (with, without) = (fit(&stretches(2, true, 20)), fit(&stretches(2, false, 20)));
    assert_eq!(without.bias, None);
    assert_eq!(without.deviation_mps, with.deviation_mps);
    assert_eq!(without.speed_mps(20.0, None, 5.0), 20.0);
}

#[test]
fn a_limit_pulls_the_speed_and_the_band_holds_nine_tenths() {
    let (stretches, trips) = stretches(3, true, 30);
    let evaluation = evaluate_cruise(&stretches, &trips).unwrap();
    assert!(
        evaluation.cruise.rmse_mps < evaluation.hold.rmse_mps,
        "{evaluation:?}"
    );
    let held = evaluation.cruise.coverage_90_pct.unwrap();
    assert!((held - 90.0).abs() < 4.0, "{held}");
    assert!(evaluation.limit.unwrap().rmse_mps > evaluation.cruise.rmse_mps);
}

/// Mean and variance given the first speed, from the covariance of two normal numbers.
#[test]
fn the_prediction_is_the_conditional_distribution() {
    let model = fit(&stretches(4, true, 10));
    let bias = model.bias.unwrap();
    let (between, within) = (bias.spread_mps.powi(2), model.deviation_mps.powi(2));
    for t in [0.0_f64, 0.5, 3.0, 40.0] {
        let covariance = between + within * (-t / model.correlation_time_s).exp();
        let slope = covariance / (between + within);
        let level = 20.0 + bias.mean_mps;
        let mean = level + slope * (23.0 - level);
        let variance = between + within - slope * covariance;
        assert!((model.speed_mps(23.0, Some(20.0), t) - mean).abs() < 1e-12);
        assert!((model.std_mps(Some(20.0), t).powi(2) - variance).abs() < 1e-12);
    }
    assert_eq!(model.std_mps(None, 0.0), 0.0);
}

#[test]
fn a_stretch_ends_with_its_limit_its_calm_and_a_leader() {
    let n = 1000;
    let mut speed = vec![20.0; n];
    speed[600..].fill(26.0);
    let mut limit = vec![22.2; n];
    limit[300..].fill(27.8);
    let mut gap = vec![f64::NAN; n];
    gap[900..].fill(30.0);
    let channels = [
        (Channel::Speed, speed),
        (Channel::SpeedLimit, limit),
        (Channel::LeadGap, gap),
    ];
    let log = DriveLog::new("cut", 0.0, STEP_S, channels.into_iter().collect()).unwrap();
    let found = cruise_stretches(&motion_of(&log), &CruiseSettings::default());
    let spans: Vec<(f64, Option<f64>)> = found
        .iter()
        .map(|s| (s.start_s().round(), s.limit_mps()))
        .collect();
    assert_eq!(
        spans,
        [(0.0, Some(22.2)), (30.0, Some(27.8)), (61.0, Some(27.8))]
    );
    assert!(found[2].duration_s() < 30.0);
}

#[test]
fn nothing_to_learn_from_is_said_and_odd_logs_are_survived() {
    assert!(matches!(
        CruiseModel::fit(&[]),
        Err(Error::TooFewStretches { .. })
    ));
    let (one, trips) = stretches(5, true, 1);
    assert!(matches!(
        evaluate_cruise(&one, &trips),
        Err(driver_eval::Error::Model(Error::TooFewStretches { .. }))
    ));
    for speed in [vec![0.0; 3], vec![30.0; 2], vec![1e6, 20.0, 20.0, 20.0]] {
        let n = speed.len();
        let channels = [
            (Channel::Speed, speed),
            (Channel::SpeedLimit, vec![f64::NAN; n]),
        ];
        let log = DriveLog::new("odd", 0.0, 10.0, channels.into_iter().collect()).unwrap();
        let stretches = cruise_stretches(&motion_of(&log), &CruiseSettings::default());
        let _ = CruiseModel::fit(&stretches.iter().collect::<Vec<_>>());
    }
}

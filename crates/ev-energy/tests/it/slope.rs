//! Slope from elevation.

use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Error, slope_from_accelerometer, slope_from_elevation};
use proptest::prelude::*;

fn grid(step_m: f64, samples: u32) -> Vec<f64> {
    (0..samples).map(|i| step_m * f64::from(i)).collect()
}

#[test]
fn frozen_elevation_is_level() {
    let distance_m = grid(1.3, 500);
    let slope_rad =
        slope_from_elevation(&distance_m, &[431.7; 500], DEFAULT_SLOPE_BANDWIDTH_M).unwrap();
    assert!(slope_rad.iter().all(|&slope| slope == 0.0));
}

#[test]
fn a_straight_hill_is_exact_up_to_its_ends() {
    let distance_m = grid(1.3, 500);
    let elevation_m: Vec<f64> = distance_m.iter().map(|s| 431.7 - 0.07 * s).collect();
    for slope in slope_from_elevation(&distance_m, &elevation_m, DEFAULT_SLOPE_BANDWIDTH_M).unwrap()
    {
        assert!((slope - (-0.07_f64).atan()).abs() < 1e-9, "{slope}");
    }
}

#[test]
fn missing_elevations_are_bridged() {
    let distance_m = grid(2.0, 400);
    let mut elevation_m: Vec<f64> = distance_m.iter().map(|s| 0.03 * s).collect();
    elevation_m[..20].fill(f64::NAN);
    elevation_m[100..130].fill(f64::NAN);
    elevation_m[399] = f64::INFINITY;
    for slope in slope_from_elevation(&distance_m, &elevation_m, DEFAULT_SLOPE_BANDWIDTH_M).unwrap()
    {
        assert!((slope - 0.03_f64.atan()).abs() < 1e-9, "{slope}");
    }
}

#[test]
fn a_stop_changes_nothing_however_long() {
    let elevation = |s: f64| 5.0 * (s / 150.0).sin();
    let moving_m = grid(1.0, 800);
    let stopped_m: Vec<f64> = moving_m
        .iter()
        .flat_map(|&s| vec![s; if s == 400.0 { 3000 } else { 1 }])
        .collect();
    let slopes = |distance_m: &[f64]| {
        let elevation_m: Vec<f64> = distance_m.iter().map(|&s| elevation(s)).collect();
        slope_from_elevation(distance_m, &elevation_m, DEFAULT_SLOPE_BANDWIDTH_M).unwrap()
    };
    let (moving, stopped) = (slopes(&moving_m), slopes(&stopped_m));
    assert!(
        moving[..400]
            .iter()
            .zip(&stopped)
            .all(|(a, b)| (a - b).abs() < 1e-9)
    );
    assert!(
        moving[401..]
            .iter()
            .rev()
            .zip(stopped.iter().rev())
            .all(|(a, b)| (a - b).abs() < 1e-9)
    );
}

#[test]
fn a_sine_is_damped_as_the_derivative_of_lanczos_is() {
    // In the middle the gain for a wave number k is 3 (sin kb − kb cos kb)/(kb)³.
    let wave_number = std::f64::consts::TAU / 500.0;
    let distance_m = grid(0.5, 8000);
    let elevation_m: Vec<f64> = distance_m
        .iter()
        .map(|s| 3.0 * (wave_number * s).sin())
        .collect();
    let slope_rad = slope_from_elevation(&distance_m, &elevation_m, 100.0).unwrap();
    let kb = wave_number * 100.0;
    let gain = 3.0 * (kb.sin() - kb * kb.cos()) / kb.powi(3);
    let expected = (gain * 3.0 * wave_number * (wave_number * distance_m[4000]).cos()).atan();
    assert!(
        (slope_rad[4000] - expected).abs() < 1e-6,
        "{} and {expected}",
        slope_rad[4000]
    );
}

#[test]
fn without_distance_or_elevation_the_slope_is_zero() {
    let slope = |distance_m: &[f64], elevation_m: &[f64]| {
        slope_from_elevation(distance_m, elevation_m, 100.0).unwrap()
    };
    assert!(slope(&[], &[]).is_empty());
    assert_eq!(slope(&[5.0], &[100.0]), [0.0]);
    assert_eq!(slope(&[5.0, 5.0, 5.0], &[100.0, 101.0, 99.0]), [0.0; 3]);
    assert_eq!(slope(&[0.0, 50.0], &[f64::NAN; 2]), [0.0; 2]);
    assert_eq!(slope(&[0.0, 500.0], &[3.0, f64::NAN]), [0.0; 2]);
}

#[test]
fn a_long_stop_with_a_restless_receiver_is_level() {
    // within a metre there is no window: such points must not be searched for one by one
    let elevation_m: Vec<f64> = (0..200_000).map(|i| 500.0 + f64::from(i % 7)).collect();
    let distance_m: Vec<f64> = (0..200_000).map(|i| 1e-6 * f64::from(i)).collect();
    let slope_rad = slope_from_elevation(&distance_m, &elevation_m, 100.0).unwrap();
    assert!(slope_rad.iter().all(|slope| *slope == 0.0));
}

#[test]
fn bad_arguments_are_refused() {
    let length = slope_from_elevation(&[0.0, 1.0], &[0.0], 100.0).unwrap_err();
    assert!(
        matches!(
            length,
            Error::Length {
                channel: "elevation_m",
                ..
            }
        ),
        "{length}"
    );
    let nan = slope_from_elevation(&[0.0, f64::NAN], &[0.0; 2], 100.0).unwrap_err();
    assert!(matches!(nan, Error::Sample { index: 1, .. }), "{nan}");
    let bandwidth = slope_from_elevation(&[0.0], &[0.0], f64::NAN).unwrap_err();
    assert!(
        matches!(
            bandwidth,
            Error::Argument {
                name: "bandwidth_m",
                ..
            }
        ),
        "{bandwidth}"
    );
}

proptest! {
    #[test]
    fn slopes_are_finite_and_one_per_sample(
        samples in prop::collection::vec((0.0..30.0_f64, any::<f64>()), 0..200),
        scale in prop_oneof![Just(0.0), Just(1.0), Just(1e6)],
    ) {
        let mut travelled = 0.0;
        let distance_m: Vec<f64> = samples.iter().map(|(d, _)| { travelled += scale * d; travelled }).collect();
        let elevation_m: Vec<f64> = samples.iter().map(|(_, h)| h % 1e4).collect();
        let slope_rad = slope_from_elevation(&distance_m, &elevation_m, 100.0);
        if travelled <= 1e9 {
            let slope_rad = slope_rad.unwrap();
            prop_assert_eq!(slope_rad.len(), samples.len());
            prop_assert!(slope_rad.iter().all(|slope| slope.abs() <= std::f64::consts::FRAC_PI_2));
        }
    }
}

/// Root mean square of the error against a known gradient, away from the ends.
fn rms_error(slope_rad: &[f64], gradient: impl Fn(usize) -> f64) -> f64 {
    let middle = 300..slope_rad.len() - 300;
    let squares = middle
        .clone()
        .map(|i| (slope_rad[i].tan() - gradient(i)).powi(2));
    (squares.sum::<f64>() / middle.len() as f64).sqrt()
}

#[test]
fn whole_metres_and_held_fixes_are_read_as_such() {
    // 20 m up and down over 2 km: gradients to 3 %
    let distance_m = grid(1.0, 6000);
    let hill = |s: f64| 20.0 * (std::f64::consts::TAU * s / 4000.0).sin();
    let gradient = |i: usize| {
        20.0 * std::f64::consts::TAU / 4000.0
            * (std::f64::consts::TAU * distance_m[i] / 4000.0).cos()
    };
    let slope = |elevation: &dyn Fn(usize) -> f64| {
        let elevation_m: Vec<f64> = (0..6000).map(elevation).collect();
        slope_from_elevation(&distance_m, &elevation_m, 100.0).unwrap()
    };
    let rounded = slope(&|i| hill(distance_m[i]).round());
    assert!(rms_error(&rounded, gradient) < 0.0035);
    let held = slope(&|i| hill(distance_m[i / 300 * 300]));
    assert!(rms_error(&held, gradient) < 0.003);
}

#[test]
fn outliers_are_left_out() {
    let distance_m = grid(1.0, 3000);
    let mut elevation_m: Vec<f64> = distance_m.iter().map(|s| 400.0 + 0.02 * s).collect();
    let clean = slope_from_elevation(&distance_m, &elevation_m, 100.0).unwrap();
    for (at, height) in [(700, 40.0), (1500, -60.0), (2200, 15.0)] {
        elevation_m[at..at + 12]
            .iter_mut()
            .for_each(|h| *h += height);
    }
    let dirty = slope_from_elevation(&distance_m, &elevation_m, 100.0).unwrap();
    for (clean, dirty) in clean.iter().zip(&dirty) {
        assert!((clean - dirty).abs() < 1e-9, "{clean} and {dirty}");
    }
}

#[test]
fn an_accelerometer_sees_what_elevation_does_not() {
    // a bridge of 4 m over 200 m on a road that climbs 1 %; elevation in whole metres without the bridge, an accelerometer with
    // an offset and noise
    let step_s = 0.1;
    let speed = |i: usize| 14.0 + 3.0 * (i as f64 / 80.0).sin();
    let speed_mps: Vec<f64> = (0..9000).map(speed).collect();
    let mut distance_m = vec![0.0];
    for v in speed_mps.windows(2) {
        distance_m.push(distance_m[distance_m.len() - 1] + 0.5 * (v[0] + v[1]) * step_s);
    }
    let gradient = |s: f64| {
        let bridge: f64 = match s % 2000.0 {
            x if x < 100.0 => 0.04,
            x if x < 200.0 => -0.04,
            _ => 0.0,
        };
        0.01 + bridge
    };
    let accelerometer_mps2: Vec<f64> = (0..9000)
        .map(|i| {
            let accel = 3.0 / 80.0 / step_s * (i as f64 / 80.0).cos();
            let noise = 0.3 * (i as f64 * 1.7).sin();
            accel + 9.81 * gradient(distance_m[i]).atan().sin() + 0.15 + noise
        })
        .collect();
    let elevation_m: Vec<f64> = distance_m.iter().map(|s| (0.01 * s).round()).collect();
    let by_elevation = slope_from_elevation(&distance_m, &elevation_m, 50.0).unwrap();
    let by_both = slope_from_accelerometer(
        step_s,
        &speed_mps,
        &accelerometer_mps2,
        Some(&elevation_m),
        50.0,
    )
    .unwrap();
    let truth = |i: usize| gradient(distance_m[i]);
    let (alone, both) = (rms_error(&by_elevation, truth), rms_error(&by_both, truth));
    assert!(both < 0.5 * alone, "{both} and {alone}");
    let mean = by_both.iter().sum::<f64>() / by_both.len() as f64;
    assert!((mean - 0.01).abs() < 1e-3, "the offset is gone: {mean}");
    let level =
        slope_from_accelerometer(step_s, &speed_mps, &accelerometer_mps2, None, 50.0).unwrap();
    assert!(level.iter().sum::<f64>().abs() / (level.len() as f64) < 2e-3);
}

/// Out on a road of this slope, and back in reverse.
fn out_and_back(slope: f64) -> (Vec<f64>, Vec<f64>) {
    let place_m: Vec<f64> = (0..400)
        .map(|k| 0.5 * f64::from(200 - i32::abs(200 - k)))
        .collect();
    let elevation_m = place_m.iter().map(|s| 431.7 + slope * s).collect();
    (place_m, elevation_m)
}

#[test]
fn a_car_that_backs_up_is_on_the_same_road() {
    let (place_m, elevation_m) = out_and_back(0.04);
    let slopes = slope_from_elevation(&place_m, &elevation_m, 20.0).unwrap();
    for (place_m, slope) in place_m.iter().zip(slopes) {
        assert!(
            (slope - 0.04_f64.atan()).abs() < 1e-9,
            "{slope} at {place_m} m"
        );
    }
}

#[test]
fn noise_around_standstill_changes_no_slope() {
    let standing = 100.0 + 0.001 * f64::from(3);
    let noise = |k: i32| standing - 0.001 * f64::from(k % 7);
    let before = (0..100).map(f64::from);
    let after = (101..200).map(f64::from);
    let place_m: Vec<f64> = before.chain((0..600).map(noise)).chain(after).collect();
    let elevation_m: Vec<f64> = place_m.iter().map(|s| 0.02 * s).collect();
    for slope in slope_from_elevation(&place_m, &elevation_m, 20.0).unwrap() {
        assert!((slope - 0.02_f64.atan()).abs() < 1e-6, "{slope}");
    }
}

#[test]
fn an_accelerometer_feels_the_same_slope_forwards_and_backwards() {
    let speed_mps: Vec<f64> = (0..800)
        .map(|k| 5.0 * (f64::from(k) / 400.0 * std::f64::consts::PI).sin())
        .collect();
    let step_s = 0.1;
    let feels = |k: usize| {
        let next = (k + 1).min(speed_mps.len() - 1);
        let before = k.saturating_sub(1);
        (speed_mps[next] - speed_mps[before]) / ((next - before) as f64 * step_s)
            + 9.80665 * 0.03_f64.sin()
    };
    let accelerometer_mps2: Vec<f64> = (0..speed_mps.len()).map(feels).collect();
    let place = speed_mps.windows(2).scan(0.0, |place_m, v| {
        *place_m += 0.5 * (v[0] + v[1]) * step_s;
        Some(*place_m)
    });
    let elevation_m: Vec<f64> = std::iter::once(0.0)
        .chain(place)
        .map(|s| s * 0.03_f64.tan())
        .collect();
    let slopes = slope_from_accelerometer(
        step_s,
        &speed_mps,
        &accelerometer_mps2,
        Some(&elevation_m),
        20.0,
    )
    .unwrap();
    for slope in slopes {
        assert!((slope - 0.03).abs() < 2e-3, "{slope}");
    }
}

//! Slope from elevation.

use ev_energy::{DEFAULT_SLOPE_BANDWIDTH_M, Error, slope_from_elevation};
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
    let back = slope_from_elevation(&[0.0, 2.0, 1.0], &[0.0; 3], 100.0).unwrap_err();
    assert!(
        matches!(
            back,
            Error::Sample {
                channel: "distance_m",
                index: 2,
                ..
            }
        ),
        "{back}"
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

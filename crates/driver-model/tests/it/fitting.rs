//! Fits recover what made the data, stay inside their bounds, and say what they lack.

use driver_model::phase_model::{Constant, Exponential, Inverse, Profile, RiseTime};
use driver_model::{AccelPoint, Error, Phase, TrainingSet};
use proptest::prelude::*;

use crate::support::{curve_of, line, plain_set};

fn means(accel: impl Fn(f64) -> f64) -> Vec<AccelPoint> {
    (0..40)
        .map(|i| f64::from(i) * 0.8)
        .map(|v| AccelPoint::new(v, accel(v)))
        .collect()
}

proptest! {
    #[test]
    fn inverse_is_recovered(p1 in 0.001..0.3f64, p2 in 0.2..5.0f64) {
        let fit = Inverse::fit(&means(|v| 1.0 / (p1 * v + p2))).unwrap();
        prop_assert!((fit.p1 - p1).abs() < 1e-5, "{} {}", fit.p1, p1);
        prop_assert!((fit.p2 - p2).abs() < 1e-5, "{} {}", fit.p2, p2);
    }

    #[test]
    fn printed_exponential_is_recovered(p1 in 0.01..0.5f64, p2 in 0.0..2.0f64) {
        let fit = Exponential::fit_printed(&means(|v| (-p1 * v).exp() + p2)).unwrap();
        prop_assert!((fit.p1 - p1).abs() < 1e-5 && (fit.p2 - p2).abs() < 1e-5, "{fit:?}");
    }

    #[test]
    fn exponential_with_amplitude_is_recovered(p0 in 0.5..3.0f64, p1 in 0.03..0.4f64, p2 in 0.0..1.0f64) {
        let fit = Exponential::fit_with_amplitude(&means(|v| p0 * (-p1 * v).exp() + p2)).unwrap();
        prop_assert!((fit.p0 - p0).abs() < 1e-4, "{fit:?}");
        prop_assert!((fit.p1 - p1).abs() < 1e-4, "{fit:?}");
        prop_assert!((fit.p2 - p2).abs() < 1e-4, "{fit:?}");
    }

    /// At an interior optimum the gradient vanishes; at a bound it points outward.
    #[test]
    fn inverse_meets_the_optimality_conditions(points in prop::collection::vec((0.0..35.0f64, 0.1..3.0f64), 5..60)) {
        let weighted: Vec<AccelPoint> = points.iter().map(|&(v, a)| AccelPoint::new(v, a)).collect();
        let fit = Inverse::fit(&weighted).unwrap();
        let (mut g1, mut g2, mut scale) = (0.0, 0.0, 0.0);
        for &(v, a) in &points {
            let model = 1.0 / (fit.p1 * v + fit.p2);
            g1 -= (model - a) * v * model * model;
            g2 -= (model - a) * model * model;
            scale += a.abs() * v.max(1.0) * model * model;
        }
        let slack = 1e-5 * scale;
        let met = |g: f64, p: f64, low: f64, high: f64| {
            g.abs() <= slack || (p <= low + 1e-6 && g > 0.0) || (p >= high - 1e-6 && g < 0.0)
        };
        prop_assert!(met(g1, fit.p1, 0.0, 1.0), "{fit:?}: gradient {g1} of {scale}");
        prop_assert!(met(g2, fit.p2, 0.05, 20.0), "{fit:?}: gradient {g2} of {scale}");
    }

    #[test]
    fn exponentials_meet_the_optimality_conditions(
        p0 in 0.5..3.0f64, p1 in 0.03..0.4f64, p2 in 0.0..1.0f64,
        scatter in prop::collection::vec((0.0..35.0f64, -0.3..0.3f64), 20..100),
    ) {
        let scattered = |&(v, off): &(f64, f64)| AccelPoint::new(v, p0 * (-p1 * v).exp() + p2 + off);
        let points: Vec<AccelPoint> = scatter.iter().map(scattered).collect();
        let free = Exponential::fit_with_amplitude(&points).unwrap();
        let printed = Exponential::fit_printed(&points).unwrap();
        for (fit, amplitude_is_free) in [(free, true), (printed, false)] {
            let (mut g, mut scale) = ([0.0; 3], [0.0; 3]);
            for point in &points {
                let e = (-fit.p1 * point.speed_mps).exp();
                let residual = fit.p0 * e + fit.p2 - point.accel_mps2;
                let gradient = [e, -point.speed_mps * fit.p0 * e, 1.0];
                for i in 0..3 {
                    g[i] += residual * gradient[i];
                    scale[i] += point.accel_mps2.abs() * gradient[i].abs();
                }
            }
            let met = |i: usize, p: f64, low: f64, high: f64| {
                g[i].abs() <= 1e-5 * scale[i] || (p <= low + 1e-6 && g[i] > 0.0) || (p >= high - 1e-6 && g[i] < 0.0)
            };
            prop_assert!(!amplitude_is_free || met(0, fit.p0, 0.0, 10.0), "{fit:?}: {g:?} of {scale:?}");
            prop_assert!(met(1, fit.p1, 0.0, 2.0), "{fit:?}: {g:?} of {scale:?}");
            prop_assert!(met(2, fit.p2, -1.0, 5.0), "{fit:?}: {g:?} of {scale:?}");
        }
    }
}

#[test]
fn acceleration_that_grows_with_speed_ends_at_the_bound() {
    let fit = Inverse::fit(&means(|v| 0.5 + 0.02 * v)).unwrap();
    assert!(fit.p1 < 1e-6, "{fit:?}");
}

#[test]
fn too_little_to_learn_from_is_said() {
    assert!(matches!(
        Inverse::fit(&[AccelPoint::new(1.0, 1.0)]),
        Err(Error::TooFewPhases {
            found: 1,
            needed: 2,
            ..
        })
    ));
    let nothing = TrainingSet::default();
    assert!(matches!(
        Profile::fit(&nothing),
        Err(Error::TooFewPhases { .. })
    ));
    assert!(matches!(
        RiseTime::fit(&nothing, RiseTime::RISE_TIME_CONSTANTS),
        Err(Error::TooFewPhases { .. })
    ));
    let message = Constant::fit(&nothing).unwrap_err().to_string();
    assert!(
        message.contains("constant") && message.contains("shorter"),
        "{message}"
    );
}

fn outline(start_kmh: f64, end_kmh: f64, duration_s: f64) -> Phase {
    Phase {
        start_speed_mps: start_kmh / 3.6,
        end_speed_mps: end_kmh / 3.6,
        step_s: 0.1,
        samples: (duration_s / 0.1).round() as usize + 1,
        onset: None,
        input: driver_model::DriverInput::default(),
    }
}

#[test]
fn rise_time_takes_the_mean_of_the_group_or_else_of_the_nearest() {
    let curves = [
        outline(0.0, 40.0, 5.0),
        outline(10.0, 30.0, 7.0),
        outline(60.0, 120.0, 20.0),
    ]
    .map(line);
    let model = RiseTime::fit(&plain_set(&curves), RiseTime::RISE_TIME_CONSTANTS).unwrap();
    let (own, is_own) = model.constant_for(outline(0.0, 20.0, 3.0).group());
    assert!((own - 6.0 / 5.0).abs() < 1e-12 && is_own);
    let (near, is_own) = model.constant_for(outline(110.0, 130.0, 3.0).group());
    assert!((near - 4.0).abs() < 1e-12 && !is_own);
}

#[test]
fn profile_of_one_phase_reproduces_it() {
    let speed: Vec<f64> = (0..=80)
        .map(|k| f64::from(k) / 80.0)
        .map(|s| 3.0 + 9.0 * s * s * (3.0 - 2.0 * s))
        .collect();
    let curve = curve_of(speed.clone());
    let model = Profile::fit(&plain_set(std::slice::from_ref(&curve))).unwrap();
    for (k, &v) in speed.iter().enumerate() {
        let found = model.speed_mps(3.0, 12.0, k as f64 / 80.0);
        assert!((found - v).abs() < 2e-3, "sample {k}: {found} against {v}");
    }
}

//! Fits recover what made the data, stay inside their bounds, and say what they lack.

use driver_model::phase_model::{Constant, Exponential, Inverse, Profile, RiseTime};
use driver_model::{Error, PhaseCurve, PhaseOutline};
use proptest::prelude::*;

fn means(accel: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    (0..40)
        .map(|i| f64::from(i) * 0.8)
        .map(|v| (v, accel(v)))
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
        let fit = Inverse::fit(&points).unwrap();
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
}

#[test]
fn acceleration_that_grows_with_speed_ends_at_the_bound() {
    let fit = Inverse::fit(&means(|v| 0.5 + 0.02 * v)).unwrap();
    assert!(fit.p1 < 1e-6, "{fit:?}");
}

#[test]
fn too_little_to_learn_from_is_said() {
    assert!(matches!(
        Inverse::fit(&[(1.0, 1.0)]),
        Err(Error::TooFewPhases {
            found: 1,
            needed: 2,
            ..
        })
    ));
    assert!(matches!(Profile::fit(&[]), Err(Error::TooFewPhases { .. })));
    assert!(matches!(
        RiseTime::fit(&[]),
        Err(Error::TooFewPhases { .. })
    ));
    let message = Constant::fit(&[]).unwrap_err().to_string();
    assert!(
        message.contains("constant") && message.contains("--min-duration"),
        "{message}"
    );
}

fn outline(start_kmh: f64, end_kmh: f64, duration_s: f64) -> PhaseOutline {
    PhaseOutline {
        start_speed_mps: start_kmh / 3.6,
        end_speed_mps: end_kmh / 3.6,
        step_s: 0.1,
        samples: (duration_s / 0.1).round() as usize + 1,
    }
}

#[test]
fn rise_time_takes_the_mean_of_the_group_or_else_of_the_nearest() {
    let model = RiseTime::fit(&[
        outline(0.0, 40.0, 5.0),
        outline(10.0, 30.0, 7.0),
        outline(60.0, 120.0, 20.0),
    ])
    .unwrap();
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
    let model = Profile::fit(&[&curve]).unwrap();
    for (k, &v) in speed.iter().enumerate() {
        let found = model.speed_mps(3.0, 12.0, k as f64 / 80.0);
        assert!((found - v).abs() < 2e-3, "sample {k}: {found} against {v}");
    }
}

fn curve_of(speed_mps: Vec<f64>) -> PhaseCurve {
    use drive_log::{Channel, DriveLog};
    use driver_model::{Phase, PhaseKind};
    let end = speed_mps.len();
    let channels = [(Channel::Speed, speed_mps)].into_iter().collect();
    let log = DriveLog::new("curve", 0.0, 0.1, channels).unwrap();
    let phase = Phase {
        start: 0,
        end,
        kind: PhaseKind::Acceleration,
        lead_influenced: false,
    };
    PhaseCurve::cut(&log, None, &phase).unwrap()
}

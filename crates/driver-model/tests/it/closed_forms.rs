//! Closed-form speeds against numerical integration of the acceleration they solve.

use driver_model::phase_model::{Exponential, Inverse, RiseTime};
use proptest::prelude::*;

/// Runge–Kutta of fourth order, 20,000 steps: backwards the acceleration may change within a tenth of a second.
fn integrate(v0: f64, duration_s: f64, accel: impl Fn(f64) -> f64) -> f64 {
    let steps = 20_000;
    let h = duration_s / f64::from(steps);
    (0..steps).fold(v0, |v, _| {
        let k1 = accel(v);
        let k2 = accel(v + 0.5 * h * k1);
        let k3 = accel(v + 0.5 * h * k2);
        let k4 = accel(v + h * k3);
        v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    })
}

fn assert_close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
        "{found} against {expected}"
    );
}

proptest! {
    #[test]
    fn inverse_solves_its_equation(
        p1 in 0.0..0.5f64, p2 in 0.2..5.0f64, v0 in 0.0..30.0f64, t in 0.0..30.0f64,
    ) {
        let model = Inverse { p1, p2 };
        assert_close(model.speed_mps(v0, t), integrate(v0, t, |v| 1.0 / (p1 * v + p2)));
    }

    #[test]
    fn exponential_solves_its_equation(
        p0 in 0.0..3.0f64, p1 in 0.0..0.5f64, p2 in -0.5..1.0f64, v0 in 0.0..30.0f64, t in 0.0..30.0f64,
    ) {
        let model = Exponential { p0, p1, p2 };
        assert_close(model.speed_mps(v0, t), integrate(v0, t, |v| p0 * (-p1 * v).exp() + p2));
    }

    #[test]
    fn exponential_is_continuous_where_its_formula_degenerates(v0 in 0.0..30.0f64, t in 0.0..30.0f64) {
        for (p1, p2) in [(0.0, 0.3), (1e-13, 0.3), (1e-9, 0.3), (0.1, 0.0), (0.1, 1e-12)] {
            let model = Exponential { p0: 1.0, p1, p2 };
            let expected = integrate(v0, t, |v| (-p1 * v).exp() + p2);
            assert_close(model.speed_mps(v0, t), expected);
        }
    }

    /// The corners that a fit may end in; deceleration towards the equilibrium `−ln(−p2/p0)/p1` included.
    #[test]
    fn exponential_holds_over_all_of_its_bounds(
        p0 in 0.0..=10.0f64, p1 in 0.0..=2.0f64, p2 in -1.0..=5.0f64, v0 in 0.0..60.0f64, t in 0.0..120.0f64,
    ) {
        let found = Exponential { p0, p1, p2 }.speed_mps(v0, t);
        let expected = integrate(v0, t, |v| p0 * (-p1 * v).exp() + p2);
        prop_assert!((found - expected).abs() <= 1e-4 * expected.abs().max(1.0), "{found} against {expected}");
    }

    #[test]
    fn rise_time_starts_at_rest_relative_to_its_start(
        tc in 0.5..5.0f64, v0 in 0.0..30.0f64, gain in 1.0..20.0f64,
    ) {
        let speed = |t| RiseTime::speed_mps(tc, v0, v0 + gain, t);
        prop_assert_eq!(speed(0.0), v0);
        let slope = (speed(1e-6) - v0) / 1e-6;
        prop_assert!(slope.abs() < 1e-4);
        // 95.96 % at 5 T_c, and exactly 95 % at 4.7439 T_c.
        assert_close(((speed(5.0 * tc) - v0) / gain * 1e4).round(), 9596.0);
        prop_assert!(((speed(4.7439 * tc) - v0) / gain - 0.95).abs() < 1e-5);
    }

    /// In reversed time, down to standstill; below it the acceleration stays that of standstill.
    #[test]
    fn inverse_solves_its_equation_in_reversed_time(
        p1 in 0.0..0.5f64, p2 in 0.2..5.0f64, v0 in 0.0..40.0f64, t in 0.0..60.0f64,
    ) {
        let expected = integrate(v0, -t, |v| 1.0 / (p1 * v.max(0.0) + p2));
        assert_stops(Inverse { p1, p2 }.speed_mps(v0, -t), expected);
    }

    #[test]
    fn exponential_solves_its_equation_in_reversed_time(
        p0 in 0.0..3.0f64, p1 in 0.0..0.5f64, p2 in -0.5..1.0f64, v0 in 0.0..40.0f64, t in 0.0..60.0f64,
    ) {
        let expected = integrate(v0, -t, |v| p0 * (-p1 * v.max(0.0)).exp() + p2);
        assert_stops(Exponential { p0, p1, p2 }.speed_mps(v0, -t), expected);
    }

    #[test]
    fn exponential_in_reversed_time_is_continuous_where_its_formula_degenerates(v0 in 0.0..30.0f64, t in 0.0..30.0f64) {
        for (p1, p2) in [(0.0, 0.3), (1e-13, 0.3), (1e-9, 0.3), (0.1, 0.0), (0.1, 1e-12), (0.1, -1e-12)] {
            let expected = integrate(v0, -t, |v| (-p1 * v.max(0.0)).exp() + p2);
            assert_stops(Exponential { p0: 1.0, p1, p2 }.speed_mps(v0, -t), expected);
        }
    }

    #[test]
    fn inverse_in_reversed_time_becomes_a_line_as_p1_vanishes(p2 in 0.2..5.0f64, v0 in 0.0..30.0f64, t in -30.0..30.0f64) {
        let line = v0 + t / p2;
        for p1 in [0.0, 1e-300, 1e-16, 1e-13] {
            assert_close(Inverse { p1, p2 }.speed_mps(v0, t), line);
        }
    }

    /// Value and slope, from either side.
    #[test]
    fn speed_is_continuous_where_time_turns(
        p0 in 0.0..3.0f64, p1 in 0.0..0.5f64, p2 in 0.2..1.0f64, v0 in 0.0..30.0f64,
    ) {
        let (inverse, exponential) = (Inverse { p1, p2 }, Exponential { p0, p1, p2 });
        let meets = |speed: &dyn Fn(f64) -> f64, accel: f64| {
            prop_assert_eq!(speed(0.0), v0);
            for t in [1e-4, -1e-4] {
                let slope = (speed(t) - v0) / t;
                prop_assert!((slope - accel).abs() < 1e-3 * accel.max(1.0), "{slope} {accel}");
            }
            Ok(())
        };
        meets(&|t| inverse.speed_mps(v0, t), 1.0 / (p1 * v0 + p2))?;
        meets(&|t| exponential.speed_mps(v0, t), p0 * (-p1 * v0).exp() + p2)?;
    }
}

/// The same speed, or both at standstill.
fn assert_stops(found: f64, expected: f64) {
    assert!(found.is_finite());
    if expected > 0.0 {
        assert_close(found, expected);
    } else {
        assert!(found <= 1e-9, "{found} after standstill");
    }
}

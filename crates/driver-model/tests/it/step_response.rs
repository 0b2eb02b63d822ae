//! Step responses: closed forms, and constants found again from curves.

use driver_model::phase_model::{RiseTime, StepCharacteristics, StepResponse};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// The chain of lags `T_i ẋ_i = x_(i−1) − x_i` behind a unit step, by Runge and Kutta.
fn integrated(constants: &[f64], t_s: f64) -> f64 {
    let steps = 4000;
    let h = t_s / f64::from(steps);
    let slope = |x: &[f64]| -> Vec<f64> {
        let input = |i: usize| if i == 0 { 1.0 } else { x[i - 1] };
        (0..x.len())
            .map(|i| (input(i) - x[i]) / constants[i])
            .collect()
    };
    let moved = |x: &[f64], k: &[f64], h: f64| -> Vec<f64> {
        x.iter().zip(k).map(|(x, k)| x + h * k).collect()
    };
    let mut x = vec![0.0; constants.len()];
    for _ in 0..steps {
        let k1 = slope(&x);
        let k2 = slope(&moved(&x, &k1, 0.5 * h));
        let k3 = slope(&moved(&x, &k2, 0.5 * h));
        let k4 = slope(&moved(&x, &k3, h));
        for i in 0..x.len() {
            x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    x[constants.len() - 1]
}

#[test]
fn closed_forms_are_those_of_the_chain_of_lags() {
    for t in [0.1, 1.0, 4.0, 20.0] {
        for (t1_s, t2_s) in [
            (0.5, 3.0),
            (1.0, 1.2),
            (0.01, 2.0),
            (2.0, 2.0 + 1e-9),
            (1.5, 1.5),
        ] {
            let found = StepResponse::Distinct { t1_s, t2_s }.share(t);
            let expected = integrated(&[t1_s, t2_s], t);
            assert!(
                (found - expected).abs() < 1e-7,
                "{t1_s} {t2_s} at {t}: {found} {expected}"
            );
        }
        for order in 2..=StepResponse::HIGHEST_ORDER {
            let response = StepResponse::Equal {
                order,
                time_constant_s: 0.7,
            };
            let expected = integrated(&vec![0.7; usize::from(order)], t);
            assert!(
                (response.share(t) - expected).abs() < 1e-7,
                "order {order} at {t}"
            );
        }
    }
}

#[test]
fn the_thesis_reaches_96_pct_at_the_rise_time_and_the_exact_constant_95() {
    let at_end = |constants: f64| {
        let response = StepResponse::Equal {
            order: 2,
            time_constant_s: 10.0 / constants,
        };
        response.share(10.0)
    };
    assert!((at_end(RiseTime::RISE_TIME_CONSTANTS) - 0.9596).abs() < 1e-4);
    assert!((at_end(RiseTime::EXACT_RISE_TIME_CONSTANTS) - 0.95).abs() < 1e-12);
    assert_eq!(StepResponse::of_rise_time(10.0).share(10.0), at_end(5.0));
}

/// A response from 5 to 15 m/s at 10 Hz, until it has settled.
fn curve(response: StepResponse, noise_mps: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut speeds: Vec<f64> = (0..1200)
        .map(|k| response.speed_mps(5.0, 15.0, 0.1 * f64::from(k)))
        .map(|v| v + noise_mps * 2.0 * (random.random::<f64>() - 0.5))
        .collect();
    // The gain is read off the ends.
    (speeds[0], speeds[1199]) = (5.0, 15.0);
    speeds
}

fn identified(response: StepResponse, noise_mps: f64) -> StepResponse {
    let characteristics = StepCharacteristics::of(0.1, &curve(response, noise_mps)).unwrap();
    StepResponse::identify(&characteristics).unwrap()
}

#[test]
fn constants_of_second_order_are_found_again_also_under_noise() {
    for (noise, tolerance_1, tolerance_2) in [(0.0, 0.02, 0.02), (0.02, 0.2, 0.08)] {
        for (t1, t2) in [(1.0, 6.0), (0.8, 9.0), (0.5, 5.0)] {
            let truth = StepResponse::Distinct { t1_s: t1, t2_s: t2 };
            let StepResponse::Distinct { t1_s, t2_s } = identified(truth, noise) else {
                panic!("{t1} and {t2} are distinct");
            };
            assert!(
                (t1_s / t1 - 1.0).abs() < tolerance_1,
                "{t1_s} for {t1}, noise {noise}"
            );
            assert!(
                (t2_s / t2 - 1.0).abs() < tolerance_2,
                "{t2_s} for {t2}, noise {noise}"
            );
        }
    }
}

/// Noise makes the steepest slope too steep, so that a high order may come out one too high.
#[test]
fn orders_and_constants_above_two_are_found_again_also_under_noise() {
    for (noise, highest, orders_off, tolerance) in [(0.0, 10, 0, 0.02), (0.02, 9, 1, 0.2)] {
        for order in 3..=highest {
            let truth = StepResponse::Equal {
                order,
                time_constant_s: 2.0,
            };
            let found = identified(truth, noise);
            assert!(
                found.order().abs_diff(order) <= orders_off,
                "{found:?} for {order}"
            );
            let StepResponse::Equal {
                time_constant_s, ..
            } = found
            else {
                panic!("order {order} has equal constants");
            };
            let off = (time_constant_s / 2.0 - 1.0).abs();
            assert!(
                off < tolerance,
                "order {order}: {time_constant_s}, noise {noise}"
            );
        }
    }
}

#[test]
fn what_is_no_rising_curve_is_not_identified() {
    let none = |speeds: &[f64]| StepCharacteristics::of(0.1, speeds).is_none();
    assert!(none(&[]) && none(&[1.0, 2.0]) && none(&[3.0; 50]));
    assert!(none(&[5.0, 4.0, 3.0, 2.0, 1.0, 0.0]));
    assert!(none(&[0.0, f64::NAN, 1.0, 2.0, 3.0, 4.0]));
    // Steepest at the beginning: a response of order 1, which no order from 2 on has.
    let first_order: Vec<f64> = (0..200)
        .map(|k| 1.0 - (-0.05 * f64::from(k)).exp())
        .collect();
    let characteristics = StepCharacteristics::of(0.1, &first_order).unwrap();
    assert!(characteristics.dead_time_s < 0.1 * characteristics.build_up_time_s);
    // So late that an order beyond the highest would be needed.
    let mut late = vec![0.0; 200];
    late.extend((0..20).map(|k| f64::from(k) / 19.0));
    let characteristics = StepCharacteristics::of(0.1, &late).unwrap();
    assert_eq!(StepResponse::identify(&characteristics), None);
}

proptest! {
    #[test]
    fn responses_rise_from_0_to_1(t1 in 0.01..5.0f64, ratio in 1.0..50.0f64, order in 2..=10u8, t in 0.0..500.0f64) {
        for response in [
            StepResponse::Distinct { t1_s: t1, t2_s: ratio * t1 },
            StepResponse::Equal { order, time_constant_s: t1 },
        ] {
            let (now, later) = (response.share(t), response.share(t + 0.1));
            prop_assert!((-1e-9..=1.0 + 1e-9).contains(&now), "{now}");
            prop_assert!(later >= now - 1e-9);
        }
    }

    #[test]
    fn nothing_that_is_measured_breaks_identification(speeds in prop::collection::vec(-1e3..1e3f64, 0..80)) {
        let characteristics = StepCharacteristics::of(0.1, &speeds);
        if let Some(response) = characteristics.as_ref().and_then(StepResponse::identify) {
            prop_assert!(response.share(1.0).is_finite());
        }
    }
}

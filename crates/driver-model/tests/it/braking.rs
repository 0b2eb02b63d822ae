//! Braking: acceleration in reversed time.

use driver_model::phase_model::{Profile, RiseTime};
use driver_model::{ModelKind, Onset, Phase, PhaseCurve, PhaseModel, Subject, TrainingSet};
use proptest::prelude::*;

use crate::support::{assorted, mirrored, plain_set, points_of};

fn brakings() -> Vec<PhaseCurve> {
    assorted(60).iter().map(mirrored).collect()
}

fn training(curves: &[PhaseCurve]) -> TrainingSet<'_> {
    let mut training = plain_set(curves);
    training.points.extend(points_of(curves));
    training
}

/// What a model promises of its first and last sample.
fn ends(kind: ModelKind) -> (bool, bool) {
    match kind {
        ModelKind::Inverse
        | ModelKind::Exponential
        | ModelKind::ExponentialAmplitude
        | ModelKind::Constant => (true, false),
        ModelKind::RiseTime | ModelKind::RiseTimeExact | ModelKind::TransitionPoint => {
            (false, true)
        }
        _ => (true, true),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_model_brakes_from_and_to_where_it_should(
        end in 0.0..25.0f64, loss in 0.5..30.0f64, samples in 2..400usize, accel in -4.0..2.0f64,
    ) {
        let curves = brakings();
        let training = training(&curves);
        let outline = Phase {
            start_speed_mps: end + loss,
            end_speed_mps: end,
            step_s: 0.1,
            samples,
            onset: Some(Onset { accel_mps2: accel, jerk_mps3: 2.0 * accel, previous_jerk_mps3: 0.0 }),
            input: driver_model::DriverInput::default(),
        };
        for kind in ModelKind::of(Subject::Phases) {
            if matches!(kind, ModelKind::TransitionPoint | ModelKind::ProfilePedal) {
                continue;
            }
            let model = PhaseModel::fit(kind, &training).unwrap();
            let speed = model.predict(&outline);
            prop_assert_eq!(speed.len(), samples);
            prop_assert!(speed.iter().all(|v| v.is_finite() && *v >= 0.0), "{} {:?}", kind, speed);
            let (starts, arrives) = ends(kind);
            prop_assert!(!starts || (speed[0] - end - loss).abs() < 1e-9, "{} {}", kind, speed[0]);
            let last = speed[samples - 1];
            prop_assert!(!arrives || (last - end).abs() < 1e-9, "{} {}", kind, last);
            if !matches!(kind, ModelKind::ProfileConditioned | ModelKind::ProfileOnset | ModelKind::Profile) {
                prop_assert!(speed.windows(2).all(|v| v[1] <= v[0] + 1e-12), "{} {:?}", kind, speed);
            }
        }
    }
}

/// Predictions of a braking and of its mirror, the latter in reversed time.
fn assert_mirrored(of_brakings: &PhaseModel, of_accelerations: &PhaseModel) {
    for braking in brakings() {
        let outline = braking.outline();
        let mut rising = of_accelerations.predict(&outline.rising());
        rising.reverse();
        for (a, b) in of_brakings.predict(&outline).into_iter().zip(rising) {
            assert!((a - b).abs() < 1e-12, "{a} and {b}");
        }
    }
}

#[test]
fn profile_and_rise_time_of_braking_are_those_of_the_mirrored_acceleration() {
    let (brakings, accelerations) = (brakings(), assorted(60));
    let (brakings, accelerations) = (plain_set(&brakings), plain_set(&accelerations));
    for constants in [
        RiseTime::RISE_TIME_CONSTANTS,
        RiseTime::EXACT_RISE_TIME_CONSTANTS,
    ] {
        let fit = |t| PhaseModel::RiseTime(RiseTime::fit(t, constants).unwrap());
        assert_eq!(fit(&brakings), fit(&accelerations));
        assert_mirrored(&fit(&brakings), &fit(&accelerations));
    }
    let fit = |t| PhaseModel::Profile(Profile::fit(t).unwrap());
    assert_mirrored(&fit(&brakings), &fit(&accelerations));
}

#[test]
fn braking_past_standstill_stands() {
    let outline = Phase {
        start_speed_mps: 5.0,
        end_speed_mps: 0.0,
        step_s: 0.1,
        samples: 600,
        onset: None,
        input: driver_model::DriverInput::default(),
    };
    let curves = brakings();
    let training = training(&curves);
    for kind in [
        ModelKind::Inverse,
        ModelKind::Exponential,
        ModelKind::ExponentialAmplitude,
        ModelKind::Constant,
    ] {
        let speed = PhaseModel::fit(kind, &training).unwrap().predict(&outline);
        assert_eq!(speed[599], 0.0, "{kind}");
        assert!(speed.is_sorted_by(|a, b| a >= b), "{kind}");
    }
}

//! Models that are told what the driver does.

use drive_log::{Channel, DriveLog};
use driver_model::{
    DriverChannel, Motion, PhaseCurve, PhaseKind, PhaseModel, Span, TrainingPhase, TrainingSet,
};

use crate::support::{STEP_S, motion_of};

/// A start from 2 to 14 m/s in 10 s that begins the faster the further the pedal is down; every other log has the pedal.
fn start(number: usize, has_pedal: bool) -> (Motion, PhaseCurve) {
    let pedal_pct = 20.0 + 60.0 * (number as f64 * 0.618).fract();
    let exponent = 2.0 - pedal_pct / 60.0;
    let speed = |k: usize| match k.checked_sub(20) {
        None => 2.0,
        Some(k) => 2.0 + 12.0 * (k as f64 / 100.0).powf(exponent),
    };
    let mut channels = vec![(Channel::Speed, (0..=120).map(speed).collect::<Vec<f64>>())];
    if has_pedal {
        let pedal = (0..=120).map(|k| if k < 19 { 10.0 } else { pedal_pct });
        channels.push((Channel::AcceleratorPedal, pedal.collect()));
    }
    let log = DriveLog::new("start", 0.0, STEP_S, channels.into_iter().collect()).unwrap();
    let motion = motion_of(&log);
    let span = Span {
        start: 20,
        end: 121,
        kind: PhaseKind::Acceleration,
        lead_influenced: false,
    };
    let curve = PhaseCurve::cut(&motion, &span).unwrap();
    (motion, curve)
}

fn curves(has_pedal: impl Fn(usize) -> bool) -> Vec<PhaseCurve> {
    (0..60).map(|k| start(k, has_pedal(k)).1).collect()
}

fn training(curves: &[PhaseCurve]) -> TrainingSet<'_> {
    let mut training = TrainingSet::default();
    training.phases.extend(
        curves
            .iter()
            .enumerate()
            .map(|(trip, curve)| TrainingPhase {
                curve,
                trip,
                weight: 1.0,
            }),
    );
    training
}

fn rmse_mps(model: &PhaseModel, curve: &PhaseCurve) -> f64 {
    let predicted = model.predict(&curve.outline());
    let squares = predicted
        .iter()
        .zip(curve.speed_mps())
        .map(|(p, v)| (p - v).powi(2));
    (squares.sum::<f64>() / curve.speed_mps().len() as f64).sqrt()
}

#[test]
fn the_pedal_tells_how_a_phase_goes_on_and_phases_without_are_predicted_as_by_the_onset() {
    // Three of four logs say where the pedal is.
    let curves = curves(|k| k % 4 != 0);
    let training = training(&curves);
    let fit = |kind| PhaseModel::fit(kind, &training).unwrap();
    let (pedal, onset) = (
        fit(driver_model::ModelKind::ProfilePedal),
        fit(driver_model::ModelKind::ProfileOnset),
    );
    let PhaseModel::ProfilePedal(profile) = &pedal else {
        panic!("a model that is told of the pedal");
    };
    assert_eq!(profile.channels, [DriverChannel::AcceleratorPedal]);

    let told = start(100, true).1;
    assert!(!pedal.falls_back(&told.outline()));
    assert!(rmse_mps(&pedal, &told) < 0.1, "{}", rmse_mps(&pedal, &told));
    let untold = start(100, false).1;
    assert!(pedal.falls_back(&untold.outline()));
    assert_eq!(
        pedal.predict(&untold.outline()),
        onset.predict(&untold.outline())
    );

    let text = serde_json::to_string(&pedal).unwrap();
    let read: PhaseModel = serde_json::from_str(&text).unwrap();
    assert!(read.check().is_ok());
    assert_eq!(
        read.predict(&told.outline()),
        pedal.predict(&told.outline())
    );
}

#[test]
fn without_the_pedal_there_is_nothing_to_fit() {
    let curves = curves(|_| false);
    let error = PhaseModel::fit(driver_model::ModelKind::ProfilePedal, &training(&curves));
    let text = error.unwrap_err().to_string();
    assert!(text.contains("what the driver does"), "{text}");
}

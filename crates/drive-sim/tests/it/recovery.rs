//! Without variation, noise and leaders models find the truth that made the drives.

use drive_log::{Channel, DriveLog};
use drive_sim::{SimulatedDriver, SynthSettings};
use driver_model::phase_model::{Exponential, Inverse, Profile, RiseTime};
use driver_model::{
    AccelPoint, ModelKind, Motion, Phase, PhaseCurve, PhaseKind, PhaseModel, Span, TrainingPhase,
    TrainingSet,
};

use crate::simulate::{complete_accelerations, curve, found, ideal, run};

/// Half the width of the usual band, 3 km/h.
const BAND_MPS: f64 = 1.5 / 3.6;

/// A straight line with this outline.
fn line(outline: Phase) -> PhaseCurve {
    let (from_mps, gain_mps) = (outline.start_speed_mps, outline.gain_mps());
    let last = (outline.samples - 1) as f64;
    let speed = |k: usize| from_mps + gain_mps * (k as f64 / last);
    let speed_mps = (0..outline.samples).map(speed).collect();
    let channels = [(Channel::Speed, speed_mps)].into_iter().collect();
    let log = DriveLog::new("log", 0.0, outline.step_s, channels).unwrap();
    let phase = Span {
        start: 0,
        end: outline.samples,
        kind: PhaseKind::Acceleration,
        lead_influenced: false,
    };
    PhaseCurve::cut(&Motion::of_log(&log, 100.0).unwrap(), &phase).unwrap()
}

fn set(curves: &[PhaseCurve]) -> TrainingSet<'_> {
    let mut training = TrainingSet::default();
    let phase = |(k, curve)| TrainingPhase {
        curve,
        trip: k / 10,
        weight: 1.0,
    };
    training.phases.extend(curves.iter().enumerate().map(phase));
    training
}

#[test]
fn the_true_model_predicts_every_complete_phase() {
    for kind in SimulatedDriver::KINDS {
        let settings = ideal(kind);
        let mut phases = 0;
        for drive in run(&settings) {
            for phase in complete_accelerations(&drive) {
                let truth = settings
                    .driver
                    .acceleration
                    .predict(&phase.outline(settings.step_s));
                let driven = &drive.log.speed_mps()[phase.start..phase.end];
                for (a, b) in truth.iter().zip(driven) {
                    // Half the resolution of the log; far inside a band of ±1.5 km/h.
                    assert!((a - b).abs() <= 0.51e-4, "{kind} {a} {b}");
                }
                phases += 1;
            }
        }
        assert!(phases > 40, "{kind} {phases}");
    }
}

#[test]
fn the_true_functions_stay_in_band_on_phases_as_they_are_found() {
    // Acceleration as a function of speed holds wherever a phase is cut; the others are told the ends of the cut.
    for kind in [
        ModelKind::Inverse,
        ModelKind::Exponential,
        ModelKind::ExponentialAmplitude,
        ModelKind::Constant,
    ] {
        let settings = ideal(kind);
        for drive in run(&settings) {
            for phase in found(&drive).phases_of(PhaseKind::Acceleration) {
                let truth = settings.driver.acceleration.predict(&phase.outline());
                for (a, b) in truth.iter().zip(phase.speed_mps()) {
                    assert!((a - b).abs() <= BAND_MPS, "{kind} {a} {b}");
                }
            }
        }
    }
}

/// As many steps as no phase has.
const WHOLE: usize = 10_000;

/// Mean speed and mean acceleration of pieces of so many steps, cut from complete phases; the last may be shorter.
fn means(settings: &SynthSettings, steps: usize) -> Vec<AccelPoint> {
    let mut means = Vec::new();
    for drive in run(settings) {
        for phase in complete_accelerations(&drive) {
            let last = phase.end - 1;
            for start in (phase.start..last).step_by(steps) {
                let end = (start + steps).min(last);
                let speed = &drive.log.speed_mps()[start..=end];
                let n = (end - start) as f64;
                let sum_mps: f64 = speed.windows(2).map(|v| 0.5 * (v[0] + v[1])).sum();
                let gain_mps = speed[end - start] - speed[0];
                means.push(AccelPoint::new(
                    sum_mps / n,
                    gain_mps / (n * settings.step_s),
                ));
            }
        }
    }
    means
}

fn assert_close(found: f64, truth: f64, relative: f64) {
    assert!(
        (found / truth - 1.0).abs() <= relative,
        "{found} is not {truth} within {relative}"
    );
}

#[test]
fn function_fits_find_the_truth_on_short_pieces() {
    // Over 1 s the mean acceleration differs from the acceleration at the mean speed by less than a percent.
    let inverse = ideal(ModelKind::Inverse);
    let PhaseModel::Inverse(truth) = &inverse.driver.acceleration else {
        unreachable!()
    };
    let fit = Inverse::fit(&means(&inverse, 10)).unwrap();
    assert_close(fit.p1, truth.p1, 0.01);
    assert_close(fit.p2, truth.p2, 0.01);

    let exponential = ideal(ModelKind::Exponential);
    let PhaseModel::Exponential(truth) = &exponential.driver.acceleration else {
        unreachable!()
    };
    let fit = Exponential::fit_printed(&means(&exponential, 10)).unwrap();
    assert_close(fit.p1, truth.p1, 0.01);
    assert_close(fit.p2, truth.p2, 0.01);

    let amplitude = ideal(ModelKind::ExponentialAmplitude);
    let PhaseModel::ExponentialAmplitude(truth) = &amplitude.driver.acceleration else {
        unreachable!()
    };
    let fit = Exponential::fit_with_amplitude(&means(&amplitude, 10)).unwrap();
    assert_close(fit.p0, truth.p0, 0.01);
    assert_close(fit.p1, truth.p1, 0.02);
    assert_close(fit.p2, truth.p2, 0.02);
}

#[test]
fn function_fits_come_near_the_truth_on_whole_phases() {
    // The mean acceleration of a whole phase is not the acceleration at its mean speed, however exact the fit.
    let inverse = ideal(ModelKind::Inverse);
    let PhaseModel::Inverse(truth) = &inverse.driver.acceleration else {
        unreachable!()
    };
    let fit = Inverse::fit(&means(&inverse, WHOLE)).unwrap();
    assert_close(fit.p1, truth.p1, 0.05);
    assert_close(fit.p2, truth.p2, 0.05);

    let exponential = ideal(ModelKind::Exponential);
    let PhaseModel::Exponential(truth) = &exponential.driver.acceleration else {
        unreachable!()
    };
    let fit = Exponential::fit_printed(&means(&exponential, WHOLE)).unwrap();
    assert_close(fit.p1, truth.p1, 0.06);
    assert_close(fit.p2, truth.p2, 0.06);

    let amplitude = ideal(ModelKind::ExponentialAmplitude);
    let PhaseModel::ExponentialAmplitude(truth) = &amplitude.driver.acceleration else {
        unreachable!()
    };
    let fit = Exponential::fit_with_amplitude(&means(&amplitude, WHOLE)).unwrap();
    assert_close(fit.p0, truth.p0, 0.05);
    assert_close(fit.p1, truth.p1, 0.15);
    assert_close(fit.p2, truth.p2, 0.15);
}

fn complete_curves(settings: &SynthSettings) -> Vec<PhaseCurve> {
    run(settings)
        .iter()
        .flat_map(|drive| {
            complete_accelerations(drive)
                .map(|p| curve(&drive.log, p))
                .collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn rise_time_finds_every_constant() {
    let settings = ideal(ModelKind::RiseTime);
    let PhaseModel::RiseTime(truth) = &settings.driver.acceleration else {
        unreachable!()
    };
    // The outlines tell the speeds aimed at, which the curves of this driver do not reach.
    let curves: Vec<PhaseCurve> = run(&settings)
        .iter()
        .flat_map(complete_accelerations)
        .map(|phase| line(phase.outline(settings.step_s)))
        .collect();
    let fit = RiseTime::fit(&set(&curves), RiseTime::RISE_TIME_CONSTANTS).unwrap();
    assert!(fit.groups.len() >= 4);
    for group in &fit.groups {
        let (truth_s, own) = truth.constant_for(group.group);
        assert!(own);
        assert!((group.time_constant_s - truth_s).abs() < 1e-9);
    }
}

#[test]
fn profile_finds_the_shape() {
    let settings = ideal(ModelKind::Profile);
    let PhaseModel::Profile(truth) = &settings.driver.acceleration else {
        unreachable!()
    };
    let curves = complete_curves(&settings);
    let fit = Profile::fit(&set(&curves)).unwrap();
    for (a, b) in fit.shape.iter().zip(&truth.shape) {
        // A curve of 30 samples is read between them.
        assert!((a - b).abs() < 2e-3, "{a} {b}");
    }
}

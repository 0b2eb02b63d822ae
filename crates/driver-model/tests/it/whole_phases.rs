//! Phases from where they begin to where they end.

use std::collections::BTreeMap;

use drive_log::{Channel, DriveLog};
use driver_model::segmentation::HeuristicRules;
use driver_model::{
    DriveBehaviour, Error, FitSettings, ModelKind, PhaseExtent, PhaseKind, PhaseSettings, Span,
    fit_with,
};
use proptest::prelude::*;

use crate::support::{STEP_S, log_of, motion_of};

/// Speed from rest with these accelerations, none below 0.
fn driven(accel_mps2: impl IntoIterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut speed_mps = vec![0.0];
    for (steps, accel_mps2) in accel_mps2 {
        for _ in 0..steps {
            let last = speed_mps[speed_mps.len() - 1];
            speed_mps.push(f64::max(0.0, last + STEP_S * accel_mps2));
        }
    }
    speed_mps
}

fn cut(log: &DriveLog) -> Vec<Span> {
    HeuristicRules::default().segment(log).unwrap().phases
}

fn whole(log: &DriveLog) -> Vec<Span> {
    HeuristicRules::default().whole_phases(log, &cut(log))
}

fn places(phases: &[Span]) -> Vec<(PhaseKind, usize, usize)> {
    phases.iter().map(|p| (p.kind, p.start, p.end)).collect()
}

/// 2 s standing; up gently, hard, gently to 16 m/s; 4 s of holding it; down gently, hard, gently to standstill.
fn there_and_back() -> Vec<f64> {
    driven([
        (20, 0.0),
        (40, 0.1),
        (100, 1.5),
        (60, 0.1),
        (40, 0.01),
        (40, -0.1),
        (100, -1.5),
        (64, -0.1),
        (30, 0.0),
    ])
}

#[test]
fn a_phase_begins_and_ends_where_the_car_starts_and_stops() {
    let log = log_of(there_and_back());
    use PhaseKind::{Acceleration, Braking};
    assert_eq!(
        places(&whole(&log)),
        [(Acceleration, 20, 221), (Braking, 260, 465)]
    );
    let speed_mps = log.speed_mps();
    assert!(speed_mps[20] < 1e-9 && speed_mps[464] < 1e-9);
    assert!(speed_mps[21] > 0.0 && speed_mps[463] > 0.0);
}

#[test]
fn phases_of_one_kind_that_meet_are_one_and_hesitation_parts_them() {
    let twice = |between| log_of(driven([(10, 0.0), (40, 1.0), (20, between), (40, 1.0)]));
    assert_eq!(places(&whole(&twice(0.1))).len(), 1);
    assert_eq!(
        places(&whole(&twice(0.04))),
        [
            (PhaseKind::Acceleration, 10, 51),
            (PhaseKind::Acceleration, 70, 111)
        ]
    );
}

fn behind(gap_m: impl Fn(usize) -> f64) -> DriveLog {
    let speed_mps = there_and_back();
    let gaps = (0..speed_mps.len()).map(gap_m).collect();
    let channels = BTreeMap::from([(Channel::Speed, speed_mps), (Channel::LeadGap, gaps)]);
    DriveLog::new("test", 0.0, STEP_S, channels).unwrap()
}

#[test]
fn a_leader_in_the_part_beyond_the_threshold_counts() {
    let of = |log: &DriveLog| {
        DriveBehaviour::of_drive(&[motion_of(log)], &PhaseSettings::default()).unwrap()
    };
    // 30 of the 201 samples of the acceleration, all after it has fallen below the threshold.
    let late = of(&behind(
        |k| if (185..215).contains(&k) { 5.0 } else { 500.0 },
    ));
    assert_eq!(late.lead_influenced.acceleration, 0);
    assert_eq!(late.whole_lead_influenced.acceleration, 1);
    assert_eq!((late.phases.len(), late.whole_phases.len()), (2, 1));
    // 12 of the 100 above the threshold are more than a tenth of these, but not of all 201.
    let middle = of(&behind(
        |k| if (120..132).contains(&k) { 5.0 } else { 500.0 },
    ));
    assert_eq!(middle.lead_influenced.acceleration, 1);
    assert_eq!(middle.whole_lead_influenced.acceleration, 1);
}

#[test]
fn onset_and_gain_are_those_of_the_whole_phase() {
    let motion = motion_of(&log_of(there_and_back()));
    let settings = PhaseSettings::default().reaching(PhaseExtent::Whole);
    let trip = DriveBehaviour::of_drive(&[motion], &settings).unwrap();
    assert_eq!(trip.phases, trip.whole_phases);
    let outline = trip.phases[0].outline();
    assert!((outline.gain_mps() - 16.0).abs() < 1e-9 && outline.samples == 201);
    assert!(outline.onset.unwrap().accel_mps2.abs() < 1e-12);
}

#[test]
fn models_of_whole_phases_differ_and_settings_are_checked() {
    let motions: Vec<_> = (0..3)
        .map(|_| motion_of(&log_of(there_and_back())))
        .collect();
    let fitted = |extent| {
        let settings = FitSettings {
            phases: PhaseSettings::default().reaching(extent),
            ..FitSettings::default()
        };
        fit_with(ModelKind::Profile, &motions, None, &settings, &|| {}).unwrap()
    };
    assert_ne!(
        fitted(PhaseExtent::Threshold).model,
        fitted(PhaseExtent::Whole).model
    );
    let settings = FitSettings {
        phases: PhaseSettings::default().reaching(PhaseExtent::Whole),
        ..FitSettings::default()
    };
    let refused = fit_with(ModelKind::Idm, &motions, None, &settings, &|| {});
    assert!(matches!(refused, Err(Error::NoPhases { .. })));
    for end_accel_mps2 in [0.0, -0.05, f64::NAN, f64::INFINITY] {
        let mut settings = PhaseSettings::default();
        settings.heuristic.end_accel_mps2 = end_accel_mps2;
        let refused = DriveBehaviour::of_drive(&motions, &settings);
        assert!(matches!(
            refused,
            Err(Error::Option {
                name: "end_accel_mps2",
                ..
            })
        ));
    }
}

#[test]
fn spans_outside_of_the_log_are_left_out() {
    let log = log_of(there_and_back());
    let rules = HeuristicRules::default();
    for (start, end) in [(0, 0), (5, 3), (0, 100_000), (usize::MAX, usize::MAX)] {
        let span = Span {
            start,
            end,
            kind: PhaseKind::Braking,
            lead_influenced: false,
        };
        assert_eq!(rules.whole_phases(&log, &[span]), []);
    }
}

/// Runs of accelerations on both sides of both thresholds.
fn drives() -> impl Strategy<Value = Vec<f64>> {
    let accel_mps2 = prop::sample::select(vec![
        -1.2, -0.3, -0.2, -0.06, -0.05, -0.04, 0.0, 0.04, 0.05, 0.06, 0.2, 0.3, 1.2,
    ]);
    prop::collection::vec((1..12usize, accel_mps2), 1..60).prop_map(driven)
}

proptest! {
    #[test]
    fn a_whole_phase_contains_the_phases_that_it_comes_from(speed_mps in drives()) {
        let log = log_of(speed_mps);
        let whole = whole(&log);
        for phase in cut(&log) {
            let around = whole.iter().filter(|w| {
                w.kind == phase.kind && w.start <= phase.start && phase.end <= w.end
            });
            let moves = matches!(phase.kind, PhaseKind::Acceleration | PhaseKind::Braking);
            prop_assert_eq!(around.count(), usize::from(moves));
        }
    }

    #[test]
    fn extension_is_idempotent_and_kinds_do_not_overlap(speed_mps in drives()) {
        let log = log_of(speed_mps);
        let whole = whole(&log);
        prop_assert_eq!(&HeuristicRules::default().whole_phases(&log, &whole), &whole);
        for kind in [PhaseKind::Acceleration, PhaseKind::Braking] {
            let own: Vec<_> = whole.iter().filter(|w| w.kind == kind).collect();
            prop_assert!(own.windows(2).all(|w| w[0].end <= w[1].start));
        }
        // Where braking follows acceleration at once they share the sample between them.
        prop_assert!(whole.windows(2).all(|w| w[0].end <= w[1].start + 1));
    }

    #[test]
    fn a_drive_backwards_has_the_same_phases_mirrored(speed_mps in drives()) {
        let samples = speed_mps.len();
        let forwards = whole(&log_of(speed_mps.clone()));
        let backwards = whole(&log_of(speed_mps.into_iter().rev().collect()));
        let mirror = |phase: &Span| {
            let kind = match phase.kind {
                PhaseKind::Acceleration => PhaseKind::Braking,
                _ => PhaseKind::Acceleration,
            };
            (kind, samples - phase.end, samples - phase.start)
        };
        let mirrored: Vec<_> = backwards.iter().rev().map(mirror).collect();
        prop_assert_eq!(places(&forwards), mirrored);
    }
}

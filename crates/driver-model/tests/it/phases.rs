//! Both routes to phases, and the leader's influence.

use std::collections::BTreeMap;
use std::path::Path;

use drive_log::{Channel, DriveLog, LayoutChoice, Preparation};
use driver_model::segmentation::{
    HeuristicRules, Scaling, StatisticalRules, dead_banded, lead_influenced,
};
use driver_model::{Onset, PhaseKind};

use crate::support::curve_from;

/// 5 s standing, 10 s at 1 m/s², 20 s holding, 5 s at −2 m/s².
fn log(lead_gap_m: Option<f64>) -> DriveLog {
    let mut speed = vec![0.0; 50];
    speed.extend((0..100).map(|k| f64::from(k) * 0.1));
    speed.extend([10.0; 200]);
    speed.extend((0..50).map(|k| 10.0 - f64::from(k) * 0.2));
    let mut channels = BTreeMap::new();
    if let Some(gap) = lead_gap_m {
        channels.insert(Channel::LeadGap, vec![gap; speed.len()]);
    }
    channels.insert(Channel::Speed, speed);
    DriveLog::new("test", 0.0, 0.1, channels).unwrap()
}

#[test]
fn heuristic_runs_follow_table_3_1() {
    let segmented = HeuristicRules::default().segment(&log(None)).unwrap();
    let kinds: Vec<_> = segmented
        .phases
        .iter()
        .map(|p| (p.kind, p.start, p.end))
        .collect();
    use PhaseKind::{Acceleration, Braking, Cruise, Other};
    assert_eq!(
        kinds,
        [
            (Other, 0, 50),
            (Acceleration, 50, 150),
            (Cruise, 150, 350),
            (Braking, 350, 400),
        ]
    );
}

#[test]
fn statistical_phases_partition_the_drive() {
    let log = log(None);
    let segmented = StatisticalRules::for_models().segment(&log).unwrap();
    let kinds: Vec<_> = segmented.phases.iter().map(|p| p.kind).collect();
    assert!(kinds.contains(&PhaseKind::Acceleration) && kinds.contains(&PhaseKind::Braking));
    assert!(kinds.contains(&PhaseKind::Cruise));
    assert_eq!(segmented.phases.first().unwrap().start, 0);
    assert_eq!(segmented.phases.last().unwrap().end, log.len());
    assert!(segmented.phases.windows(2).all(|w| w[0].end == w[1].start));
}

#[test]
fn the_scale_of_streams_is_half_the_ranges_of_the_wltc() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cycles/wltc-3b.csv");
    let raw = drive_log::read_file(&path, &LayoutChoice::Auto).unwrap();
    let cycle = raw.logs.into_iter().next().unwrap();
    let drive = drive_log::prepare(cycle, &Preparation::default()).unwrap();
    let log = &drive.pieces[0];
    let half_range = |values: &[f64]| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        (most - least) / 2.0
    };
    let banded = dead_banded(&log.accel_mps2(), 0.4).unwrap();
    assert_eq!(
        Scaling::WLTC,
        Scaling::Fixed {
            speed_mps: half_range(log.speed_mps()).round(),
            accel_mps2: (half_range(&banded) * 10.0).round() / 10.0,
        }
    );
}

#[test]
fn a_leader_influences_under_five_times_the_speed() {
    // At 10 m/s the limit is 50 m.
    assert!(lead_influenced(&log(Some(49.0)), 200..300));
    assert!(!lead_influenced(&log(Some(50.0)), 200..300));
    assert!(!lead_influenced(&log(Some(f64::NAN)), 200..300));
    assert!(!lead_influenced(&log(None), 200..300));
    // Standing, no gap is near.
    assert!(!lead_influenced(&log(Some(1.0)), 0..50));
}

#[test]
fn the_dead_band_is_strict() {
    assert_eq!(
        dead_banded(&[0.4, -0.4, 0.39, -0.39, 0.0], 0.4).unwrap(),
        [0.4, -0.4, 0.0, 0.0, 0.0]
    );
}

#[test]
fn an_onset_is_made_of_the_differences_before_the_phase() {
    let speed = vec![9.0, 1.0, 1.1, 1.25, 1.6, 2.6, 0.5, 7.0];
    let onset = curve_from(4, speed.clone()).outline().onset.unwrap();
    // Accelerations of 1, 1.5 and 3.5 m/s² lead to the first sample.
    let expected = Onset {
        accel_mps2: 3.5,
        jerk_mps3: 20.0,
        previous_jerk_mps3: 5.0,
    };
    for (found, expected) in [
        (onset.accel_mps2, expected.accel_mps2),
        (onset.jerk_mps3, expected.jerk_mps3),
        (onset.previous_jerk_mps3, expected.previous_jerk_mps3),
    ] {
        assert!((found - expected).abs() < 1e-9, "{onset:?}");
    }
    // Three samples are needed before the phase, and none of those in it but the first counts.
    assert_eq!(curve_from(2, speed.clone()).outline().onset, None);
    let mut later = speed.clone();
    later[5..].iter_mut().for_each(|v| *v += 3.0);
    assert_eq!(curve_from(4, later).outline().onset, Some(onset));
    assert!(curve_from(3, speed).outline().onset.is_some());
}

#[test]
fn the_rising_phase_of_braking_is_its_mirror_without_an_onset() {
    let braking = curve_from(3, vec![9.0, 9.0, 8.9, 8.5, 7.0, 6.0, 2.0]);
    let outline = braking.outline();
    assert!(outline.is_braking() && outline.onset.is_some());
    assert_eq!(braking.kind(), PhaseKind::Braking);
    let rising = outline.rising();
    assert_eq!((rising.start_speed_mps, rising.end_speed_mps), (2.0, 8.5));
    assert_eq!((rising.samples, rising.onset), (4, None));
    assert_eq!(*braking.rising_speed_mps(), [2.0, 6.0, 7.0, 8.5]);
    assert_eq!(rising.rising(), rising);
}

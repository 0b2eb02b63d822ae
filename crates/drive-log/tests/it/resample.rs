//! The grid.

use drive_log::{
    Action, Channel, DriveLog, Error, FindingKind, Preparation, Smoothing, forward_difference,
    hann, prepare,
};
use proptest::prelude::*;

use crate::{log, raw, same, ten_hertz};

fn unsmoothed() -> Preparation {
    Preparation {
        smooth: Smoothing::None,
        ..Preparation::default()
    }
}

#[test]
fn a_log_on_the_grid_passes_exactly() {
    let speed: Vec<f64> = (0..50).map(|i| (f64::from(i) * 0.37).sin().abs()).collect();
    // 0.1 + 0.1 + … is not 0.3 to the last bit; decimal text is not either
    let time_s: Vec<f64> = (0..50)
        .map(|i| format!("{}.{}", 100 + i / 10, i % 10).parse().unwrap())
        .collect();
    let drive = prepare(
        raw(time_s, [(Channel::Speed, speed.clone())]),
        &unsmoothed(),
    )
    .unwrap();
    assert_eq!(drive.pieces.len(), 1);
    assert_eq!(drive.pieces[0].speed_mps(), speed);
    assert_eq!((drive.pieces[0].t0_s(), drive.samples), (100.0, 50));
    assert!((drive.step_s - 0.1).abs() < 1e-12);
    assert!(drive.findings.is_empty());
}

#[test]
fn long_gaps_cut_and_short_ones_do_not() {
    let time_s = vec![0.0, 1.0, 2.0, 5.0, 6.0, 9.0];
    let drive = prepare(
        raw(
            time_s,
            [(Channel::Speed, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])],
        ),
        &unsmoothed(),
    )
    .unwrap();
    let pieces: Vec<(&str, f64, usize)> = drive
        .pieces
        .iter()
        .map(|p| (p.name(), p.t0_s(), p.len()))
        .collect();
    assert_eq!(pieces, [("log/1", 0.0, 21), ("log/2", 5.0, 11)]);
    let found: Vec<(FindingKind, f64, f64, Action)> = drive
        .findings
        .iter()
        .map(|f| (f.kind, f.from_s, f.to_s, f.action))
        .collect();
    assert_eq!(
        found,
        [
            (FindingKind::TimeGap, 2.0, 5.0, Action::Split),
            (FindingKind::TimeGap, 6.0, 9.0, Action::Split),
            (FindingKind::TooShort, 9.0, 9.0, Action::Dropped),
        ]
    );
}

#[test]
fn a_short_gap_is_reported_as_interpolated() {
    let drive = prepare(
        log("t,v\n0,1\n0.1,2\n0.2,3\n0.9,3\n1.0,4\n1.1,5\n"),
        &unsmoothed(),
    )
    .unwrap();
    assert_eq!(drive.pieces[0].len(), 12);
    assert_eq!(
        (drive.findings[0].kind, drive.findings[0].action),
        (FindingKind::TimeGap, Action::Interpolated)
    );
}

#[test]
fn missing_speed_is_bridged_like_missing_time() {
    let mut speed = vec![10.0; 100];
    speed[20..35].fill(f64::NAN);
    speed[50..80].fill(f64::NAN);
    let drive = prepare(
        raw(ten_hertz(100), [(Channel::Speed, speed)]),
        &unsmoothed(),
    )
    .unwrap();
    let lengths: Vec<usize> = drive.pieces.iter().map(DriveLog::len).collect();
    assert_eq!(lengths, [50, 20]);
}

#[test]
fn other_channels_miss_what_is_missing() {
    let mut elevation: Vec<f64> = (0..100).map(f64::from).collect();
    elevation[10..20].fill(f64::NAN);
    elevation[50..80].fill(f64::NAN);
    let channels = [
        (Channel::Speed, vec![10.0; 100]),
        (Channel::Elevation, elevation),
    ];
    let drive = prepare(raw(ten_hertz(100), channels), &unsmoothed()).unwrap();
    let elevation = drive.pieces[0].channel(Channel::Elevation).unwrap();
    assert!((elevation[15] - 15.0).abs() < 1e-9);
    assert!(
        elevation[49] == 49.0
            && elevation[50].is_nan()
            && elevation[79].is_nan()
            && elevation[80] == 80.0
    );
}

#[test]
fn a_speed_limit_holds() {
    let channels = [
        (Channel::Speed, vec![10.0; 3]),
        (Channel::SpeedLimit, vec![14.0, 14.0, 28.0]),
    ];
    let drive = prepare(raw(vec![0.0, 1.0, 2.0], channels), &unsmoothed()).unwrap();
    let limit = drive.pieces[0].channel(Channel::SpeedLimit).unwrap();
    assert_eq!((limit[19], limit[20]), (14.0, 28.0));
}

#[test]
fn raw_takes_a_uniform_log_as_it_is() {
    let options = Preparation {
        raw: true,
        ..Preparation::default()
    };
    let speed = vec![1.0, 9.0, 2.0];
    let drive = prepare(
        raw(vec![7.0, 7.5, 8.0], [(Channel::Speed, speed.clone())]),
        &options,
    )
    .unwrap();
    assert_eq!(
        (drive.pieces[0].speed_mps(), drive.pieces[0].step_s()),
        (speed.as_slice(), 0.5)
    );

    for (time_s, speed, index) in [
        (vec![0.0, 0.1, 0.25, 0.3], vec![1.0; 4], 2),
        (vec![0.0, 0.1, 0.2], vec![1.0, f64::NAN, 1.0], 1),
        (vec![0.0, 0.1, f64::NAN], vec![1.0; 3], 2),
        (vec![0.0, 0.0, 0.0], vec![1.0; 3], 1),
    ] {
        match prepare(raw(time_s, [(Channel::Speed, speed)]), &options) {
            Err(Error::NotUniform { index: found, .. }) => assert_eq!(found, index),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn options_without_meaning() {
    let log = || raw(vec![0.0, 1.0], [(Channel::Speed, vec![1.0; 2])]);
    for step_s in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            prepare(
                log(),
                &Preparation {
                    step_s,
                    ..unsmoothed()
                }
            ),
            Err(Error::Option { .. })
        ));
    }
    assert!(matches!(
        prepare(
            log(),
            &Preparation {
                max_gap_s: 0.0,
                ..unsmoothed()
            }
        ),
        Err(Error::Option { .. })
    ));
    assert!(matches!(
        prepare(
            log(),
            &Preparation {
                step_s: 1e-12,
                ..unsmoothed()
            }
        ),
        Err(Error::TooManySamples { .. })
    ));
}

#[test]
fn distance_is_the_area_under_the_speed() {
    let channels = [(Channel::Speed, vec![0.0, 2.0, 4.0])]
        .into_iter()
        .collect();
    let log = DriveLog::new("log", 0.0, 0.5, channels).unwrap();
    assert_eq!(log.distance_m(), [0.0, 0.5, 2.0]);
    assert_eq!(log.accel_mps2(), [4.0, 4.0, 4.0]);
    assert_eq!(log.time_s(2), 1.0);
}

#[test]
fn a_drive_is_checked() {
    let of = |speed: Vec<f64>| {
        DriveLog::new(
            "log",
            0.0,
            0.1,
            [(Channel::Speed, speed)].into_iter().collect(),
        )
    };
    assert!(matches!(of(vec![]), Err(Error::NoSpeed { .. })));
    assert!(matches!(
        of(vec![1.0, f64::NAN]),
        Err(Error::NotFinite { index: 1, .. })
    ));
    let unequal = [(Channel::Speed, vec![1.0]), (Channel::Accel, vec![])]
        .into_iter()
        .collect();
    assert!(matches!(
        DriveLog::new("log", 0.0, 0.1, unequal),
        Err(Error::Length { .. })
    ));
}

proptest! {
    #[test]
    fn a_hann_window_keeps_constants(value in -100.0_f64..100.0, len in 1_usize..50, length in 0_usize..40) {
        for smooth in hann(&vec![value; len], length) {
            prop_assert!((smooth - value).abs() <= 1e-13 * value.abs());
        }
    }

    #[test]
    fn a_hann_window_stays_within_its_signal(signal in proptest::collection::vec(-50.0..50.0, 1..60), length in 1_usize..20) {
        let (low, high) = signal.iter().fold((f64::MAX, f64::MIN), |(l, h): (f64, f64), v: &f64| (l.min(*v), h.max(*v)));
        let smooth = hann(&signal, length);
        prop_assert_eq!(smooth.len(), signal.len());
        prop_assert!(smooth.iter().all(|v| *v >= low - 1e-12 && *v <= high + 1e-12));
    }

    #[test]
    fn the_difference_of_a_line_is_its_slope(slope in -5.0_f64..5.0, len in 2_usize..50) {
        let speed: Vec<f64> = (0..len).map(|i| 3.0 + slope * 0.1 * i as f64).collect();
        prop_assert!(forward_difference(&speed, 0.1).iter().all(|a| (a - slope).abs() < 1e-12));
    }

    #[test]
    fn a_line_is_resampled_exactly(steps in proptest::collection::vec(0.01_f64..0.4, 2..80), slope in -2.0_f64..2.0, step_s in 0.02_f64..0.5) {
        let mut time_s = vec![3.0];
        for step in steps {
            time_s.push(time_s[time_s.len() - 1] + step);
        }
        let line = |t: f64| 40.0 + slope * t;
        let speed = time_s.iter().map(|t| line(*t)).collect();
        let options = Preparation { step_s, ..unsmoothed() };
        let drive = prepare(raw(time_s, [(Channel::Speed, speed)]), &options).unwrap();
        prop_assert_eq!(drive.pieces.len(), 1);
        for (i, speed) in drive.pieces[0].speed_mps().iter().enumerate() {
            // a sample within 1e-6 steps of the grid is taken over
            prop_assert!((speed - line(drive.pieces[0].time_s(i))).abs() < 2e-6 * slope.abs() * step_s + 1e-12);
        }
    }

    /// Every grid point lies between two valid samples that are at most the longest gap apart.
    #[test]
    fn pieces_never_bridge_a_gap(
        samples in proptest::collection::vec((0.01_f64..3.5, prop::option::weighted(0.8, 5.0_f64..6.0)), 2..60),
        max_gap_s in 0.5_f64..3.0,
    ) {
        let mut t = 0.0;
        let mut time_s = Vec::new();
        let mut speed = Vec::new();
        for (step, value) in samples {
            t += step;
            time_s.push(t);
            speed.push(value.unwrap_or(f64::NAN));
        }
        prop_assume!(speed.iter().any(|v| v.is_finite()));
        let valid: Vec<f64> = time_s.iter().zip(&speed).filter(|(_, v)| v.is_finite()).map(|(t, _)| *t).collect();
        let options = Preparation { max_gap_s, ..unsmoothed() };
        if let Ok(drive) = prepare(raw(time_s, [(Channel::Speed, speed)]), &options) {
            for piece in &drive.pieces {
                for i in 0..piece.len() {
                    let t = piece.time_s(i);
                    let before = valid.iter().copied().filter(|v| *v <= t + 1e-6).fold(f64::MIN, f64::max);
                    let after = valid.iter().copied().filter(|v| *v >= t - 1e-6).fold(f64::MAX, f64::min);
                    prop_assert!(after - before <= max_gap_s + 1e-6, "{before} {t} {after}");
                }
            }
        } else {
            prop_assert!(valid.windows(2).all(|pair| pair[1] - pair[0] > max_gap_s));
        }
    }

    #[test]
    fn check_makes_time_increase(times in proptest::collection::vec(prop_oneof![8 => 0.0_f64..10.0, 1 => Just(f64::NAN)], 1..60)) {
        let len = times.len();
        let checked = drive_log::check(raw(times, [(Channel::Speed, vec![1.0; len])]));
        prop_assert!(checked.log.time_s().windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(same(checked.log.channel(Channel::Speed).unwrap(), &vec![1.0; checked.log.len()]));
    }
}

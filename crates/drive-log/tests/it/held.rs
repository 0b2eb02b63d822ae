//! Values repeated in faster rows, and speeds in coarse steps.

use drive_log::{
    Action, Channel, Checked, Drive, FindingKind, Preparation, RawLog, check, prepare,
};

use crate::quality::{changed, traffic};
use crate::{raw, ten_hertz};

const LEN: usize = 6000;

/// A drive with stops, pulls of all strengths and a little noise, m/s at 10 Hz.
fn speed_mps() -> Vec<f64> {
    let wave = |f: f64, i: usize| (i as f64 * f).sin();
    (0..LEN)
        .map(|i| {
            let v = 9.0 + 9.0 * wave(0.011, i) + 4.0 * wave(0.037, i) + 0.02 * wave(1.9, i);
            v.max(0.0)
        })
        .collect()
}

/// Each value repeated for `rows` rows.
fn held(values: &[f64], rows: usize) -> Vec<f64> {
    (0..values.len()).map(|i| values[i - i % rows]).collect()
}

/// To the nearest multiple of a step.
fn rounded(values: &[f64], step: f64) -> Vec<f64> {
    values.iter().map(|v| (v / step).round() * step).collect()
}

fn log(speed: Vec<f64>) -> RawLog {
    raw(ten_hertz(speed.len()), [(Channel::Speed, speed)])
}

fn kinds(checked: &Checked) -> Vec<FindingKind> {
    checked
        .findings
        .iter()
        .map(|finding| finding.kind)
        .collect()
}

fn drive(speed: Vec<f64>) -> Drive {
    prepare(log(speed), &Preparation::default()).unwrap()
}

/// Work of speeding up, J/kg.
fn work_jpkg(drive: &Drive) -> f64 {
    let speed = drive.pieces[0].speed_mps();
    speed
        .windows(2)
        .map(|v| 0.5 * (v[1].powi(2) - v[0].powi(2)).max(0.0))
        .sum()
}

fn root_mean_square(drive: &Drive, truth: &Drive) -> f64 {
    let (a, b) = (&drive.pieces[0].accel_mps2(), &truth.pieces[0].accel_mps2());
    let sum: f64 = a.iter().zip(b.iter()).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

#[test]
fn values_of_every_rate_that_are_held_in_faster_rows_are_collapsed() {
    let truth = drive(speed_mps());
    for rows in [2, 5, 10, 20] {
        let checked = check(log(held(&speed_mps(), rows)));
        assert_eq!(kinds(&checked), [FindingKind::Held], "{rows} rows");
        assert_eq!(checked.findings[0].action, Action::Interpolated);
        let collapsed = drive(held(&speed_mps(), rows));
        let work = work_jpkg(&collapsed) / work_jpkg(&truth);
        assert!((0.97..1.01).contains(&work), "{rows} rows: {work}");
    }
}

#[test]
fn a_held_speed_is_the_truth_at_its_updates() {
    let checked = check(log(held(&speed_mps(), 10)));
    let collapsed = checked.log.channel(Channel::Speed).unwrap();
    for i in (0..LEN).step_by(10) {
        assert_eq!(collapsed[i].to_bits(), speed_mps()[i].to_bits(), "{i}");
    }
}

#[test]
fn updates_that_rows_at_irregular_times_see_late_are_found() {
    let (truth, mut time_s, mut speed) = (speed_mps(), Vec::new(), Vec::new());
    let mut at = 0;
    for k in 0..2000 {
        time_s.push(at as f64 * 0.1);
        speed.push(truth[at - at % 10]);
        at += 1 + (k * 7919) % 5;
        if at >= LEN {
            break;
        }
    }
    let checked = check(raw(time_s, [(Channel::Speed, speed)]));
    assert!(
        kinds(&checked).contains(&FindingKind::Held),
        "{:?}",
        checked.findings
    );
}

/// The speed at the updates, seen in rows at other times, s.
fn polled(updates_s: &[f64], rows_s: &[f64]) -> RawLog {
    let truth = speed_mps();
    let at = |t_s: f64| {
        let (i, share) = ((t_s / 0.1) as usize, (t_s / 0.1).fract());
        truth[i] + (truth[i + 1] - truth[i]) * share
    };
    let last = |t_s: f64| updates_s[updates_s.partition_point(|u| *u <= t_s) - 1];
    let speed = rows_s.iter().map(|t_s| at(last(*t_s))).collect();
    raw(rows_s.to_vec(), [(Channel::Speed, speed)])
}

/// Times that follow each other by `least` to `most`, up to ten minutes.
fn times_s(least: f64, most: f64, seed: u64) -> Vec<f64> {
    let mut hash = seed;
    let mut times_s = vec![0.0];
    while times_s[times_s.len() - 1] < 0.1 * (LEN - 2) as f64 - most {
        hash = hash
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let share = (hash >> 33) as f64 / (1_u64 << 31) as f64;
        times_s.push(times_s[times_s.len() - 1] + least + (most - least) * share);
    }
    times_s
}

#[test]
fn updates_that_beat_with_the_rows_are_found() {
    let truth = drive(speed_mps());
    for row_s in [0.3, 0.4, 0.6, 0.7, 0.8, 0.9] {
        let log = polled(&times_s(1.0, 1.0, 1), &times_s(row_s, row_s, 1));
        assert_eq!(kinds(&check(log.clone())), [FindingKind::Held], "{row_s}");
        let collapsed = prepare(log, &Preparation::default()).unwrap();
        let work = work_jpkg(&collapsed) / work_jpkg(&truth);
        assert!((0.98..1.005).contains(&work), "{row_s}: {work}");
        let error = root_mean_square(&collapsed, &truth);
        assert!(error < 0.2, "{row_s}: {error}");
    }
}

#[test]
fn updates_at_varying_times_are_found() {
    let truth = drive(speed_mps());
    for (rows, updates) in [
        ((0.1, 0.1), (0.2, 0.5)),
        ((0.1, 0.1), (0.15, 0.15)),
        ((0.1, 0.3), (0.4, 0.8)),
        ((0.2, 0.2), (0.6, 1.4)),
        ((0.1, 0.1), (0.5, 1.5)),
        ((0.05, 0.5), (0.9, 1.1)),
    ] {
        let log = polled(
            &times_s(updates.0, updates.1, 7),
            &times_s(rows.0, rows.1, 3),
        );
        let found = kinds(&check(log.clone()));
        assert!(
            found.contains(&FindingKind::Held),
            "{rows:?} {updates:?}: {found:?}"
        );
        let collapsed = prepare(log, &Preparation::default()).unwrap();
        let work = work_jpkg(&collapsed) / work_jpkg(&truth);
        assert!(
            (0.985..1.01).contains(&work),
            "{rows:?} {updates:?}: {work}"
        );
    }
}

#[test]
fn rows_that_are_lost_now_and_then_leave_the_others_where_they_are() {
    let lost = |i: usize| i > 0 && (i * 7919) % 100 < 20;
    let recorded: Vec<f64> = (0..LEN)
        .map(|i| speed_mps()[(0..=i).rev().find(|k| !lost(*k)).unwrap()])
        .collect();
    let checked = check(log(recorded));
    assert_eq!(kinds(&checked), [FindingKind::Held]);
    let collapsed = checked.log.channel(Channel::Speed).unwrap();
    let true_rows = (0..LEN).filter(|i| !lost(*i));
    let kept = true_rows.filter(|i| collapsed[*i].to_bits() == speed_mps()[*i].to_bits());
    assert!(kept.count() > LEN * 75 / 100);
}

#[test]
fn a_stop_that_is_held_is_no_code() {
    let stop_mps = |i: usize| 0.1 * (i.abs_diff(2150) as f64 - 80.0).max(0.0);
    let speed = speed_mps().into_iter().enumerate();
    let speed: Vec<f64> = speed.map(|(i, v)| v.min(stop_mps(i))).collect();
    let checked = check(log(held(&rounded(&speed, 1.0 / 3.6), 20)));
    assert_eq!(kinds(&checked)[0], FindingKind::Held);
    assert!(!kinds(&checked).contains(&FindingKind::Sentinel));
    let collapsed = checked.log.channel(Channel::Speed).unwrap();
    assert!(collapsed[2100..2200].iter().all(|v| *v == 0.0));
}

#[test]
fn a_speed_that_comes_at_odd_times_is_told_and_kept() {
    let mut last = 0;
    let recorded: Vec<f64> = (0..LEN)
        .map(|i| {
            if (i * i * 31 + i * 17) % 23 < 6 || i % 97 < 40 {
                last = i;
            }
            speed_mps()[last]
        })
        .collect();
    let checked = check(log(recorded));
    let held = checked
        .findings
        .iter()
        .filter(|f| f.kind == FindingKind::Held);
    assert_eq!(held.count(), 1, "{:?}", checked.findings);
}

#[test]
fn every_channel_is_looked_at_by_itself() {
    let current: Vec<f64> = (0..LEN).map(|i| 60.0 * (i as f64 * 0.05).sin()).collect();
    let log = raw(
        ten_hertz(LEN),
        [
            (Channel::Speed, speed_mps()),
            (Channel::BatteryCurrent, held(&current, 5)),
        ],
    );
    let checked = check(log);
    assert_eq!(kinds(&checked), [FindingKind::Held]);
    assert_eq!(checked.findings[0].channel, "battery_current_a");
    assert_eq!(checked.log.channel(Channel::Speed).unwrap(), speed_mps());
}

#[test]
fn values_that_change_by_themselves_are_not_held() {
    let limit: Vec<f64> = (0..LEN).map(|i| [22.2, 27.8, 25.0][i / 700 % 3]).collect();
    let heating: Vec<f64> = (0..LEN).map(|i| [0.0, 800.0, 1500.0][i / 50 % 3]).collect();
    let charge: Vec<f64> = (0..LEN).map(|i| 80.0 - (i / 60) as f64 * 0.1).collect();
    let log = raw(
        ten_hertz(LEN),
        [
            (Channel::Speed, speed_mps()),
            (Channel::SpeedLimit, limit),
            (Channel::HeatingPower, heating),
            (Channel::StateOfCharge, charge),
        ],
    );
    assert_eq!(check(log).findings, []);
}

#[test]
fn a_rounded_speed_is_smoothed_within_half_a_step() {
    for step_mps in [1.0 / 3.6, 0.5 / 3.6, 0.44704] {
        let recorded = rounded(&speed_mps(), step_mps);
        let checked = check(log(recorded.clone()));
        assert_eq!(kinds(&checked), [FindingKind::Quantised], "{step_mps}");
        let smooth = checked.log.channel(Channel::Speed).unwrap();
        let furthest = smooth
            .iter()
            .zip(&recorded)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(furthest <= 0.5 * step_mps + 1e-9, "{furthest}");

        let (truth, smoothed) = (drive(speed_mps()), drive(recorded));
        let work = work_jpkg(&smoothed) / work_jpkg(&truth);
        assert!((0.99..1.01).contains(&work), "{step_mps}: {work}");
        let error = root_mean_square(&smoothed, &truth);
        assert!(error < 0.15, "{step_mps}: {error}");
    }
}

#[test]
fn a_rounded_standstill_stands_still() {
    let stop_mps = |i: usize| 0.1 * (i.abs_diff(2150) as f64 - 150.0).max(0.0);
    let speed = speed_mps().into_iter().enumerate();
    let speed: Vec<f64> = speed.map(|(i, v)| v.min(stop_mps(i))).collect();
    let recorded = rounded(&speed, 1.0 / 3.6);
    let checked = check(log(recorded));
    let smooth = checked.log.channel(Channel::Speed).unwrap();
    assert!(smooth[2060..2240].iter().all(|v| *v == 0.0));
    assert!(smooth.iter().all(|v| *v >= 0.0));
}

#[test]
fn a_rounded_speed_that_is_held_is_both() {
    let recorded = held(&rounded(&speed_mps(), 1.0 / 3.6), 10);
    let checked = check(log(recorded));
    assert_eq!(kinds(&checked)[0], FindingKind::Held);
}

#[test]
fn a_speed_in_fine_steps_is_left_alone() {
    assert_eq!(check(log(rounded(&speed_mps(), 0.01 / 3.6))).findings, []);
}

#[test]
fn a_rounded_speed_that_freezes_with_other_channels_is_frozen() {
    let mut frozen = traffic(9000);
    for channel in [
        Channel::Speed,
        Channel::MotorTorque,
        Channel::BatteryVoltage,
        Channel::BatteryCurrent,
    ] {
        frozen = changed(&frozen, channel, |values| {
            let last = values[4000];
            values[4000..8000].fill(last);
        });
    }
    let log = changed(&frozen, Channel::Speed, |speed| {
        *speed = rounded(speed, 1.0 / 3.6);
    });
    let removed: Vec<String> = check(log)
        .findings
        .into_iter()
        .filter(|f| f.kind == FindingKind::Frozen && f.action == Action::Removed)
        .map(|f| f.channel)
        .collect();
    assert_eq!(removed[0], "speed_mps", "{removed:?}");
    assert_eq!(removed.len(), 4, "{removed:?}");
}

#[test]
fn a_speed_rounded_in_one_unit_and_written_in_another_is_smoothed() {
    let truth = drive(speed_mps());
    let written = |unit: f64, digit: f64| rounded(&rounded(&speed_mps(), unit), digit);
    for (unit, digit) in [
        (1.0 / 3.6, 0.1),
        (1.0 / 3.6, 0.01),
        (0.44704, 0.01 / 3.6),
        (0.44704, 1.0 / 3.6),
        (1.852 / 3.6, 0.1),
    ] {
        let drive = drive(written(unit, digit));
        assert_eq!(drive.findings.len(), 1, "{unit} {digit}");
        assert_eq!(drive.findings[0].kind, FindingKind::Quantised);
        let work = work_jpkg(&drive) / work_jpkg(&truth);
        assert!((work - 1.0).abs() < 0.01, "{unit} {digit}: {work}");
    }
    // what is fine lies on no lattice but that of its digits
    for digit in [0.01, 0.001] {
        assert!(kinds(&check(log(rounded(&speed_mps(), digit)))).is_empty());
    }
}

#[test]
fn updates_of_a_rounded_speed_are_smoothed() {
    let truth = drive(speed_mps());
    let drive = drive(held(&rounded(&speed_mps(), 1.0 / 3.6), 3));
    let kinds: Vec<FindingKind> = drive.findings.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [FindingKind::Held, FindingKind::Quantised]);
    let work = work_jpkg(&drive) / work_jpkg(&truth);
    assert!((work - 1.0).abs() < 0.01, "{work}");
    assert!(root_mean_square(&drive, &truth) < 0.35);
}

//! Speeds that are not there for a moment.

use drive_log::{Action, Channel, FindingKind, Preparation, RawLog, check, prepare};

use crate::made::{drive, without};
use crate::quality::{changed, kinds};

/// Speed alone, a sample every `step_s`.
fn speed_only(step_s: f64) -> RawLog {
    let dropped: Vec<Channel> = Channel::ALL
        .into_iter()
        .filter(|channel| *channel != Channel::Speed)
        .collect();
    without(&drive(step_s), &dropped)
}

/// Rows that look random, one in `one_in`.
fn rows(log: &RawLog, one_in: u64) -> Vec<usize> {
    let hash = |i: usize| (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
    (1..log.len() - 1)
        .filter(|i| hash(*i) % one_in == 0)
        .collect()
}

fn with_code(log: &RawLog, rows: &[usize], code_mps: f64) -> RawLog {
    changed(log, Channel::Speed, |speed| {
        rows.iter().for_each(|&i| speed[i] = code_mps);
    })
}

/// Work of speeding up, J/kg, over all pieces.
fn work_jpkg(log: RawLog) -> f64 {
    let pieces = prepare(log, &Preparation::default()).unwrap().pieces;
    let rises = |v: &[f64]| 0.5 * (v[1].powi(2) - v[0].powi(2)).max(0.0);
    let works = pieces
        .iter()
        .map(|piece| piece.speed_mps().windows(2).map(rises).sum::<f64>());
    works.sum()
}

#[test]
fn a_code_in_single_rows_is_removed_wherever_it_is() {
    for step_s in [0.1, 0.5, 1.0] {
        let log = speed_only(step_s);
        for code in [-1.0, -1.0 / 3.6, 255.0 / 3.6, 65_535.0 / 3.6, 999.0 / 3.6] {
            for one_in in [20, 50, 200] {
                let rows = rows(&log, one_in);
                let checked = check(with_code(&log, &rows, code));
                let found = kinds(&checked);
                assert_eq!(
                    found,
                    [(FindingKind::Sentinel, "speed_mps", Action::Removed)],
                    "{code} every {one_in} rows of {step_s} s"
                );
                let speed = checked.log.channel(Channel::Speed).unwrap();
                assert!((0..speed.len()).all(|i| speed[i].is_nan() == rows.contains(&i)));
            }
        }
    }
}

#[test]
fn rows_of_zero_in_motion_are_removed_and_stops_stay() {
    for step_s in [0.1, 1.0] {
        let log = speed_only(step_s);
        let recorded = log.channel(Channel::Speed).unwrap();
        let rows: Vec<usize> = rows(&log, 50)
            .into_iter()
            .filter(|i| recorded[*i] > 3.0)
            .collect();
        let checked = check(with_code(&log, &rows, 0.0));
        let speed = checked.log.channel(Channel::Speed).unwrap();
        let removed: Vec<usize> = (0..speed.len()).filter(|i| speed[*i].is_nan()).collect();
        assert_eq!(removed, rows, "{step_s}");
        assert_eq!(checked.findings.len(), 1, "{:?}", checked.findings);
    }
}

#[test]
fn bursts_of_a_second_do_not_blame_the_unit() {
    let log = speed_only(0.1);
    for code in [65_535.0 / 3.6, 999.0 / 3.6, -99.0 / 3.6] {
        let wrong = changed(&log, Channel::Speed, |speed| {
            for start in [800, 4300, 8100] {
                speed[start..start + 10].fill(code);
            }
        });
        let work = work_jpkg(wrong) / work_jpkg(log.clone());
        assert!((0.99..1.01).contains(&work), "{code}: {work}");
    }
}

#[test]
fn one_row_backward_between_rows_forward_is_a_spike() {
    let log = speed_only(1.0);
    let recorded = log.channel(Channel::Speed).unwrap();
    let at = (1..recorded.len())
        .find(|&i| recorded[i - 1] > 2.0)
        .unwrap();
    let checked = check(with_code(&log, &[at], -1.0 / 3.6));
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Spike, "speed_mps", Action::Removed)]
    );
    assert!(checked.log.channel(Channel::Speed).unwrap()[at].is_nan());
}

#[test]
fn a_true_row_between_two_of_a_code_stays() {
    let log = speed_only(1.0);
    let rows = [60, 61, 63, 64, 65, 67, 300, 302, 420];
    let checked = check(with_code(&log, &rows, 255.0 / 3.6));
    let speed = checked.log.channel(Channel::Speed).unwrap();
    let removed: Vec<usize> = (0..speed.len()).filter(|i| speed[*i].is_nan()).collect();
    assert_eq!(removed, rows);
}

#[test]
fn dropouts_beside_a_wrong_unit_are_told_from_it() {
    let log = without(&drive(1.0), &[Channel::SpeedLimit]);
    let rows = rows(&log, 100);
    let wrong = changed(&with_code(&log, &rows, 0.0), Channel::Speed, |speed| {
        speed.iter_mut().for_each(|v| *v *= 3.6);
    });
    let checked = check(wrong);
    let units: Vec<Action> = checked
        .findings
        .iter()
        .filter(|f| f.kind == FindingKind::Unit)
        .map(|f| f.action)
        .collect();
    assert_eq!(units, [Action::Scaled], "{:?}", checked.findings);
}

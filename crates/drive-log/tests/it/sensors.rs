//! Sensors that end, stop, drift or scatter, and rows that were drawn and not measured.

use drive_log::{Action, Channel, FindingKind, RawLog, check};

use crate::made::{drive, only, times, without};
use crate::quality::changed;
use crate::raw;

const WITNESSES: [Channel; 5] = [
    Channel::SpeedLimit,
    Channel::Accelerometer,
    Channel::BatteryCurrent,
    Channel::BatteryVoltage,
    Channel::Elevation,
];

/// Noise of deviation 1, the same on every run.
pub(crate) fn noise(i: usize) -> f64 {
    let uniform = |salt: u64| {
        let mut x = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (x ^ (x >> 31)) as f64 / u64::MAX as f64
    };
    (0..12).map(|salt| uniform(7919 * salt)).sum::<f64>() - 6.0
}

fn speed(log: &RawLog) -> &[f64] {
    log.channel(Channel::Speed).unwrap()
}

pub(crate) fn with(log: &RawLog, channel: Channel, of: impl Fn(usize, f64) -> f64) -> RawLog {
    changed(log, channel, |values| {
        for (i, value) in values.iter_mut().enumerate() {
            *value = of(i, *value);
        }
    })
}

/// The drive as a car records it: the last digits of the speed scatter, the voltage gives way to the current, a state of charge and
/// the slope of the road.
pub(crate) fn recorded() -> RawLog {
    let log = drive(0.1);
    let log = with(&log, Channel::Speed, |i, v| {
        if v > 0.0 {
            (v + 0.008 * noise(i)).max(0.0)
        } else {
            0.0
        }
    });
    let current = log.channel(Channel::BatteryCurrent).unwrap().to_vec();
    let current: Vec<f64> = (0..log.len())
        .map(|i| current[i] + 0.3 * noise(i + 1_000_000))
        .collect();
    let voltage = current.iter().map(|a| 360.0 - 0.1 * a).collect();
    let mut charge_as = 0.0;
    let soc = current.iter().map(|a| {
        charge_as += 0.1 * a;
        80.0 - charge_as / (60.0 * 36.0)
    });
    let soc: Vec<f64> = soc.collect();
    let (speed, elevation) = (speed(&log), log.channel(Channel::Elevation).unwrap());
    let grade = |i: usize| {
        let (from, to) = (i.saturating_sub(10), (i + 10).min(log.len() - 1));
        let way_m: f64 = speed[from..to].iter().map(|v| 0.1 * v).sum();
        if way_m > 1.0 {
            ((elevation[to] - elevation[from]) / way_m).asin()
        } else {
            0.0
        }
    };
    let slope = (0..log.len()).map(grade).collect();
    let own = [
        (Channel::BatteryCurrent, current),
        (Channel::BatteryVoltage, voltage),
        (Channel::StateOfCharge, soc),
        (Channel::Slope, slope),
    ];
    let replaced = own.each_ref().map(|(channel, _)| *channel);
    let others = without(&log, &replaced);
    let others = others.channels().map(|(c, values)| (c, values.to_vec()));
    raw(log.time_s().to_vec(), others.chain(own))
}

/// That one finding has this kind, channel and action.
#[track_caller]
pub(crate) fn assert_found(
    log: &RawLog,
    kind: FindingKind,
    channel: &str,
    action: Action,
) -> RawLog {
    let checked = check(log.clone());
    let is_it =
        |f: &drive_log::Finding| (f.kind, f.channel.as_str(), f.action) == (kind, channel, action);
    assert!(
        checked.findings.iter().any(is_it),
        "{:#?}",
        checked.findings
    );
    checked.log
}

#[track_caller]
pub(crate) fn assert_near(log: &RawLog, expected: &RawLog, channel: Channel, tolerance: f64) {
    let (found, expected) = (
        log.channel(channel).unwrap(),
        expected.channel(channel).unwrap(),
    );
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(a.is_nan() || (a - b).abs() <= tolerance, "{i}: {a} for {b}");
    }
}

#[test]
fn a_recorded_drive_is_what_it_says() {
    assert_eq!(check(recorded()).findings, []);
}

#[test]
fn short_times_tell_their_unit() {
    let log = recorded();
    let at = |factor: f64, apart: &[Channel]| {
        let log = without(&log, apart);
        let time_s = log.time_s().iter().map(|t| t * factor).collect();
        raw(
            time_s,
            log.channels().map(|(c, values)| (c, values.to_vec())),
        )
    };
    let minutes = at(1.0 / 60.0, &WITNESSES);
    assert_eq!(
        only(&minutes),
        (FindingKind::Unit, "time".to_owned(), Action::Scaled)
    );
    assert!((check(minutes).log.time_s()[600] - 60.0).abs() < 1e-6);
    for apart in [&WITNESSES[..], &[]] {
        assert_found(&at(0.1, apart), FindingKind::Unit, "time", Action::Refused);
    }
}

#[test]
fn lost_rows_are_told_by_accelerometer_and_battery() {
    let log = recorded();
    let time_s = log.time_s().iter().map(|t| 2.0 * t).collect();
    let slow = raw(
        time_s,
        log.channels().map(|(c, values)| (c, values.to_vec())),
    );
    let slow = without(&slow, &[Channel::Slope, Channel::StateOfCharge]);
    let checked = check(slow);
    let refused = checked
        .findings
        .iter()
        .find(|f| f.action == Action::Refused)
        .unwrap();
    assert_eq!(refused.channel, "time");
    assert!(
        refused.detail.contains("rows are missing"),
        "{}",
        refused.detail
    );
}

/// The drive as its times are off by a factor.
fn at_times(log: &RawLog, factor: f64) -> RawLog {
    let time_s = log.time_s().iter().map(|t| factor * t).collect();
    raw(
        time_s,
        log.channels().map(|(c, values)| (c, values.to_vec())),
    )
}

#[track_caller]
fn assert_refused(log: RawLog, words: &[&str]) {
    let refused = check(log)
        .findings
        .into_iter()
        .find(|f| f.action == Action::Refused)
        .unwrap();
    for word in words {
        assert!(refused.detail.contains(word), "{}", refused.detail);
    }
}

#[test]
fn an_accelerometer_tells_slow_times_and_not_the_battery_alone() {
    let log = without(&recorded(), &[Channel::Slope, Channel::StateOfCharge]);
    // so slow that the speed hardly seems to change
    for factor in [3.0, 5.0] {
        assert_refused(at_times(&log, factor), &["rows are missing"]);
    }
    let alone = without(
        &log,
        &[
            Channel::BatteryCurrent,
            Channel::Elevation,
            Channel::SpeedLimit,
        ],
    );
    let words = ["accelerometer", "times", "speeds", "leave"];
    assert_refused(at_times(&alone, 2.0), &words);
    // a scale that is off by little does no harm
    let scaled = times(&alone, Channel::Accelerometer, 1.22);
    assert_eq!(
        only(&scaled),
        (
            FindingKind::Mounting,
            "accelerometer_mps2".to_owned(),
            Action::Dropped
        )
    );
}

#[test]
fn fast_times_do_not_make_the_speed_one_in_another_unit() {
    let log = without(
        &recorded(),
        &[Channel::Slope, Channel::StateOfCharge, Channel::SpeedLimit],
    );
    for factor in [0.6, 0.45] {
        assert_refused(at_times(&log, factor), &["times"]);
    }
}

#[test]
fn noise_does_not_hide_the_unit_of_a_speed() {
    let log = without(&recorded(), &[Channel::Slope, Channel::StateOfCharge]);
    let noisy = with(&log, Channel::Speed, |i, v| {
        (v + if v > 0.5 { 0.2 * noise(i + 500) } else { 0.0 }) / 1.609_344
    });
    assert_found(&noisy, FindingKind::Unit, "speed_mps", Action::Scaled);
}

#[test]
fn a_speed_that_scatters_is_smoothed() {
    let log = recorded();
    for deviation in [0.05, 0.3] {
        let noisy = with(&log, Channel::Speed, |i, v| {
            if v > 0.5 {
                v + deviation * noise(i + 500)
            } else {
                v
            }
        });
        let smooth = assert_found(&noisy, FindingKind::Noise, "speed_mps", Action::Smoothed);
        assert_near(&smooth, &log, Channel::Speed, 4.0 * deviation);
        let rms = |speed: &[f64]| {
            let steps = speed.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
            (steps.sum::<f64>() / speed.len() as f64).sqrt()
        };
        let (found, true_rms) = (rms(speed(&smooth)), rms(speed(&log)));
        assert!((found / true_rms - 1.0).abs() < 0.1, "{found} {true_rms}");
    }
}

#[test]
fn values_at_the_end_of_the_range_are_not_known() {
    assert_clipped(Channel::Speed, |v| v.min(20.0));
    assert_clipped(Channel::BatteryCurrent, |a| a.min(60.0));
    assert_clipped(Channel::BatteryCurrent, |a| a.max(0.0));
    assert_clipped(Channel::BatteryCurrent, |a| a.clamp(-32.0, 32.0));
}

#[test]
fn a_speed_that_a_limiter_holds_is_kept() {
    let log = recorded();
    let limited = with(&log, Channel::Speed, |_, v| v.min(20.0));
    let accel = speed(&limited).to_vec();
    let felt = with(&limited, Channel::Accelerometer, |i, _| {
        let (from, to) = (i.saturating_sub(3), (i + 3).min(accel.len() - 1));
        (accel[to] - accel[from]) / (0.1 * (to - from) as f64) + 0.02 * noise(i)
    });
    let alone = without(&limited, &[Channel::Accelerometer]);
    for log in [felt, alone] {
        let found = assert_found(&log, FindingKind::Clipped, "speed_mps", Action::Kept);
        assert_eq!(speed(&found), speed(&log));
    }
}

#[track_caller]
fn assert_clipped(channel: Channel, clip: fn(f64) -> f64) {
    let log = recorded();
    let clipped = with(&log, channel, |_, value| clip(value));
    let found = assert_found(
        &clipped,
        FindingKind::Clipped,
        channel.name(),
        Action::Removed,
    );
    // a few samples at the end are no plateau
    let wrong = |(a, b): &(&f64, &f64)| a.is_finite() && (*a - *b).abs() > 8.0;
    let values = found.channel(channel).unwrap().iter();
    let wrong = values.zip(log.channel(channel).unwrap()).filter(wrong);
    assert_eq!(wrong.count(), 0);
}

#[test]
fn a_straight_line_was_not_measured() {
    let log = recorded();
    let measured = speed(&log).to_vec();
    let line = |i: usize| {
        measured[3000] + (measured[3400] - measured[3000] + 3.0) * (i - 3000) as f64 / 400.0
    };
    let filled = with(&log, Channel::Speed, |i, v| {
        if (3000..3400).contains(&i) {
            line(i)
        } else {
            v
        }
    });
    let found = assert_found(&filled, FindingKind::Filled, "speed_mps", Action::Removed);
    let removed = speed(&found)[3000..3400].iter().filter(|v| v.is_nan());
    assert!(removed.count() > 390);
}

#[test]
fn a_slope_that_the_elevation_contradicts_is_not_used() {
    let log = without(
        &recorded(),
        &[Channel::Accelerometer, Channel::BatteryCurrent],
    );
    let assert_dropped = |of: fn(usize, f64) -> f64, kind| {
        let wrong = with(&log, Channel::Slope, of);
        let found = assert_found(&wrong, kind, "grade_rad", Action::Dropped);
        assert!(found.channel(Channel::Slope).is_none());
    };
    assert_dropped(|_, s| s + 0.01, FindingKind::Unit);
    assert_dropped(|_, s| s.abs(), FindingKind::Unit);
    assert_dropped(
        |i, s| if i > 6000 { 0.0123 } else { s },
        FindingKind::Frozen,
    );
    let doubled = times(&log, Channel::Slope, 2.0);
    assert_found(
        &doubled,
        FindingKind::Contradicted,
        "grade_rad",
        Action::Kept,
    );
    let slope = log.channel(Channel::Slope).unwrap().to_vec();
    let late = with(&log, Channel::Slope, |i, _| {
        slope[(i + 11_000) % slope.len()]
    });
    assert_found(&late, FindingKind::Contradicted, "grade_rad", Action::Kept);
}

#[test]
fn the_accelerometer_tells_which_of_slope_and_elevation_is_the_road() {
    let log = recorded();
    let doubled = times(&log, Channel::Slope, 2.0);
    assert_found(&doubled, FindingKind::Unit, "grade_rad", Action::Dropped);
    let elevation = times(&log, Channel::Elevation, 2.0);
    assert_found(
        &elevation,
        FindingKind::Unit,
        "elevation_m",
        Action::Dropped,
    );
    let alone = without(&log, &[Channel::Slope]);
    assert_eq!(check(alone.clone()).findings, []);
    let tenfold = times(&alone, Channel::Elevation, 10.0);
    assert_found(&tenfold, FindingKind::Unit, "elevation_m", Action::Dropped);
}

#[test]
fn a_slope_alone_that_the_battery_does_not_feel_is_reported() {
    let log = without(&recorded(), &[Channel::Elevation, Channel::Accelerometer]);
    assert_eq!(check(log.clone()).findings, []);
    let unsigned = with(&log, Channel::Slope, |_, s| 2.0 * s.abs());
    let tripled = times(&log, Channel::Slope, 3.0);
    for wrong in [unsigned, tripled] {
        assert_found(&wrong, FindingKind::Contradicted, "grade_rad", Action::Kept);
    }
}

#[test]
fn slow_starts_alone_are_a_doubt_about_the_unit() {
    let log = without(
        &recorded(),
        &[&WITNESSES[..], &[Channel::Slope, Channel::StateOfCharge]].concat(),
    );
    let slow = times(&log, Channel::Speed, 1.0 / 3.6);
    let found = assert_found(&slow, FindingKind::Unit, "speed_mps", Action::Kept);
    assert_eq!(speed(&found), speed(&slow));
}

#[test]
fn rows_that_are_stamped_in_batches_are_spread() {
    let log = recorded();
    let stamped = |of: fn(usize) -> f64| {
        let channels = log.channels().map(|(c, values)| (c, values.to_vec()));
        raw((0..log.len()).map(of).collect(), channels)
    };
    let batches = stamped(|i| (i / 10) as f64 + 0.001 * (i % 10) as f64);
    assert_eq!(
        only(&batches),
        (FindingKind::Batched, "time".to_owned(), Action::Converted)
    );
    let even = check(batches).log;
    let off_s = even
        .time_s()
        .iter()
        .zip(log.time_s())
        .map(|(a, b)| (a - b).abs());
    assert!(off_s.fold(0.0, f64::max) < 1e-9);
    // what is measured in bursts stays where it is
    let apart = without(&log, &[Channel::Accelerometer, Channel::BatteryCurrent]);
    let bursts = changed(&apart, Channel::Speed, |v| {
        (0..v.len()).for_each(|i| v[i] = v[i / 10 * 10] + 1e-3 * (i % 10) as f64);
    });
    let channels = bursts.channels().map(|(c, values)| (c, values.to_vec()));
    let time_s = (0..log.len()).map(|i| (i / 10) as f64 + 0.01 * (i % 10) as f64);
    let bursts = check(raw(time_s.collect(), channels));
    let batched = |f: &&drive_log::Finding| f.kind == FindingKind::Batched;
    assert_eq!(bursts.findings.iter().filter(batched).count(), 0);
}

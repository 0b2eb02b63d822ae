//! Channels, times and rows that contradict each other.

use drive_log::{Action, Channel, FindingKind, RawLog, check};

use crate::made::{GRAVITY_MPS2, assert_close, drive, only, times, without};
use crate::quality::{changed, kinds};
use crate::sensors::{assert_found, assert_near, recorded, with};
use crate::{raw, read};

const ALONE: [Channel; 4] = [
    Channel::SpeedLimit,
    Channel::Accelerometer,
    Channel::BatteryCurrent,
    Channel::BatteryVoltage,
];

/// The same rows at other times.
fn at(log: &RawLog, time_s: impl Fn(usize) -> f64) -> RawLog {
    let channels = log.channels().map(|(c, values)| (c, values.to_vec()));
    raw((0..log.len()).map(time_s).collect(), channels)
}

#[track_caller]
fn assert_only(log: &RawLog, channel: &str, action: Action, words: &str) {
    assert_eq!(
        (only(log).1.as_str(), only(log).2),
        (channel, action),
        "{words}"
    );
    let detail = &check(log.clone()).findings[0].detail;
    assert!(detail.contains(words), "{detail}");
}

#[test]
fn row_numbers_are_no_seconds() {
    let log = drive(0.1);
    let numbered = at(&log, |i| i as f64);
    assert_only(&numbered, "time", Action::Scaled, "rows are numbered");
    assert_close(&check(numbered.clone()).log, Channel::Speed, &log);
    assert!((check(numbered.clone()).log.time_s()[50] - 5.0).abs() < 1e-9);
    assert_only(
        &without(&numbered, &ALONE),
        "time",
        Action::Refused,
        "counts rows",
    );
    let seconds = without(&drive(1.0), &ALONE);
    assert!(check(seconds).findings.is_empty());
}

#[test]
fn times_in_whole_minutes_are_refused() {
    let log = without(&drive(1.0), &ALONE);
    let minutes = at(&log, |i| (i / 60 * 60) as f64);
    let first = &check(minutes).findings[0];
    assert_eq!(first.action, Action::Refused);
    assert!(first.detail.contains("seconds are not written"));
}

#[test]
fn a_clock_that_starts_anew_is_no_second_vehicle() {
    let log = without(&drive(0.1), &ALONE);
    let len = log.len();
    let shifted = at(&log, |i| (i % (len / 2)) as f64 * 0.1);
    let checked = check(shifted);
    let splits = [(FindingKind::BackwardTime, "time", Action::Split)];
    assert_eq!(kinds(&checked), splits);
}

#[test]
fn codes_in_single_rows_are_removed() {
    let log = drive(0.1);
    let sparse = |i: usize| i % 190 == 7;
    let coded = |log: &RawLog, channel, code: f64| {
        changed(log, channel, |values| {
            (0..values.len())
                .filter(|i| sparse(*i))
                .for_each(|i| values[i] = code);
        })
    };
    for code in [3276.7, 819.1, -409.6] {
        let wrong = coded(&log, Channel::BatteryCurrent, code);
        assert_only(&wrong, "battery_current_a", Action::Removed, "of exactly");
        let left = check(wrong).log;
        let values = left.channel(Channel::BatteryCurrent).unwrap();
        assert!((0..values.len()).all(|i| values[i].is_nan() == sparse(i)));
    }
    let varied = changed(&log, Channel::BatteryVoltage, |v| {
        (0..v.len()).for_each(|i| v[i] += (i as f64 * 0.01).sin());
    });
    for code in [0.0, 1023.5] {
        let wrong = coded(&varied, Channel::BatteryVoltage, code);
        assert_only(&wrong, "battery_voltage_v", Action::Removed, "of exactly");
    }
}

#[test]
fn volts_and_amps_in_each_others_column_are_exchanged() {
    let log = drive(0.1);
    let [volts, amps] = [Channel::BatteryVoltage, Channel::BatteryCurrent]
        .map(|channel| log.channel(channel).unwrap().to_vec());
    let wrong = changed(&log, Channel::BatteryVoltage, |v| *v = amps);
    let wrong = changed(&wrong, Channel::BatteryCurrent, |v| *v = volts);
    assert_only(&wrong, "battery_voltage_v", Action::Replaced, "exchanged");
    assert_close(&check(wrong).log, Channel::BatteryCurrent, &log);
}

#[test]
fn a_current_whose_sign_turns_is_dropped() {
    let turned = changed(&drive(0.1), Channel::BatteryCurrent, |values| {
        let half = values.len() / 2;
        values[half..].iter_mut().for_each(|a| *a = -*a);
    });
    assert_only(&turned, "battery_current_a", Action::Dropped, "turns");
}

#[test]
fn a_speed_that_only_the_battery_contradicts_is_reported() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit, Channel::Accelerometer]);
    for (factor, unit) in [(1.609_344, "mph"), (1.852, "knots")] {
        let slow = times(&log, Channel::Speed, 1.0 / factor);
        assert_only(&slow, "speed_mps", Action::Kept, unit);
    }
}

#[test]
fn slopes_that_contradict_the_elevation_or_every_street_are_dropped() {
    let log = without(&drive(0.1), &ALONE);
    let elevation = log.channel(Channel::Elevation).unwrap().to_vec();
    let speed = log.channel(Channel::Speed).unwrap().to_vec();
    let sloped = changed(&log, Channel::Slope, |slope| {
        for i in 1..slope.len() {
            let way_m = 0.05 * (speed[i] + speed[i - 1]);
            slope[i] = ((elevation[i] - elevation[i - 1]) / way_m.max(1e-3)).atan();
        }
    });
    assert!(check(sloped.clone()).findings.is_empty());
    for (factor, words) in [
        (-1.0, "turned around"),
        (57.295_78, "steeper than any street"),
        (0.01, "in another unit"),
    ] {
        let wrong = times(&sloped, Channel::Slope, factor);
        assert_only(&wrong, "grade_rad", Action::Dropped, words);
    }
    let feet = times(&sloped, Channel::Elevation, 1.0 / 0.3048);
    assert_only(&feet, "elevation_m", Action::Dropped, "ft");
}

/// A car ahead whose speed sways about the own one.
fn following() -> RawLog {
    let log = without(&drive(0.1), &ALONE);
    let speed = log.channel(Channel::Speed).unwrap().to_vec();
    let apart = |i: usize| 1.5 * (0.21 * 0.1 * i as f64).cos();
    let log = changed(&log, Channel::LeadSpeed, |lead| {
        (0..lead.len()).for_each(|i| lead[i] = speed[i] + apart(i));
    });
    changed(&log, Channel::LeadGap, |gap| {
        (0..gap.len()).for_each(|i| gap[i] = 25.0 + 1.5 / 0.21 * (0.21 * 0.1 * i as f64).sin());
    })
}

#[test]
fn gap_and_lead_speed_are_checked_against_each_other() {
    let log = following();
    assert!(check(log.clone()).findings.is_empty());
    let own = log.channel(Channel::Speed).unwrap().to_vec();
    let relative = changed(&log, Channel::LeadSpeed, |lead| {
        lead.iter_mut().zip(&own).for_each(|(v, own)| *v -= own);
    });
    for (wrong, channel) in [
        (times(&log, Channel::LeadSpeed, 3.6), Channel::LeadSpeed),
        (relative, Channel::LeadSpeed),
        (
            times(&log, Channel::LeadGap, 1.0 / 0.3048),
            Channel::LeadGap,
        ),
    ] {
        assert_only(&wrong, channel.name(), Action::Scaled, "put right");
        assert_close(&check(wrong).log, channel, &log);
    }
}

#[test]
fn a_gap_that_is_not_renewed_any_more_is_removed() {
    let stale = |values: &mut Vec<f64>| {
        let last = values[3000];
        values[3000..3200].fill(last);
    };
    let log = changed(&following(), Channel::LeadGap, stale);
    let log = changed(&log, Channel::LeadSpeed, stale);
    assert_only(&log, "lead_gap_m", Action::Removed, "last gap is kept");
    let left = check(log).log;
    assert!(left.channel(Channel::LeadGap).unwrap()[3100].is_nan());
}

#[test]
fn speeds_beyond_every_car_are_refused_and_altitudes_read() {
    let fast = times(&without(&drive(1.0), &ALONE), Channel::Speed, 100.0);
    let checked = check(fast);
    let refused = checked
        .findings
        .iter()
        .find(|f| f.action == Action::Refused);
    assert!(refused.is_some_and(|f| f.channel == "speed_mps"));
    let file = read("Time (s),Speed (km/h),Altitude (m)\n0,36,100\n1,36,101\n").unwrap();
    assert_eq!(
        file.logs[0].channel(Channel::Elevation),
        Some(&[100.0, 101.0][..])
    );
}

/// The drive with other speeds in a part of its samples.
fn with_speeds(of: impl Fn(f64, f64) -> f64) -> RawLog {
    let log = recorded();
    let all = log.len() as f64;
    with(&log, Channel::Speed, |i, v| of(i as f64 / all, v))
}

#[test]
fn a_car_that_reverses_on_the_road_goes_forward() {
    let log = recorded();
    for from in [0.0, 0.5] {
        let turned = with_speeds(|share, v| if share >= from { -v } else { v });
        let found = assert_found(
            &turned,
            FindingKind::Contradicted,
            "speed_mps",
            Action::SignFlipped,
        );
        // where the sign changes in motion, samples beside it may be lost
        let known = found
            .channel(Channel::Speed)
            .unwrap()
            .iter()
            .filter(|v| v.is_finite())
            .count();
        assert!(known + 40 > log.len(), "{known}");
        assert_near(&found, &log, Channel::Speed, 0.05);
    }
}

#[test]
fn a_speed_of_which_a_part_is_in_another_unit_is_not_converted_as_a_whole() {
    for from in [0.3, 0.5] {
        let part = with_speeds(|share, v| if share >= from { 3.6 * v } else { v });
        let checked = check(part);
        let has = |is: fn(&drive_log::Finding) -> bool| checked.findings.iter().any(is);
        let is_whole = has(|f| f.kind == FindingKind::Unit && f.action == Action::Scaled);
        let is_refused = has(|f| f.action == Action::Refused);
        let is_told = is_refused || has(|f| f.kind == FindingKind::UnitChange);
        let is_right = is_told && (is_refused || !is_whole);
        assert!(is_right, "{from}: {:#?}", checked.findings);
    }
}

#[test]
fn an_elevation_that_stands_still_on_a_hill_that_is_felt() {
    let road = drive(0.1);
    let hill = 1500..1750;
    let speed_mps = road.channel(Channel::Speed).unwrap().to_vec();
    let mut elevation_m = road.channel(Channel::Elevation).unwrap().to_vec();
    let rise_m = elevation_m[hill.end] - elevation_m[hill.start];
    for i in hill.clone() {
        elevation_m[i] = elevation_m[hill.start];
    }
    elevation_m[hill.end..]
        .iter_mut()
        .for_each(|m| *m -= rise_m);
    let felt_mps2 = -0.07 * GRAVITY_MPS2;
    let mut log = changed(&road, Channel::Elevation, |m| {
        m.copy_from_slice(&elevation_m);
    });
    log = changed(&log, Channel::Accelerometer, |a| {
        a[hill.clone()].iter_mut().for_each(|a| *a += felt_mps2);
    });
    let is_told = |checked: &drive_log::Checked| {
        let told = (FindingKind::Contradicted, "elevation_m", Action::Removed);
        kinds(checked).contains(&told)
    };
    assert!(!is_told(&check(road)));
    // the battery does not feel what the accelerometer does
    assert!(!is_told(&check(log.clone())));
    log = changed(&log, Channel::BatteryCurrent, |a| {
        for i in hill.clone() {
            a[i] += 1700.0 * felt_mps2 * speed_mps[i] / 350.0;
        }
    });
    let checked = check(log);
    assert!(is_told(&checked), "{:?}", checked.findings);
    let mended_m = checked.log.channel(Channel::Elevation).unwrap();
    assert!(mended_m[1600..1650].iter().all(|m| m.is_nan()));
    let said = |finding: &drive_log::Finding| finding.detail.contains("added to all that follows");
    assert!(checked.findings.iter().any(said), "{:?}", checked.findings);
    let moved_m = mended_m[2000] - elevation_m[2000];
    assert!((-50.0..-20.0).contains(&moved_m), "{moved_m}");
}

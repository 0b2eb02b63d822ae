//! Times as text, and times in numbers whose unit the header has wrong.

use drive_log::{Action, Channel, FindingKind, RawLog};

use crate::{log, read};

/// Speeds in km/h of a drive that speeds up and brakes, a second apart.
fn speeds_kmh() -> impl Iterator<Item = f64> {
    (0..300).map(|i| 50.0 * (1.0 - (f64::from(i) / 20.0).cos()))
}

/// The drive with its times written by `time`, from the number of the second.
fn drive(header: &str, time: impl Fn(u32) -> String) -> String {
    let rows = (0..)
        .zip(speeds_kmh())
        .map(|(i, v)| format!("{},{v:.2}\n", time(i)));
    format!("{header}\n{}", rows.collect::<String>())
}

fn is_the_drive(log: &RawLog, case: &str) {
    assert_eq!(log.len(), 300, "{case}");
    for (i, t) in log.time_s().iter().enumerate() {
        let from_start_s = t - log.time_s()[0];
        assert!(
            (from_start_s - i as f64).abs() < 1e-3,
            "{case}: {from_start_s} at {i}"
        );
    }
    let speed = log.channel(Channel::Speed).unwrap();
    let expected: Vec<f64> = speeds_kmh().map(|v| v / 3.6).collect();
    assert!(
        speed
            .iter()
            .zip(&expected)
            .all(|(a, b)| (a - b).abs() < 0.01),
        "{case}"
    );
}

fn clock(i: u32, from_s: u32) -> String {
    let s = from_s + i;
    format!("{:02}:{:02}:{:02}", s / 3600 % 24, s / 60 % 60, s % 60)
}

#[test]
fn text_in_one_column() {
    let day = |i: u32| if i < 60 { 28 } else { 29 };
    for (header, time) in [
        ("time", &(|i| clock(i, 86_340)) as &dyn Fn(u32) -> String),
        ("timestamp", &|i| {
            format!("2026-03-{}T{}Z", day(i), clock(i, 86_340))
        }),
        ("time", &|i| {
            format!("2026-03-{} {}.000+01:00", day(i), clock(i, 86_340))
        }),
        ("DateTime", &|i| {
            format!("{}.03.2026 {}", day(i), clock(i, 86_340))
        }),
        ("date", &|i| {
            format!("{}/3/2026 {}", day(i), clock(i, 86_340))
        }),
        ("date", &|i| {
            format!("3/{}/2026 {}", day(i), clock(i, 86_340))
        }),
        ("time", &|i| {
            format!("{}-Mar-2026 {}", day(i), clock(i, 86_340))
        }),
    ] {
        let log = log(drive(&format!("{header},speed_kmh"), time));
        is_the_drive(&log, &time(0));
        assert_eq!(log.time_s()[0], 0.0);
        assert_eq!(drive_log::check(log).findings, [], "{}", time(0));
    }
}

#[test]
fn a_date_and_a_clock() {
    let log = log(drive("Date,Time,speed_kmh", |i| {
        format!("2026-03-04,{}", clock(i, 0))
    }));
    is_the_drive(&log, "two columns");
}

/// Summer time begins: the clock goes from 02:00 to 03:00, and the zone with it.
#[test]
fn a_zone_that_changes() {
    let text = drive("time,speed_kmh", |i| {
        let summer = i >= 120;
        let zone = if summer { "+02:00" } else { "+01:00" };
        let from_s = if summer { 7080 + 3600 } else { 7080 };
        format!("2026-03-29T{}{zone}", clock(i, from_s))
    });
    is_the_drive(&log(text), "summer time");
}

#[test]
fn what_the_header_does_not_say_is_said_in_a_finding() {
    for (header, time) in [
        (
            "time_s",
            &(|i| format!("2026-03-29T{}", clock(i, 0))) as &dyn Fn(u32) -> String,
        ),
        ("timestamp", &|i| {
            format!("{}", 1_774_749_300_000_u64 + u64::from(i) * 1000)
        }),
        ("time", &|i| {
            format!("{:.8}", 46_110.0 + f64::from(i) / 86_400.0)
        }),
        ("time_s", &|i| clock(i, 35_730).replace(':', "")),
        ("time", &|i| clock(i, 86_340).replace(':', "") + ".00"),
    ] {
        let log = log(drive(&format!("{header},speed_kmh"), time));
        is_the_drive(&log, &time(0));
        let findings = drive_log::check(log).findings;
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert_eq!(findings[0].kind, FindingKind::TimeFormat);
    }
    let days = log(drive("time_d,speed_kmh", |i| {
        format!("{:.8}", f64::from(i) / 86_400.0)
    }));
    is_the_drive(&days, "the header says days");
}

#[test]
fn times_at_which_no_car_drives_are_scaled_by_the_only_unit_that_fits() {
    for (header, time) in [
        (
            "time_ms",
            &(|i: u32| i.to_string()) as &dyn Fn(u32) -> String,
        ),
        ("time_s", &|i| {
            format!("{:.8}", 46_110.0 + f64::from(i) / 86_400.0)
        }),
        ("time_s", &|i| (1000 * i).to_string()),
    ] {
        let checked = drive_log::check(log(drive(&format!("{header},speed_kmh"), time)));
        is_the_drive(&checked.log, &time(1));
        let finding = &checked.findings[0];
        assert_eq!(
            (finding.kind, finding.action),
            (FindingKind::Unit, Action::Scaled)
        );
    }
}

#[test]
fn what_cannot_be_told_is_refused_with_the_cure() {
    for (text, words) in [
        (
            drive("time,speed_kmh", |i| i.to_string()),
            &["\"time\"", "time_s", "unit"][..],
        ),
        (
            drive("date,speed_kmh", |i| {
                format!("{}/4/2026 {}", 3 + 2 * (i / 200), clock(i, 0))
            }),
            &["line 202", "D/M/Y or M/D/Y", "date_order"],
        ),
        (
            drive("time,speed_kmh", |i| {
                if i == 7 {
                    "noon".to_owned()
                } else {
                    clock(i, 0)
                }
            }),
            &["line 9", "\"noon\"", "HH:MM:SS"],
        ),
        (
            drive("time_s,speed_kmh", |i| {
                format!("{:02}:{:02}", i / 60, i % 60)
            }),
            &["line 2", "\"00:00\""],
        ),
        (
            drive("time,speed_kmh", |i| format!("0 days {}", clock(i, 0))),
            &["line 2", "is not a time", "HH:MM:SS"],
        ),
    ] {
        let error = read(&text).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error:?} does not say {word:?}");
        }
    }
}

/// Time read from a column of speeds goes up and down.
#[test]
fn a_header_that_is_shifted_by_a_column() {
    let rows: String = (0..)
        .zip(speeds_kmh())
        .map(|(i, v)| format!("{i},{v:.1},{},\n", i % 360))
        .collect();
    let error = read(format!("sats,time_s,speed_kmh,heading\n{rows}")).unwrap_err();
    assert!(error.to_string().contains("header"), "{error}");
}

/// A clock that is set back once, or samples that come a little late, are no such thing.
#[test]
fn a_clock_that_is_set_back_is_read() {
    let set_back = log(drive("time_s,speed_kmh", |i| {
        (if i < 100 { i + 500 } else { i }).to_string()
    }));
    assert_eq!(set_back.len(), 300);
    let late = log(drive("time_s,speed_kmh", |i| {
        [i, i + 1, i.wrapping_sub(1)][i as usize % 3].to_string()
    }));
    assert_eq!(late.len(), 300);
}

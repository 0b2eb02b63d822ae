//! Channels that say something of each other, and one that is wrong among them.

use drive_log::{Action, Channel, FindingKind, Preparation, RawLog, check, prepare};

use crate::made::{assert_close, drive, only, times, without};
use crate::quality::{changed, kinds};
use crate::read;

/// Way driven at each sample, as an odometer with this step counts it, m.
fn way_m(log: &RawLog, step_m: f64) -> Vec<f64> {
    let (time_s, speed) = (log.time_s(), log.channel(Channel::Speed).unwrap());
    let mut way_m = vec![12_345_600.0];
    for i in 1..time_s.len() {
        way_m.push(way_m[i - 1] + 0.5 * (speed[i] + speed[i - 1]) * (time_s[i] - time_s[i - 1]));
    }
    way_m
        .iter()
        .map(|m| (m / step_m).floor() * step_m)
        .collect()
}

fn with_way(log: &RawLog, way_m: Vec<f64>) -> RawLog {
    changed(log, Channel::Distance, |values| *values = way_m)
}

#[test]
fn an_accelerometer_of_another_scale_does_not_change_the_speed() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    for dropped in [&[][..], &[Channel::BatteryCurrent]] {
        for share in [0.28, 0.3, 0.45, 0.5, 0.55, 2.2, 3.6] {
            let wrong = times(&without(&log, dropped), Channel::Accelerometer, share);
            let checked = check(wrong);
            let [finding] = checked.findings.as_slice() else {
                panic!("{share}: {:?}", checked.findings);
            };
            // by 0.5, and no battery to say that the times are right
            let expected = if dropped.is_empty() || is_unit(share) {
                ("accelerometer_mps2", Action::Dropped)
            } else {
                ("time", Action::Refused)
            };
            assert_eq!(
                (finding.channel.as_str(), finding.action),
                expected,
                "{share}"
            );
            assert_close(&checked.log, Channel::Speed, &log);
        }
    }
}

/// Whether an acceleration is so many times another of the made drive because of its unit.
fn is_unit(times: f64) -> bool {
    let units = [3.6, 1.0 / 0.44704, 0.44704, 1.0 / 3.6];
    units
        .iter()
        .any(|unit| (times / unit - 1.0_f64).abs() < 0.08)
}

#[test]
fn an_accelerometer_that_is_computed_in_another_unit_is_dropped() {
    let log = without(
        &drive(1.0),
        &[
            Channel::SpeedLimit,
            Channel::Accelerometer,
            Channel::BatteryCurrent,
        ],
    );
    let speed = log.channel(Channel::Speed).unwrap().to_vec();
    let wrong = changed(&log, Channel::Accel, |accel| {
        for i in 1..accel.len() - 1 {
            accel[i] = 3.6 * (speed[i + 1] - speed[i - 1]) / 2.0;
        }
    });
    let (_, channel, action) = only(&wrong);
    assert_eq!((channel.as_str(), action), ("accel_mps2", Action::Dropped));
}

#[test]
fn a_current_of_another_scale_does_not_change_the_speed() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    for factor in [0.05, 0.1, 0.15] {
        let wrong = times(&log, Channel::BatteryCurrent, factor);
        let (_, channel, action) = only(&wrong);
        assert_eq!(
            (channel.as_str(), action),
            ("battery_current_a", Action::Dropped),
            "{factor}"
        );
        assert_close(&check(wrong).log, Channel::Speed, &log);
    }
    let (_, channel, action) = only(&times(&log, Channel::BatteryCurrent, 10.0));
    assert_eq!(
        (channel.as_str(), action),
        ("battery_current_a", Action::Kept)
    );
}

#[test]
fn a_channel_that_is_mostly_out_of_range_is_no_channel() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    let (kind, channel, action) = only(&times(&log, Channel::BatteryCurrent, 1000.0));
    assert_eq!(
        (kind, channel.as_str(), action),
        (
            FindingKind::OutOfRange,
            "battery_current_a",
            Action::Dropped
        )
    );
}

#[test]
fn a_way_tells_the_unit_of_the_speed() {
    let log = without(
        &drive(0.1),
        &[
            Channel::SpeedLimit,
            Channel::Accelerometer,
            Channel::BatteryCurrent,
        ],
    );
    for step_m in [0.1, 100.0] {
        let with = with_way(&log, way_m(&log, step_m));
        assert_eq!(check(with.clone()).findings, [], "{step_m}");
        for factor in [3.6, 1.0 / 0.44704, 1.609_344, 1.0 / 3.6] {
            let checked = check(times(&with, Channel::Speed, factor));
            assert_eq!(
                kinds(&checked),
                [(FindingKind::Unit, "speed_mps", Action::Scaled)],
                "{factor}"
            );
            assert_close(&checked.log, Channel::Speed, &log);
            assert!(checked.log.channel(Channel::Distance).is_none());
        }
    }
}

#[test]
fn a_way_is_read_however_it_is_called() {
    let log = without(
        &drive(1.0),
        &[
            Channel::SpeedLimit,
            Channel::Accelerometer,
            Channel::BatteryCurrent,
        ],
    );
    let speed = log.channel(Channel::Speed).unwrap();
    for (header, unit_m) in [
        ("distance_m", 1.0),
        ("odometer_km", 1e3),
        ("Distance [km]", 1e3),
        ("Odometer (mi)", 1609.344),
        ("trip_distance_km", 1e3),
    ] {
        let mut text = format!("time_s,speed_kmh,{header}\n");
        for (i, way_m) in way_m(&log, 1.0).iter().enumerate() {
            text += &format!(
                "{},{:.2},{:.4}\n",
                log.time_s()[i],
                speed[i],
                way_m / unit_m
            );
        }
        let logs = read(text).unwrap().logs;
        let checked = check(logs[0].clone());
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Unit, "speed_mps", Action::Scaled)],
            "{header}"
        );
    }
}

#[test]
fn a_distance_to_something_is_no_way() {
    let file = read("time_s,speed_kmh,distance_to_lead\n0,36,20\n1,36,21\n").unwrap();
    assert!(file.logs[0].channel(Channel::Distance).is_none());
    let log = without(&drive(1.0), &[Channel::SpeedLimit]);
    let ahead_m = (0..log.len()).map(|i| 40.0 + 20.0 * (0.1 * i as f64).sin());
    assert_eq!(check(with_way(&log, ahead_m.collect())).findings, []);
}

#[test]
fn volts_and_amps_may_be_short() {
    let file = read("t,v,V,A\n0,10,350,20\n1,10,350,21\n").unwrap();
    let log = &file.logs[0];
    assert_eq!(
        log.channel(Channel::BatteryVoltage).unwrap(),
        [350.0, 350.0]
    );
    assert_eq!(log.channel(Channel::BatteryCurrent).unwrap(), [20.0, 21.0]);
    for other in ["V", "A", "V,V", "battery_voltage_v,A"] {
        let columns = other.split(',').count();
        let row = ",1".repeat(columns);
        let file = read(format!("t,v,{other}\n0,10{row}\n1,10{row}\n")).unwrap();
        assert!(
            file.logs[0].channel(Channel::BatteryCurrent).is_none(),
            "{other}"
        );
    }
}

#[test]
fn a_current_without_a_sign_is_dropped_on_either_side_of_zero() {
    for step_s in [0.1, 1.0] {
        for side in [1.0, -1.0] {
            let log = changed(&drive(step_s), Channel::BatteryCurrent, |a| {
                a.iter_mut().for_each(|a| *a = side * a.abs());
            });
            let (kind, _, action) = only(&log);
            assert_eq!(
                (kind, action),
                (FindingKind::CurrentSign, Action::Dropped),
                "{step_s} {side}"
            );
        }
    }
}

#[test]
fn a_current_that_is_never_regained_keeps_its_sign() {
    for (side, action) in [(1.0, None), (-1.0, Some(Action::SignFlipped))] {
        let log = changed(&drive(1.0), Channel::BatteryCurrent, |a| {
            a.iter_mut().for_each(|a| *a = side * a.max(1.0));
        });
        let actions: Vec<Action> = check(log).findings.iter().map(|f| f.action).collect();
        assert_eq!(actions, action.into_iter().collect::<Vec<_>>(), "{side}");
    }
}

#[test]
fn an_accelerometer_that_always_says_the_same_is_dropped() {
    for value in [0.0, 0.37] {
        let log = changed(&drive(0.1), Channel::Accelerometer, |a| a.fill(value));
        let (_, channel, action) = only(&log);
        assert_eq!(
            (channel.as_str(), action),
            ("accelerometer_mps2", Action::Dropped),
            "{value}"
        );
    }
}

#[test]
fn stretches_in_another_unit_are_converted_in_town() {
    let log = without(
        &drive(1.0),
        &[
            Channel::SpeedLimit,
            Channel::Accelerometer,
            Channel::BatteryCurrent,
        ],
    );
    // at 18 to 30 km/h, where a jump is one that brakes could make
    for (from, to) in [(15, 108), (255, 347)] {
        for factor in [1.0 / 1.609_344, 1.0 / 3.6] {
            let wrong = changed(&log, Channel::Speed, |speed| {
                speed[from..to].iter_mut().for_each(|v| *v *= factor);
            });
            let checked = check(wrong);
            assert_eq!(
                kinds(&checked),
                [(FindingKind::UnitChange, "speed_mps", Action::Scaled)],
                "{from} to {to} s, {factor}: {:?}",
                checked.findings
            );
            assert_close(&checked.log, Channel::Speed, &log);
        }
    }
}

#[test]
fn a_channel_alone_against_the_speed_is_refused_where_either_may_be_wrong() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit, Channel::BatteryCurrent]);
    // as brisk as to be ordinary in either unit
    let wrong = times(
        &times(&log, Channel::Speed, 1.25),
        Channel::Accelerometer,
        0.78,
    );
    let error = prepare(wrong, &Preparation::default())
        .unwrap_err()
        .to_string();
    for word in ["km/h read as mph", "accelerometer_mps2", "name the unit"] {
        assert!(error.contains(word), "{error}");
    }
}

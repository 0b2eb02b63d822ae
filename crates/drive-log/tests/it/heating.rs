//! Heating power that is none, and what takes its place.

use drive_log::{Action, Channel, FindingKind, RawLog, check};

use crate::made;
use crate::quality::{changed, kinds, traffic};

fn pulses(log: &RawLog) -> RawLog {
    changed(log, Channel::HeatingPower, |heating| {
        for at in [500, 1500, 1800, 2500, 3700, 4100] {
            heating[at..at + 10].fill(5520.0);
        }
    })
}

#[test]
fn pulses_that_the_battery_does_not_feel() {
    let checked = check(pulses(&traffic(6000)));
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Sentinel, "heating_power_w", Action::Removed)]
    );
    let heating = checked.log.channel(Channel::HeatingPower).unwrap();
    assert_eq!(heating.iter().filter(|v| v.is_nan()).count(), 60);
    assert!(heating.iter().all(|v| v.is_nan() || *v == 0.0));
}

#[test]
fn pulses_that_the_battery_feels_are_heat() {
    let log = pulses(&traffic(6000));
    let heating = log.channel(Channel::HeatingPower).unwrap().to_vec();
    let log = changed(&log, Channel::BatteryCurrent, |a| {
        a.iter_mut()
            .zip(&heating)
            .for_each(|(a, h)| *a += h / 380.0);
    });
    assert_eq!(check(log).findings, []);
}

#[test]
fn a_pinned_heater() {
    let log = changed(&traffic(6000), Channel::HeatingPower, |heating| {
        heating.fill(1520.0);
        heating[4000..4500]
            .iter_mut()
            .enumerate()
            .for_each(|(i, v)| *v += i as f64);
    });
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Pinned, "heating_power_w", Action::Dropped)]
    );
    assert!(checked.log.channel(Channel::HeatingPower).is_none());
    let off = changed(&traffic(6000), Channel::HeatingPower, |heating| {
        heating[10..900].fill(700.0);
    });
    assert_eq!(check(off).findings, []);
}

/// A stop of a minute, at which the battery gives `battery_w`.
fn stopped(battery_w: f64) -> RawLog {
    let mut log = traffic(6000);
    for channel in [Channel::Speed, Channel::MotorTorque, Channel::Accel] {
        log = changed(&log, channel, |values| {
            for (i, v) in values[1900..2600].iter_mut().enumerate() {
                let ramp = if i < 100 { 1.0 - i as f64 / 100.0 } else { 0.0 };
                *v *= ramp.max((i as f64 - 600.0) / 100.0);
            }
        });
    }
    log = changed(&log, Channel::BatteryVoltage, |v| v[2000..2500].fill(380.0));
    changed(&log, Channel::BatteryCurrent, |a| {
        for (i, a) in a[2000..2500].iter_mut().enumerate() {
            *a = (battery_w + (i as f64 * 0.3).sin()) / 380.0;
        }
    })
}

/// A heater that changes its power, up to 2 kW.
fn heater(values: &mut [f64]) {
    for (i, v) in values.iter_mut().enumerate() {
        *v = 1500.0 + 500.0 * (i as f64 * 0.01).sin();
    }
}

#[test]
fn heating_that_the_battery_contradicts_at_standstill() {
    let cold = changed(&stopped(500.0), Channel::HeatingPower, |h| heater(h));
    let checked = check(cold);
    assert_eq!(
        kinds(&checked),
        [(
            FindingKind::Contradicted,
            "heating_power_w",
            Action::Dropped
        )]
    );
    let warm = changed(&stopped(2500.0), Channel::HeatingPower, |h| heater(h));
    assert_eq!(check(warm).findings, []);
    // without volts and amps nobody can tell
    let blind = changed(&traffic(6000), Channel::HeatingPower, |h| heater(h));
    assert_eq!(check(blind).findings, []);
}

#[test]
fn requested_heating_replaces_what_is_missing_unless_it_is_contradicted() {
    let requested = changed(&stopped(2500.0), Channel::HeatingRequest, |h| heater(h));
    let checked = check(requested);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Missing, "heating_power_w", Action::Replaced)]
    );
    assert_eq!(
        checked.log.channel(Channel::HeatingPower),
        checked.log.channel(Channel::HeatingRequest)
    );
    // a channel without a value is none
    let empty = changed(&stopped(2500.0), Channel::HeatingRequest, |h| heater(h));
    let empty = changed(&empty, Channel::HeatingPower, |h| h.fill(f64::NAN));
    let checked = check(empty);
    assert!(kinds(&checked).contains(&(FindingKind::Missing, "heating_power_w", Action::Replaced)));
    assert!(checked.log.channel(Channel::HeatingPower).is_some());
    let ignored = changed(&stopped(500.0), Channel::HeatingRequest, |h| heater(h));
    let checked = check(ignored);
    assert_eq!(
        kinds(&checked),
        [(
            FindingKind::Contradicted,
            "heating_request_w",
            Action::Dropped
        )]
    );
    assert_eq!(checked.log.channel(Channel::HeatingPower), None);
}

/// 5 kW are asked for from 200 to 500 s, and delivered up to 320 s.
fn half_delivered() -> RawLog {
    let at = |s: usize| 10 * s;
    let log = changed(&made::drive(0.1), Channel::BatteryCurrent, |a| {
        a[at(200)..at(320)]
            .iter_mut()
            .for_each(|a| *a += 5000.0 / 350.0);
    });
    changed(&log, Channel::HeatingRequest, |request| {
        request.fill(0.0);
        request[at(200)..at(500)].fill(5000.0);
    })
}

#[test]
fn requested_heating_is_believed_by_half_minutes() {
    let expected = (
        FindingKind::Contradicted,
        "heating_power_w",
        Action::Replaced,
    );
    let silent = changed(&half_delivered(), Channel::HeatingPower, |heating| {
        heating.fill(0.0);
    });
    for log in [half_delivered(), silent] {
        let checked = check(log);
        assert!(
            kinds(&checked).contains(&expected),
            "{:?}",
            checked.findings
        );
        let heating = checked.log.channel(Channel::HeatingPower).unwrap();
        assert_eq!(
            [2200, 3000, 3500, 4500].map(|i| heating[i]),
            [5000.0, 5000.0, 0.0, 0.0]
        );
    }
    // a hill takes as much as a heater where nothing feels the road
    let mut blind = half_delivered();
    blind = changed(&blind, Channel::Accelerometer, |a| a.fill(f64::NAN));
    let checked = check(blind);
    assert!(
        !kinds(&checked).contains(&expected),
        "{:?}",
        checked.findings
    );
}

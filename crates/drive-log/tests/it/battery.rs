//! Volts and amps that wrap around, spike, stop or are off, and what of other channels the battery does not feel.

use drive_log::{Action, Channel, FindingKind, RawLog, check};

use crate::made::without;
use crate::raw;
use crate::sensors::{assert_found, assert_near, noise, recorded, with};

/// The drive with a current that does not change at once.
fn gentle() -> RawLog {
    let log = recorded();
    let current = log.channel(Channel::BatteryCurrent).unwrap().to_vec();
    with(&log, Channel::BatteryCurrent, |i, _| {
        let around = &current[i.saturating_sub(10)..(i + 11).min(current.len())];
        around.iter().sum::<f64>() / around.len() as f64 + 0.3 * noise(i)
    })
}

#[test]
fn a_current_that_wraps_around_is_put_right() {
    let log = gentle();
    let assert_put_right = |wrapped: &RawLog| {
        let found = assert_found(
            wrapped,
            FindingKind::CurrentSign,
            "battery_current_a",
            Action::Converted,
        );
        assert_near(&found, &log, Channel::BatteryCurrent, 1e-9);
    };
    for turn_a in [256.0, 409.6, 655.36, 1000.0, 1024.0, 2048.0, 4096.0, 6553.6] {
        assert_put_right(&unsigned(&log, turn_a));
    }
    // in both directions, and more than once
    assert_put_right(&with(&log, Channel::BatteryCurrent, |_, a| {
        (a + 64.0).rem_euclid(128.0) - 64.0
    }));
}

/// As a counter without a sign has it.
fn unsigned(log: &RawLog, turn_a: f64) -> RawLog {
    with(log, Channel::BatteryCurrent, |_, a| a.rem_euclid(turn_a))
}

#[test]
fn a_current_that_wraps_around_nowhere_known_is_dropped() {
    let log = gentle();
    for turn_a in [300.0, 720.0, 4000.0] {
        let found = assert_found(
            &unsigned(&log, turn_a),
            FindingKind::CurrentSign,
            "battery_current_a",
            Action::Dropped,
        );
        assert!(found.channel(Channel::BatteryCurrent).is_none());
    }
    // one exact value is a code
    let code = with(&log, Channel::BatteryCurrent, |i, a| {
        if i % 37 == 0 { 655.35 } else { a }
    });
    assert_found(
        &code,
        FindingKind::Sentinel,
        "battery_current_a",
        Action::Removed,
    );
}

#[test]
fn amps_that_leave_for_a_moment_are_removed() {
    let log = gentle();
    let is_damaged = |i: usize| i % 53 == 7;
    let scaled = |factor: f64| {
        with(&log, Channel::BatteryCurrent, |i, a| {
            if is_damaged(i) { a * factor } else { a }
        })
    };
    for factor in [5.0, 10.0, -1.0] {
        let found = assert_found(
            &scaled(factor),
            FindingKind::Spike,
            "battery_current_a",
            Action::Removed,
        );
        assert_near(&found, &log, Channel::BatteryCurrent, 25.0);
    }
    for samples in [1, 3, 10, 20] {
        let dead = with(&log, Channel::BatteryCurrent, |i, a| {
            if i % 400 < samples { 0.0 } else { a }
        });
        let found = assert_found(
            &dead,
            FindingKind::Sentinel,
            "battery_current_a",
            Action::Removed,
        );
        let current = log.channel(Channel::BatteryCurrent).unwrap();
        let damaged = (0..log.len()).filter(|i| i % 400 < samples && current[*i].abs() > 15.0);
        let damaged: Vec<usize> = damaged.collect();
        let found = found.channel(Channel::BatteryCurrent).unwrap();
        let removed = damaged.iter().filter(|&&i| found[i].is_nan()).count();
        assert!(10 * removed > 9 * damaged.len(), "{removed} {damaged:?}");
    }
}

#[test]
fn a_rough_current_or_one_that_ends_at_zero_has_no_spikes() {
    let log = recorded();
    let rough = with(&log, Channel::BatteryCurrent, |i, a| {
        a + 15.0 * noise(i + 77)
    });
    let never_regained = with(&rough, Channel::BatteryCurrent, |_, a| a.max(0.0));
    let in_part = with(&log, Channel::BatteryCurrent, |i, a| {
        if i % 3000 < 500 {
            a + 20.0 * noise(i)
        } else {
            a
        }
    });
    for log in [rough, never_regained, in_part] {
        let removed: Vec<_> = check(log)
            .findings
            .into_iter()
            .filter(|f| matches!(f.kind, FindingKind::Spike | FindingKind::Sentinel))
            .collect();
        assert_eq!(removed, []);
    }
}

#[test]
fn auxiliaries_of_more_than_the_battery_delivers_are_dropped() {
    let log = recorded();
    let with_aux = |aux_w: f64| {
        let channels = log.channels().map(|(c, values)| (c, values.to_vec()));
        let aux = (Channel::AuxPower, vec![aux_w; log.len()]);
        raw(log.time_s().to_vec(), channels.chain([aux]))
    };
    assert_eq!(check(with_aux(400.0)).findings, []);
    let found = assert_found(
        &with_aux(4000.0),
        FindingKind::Contradicted,
        "aux_power_w",
        Action::Dropped,
    );
    assert!(found.channel(Channel::AuxPower).is_none());
}

#[test]
fn spikes_of_the_current_do_not_make_a_voltage_frozen() {
    let log = recorded();
    let held = log.channel(Channel::BatteryVoltage).unwrap()[900];
    // at standstill, where the current hardly changes
    let still = with(&log, Channel::BatteryVoltage, |i, v| {
        if (1130..1280).contains(&i) { held } else { v }
    });
    let spiked = with(&still, Channel::BatteryCurrent, |i, a| {
        if i == 1200 { a + 60.0 } else { a }
    });
    let frozen = |f: &&drive_log::Finding| f.kind == FindingKind::Frozen;
    assert_eq!(check(spiked).findings.iter().filter(frozen).count(), 0);
}

#[test]
fn an_accelerometer_that_stops_in_motion_is_removed() {
    let log = recorded();
    let held = log.channel(Channel::Accelerometer).unwrap()[1340];
    let dead = with(&log, Channel::Accelerometer, |i, a| {
        if i >= 9000 { held } else { a }
    });
    let found = assert_found(
        &dead,
        FindingKind::Frozen,
        "accelerometer_mps2",
        Action::Removed,
    );
    let end = &found.channel(Channel::Accelerometer).unwrap()[9000..];
    assert!(end.iter().all(|a| a.is_nan()));
}

#[test]
fn an_offset_that_leaves_no_power_for_the_standing_car_is_reported() {
    let log = recorded();
    // the state of charge drifts, as if 10 A less flowed
    let drifting = with(&log, Channel::StateOfCharge, |i, soc| {
        soc + 10.0 * 0.1 * i as f64 / (60.0 * 36.0)
    });
    let found = assert_found(
        &drifting,
        FindingKind::CurrentOffset,
        "battery_current_a",
        Action::Kept,
    );
    assert_near(&found, &log, Channel::BatteryCurrent, 1e-9);
}

#[test]
fn volts_and_amps_that_stop_in_motion_are_removed() {
    let log = recorded();
    for (channel, value) in [
        (Channel::BatteryCurrent, Some(0.0)),
        (Channel::BatteryCurrent, None),
        (Channel::BatteryVoltage, None),
    ] {
        let held = log.channel(channel).unwrap()[1340];
        let dead = with(&log, channel, |i, old| {
            if (1340..1540).contains(&i) {
                value.unwrap_or(held)
            } else {
                old
            }
        });
        let found = assert_found(&dead, FindingKind::Frozen, channel.name(), Action::Removed);
        assert!(
            found.channel(channel).unwrap()[1340..1540]
                .iter()
                .all(|v| v.is_nan())
        );
    }
    let dead = with(&log, Channel::BatteryVoltage, |i, v| {
        if (1340..1540).contains(&i) { 0.0 } else { v }
    });
    assert_found(
        &dead,
        FindingKind::Sentinel,
        "battery_voltage_v",
        Action::Removed,
    );
}

#[test]
fn the_state_of_charge_tells_an_offset_of_the_current() {
    let log = recorded();
    for offset_a in [5.0, -5.0, 20.0] {
        let off = with(&log, Channel::BatteryCurrent, |_, a| a + offset_a);
        let found = assert_found(
            &off,
            FindingKind::CurrentOffset,
            "battery_current_a",
            Action::Shifted,
        );
        assert_near(&found, &log, Channel::BatteryCurrent, 0.2);
    }
    let charging = with(&log, Channel::BatteryCurrent, |_, a| a - 5.0);
    let charging = without(&charging, &[Channel::StateOfCharge]);
    assert_found(
        &charging,
        FindingKind::CurrentOffset,
        "battery_current_a",
        Action::Kept,
    );
}

/// A third of the drive with another current.
fn in_part(of: impl Fn(f64) -> f64) -> RawLog {
    let log = recorded();
    let third = log.time_s().len() / 3;
    with(&log, Channel::BatteryCurrent, |i, a| {
        if (third..2 * third).contains(&i) {
            of(a)
        } else {
            a
        }
    })
}

#[test]
fn a_current_in_another_scale_or_turned_for_a_while_is_dropped() {
    for times in [10.0, 0.1, 2.0, 0.5, -1.0] {
        let found = assert_found(
            &in_part(|a| times * a),
            FindingKind::Contradicted,
            "battery_current_a",
            Action::Dropped,
        );
        assert!(found.channel(Channel::BatteryCurrent).is_none(), "{times}");
    }
}

//! Channels that are something else than their header says, and channels that are not.

use drive_log::{Action, Channel, Error, FindingKind, Preparation, RawLog, check, prepare};

use crate::made::{GRAVITY_MPS2, assert_close, drive, only, speed_mps, times, without};
use crate::quality::{changed, kinds};
use crate::{raw, ten_hertz};

#[test]
fn an_ordinary_drive_is_what_it_says() {
    for step_s in [0.1, 0.5, 1.0] {
        let log = drive(step_s);
        assert_eq!(check(log.clone()).findings, [], "{step_s}");
        for dropped in [
            Channel::Accelerometer,
            Channel::SpeedLimit,
            Channel::BatteryCurrent,
            Channel::Elevation,
        ] {
            assert_eq!(
                check(without(&log, &[dropped])).findings,
                [],
                "{step_s} {dropped}"
            );
        }
    }
}

#[test]
fn a_speed_in_another_unit_is_converted_by_what_is_measured() {
    for step_s in [0.1, 1.0] {
        let log = drive(step_s);
        for factor in [3.6, 1.0 / 0.44704, 1.609_344, 1.0 / 1.609_344, 1.0 / 3.6] {
            let wrong = times(
                &without(&log, &[Channel::SpeedLimit]),
                Channel::Speed,
                factor,
            );
            let checked = check(wrong);
            assert_eq!(
                kinds(&checked),
                [(FindingKind::Unit, "speed_mps", Action::Scaled)],
                "{factor}"
            );
            assert_close(&checked.log, Channel::Speed, &log);
        }
    }
}

#[test]
fn the_battery_power_tells_kilometres_per_hour_called_metres_per_second() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit, Channel::Accelerometer]);
    let checked = check(times(&log, Channel::Speed, 3.6));
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Unit, "speed_mps", Action::Scaled)]
    );
    assert!(checked.findings[0].detail.contains("km/h read as m/s"));
    assert_close(&checked.log, Channel::Speed, &log);
}

#[test]
fn an_impossible_speed_of_unknown_unit_is_refused_with_the_cure() {
    let channels = [(
        Channel::Speed,
        drive(0.1).channel(Channel::Speed).unwrap().to_vec(),
    )];
    let log = times(&raw(ten_hertz(12_000), channels), Channel::Speed, 3.6);
    let error = prepare(log, &Preparation::default()).unwrap_err();
    assert!(matches!(error, Error::Refused { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains("log: speed_mps") && message.contains("km/h read as m/s"),
        "{message}"
    );
}

#[test]
fn a_speed_far_over_every_limit_is_told() {
    let log = without(
        &drive(0.1),
        &[
            Channel::Accelerometer,
            Channel::BatteryCurrent,
            Channel::Elevation,
        ],
    );
    let (kind, channel, action) = only(&times(&log, Channel::Speed, 1.0 / 3.6));
    assert_eq!(
        (kind, channel.as_str(), action),
        (FindingKind::Unit, "speed_mps", Action::Kept)
    );
    let (kind, channel, _) = only(&times(&log, Channel::Speed, 1.0 / 0.44704));
    assert_eq!((kind, channel.as_str()), (FindingKind::Unit, "speed_mps"));
}

#[test]
fn limits_in_another_unit_are_converted() {
    for (unit, factor) in [("km/h", 3.6), ("mph", 1.0 / 0.44704)] {
        let log = changed(&drive(0.1), Channel::SpeedLimit, |limits| {
            for limit in limits {
                *limit = (*limit * factor / 5.0).round() * 5.0;
            }
        });
        let checked = check(log);
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Unit, "speed_limit_mps", Action::Scaled)],
            "{unit}"
        );
        assert!(checked.findings[0].detail.contains(unit));
    }
}

#[test]
fn stretches_in_another_unit_are_converted() {
    for step_s in [0.1, 1.0] {
        let log = without(&drive(step_s), &[Channel::SpeedLimit]);
        for factor in [1.609_344, 1.0 / 1.609_344, 3.6, 1.0 / 3.6] {
            let at = |t_s: f64| (t_s / step_s) as usize;
            let wrong = changed(&log, Channel::Speed, |speed| {
                speed[at(180.0)..at(185.0)]
                    .iter_mut()
                    .for_each(|v| *v *= factor);
                speed[at(420.0)..at(450.0)]
                    .iter_mut()
                    .for_each(|v| *v *= factor);
            });
            let checked = check(wrong);
            let converted = (FindingKind::UnitChange, "speed_mps", Action::Scaled);
            assert_eq!(kinds(&checked), [converted, converted], "{step_s} {factor}");
            assert_close(&checked.log, Channel::Speed, &log);
        }
    }
}

#[test]
fn a_unit_that_changes_for_good_is_told() {
    let log = changed(
        &without(
            &drive(1.0),
            &[
                Channel::SpeedLimit,
                Channel::Accelerometer,
                Channel::BatteryCurrent,
            ],
        ),
        Channel::Speed,
        |speed| {
            speed[660..].iter_mut().for_each(|v| *v /= 1.609_344);
        },
    );
    let (kind, _, action) = only(&log);
    assert_eq!((kind, action), (FindingKind::UnitChange, Action::Kept));
}

#[test]
fn times_in_another_unit_are_scaled() {
    for (step_s, factor) in [
        (0.1, 1000.0),
        (1.0, 1000.0),
        (0.1, 1e-3),
        (1.0, 1e-3),
        (1.0, 60.0),
        (1.0, 1.0 / 60.0),
    ] {
        let log = drive(step_s);
        let time_s = log.time_s().iter().map(|t| t * factor).collect();
        let channels = log
            .channels()
            .map(|(channel, values)| (channel, values.to_vec()))
            .collect();
        let checked = check(RawLog::new("log", time_s, channels).unwrap());
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Unit, "time", Action::Scaled)],
            "{step_s} {factor}: {:?}",
            checked.findings
        );
        let last_s = checked.log.time_s().last().unwrap();
        assert!(
            (last_s - log.time_s().last().unwrap()).abs() < 1e-6,
            "{last_s}"
        );
    }
}

#[test]
fn a_sparse_log_is_no_log_in_another_unit() {
    for step_s in [5.0_f64, 30.0, 60.0] {
        let log = drive(step_s.min(5.0));
        let time_s = (0..log.len()).map(|i| i as f64 * step_s).collect();
        let channels = [(
            Channel::Speed,
            log.channel(Channel::Speed).unwrap().to_vec(),
        )];
        let checked = check(raw(time_s, channels));
        assert!(
            checked.findings.iter().all(|f| f.kind != FindingKind::Unit),
            "{:?}",
            checked.findings
        );
    }
}

#[test]
fn an_accelerometer_in_g_turned_or_both_is_put_right() {
    let log = drive(0.1);
    for (factor, kind) in [
        (1.0 / GRAVITY_MPS2, FindingKind::Unit),
        (GRAVITY_MPS2, FindingKind::Unit),
        (-1.0, FindingKind::Mounting),
        (-1.0 / GRAVITY_MPS2, FindingKind::Unit),
    ] {
        let checked = check(times(&log, Channel::Accelerometer, factor));
        assert_eq!(
            kinds(&checked),
            [(kind, "accelerometer_mps2", Action::Scaled)],
            "{factor}"
        );
        assert_close(&checked.log, Channel::Accelerometer, &log);
    }
}

#[test]
fn an_accelerometer_off_level_or_late_is_put_right() {
    let log = drive(0.1);
    let tilted = changed(&log, Channel::Accelerometer, |a| {
        a.iter_mut().for_each(|a| *a += 0.85);
    });
    let checked = check(tilted);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Mounting, "accelerometer_mps2", Action::Shifted)]
    );
    for shift in [-10_isize, 12, 20] {
        let late = changed(&log, Channel::Accelerometer, |a| {
            let old = a.clone();
            for (i, a) in a.iter_mut().enumerate() {
                let from = (i as isize - shift).clamp(0, old.len() as isize - 1);
                *a = old[from as usize];
            }
        });
        let checked = check(late);
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Delay, "accelerometer_mps2", Action::Shifted)],
            "{shift}"
        );
        assert!(
            checked.findings[0]
                .detail
                .contains(&format!("by {:.2} s", shift as f64 * 0.1))
        );
    }
}

#[test]
fn an_accelerometer_across_the_car_is_dropped() {
    let log = changed(&drive(0.1), Channel::Accelerometer, |a| {
        for (i, a) in a.iter_mut().enumerate() {
            *a = (0.017 * i as f64).sin();
        }
    });
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Mounting, "accelerometer_mps2", Action::Dropped)]
    );
    assert!(checked.log.channel(Channel::Accelerometer).is_none());
}

#[test]
fn a_gap_that_is_a_code_is_no_gap() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    let follows = |i: usize| (3000..4000).contains(&i) || (6000..9500).contains(&i);
    let gap_m = |i: usize| {
        if follows(i) {
            25.0 + 10.0 * (0.003 * i as f64).sin()
        } else {
            f64::NAN
        }
    };
    for (gap_code, lead_code) in [
        (0.0, 0.0),
        (-1.0, -1.0),
        (252.0, 255.0),
        (255.0, 0.0),
        (655.35, 0.0),
    ] {
        let code = |value: f64, code: f64| if value.is_nan() { code } else { value };
        let with = changed(&log, Channel::LeadGap, |gap| {
            (0..gap.len()).for_each(|i| gap[i] = code(gap_m(i), gap_code));
        });
        let with = changed(&with, Channel::LeadSpeed, |lead| {
            (0..lead.len()).for_each(|i| {
                lead[i] = if follows(i) {
                    speed_mps(i as f64 * 0.1) + 0.1
                } else {
                    lead_code
                }
            });
        });
        let checked = check(with);
        let gap = checked.log.channel(Channel::LeadGap).unwrap();
        assert!(
            (0..gap.len()).all(|i| gap[i].is_finite() == follows(i)),
            "{gap_code}: {:?}",
            checked.findings
        );
        assert!(!checked.findings.is_empty());
    }
}

#[test]
fn a_limit_of_nothing_or_beyond_every_country_is_none() {
    let unknown = |i: usize| (2000..3000).contains(&i);
    for code in [0.0, 255.0 / 3.6, 250.0 / 3.6, 99.0] {
        let log = changed(&drive(0.1), Channel::SpeedLimit, |limit| {
            limit[2000..3000].fill(code);
        });
        let checked = check(log);
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Sentinel, "speed_limit_mps", Action::Removed)],
            "{code}"
        );
        let limit = checked.log.channel(Channel::SpeedLimit).unwrap();
        assert!((0..limit.len()).all(|i| limit[i].is_nan() == unknown(i)));
    }
}

#[test]
fn a_speed_that_is_a_code_for_seconds_is_missing() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    for code in [-1.0, -1.0 / 3.6, 255.0 / 3.6, 65.535] {
        let wrong = changed(&log, Channel::Speed, |speed| {
            speed[700..740].fill(code);
            speed[4500..4900].fill(code);
        });
        let checked = check(wrong);
        assert_eq!(
            kinds(&checked),
            [(FindingKind::Sentinel, "speed_mps", Action::Removed)],
            "{code}"
        );
        let speed = checked.log.channel(Channel::Speed).unwrap();
        assert_eq!(speed.iter().filter(|v| v.is_nan()).count(), 440, "{code}");
    }
}

#[test]
fn a_speed_that_drops_out_to_zero_is_missing_and_standstill_is_not() {
    let log = without(&drive(0.1), &[Channel::SpeedLimit]);
    let wrong = changed(&log, Channel::Speed, |speed| speed[700..740].fill(0.0));
    let checked = check(wrong);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Sentinel, "speed_mps", Action::Removed)]
    );
    let speed = checked.log.channel(Channel::Speed).unwrap();
    assert!((0..speed.len()).all(|i| speed[i].is_nan() == (700..740).contains(&i)));
}

#[test]
fn noise_at_standstill_and_reversing_are_nothing_wrong() {
    let log = changed(&drive(0.1), Channel::Speed, |speed| {
        speed
            .iter_mut()
            .filter(|v| **v == 0.0)
            .for_each(|v| *v = -0.01);
        for (i, v) in speed.iter_mut().take(80).enumerate() {
            *v = -0.05 * i.min(79 - i) as f64;
        }
    });
    assert_eq!(check(log).findings, []);
}

#[test]
fn a_wrong_sign_is_found_at_every_rate_and_in_short_logs() {
    for (step_s, samples) in [
        (0.1, 12_000),
        (0.1, 1100),
        (1.0, 1200),
        (1.0, 110),
        (2.0, 600),
    ] {
        let log = drive(step_s);
        let cut = log
            .channels()
            .map(|(channel, values)| (channel, values[..samples].to_vec()));
        let short = RawLog::new("log", log.time_s()[..samples].to_vec(), cut.collect()).unwrap();
        assert_eq!(check(short.clone()).findings, [], "{step_s} {samples}");
        let checked = check(times(&short, Channel::BatteryCurrent, -1.0));
        assert_eq!(
            kinds(&checked),
            [(
                FindingKind::CurrentSign,
                "battery_current_a",
                Action::SignFlipped
            )],
            "{step_s} {samples}"
        );
        assert_close(&checked.log, Channel::BatteryCurrent, &short);
    }
}

#[test]
fn a_current_without_a_sign_is_dropped() {
    let log = changed(&drive(1.0), Channel::BatteryCurrent, |a| {
        a.iter_mut().for_each(|a| *a = a.abs());
    });
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(
            FindingKind::CurrentSign,
            "battery_current_a",
            Action::Dropped
        )]
    );
}

#[test]
fn energy_that_comes_out_of_a_level_road_has_the_wrong_sign() {
    let cruise = |elevation_m: Option<fn(usize) -> f64>| {
        let len = 3000;
        let wave = |i: usize| (0.017 * i as f64).sin();
        let mut channels = vec![
            (
                Channel::Speed,
                (0..len)
                    .map(|i| 20.0 + 0.01 * wave(i))
                    .collect::<Vec<f64>>(),
            ),
            (Channel::BatteryVoltage, vec![350.0; len]),
            (
                Channel::BatteryCurrent,
                (0..len).map(|i| -20.0 + wave(3 * i + 7)).collect(),
            ),
        ];
        channels.extend(elevation_m.map(|z| (Channel::Elevation, (0..len).map(z).collect())));
        raw(ten_hertz(len), channels)
    };
    let level = |i: usize| 300.0 + (0.01 * i as f64).sin();
    let down = |i: usize| 800.0 - 0.1 * i as f64;
    assert_eq!(only(&cruise(Some(level))).2, Action::SignFlipped);
    assert_eq!(only(&cruise(None)).2, Action::Kept);
    assert_eq!(check(cruise(Some(down))).findings, []);
}

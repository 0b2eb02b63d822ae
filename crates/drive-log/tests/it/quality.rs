//! What is wrong with a recording, and what is not.

use drive_log::{Action, Channel, Checked, FindingKind, Preparation, RawLog, check, prepare};

use crate::{raw, same, ten_hertz};

pub(crate) fn kinds(checked: &Checked) -> Vec<(FindingKind, &str, Action)> {
    checked
        .findings
        .iter()
        .map(|f| (f.kind, f.channel.as_str(), f.action))
        .collect()
}

/// A car in traffic: lively speed, torque, volts, amps and a level road with bumps, `len` samples
/// at 10 Hz.
pub(crate) fn traffic(len: usize) -> RawLog {
    let wave = |f: f64, i: usize| (i as f64 * f).sin();
    let speed: Vec<f64> = (0..len)
        .map(|i| 15.0 + 5.0 * wave(0.013, i) + 0.1 * wave(0.7, i))
        .collect();
    let torque: Vec<f64> = (0..len)
        .map(|i| 60.0 * wave(0.013, i + 120) + wave(1.3, i))
        .collect();
    let current: Vec<f64> = torque
        .iter()
        .zip(&speed)
        .map(|(t, v)| t * v / 20.0 + 5.0)
        .collect();
    let channels = [
        (
            Channel::Accel,
            (0..len)
                .map(|i| 0.6 * wave(0.013, i + 120) + 0.05 * wave(2.1, i))
                .collect(),
        ),
        (
            Channel::Elevation,
            (0..len).map(|i| 500.0 + 3.0 * wave(0.002, i)).collect(),
        ),
        (Channel::MotorTorque, torque),
        (
            Channel::BatteryVoltage,
            current.iter().map(|a| 380.0 - 0.1 * a).collect(),
        ),
        (Channel::BatteryCurrent, current),
        (Channel::Speed, speed),
    ];
    raw(ten_hertz(len), channels)
}

pub(crate) fn changed(
    log: &RawLog,
    channel: Channel,
    change: impl FnOnce(&mut Vec<f64>),
) -> RawLog {
    let channels = log.channels().map(|(c, values)| (c, values.to_vec()));
    let mut channels: std::collections::BTreeMap<_, _> = channels.collect();
    change(
        channels
            .entry(channel)
            .or_insert_with(|| vec![0.0; log.len()]),
    );
    RawLog::new(log.name(), log.time_s().to_vec(), channels).unwrap()
}

#[test]
fn an_ordinary_drive_has_no_findings() {
    let log = traffic(6000);
    let checked = check(log.clone());
    assert_eq!(checked.findings, []);
    assert_eq!(checked.log, log);
}

#[test]
fn standing_still_is_not_frozen() {
    let mut log = traffic(6000);
    for channel in [
        Channel::Speed,
        Channel::Accel,
        Channel::MotorTorque,
        Channel::BatteryCurrent,
    ] {
        log = changed(&log, channel, |values| values[1000..5000].fill(0.0));
        // the car stops and starts gently
        log = changed(&log, channel, |values| {
            for i in 0..100 {
                values[900 + i] *= 1.0 - i as f64 / 100.0;
                values[5000 + i] *= i as f64 / 100.0;
            }
        });
    }
    log = changed(&log, Channel::BatteryVoltage, |values| {
        values[1000..5000].fill(380.0);
    });
    assert_eq!(check(log).findings, []);
}

#[test]
fn cruise_control_is_not_frozen() {
    let log = changed(&traffic(6000), Channel::Speed, |speed| {
        let cruise = speed[3000];
        speed[3000..3300].fill(cruise);
        for i in 0..100 {
            speed[3300 + i] = cruise + (speed[3300 + i] - cruise) * i as f64 / 100.0;
        }
    });
    assert_eq!(check(log).findings, []);
    // a cycle driven to the last bit: every phase constant, and all that a simulator computes from
    // it
    let len = 6000;
    let staircase: Vec<f64> = (0..len)
        .map(|i| 10.0 + (i / 700 % 2) as f64 * 0.5)
        .collect();
    let torque: Vec<f64> = staircase.iter().map(|v| v * 3.0).collect();
    let channels = [
        (Channel::MotorTorque, torque.clone()),
        (Channel::BatteryCurrent, torque.clone()),
        (
            Channel::BatteryVoltage,
            torque.iter().map(|t| 380.0 - t).collect(),
        ),
        (Channel::Speed, staircase),
    ];
    assert_eq!(check(raw(ten_hertz(len), channels)).findings, []);
}

#[test]
fn elevation_in_steps_is_not_frozen() {
    let log = changed(&traffic(6000), Channel::Elevation, |z| {
        z.iter_mut().for_each(|z| *z = z.round());
    });
    assert_eq!(check(log).findings, []);
    let level = changed(&traffic(6000), Channel::Elevation, |z| z.fill(0.0));
    assert_eq!(check(level).findings, [], "a simulator's level road");
}

#[test]
fn frozen_channels_are_removed_together() {
    let mut log = traffic(6000);
    let frozen = [
        Channel::Speed,
        Channel::Accel,
        Channel::MotorTorque,
        Channel::BatteryVoltage,
        Channel::BatteryCurrent,
    ];
    for channel in frozen {
        log = changed(&log, channel, |values| {
            let last = values[3000];
            values[3000..].fill(last);
        });
    }
    let checked = check(log.clone());
    let found: Vec<&str> = checked
        .findings
        .iter()
        .map(|f| f.channel.as_str())
        .collect();
    assert_eq!(found.len(), 5, "{:?}", checked.findings);
    for finding in &checked.findings {
        assert_eq!(
            (finding.kind, finding.action),
            (FindingKind::Frozen, Action::Removed)
        );
        assert_eq!((finding.from_s, finding.to_s), (300.0, 5999.0 * 0.1));
    }
    let drive = prepare(log, &Preparation::default()).unwrap();
    assert_eq!(
        drive
            .pieces
            .iter()
            .map(drive_log::DriveLog::len)
            .collect::<Vec<_>>(),
        [3001]
    );
}

#[test]
fn a_speed_frozen_alone() {
    let log = |s: usize| {
        changed(&traffic(6000), Channel::Speed, |speed| {
            let last = speed[2000];
            speed[2000..2000 + 10 * s].fill(last);
            let end = 2000 + 10 * s;
            for i in 0..100 {
                speed[end + i] = last + (speed[end + i] - last) * i as f64 / 100.0;
            }
        })
    };
    assert_eq!(kinds(&check(log(50))), []);
    assert_eq!(
        kinds(&check(log(70))),
        [(FindingKind::Frozen, "speed_mps", Action::Removed)]
    );
    let constant = raw(ten_hertz(6000), [(Channel::Speed, vec![10.0; 6000])]);
    assert_eq!(
        kinds(&check(constant)),
        [(FindingKind::Frozen, "speed_mps", Action::Kept)]
    );
}

#[test]
fn frozen_elevation() {
    let log = changed(&traffic(6000), Channel::Elevation, |z| z.fill(512.0));
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Frozen, "elevation_m", Action::Removed)]
    );
    assert!(
        checked.log.channel(Channel::Elevation).is_none(),
        "nothing is left of it"
    );
}

#[test]
fn spikes_and_splices_of_speed() {
    let spike = changed(&traffic(600), Channel::Speed, |speed| {
        speed[300..303].fill(60.0);
    });
    let checked = check(spike);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Spike, "speed_mps", Action::Removed)]
    );
    assert!(
        checked.log.channel(Channel::Speed).unwrap()[300..303]
            .iter()
            .all(|v| v.is_nan())
    );

    let splice = changed(&traffic(600), Channel::Speed, |speed| {
        speed[300..].iter_mut().for_each(|v| *v += 16.0);
    });
    assert_eq!(
        kinds(&check(splice.clone())),
        [(FindingKind::Splice, "speed_mps", Action::Split)]
    );
    let drive = prepare(splice, &Preparation::default()).unwrap();
    assert_eq!(
        drive
            .pieces
            .iter()
            .map(|p| (p.t0_s(), p.len()))
            .collect::<Vec<_>>(),
        [(0.0, 300), (30.0, 300)]
    );
    assert!(drive.pieces[0].accel_mps2().iter().all(|a| a.abs() < 2.0));
}

#[test]
fn hard_braking_at_one_hertz_is_no_splice() {
    let speed = vec![30.0, 30.0, 20.5, 11.0, 1.5, 0.0, 0.0];
    let time_s = (0..7).map(f64::from).collect();
    assert_eq!(check(raw(time_s, [(Channel::Speed, speed)])).findings, []);
}

#[test]
fn a_splice_of_the_charge() {
    let mut soc: Vec<f64> = (0..600).map(|i| 80.0 - f64::from(i) * 1e-3).collect();
    soc[300..].iter_mut().for_each(|v| *v -= 3.0);
    let log = changed(&traffic(600), Channel::StateOfCharge, |values| {
        *values = soc;
    });
    assert_eq!(
        kinds(&check(log.clone())),
        [(FindingKind::Splice, "soc_pct", Action::Kept)]
    );
    let with_speed = changed(&log, Channel::Speed, |speed| {
        speed[300..].iter_mut().for_each(|v| *v += 0.9);
    });
    assert_eq!(
        kinds(&check(with_speed)),
        [(FindingKind::Splice, "soc_pct", Action::Split)]
    );
}

#[test]
fn altitude_outliers() {
    let log = changed(&traffic(6000), Channel::Elevation, |z| {
        z[1000..1010].fill(520.0);
        z[2000..2400].fill(-111.0);
        z[3000..5000].iter_mut().for_each(|z| *z += 4.0);
    });
    let checked = check(log);
    let outlier = (FindingKind::AltitudeOutlier, "elevation_m", Action::Removed);
    assert_eq!(kinds(&checked), [outlier, outlier]);
    let z = checked.log.channel(Channel::Elevation).unwrap();
    let removed: Vec<usize> = (0..6000).filter(|&i| z[i].is_nan()).collect();
    assert_eq!(removed, (1000..1010).chain(2000..2400).collect::<Vec<_>>());
}

#[test]
fn values_that_cannot_be() {
    let mut log = changed(&traffic(600), Channel::LeadGap, |gap| {
        gap.fill(20.0);
        gap[5] = -0.3;
        gap[9] = -2.0;
    });
    log = changed(&log, Channel::StateOfCharge, |soc| {
        soc.fill(50.0);
        soc[7] = 6553.5;
    });
    let checked = check(log);
    let out = |channel| (FindingKind::OutOfRange, channel, Action::Removed);
    assert_eq!(kinds(&checked), [out("lead_gap_m"), out("soc_pct")]);
    assert!(
        checked.findings[0]
            .detail
            .contains("2 values from -2 to -0.3"),
        "{}",
        checked.findings[0].detail
    );
    assert!(checked.log.channel(Channel::LeadGap).unwrap()[5].is_nan());
}

#[test]
fn missing_values_are_told() {
    let log = changed(&traffic(600), Channel::StateOfCharge, |soc| {
        soc.fill(50.0);
        soc[590..].fill(f64::NAN);
    });
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(FindingKind::Missing, "soc_pct", Action::Kept)]
    );
    assert_eq!(checked.findings[0].from_s, 59.0);
}

#[test]
fn a_current_of_the_wrong_sign() {
    let log = changed(&traffic(6000), Channel::BatteryCurrent, |a| {
        a.iter_mut().for_each(|a| *a = -*a);
    });
    let checked = check(log);
    assert_eq!(
        kinds(&checked),
        [(
            FindingKind::CurrentSign,
            "battery_current_a",
            Action::SignFlipped
        )]
    );
    let flipped = checked.log.channel(Channel::BatteryCurrent).unwrap();
    assert!(same(
        flipped,
        traffic(6000).channel(Channel::BatteryCurrent).unwrap()
    ));
    // ten seconds are not enough to tell
    let short = changed(&traffic(100), Channel::BatteryCurrent, |a| {
        a.iter_mut().for_each(|a| *a = -*a);
    });
    assert_eq!(check(short).findings, []);
}

#[test]
fn time_out_of_order() {
    let time_s = vec![0.0, 0.1, 0.3, 0.2, 0.4, 0.4, 0.5];
    let speed = vec![0.0, 1.0, 3.0, 2.0, f64::NAN, 4.0, 5.0];
    let checked = check(raw(time_s, [(Channel::Speed, speed)]));
    assert_eq!(checked.log.time_s(), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
    assert_eq!(
        checked.log.channel(Channel::Speed).unwrap(),
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    );
    let found = kinds(&checked);
    assert!(
        found.contains(&(FindingKind::BackwardTime, "time", Action::Sorted)),
        "{found:?}"
    );
    assert!(
        found.contains(&(FindingKind::RepeatedTime, "time", Action::Dropped)),
        "{found:?}"
    );
}

#[test]
fn a_clock_that_was_set_back() {
    let time_s: Vec<f64> = ten_hertz(100).into_iter().chain(ten_hertz(100)).collect();
    let log = raw(time_s, [(Channel::Speed, vec![10.0; 200])]);
    let checked = check(log.clone());
    assert_eq!(
        kinds(&checked),
        [(FindingKind::BackwardTime, "time", Action::Split)]
    );
    let drive = prepare(log, &Preparation::default()).unwrap();
    assert_eq!(
        drive
            .pieces
            .iter()
            .map(drive_log::DriveLog::len)
            .collect::<Vec<_>>(),
        [100, 100]
    );
}

#[test]
fn a_single_time_far_ahead() {
    let mut time_s = ten_hertz(100);
    time_s[50] = 1e6;
    let checked = check(raw(time_s, [(Channel::Speed, vec![10.0; 100])]));
    assert_eq!(
        kinds(&checked),
        [(FindingKind::BackwardTime, "time", Action::Dropped)]
    );
    assert_eq!(checked.log.len(), 99);
}

#[test]
fn samples_without_a_time() {
    let mut time_s = ten_hertz(100);
    time_s[50] = f64::NAN;
    let checked = check(raw(time_s, [(Channel::Speed, vec![10.0; 100])]));
    assert_eq!(
        kinds(&checked),
        [(FindingKind::MissingTime, "time", Action::Dropped)]
    );
}

#[test]
fn findings_are_serialised_by_name() {
    let checked = check(raw(vec![0.0, 1.0, 9.0], [(Channel::Speed, vec![1.0; 3])]));
    let json = serde_json::to_value(&checked.findings).unwrap();
    assert_eq!(json[0]["kind"], "time_gap");
    assert_eq!(json[0]["action"], "kept");
    assert_eq!(json[0]["channel"], "time");
    assert_eq!(serde_json::to_value(Channel::Slope).unwrap(), "grade_rad");
}

//! A made drive, and what tests do to it.

use drive_log::{Action, Channel, FindingKind, RawLog, check};

use crate::quality::changed;
use crate::raw;

pub(crate) const GRAVITY_MPS2: f64 = 9.80665;
const MASS_KG: f64 = 1700.0;
const DRAG_AREA_M2: f64 = 0.7;

/// Twenty minutes in town and country, a sample every `step_s`: stops, limits of 50 and 100 km/h,
/// hills, an accelerometer, volts and amps of a car with two thirds of its braking regained.
pub(crate) fn drive(step_s: f64) -> RawLog {
    let len = (1200.0 / step_s) as usize;
    let time_s: Vec<f64> = (0..len).map(|i| i as f64 * step_s).collect();
    let speed: Vec<f64> = time_s.iter().map(|&t| speed_mps(t)).collect();
    let accel: Vec<f64> = time_s
        .iter()
        .map(|&t| (speed_mps(t + 0.05) - speed_mps(t - 0.05)) / 0.1)
        .collect();
    let mut elevation = vec![300.0];
    for i in 1..len {
        let way_m = 0.5 * (speed[i] + speed[i - 1]) * step_s;
        elevation.push(elevation[i - 1] + way_m * grade(time_s[i]));
    }
    let power_w = |i: usize| {
        let force_n = MASS_KG * (accel[i] + GRAVITY_MPS2 * (0.01 + grade(time_s[i])))
            + 0.6 * DRAG_AREA_M2 * speed[i].powi(2);
        let wheels_w = if speed[i] > 0.0 {
            force_n * speed[i]
        } else {
            0.0
        };
        500.0
            + if wheels_w > 0.0 {
                wheels_w / 0.85
            } else {
                wheels_w * 0.65
            }
    };
    let current: Vec<f64> = (0..len).map(|i| power_w(i) / 350.0).collect();
    let channels = [
        (
            Channel::Accelerometer,
            (0..len)
                .map(|i| accel[i] + GRAVITY_MPS2 * grade(time_s[i]))
                .collect(),
        ),
        (
            Channel::SpeedLimit,
            time_s.iter().map(|&t| limit_mps(t)).collect(),
        ),
        (Channel::Elevation, elevation),
        (Channel::BatteryVoltage, vec![350.0; len]),
        (Channel::BatteryCurrent, current),
        (Channel::Speed, speed),
    ];
    raw(time_s, channels)
}

/// Every second minute in the country.
fn limit_mps(t_s: f64) -> f64 {
    if ((t_s / 120.0) as usize).is_multiple_of(2) {
        50.0 / 3.6
    } else {
        100.0 / 3.6
    }
}

/// Up to about the limit and back to a stop once in two minutes.
pub(crate) fn speed_mps(t_s: f64) -> f64 {
    let top_mps = limit_mps(t_s);
    let phase_s = t_s.rem_euclid(120.0);
    let speed_mps = (1.7 * (phase_s - 10.0))
        .min(2.2 * (112.0 - phase_s))
        .min(top_mps);
    let wave = 0.03 * top_mps * (0.31 * t_s).sin() + 0.02 * top_mps * (0.13 * t_s).sin();
    if speed_mps <= 0.0 {
        0.0
    } else {
        speed_mps + wave * (speed_mps / top_mps).min(1.0)
    }
}

fn grade(t_s: f64) -> f64 {
    0.02 * (0.011 * t_s).sin()
}

pub(crate) fn without(log: &RawLog, dropped: &[Channel]) -> RawLog {
    let channels = log
        .channels()
        .filter(|(channel, _)| !dropped.contains(channel))
        .map(|(channel, values)| (channel, values.to_vec()));
    RawLog::new(log.name(), log.time_s().to_vec(), channels.collect()).unwrap()
}

pub(crate) fn times(log: &RawLog, channel: Channel, factor: f64) -> RawLog {
    changed(log, channel, |values| {
        values.iter_mut().for_each(|v| *v *= factor);
    })
}

/// The only finding, its channel and action.
#[track_caller]
pub(crate) fn only(log: &RawLog) -> (FindingKind, String, Action) {
    let checked = check(log.clone());
    assert_eq!(checked.findings.len(), 1, "{:#?}", checked.findings);
    let finding = &checked.findings[0];
    (finding.kind, finding.channel.clone(), finding.action)
}

#[track_caller]
pub(crate) fn assert_close(log: &RawLog, channel: Channel, expected: &RawLog) {
    let (found, expected) = (
        log.channel(channel).unwrap(),
        expected.channel(channel).unwrap(),
    );
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(
            a.is_nan() || (a - b).abs() < 1e-3 * (1.0 + b.abs()),
            "{i}: {a} for {b}"
        );
    }
}

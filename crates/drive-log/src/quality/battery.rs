//! Volts, amps and accelerations that stop.

use std::ops::Range;

use super::checked::Checked;
use super::motion::MOVING_MPS;
use super::runs::constant_runs;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// While the speed rises by so much, m/s, the current does not stay the same for so long, s: 0.1 s at most in 33 trips of a BMW
/// i3. A voltage does not while the current changes by so much, A: 3.2 s there, and 6 A.
const SPEED_RISE_MPS: f64 = 1.0;
const CURRENT_S: f64 = 3.0;
const VOLTAGE_S: f64 = 10.0;
const CURRENT_CHANGE_A: f64 = 30.0;

/// The share of a current's values at either end that may be spikes.
const TAIL: f64 = 0.05;

/// A channel is lively where under this share of the samples in motion repeats the one before, those of the stretch apart.
const LIVELY_SHARE: f64 = 0.5;
const LIVELY_SAMPLES: usize = 100;

/// No battery in motion has less than this share of its median voltage.
const DEAD_SHARE: f64 = 0.1;

/// Removes volts of nothing while the battery has some.
pub(super) fn remove_dead_voltage(checked: &mut Checked) {
    let Some(voltage_v) = checked.values(Channel::BatteryVoltage) else {
        return;
    };
    let known = voltage_v.iter().copied().filter(|v| v.is_finite());
    let Some(median_v) = quantile(&mut known.collect::<Vec<f64>>(), 0.5) else {
        return;
    };
    let dead: Vec<usize> = (0..voltage_v.len())
        .filter(|&i| voltage_v[i] < DEAD_SHARE * median_v)
        .collect();
    let (Some(&first), Some(&last)) = (dead.first(), dead.last()) else {
        return;
    };
    let detail = format!(
        "{} values below a tenth of the median, {median_v:.0} V: none measured",
        dead.len()
    );
    checked.report(
        FindingKind::Sentinel,
        Channel::BatteryVoltage,
        &(first..last + 1),
        Action::Removed,
        detail,
    );
    for i in dead {
        checked.remove(Channel::BatteryVoltage, i..i + 1);
    }
}

/// Removes an accelerometer that stays the same while the car accelerates.
pub(super) fn remove_still_accelerometer(checked: &mut Checked) {
    remove(
        checked,
        Channel::Accelerometer,
        CURRENT_S,
        |checked, run| rise(&checked.log.speed_mps()[run]) >= SPEED_RISE_MPS,
    );
}

/// Removes a current that stays the same while the car accelerates, and a voltage while the current does.
pub(super) fn remove_still(checked: &mut Checked) {
    remove(
        checked,
        Channel::BatteryCurrent,
        CURRENT_S,
        |checked, run| rise(&checked.log.speed_mps()[run]) >= SPEED_RISE_MPS,
    );
    remove(
        checked,
        Channel::BatteryVoltage,
        VOLTAGE_S,
        |checked, run| {
            checked
                .values(Channel::BatteryCurrent)
                .is_some_and(|current_a| spread(&current_a[run]) >= CURRENT_CHANGE_A)
        },
    );
}

fn remove(
    checked: &mut Checked,
    channel: Channel,
    least_s: f64,
    changes: impl Fn(&Checked, Range<usize>) -> bool,
) {
    let Some(values) = checked.values(channel) else {
        return;
    };
    let still: Vec<_> = constant_runs(values)
        .filter(|run| checked.duration_s(run) >= least_s && changes(checked, run.clone()))
        .collect();
    if still.is_empty() || !is_lively(checked, values, &still, LIVELY_SHARE) {
        return;
    }
    let (Some(first), Some(last)) = (still.first(), still.last()) else {
        return;
    };
    let lengths_s = still.iter().map(|run| checked.duration_s(run));
    let detail = format!(
        "one value for up to {:.1} s in which the car changes its power; stretches: {}",
        lengths_s.fold(0.0, f64::max),
        still.len(),
    );
    let range = first.start..last.end;
    checked.report(
        FindingKind::Frozen,
        channel,
        &range,
        Action::Removed,
        detail,
    );
    for run in still {
        checked.remove(channel, run);
    }
}

/// The largest rise from a value in motion to a later one.
fn rise(speed_mps: &[f64]) -> f64 {
    let moving = speed_mps.iter().filter(|v| **v > MOVING_MPS);
    let (_, rise_mps) = moving.fold((f64::INFINITY, 0.0_f64), |(low, rise), v| {
        let low = low.min(*v);
        (low, rise.max(v - low))
    });
    rise_mps
}

/// Between what a twentieth of the values is under and over: a spike is no change.
fn spread(values: &[f64]) -> f64 {
    let mut known: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let low = quantile(&mut known, TAIL);
    let high = quantile(&mut known, 1.0 - TAIL);
    high.zip(low).map_or(0.0, |(high, low)| high - low)
}

/// Whether a channel repeats a value in motion in less than a share of its samples, some stretches apart.
pub(super) fn is_lively(
    checked: &Checked,
    values: &[f64],
    apart: &[Range<usize>],
    share: f64,
) -> bool {
    let speed_mps = checked.log.speed_mps();
    let moving = |i: &usize| speed_mps[*i].abs() > MOVING_MPS && values[*i].is_finite();
    let mut apart = apart.iter().peekable();
    let (mut known, mut repeated) = (0_usize, 0_usize);
    for i in (1..values.len()).filter(moving) {
        while apart.next_if(|run| run.end < i).is_some() {}
        if apart.peek().is_some_and(|run| run.contains(&i)) {
            continue;
        }
        known += 1;
        repeated += usize::from(values[i].to_bits() == values[i - 1].to_bits());
    }
    known >= LIVELY_SAMPLES && (repeated as f64) < share * known as f64
}

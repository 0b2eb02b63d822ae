//! Power of heating and auxiliaries that is no power.

use std::collections::BTreeMap;
use std::ops::Range;

use super::checked::Checked;
use super::heating_windows::{self, Windows};
use super::motion::STANDSTILL_MPS;
use super::runs::constant_runs;
use crate::{Action, Channel, FindingKind};

/// A pulse: shorter than this, s, and higher than what is around it by this, W. Heaters ramp over
/// seconds.
const PULSE_S: f64 = 3.0;
const PULSE_W: f64 = 1000.0;

/// Pulses of one exact value that make it a code.
const PULSES: usize = 3;

/// Share of a pulse's height that the battery must deliver for the pulse to be true.
const FELT_SHARE: f64 = 0.5;

/// Time before and after a pulse against which the battery power is compared, s.
const AROUND_S: f64 = 0.5;

/// A heater regulates; one that draws the same for this share of the drive and this long, s, does
/// not. Below the power, W, it is off.
const PINNED_SHARE: f64 = 0.5;
const PINNED_S: f64 = 300.0;
const OFF_W: f64 = 50.0;

/// At standstill the battery gives what heating and auxiliaries take, and no less. A heater claims power
/// above the first, W; the second is the meters' tolerance, W.
pub(super) const CLAIM_W: f64 = 300.0;
const TOLERANCE_W: f64 = 200.0;

/// Claims at standstill that decide, s, and the share of them that the battery must contradict.
const CLAIMED_S: f64 = 5.0;
const CONTRADICTED_SHARE: f64 = 0.5;

/// Removes a value that comes in pulses again and again, to the last bit, and that the battery does
/// not feel.
pub(super) fn remove_sentinel(checked: &mut Checked) {
    let Some(power_w) = checked.values(Channel::HeatingPower) else {
        return;
    };
    let mut pulses: BTreeMap<u64, Vec<Range<usize>>> = BTreeMap::new();
    for run in constant_runs(power_w) {
        let around_w = (run.start > 0)
            .then(|| power_w[run.start - 1])
            .zip(power_w.get(run.end).copied());
        let value_w = power_w[run.start];
        let is_pulse =
            around_w.is_some_and(|(a, b)| value_w > a + PULSE_W && value_w > b + PULSE_W);
        if is_pulse && checked.duration_s(&run) < PULSE_S {
            pulses.entry(value_w.to_bits()).or_default().push(run);
        }
    }
    let Some((bits, pulses)) = pulses.into_iter().max_by_key(|(_, pulses)| pulses.len()) else {
        return;
    };
    let (Some(first), Some(last)) = (pulses.first(), pulses.last()) else {
        return;
    };
    if pulses.len() < PULSES {
        return;
    }
    let range = first.start..last.end;
    let value_w = f64::from_bits(bits);
    let pulsed = format!("{} pulses of exactly {value_w} W", pulses.len());
    match felt_share(checked, &pulses) {
        Some(share) if share < FELT_SHARE => {
            let samples: Vec<usize> = (0..power_w.len())
                .filter(|&i| power_w[i].to_bits() == bits)
                .collect();
            let detail = format!(
                "{pulsed}, of which the battery delivers {:.0} %; {} samples",
                100.0 * share,
                samples.len()
            );
            for i in samples {
                checked.remove(Channel::HeatingPower, i..i + 1);
            }
            checked.report(
                FindingKind::Sentinel,
                Channel::HeatingPower,
                &range,
                Action::Removed,
                detail,
            );
        }
        Some(_) => {}
        // a heater switched on and off looks the same
        None => checked.report(
            FindingKind::Sentinel,
            Channel::HeatingPower,
            &range,
            Action::Kept,
            pulsed,
        ),
    }
}

/// Median over the pulses of the battery's extra power over the pulse's height: the drive itself
/// changes the power within a second by more than a pulse, in both directions. `None` without volts
/// and amps.
fn felt_share(checked: &Checked, pulses: &[Range<usize>]) -> Option<f64> {
    let (voltage_v, current_a) = (
        checked.values(Channel::BatteryVoltage)?,
        checked.values(Channel::BatteryCurrent)?,
    );
    let (power_w, time_s) = (checked.values(Channel::HeatingPower)?, checked.log.time_s());
    let battery_w = |range: Range<usize>| mean(range.map(|i| voltage_v[i] * current_a[i]));
    let mut shares = Vec::with_capacity(pulses.len());
    for pulse in pulses {
        let start_s = time_s[pulse.start] - AROUND_S;
        let end_s = time_s[pulse.end - 1] + AROUND_S;
        let before = time_s.partition_point(|t| *t < start_s)..pulse.start;
        let after = pulse.end..time_s.partition_point(|t| *t <= end_s);
        if let (Some(during), Some(before), Some(after)) = (
            battery_w(pulse.clone()),
            battery_w(before),
            battery_w(after),
        ) {
            let height_w =
                power_w[pulse.start] - 0.5 * (power_w[pulse.start - 1] + power_w[pulse.end]);
            shares.push((during - 0.5 * (before + after)) / height_w);
        }
    }
    let middle = shares.len() / 2;
    (!shares.is_empty()).then(|| *shares.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for value in values.filter(|v| v.is_finite()) {
        sum += value;
        count += 1;
    }
    (count > 0).then(|| sum / count as f64)
}

/// Drops a heating channel that has one value for most of the drive.
pub(super) fn drop_pinned(checked: &mut Checked) {
    let Some(power_w) = checked.values(Channel::HeatingPower) else {
        return;
    };
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    for run in constant_runs(power_w) {
        *counts.entry(power_w[run.start].to_bits()).or_default() += run.len();
    }
    let finite: usize = counts.values().sum();
    let Some((bits, count)) = counts.into_iter().max_by_key(|(_, count)| *count) else {
        return;
    };
    let value_w = f64::from_bits(bits);
    let samples = 0..power_w.len();
    let pinned_s = checked.duration_s(&samples) * count as f64 / power_w.len() as f64;
    if value_w > OFF_W && count as f64 >= PINNED_SHARE * finite as f64 && pinned_s >= PINNED_S {
        let detail = format!(
            "{value_w} W in {:.0} % of the samples",
            100.0 * count as f64 / finite as f64
        );
        checked.report_all(
            FindingKind::Pinned,
            Channel::HeatingPower,
            Action::Dropped,
            detail,
        );
        checked.log.channels.remove(&Channel::HeatingPower);
    }
}

/// Drops auxiliaries and heating that the battery contradicts. Auxiliaries are judged by themselves, before they count beside heating.
pub(super) fn drop_contradicted(checked: &mut Checked) {
    for channel in [Channel::AuxPower, Channel::HeatingPower] {
        if let Some(detail) = contradiction(checked, channel) {
            drop_channel(checked, channel, detail);
        }
    }
}

/// Takes the power that was requested of the heater where there is none of the heater itself, or another one, and the battery
/// delivers it.
pub(super) fn take_request(checked: &mut Checked) {
    let Some(request_w) = checked.values(Channel::HeatingRequest).map(<[f64]>::to_vec) else {
        return;
    };
    let is_there = |values: &[f64]| values.iter().any(|value| value.is_finite());
    let windows = heating_windows::judge(checked);
    if checked.values(Channel::HeatingPower).is_some_and(is_there) {
        if let Some(mut windows) = windows {
            windows.believed.retain(|window| window.is_unsaid);
            take_windows(
                checked,
                &request_w,
                &windows,
                "the heating power is another one",
            );
        }
        return;
    }
    let wrong = contradiction(checked, Channel::HeatingRequest)
        .or_else(|| windows.as_ref().and_then(Windows::contradiction));
    match (wrong, windows) {
        (None, _) => {
            let detail = format!("{} taken in its place", Channel::HeatingRequest);
            replace(checked, FindingKind::Missing, request_w, detail);
        }
        (Some(wrong), Some(windows)) if !windows.believed.is_empty() => {
            take_windows(checked, &request_w, &windows, &wrong);
        }
        (Some(wrong), _) => drop_channel(checked, Channel::HeatingRequest, wrong),
    }
}

/// Takes the request in the windows in which the battery delivers it; in the others there is what there was, or no heating.
fn take_windows(checked: &mut Checked, request_w: &[f64], windows: &Windows, why: &str) {
    if windows.believed.is_empty() {
        return;
    }
    let said_w = checked.values(Channel::HeatingPower);
    let mut heating_w = said_w.map_or_else(|| vec![0.0; request_w.len()], <[f64]>::to_vec);
    for window in &windows.believed {
        heating_w[window.samples.clone()].copy_from_slice(&request_w[window.samples.clone()]);
    }
    let (taken, asked) = (windows.believed.len(), windows.asked);
    let detail = format!(
        "{} taken in {taken} of {asked} half minutes in which heat is asked for, where the battery delivers it: else {why}",
        Channel::HeatingRequest
    );
    replace(checked, FindingKind::Contradicted, heating_w, detail);
}

fn replace(checked: &mut Checked, kind: FindingKind, heating_w: Vec<f64>, detail: String) {
    let channels = &mut checked.log.channels;
    channels.insert(Channel::HeatingPower, heating_w);
    checked.report_all(kind, Channel::HeatingPower, Action::Replaced, detail);
}

fn drop_channel(checked: &mut Checked, channel: Channel, detail: String) {
    checked.report_all(FindingKind::Contradicted, channel, Action::Dropped, detail);
    checked.log.channels.remove(&channel);
}

/// What the battery says against the power of heating or auxiliaries at standstill; `None` where it says nothing.
fn contradiction(checked: &Checked, channel: Channel) -> Option<String> {
    let claim_w = checked.values(channel)?;
    let (voltage_v, current_a) = (
        checked.values(Channel::BatteryVoltage)?,
        checked.values(Channel::BatteryCurrent)?,
    );
    let speed_mps = checked.log.speed_mps();
    let beside = checked
        .values(Channel::AuxPower)
        .filter(|_| channel != Channel::AuxPower);
    let beside_w = |i: usize| beside.map_or(0.0, |aux| aux[i].max(0.0));
    let (mut claimed, mut contradicted) = (0_usize, 0_usize);
    for i in 0..claim_w.len() {
        let battery_w = voltage_v[i] * current_a[i];
        if speed_mps[i].abs() < STANDSTILL_MPS && claim_w[i] > CLAIM_W && battery_w.is_finite() {
            claimed += 1;
            contradicted += usize::from(battery_w < claim_w[i] + beside_w(i) - TOLERANCE_W);
        }
    }
    let samples = claim_w.len();
    let claimed_s = checked.duration_s(&(0..samples)) * claimed as f64 / samples as f64;
    let share = contradicted as f64 / claimed as f64;
    (claimed_s >= CLAIMED_S && share >= CONTRADICTED_SHARE).then(|| {
        format!(
            "the battery delivers less in {:.0} % of the {claimed_s:.0} s at standstill with over {CLAIM_W} W",
            100.0 * share
        )
    })
}

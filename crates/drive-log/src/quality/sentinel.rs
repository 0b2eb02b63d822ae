//! Values that are codes for "nothing measured".

use std::collections::BTreeMap;
use std::ops::Range;

use super::checked::Checked;
use super::runs::constant_runs;
use crate::{Action, Channel, FindingKind};

/// A code lasts longer than a spike, s, and at least this many samples.
const CODE_S: f64 = 2.0;
const CODE_SAMPLES: usize = 3;

/// Ends of a code's runs that are jumps which nothing on the road makes: at least two, and half of
/// all ends.
const JUMPS: usize = 2;

/// Samples further apart do not say whether there was a jump, s.
const NEIGHBOURS_S: f64 = 2.0;

/// Acceleration that tyres cannot transmit, m/s², and what a coarse sensor may add in one step, m/s.
const TYRE_LIMIT_MPS2: f64 = 10.0;
const COARSE_STEP_MPS: f64 = 1.0;

/// Two cars that meet head-on at the highest limits close in at 60 m/s or less; a rounded gap may add
/// some metres.
const CLOSING_MPS: f64 = 60.0;
const COARSE_STEP_M: f64 = 5.0;

/// A gap that stays the same to the last bit in motion is not measured, s: two cars never keep it for
/// so long. Faster than this, m/s, is motion.
const STEADY_GAP_S: f64 = 60.0;
const MOVING_MPS: f64 = 2.0;

/// No country has a limit over 160 km/h; the rest is a code for none or unknown, m/s.
pub(super) const HIGHEST_LIMIT_MPS: f64 = 45.0;

/// How the runs of a value begin and end, and whether one is longer than a spike.
#[derive(Default)]
struct Ends {
    jumps: usize,
    all: usize,
    is_long: bool,
}

/// Removes codes from the speed: an extreme that stays for seconds, entered and left by jumps,
/// wherever it is; of any other value, standstill above all, only what lies between two jumps. Updates of the speed may be
/// `interval_s` apart.
pub(super) fn remove_speed(checked: &mut Checked, interval_s: f64) {
    let possible = |step_s: f64| TYRE_LIMIT_MPS2 * (step_s + interval_s) + COARSE_STEP_MPS;
    for value in codes(checked, Channel::Speed, possible) {
        if value != 0.0 && is_extreme(checked, Channel::Speed, value) {
            let samples = samples_of(checked, Channel::Speed, value);
            remove_jumped(checked, &samples, value);
        }
    }
    let runs: Vec<Range<usize>> = constant_runs(checked.log.speed_mps())
        .filter(|run| is_long(checked, run))
        .filter(|run| jumps(checked, Channel::Speed, run, possible).0 == 2)
        .collect();
    for run in runs {
        let value = checked.log.speed_mps()[run.start];
        remove_jumped(checked, &run.collect::<Vec<usize>>(), value);
    }
}

fn remove_jumped(checked: &mut Checked, samples: &[usize], value_mps: f64) {
    let what = format!("{value_mps:.4} m/s, entered or left by jumps that no car makes");
    remove(checked, Channel::Speed, samples, &what);
}

/// Removes gaps to nothing: of exactly 0, which is bumper to bumper, and an extreme that is entered
/// and left by jumps or never changes; and what the speed of the car ahead says meanwhile.
pub(super) fn remove_gaps(checked: &mut Checked) {
    if checked.values(Channel::LeadGap).is_none() {
        return;
    }
    let zeros = samples_of(checked, Channel::LeadGap, 0.0);
    remove_gap(checked, &zeros, "0 m: no car ahead");
    let possible = |step_s: f64| CLOSING_MPS * step_s + COARSE_STEP_M;
    let mut values = codes(checked, Channel::LeadGap, possible);
    values.extend(steady_gaps(checked));
    for value in values {
        if is_extreme(checked, Channel::LeadGap, value) {
            let samples = samples_of(checked, Channel::LeadGap, value);
            remove_gap(checked, &samples, &format!("{value} m: no car ahead"));
        }
    }
}

/// Removes limits that are none: 0, and beyond every limit there is.
pub(super) fn remove_limits(checked: &mut Checked) {
    let Some(limit_mps) = checked.values(Channel::SpeedLimit) else {
        return;
    };
    let mut codes: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (i, &limit) in limit_mps.iter().enumerate() {
        if limit == 0.0 || limit > HIGHEST_LIMIT_MPS {
            codes.entry(limit.abs().to_bits()).or_default().push(i);
        }
    }
    for (bits, samples) in codes {
        let limit_mps = f64::from_bits(bits);
        let what = format!("{limit_mps:.2} m/s ({:.0} km/h): no limit", 3.6 * limit_mps);
        remove(checked, Channel::SpeedLimit, &samples, &what);
    }
}

/// Values that stay for longer than a spike and whose runs are entered and left by jumps.
fn codes(checked: &Checked, channel: Channel, possible: impl Fn(f64) -> f64 + Copy) -> Vec<f64> {
    let Some(values) = checked.values(channel) else {
        return Vec::new();
    };
    let mut found: BTreeMap<u64, Ends> = BTreeMap::new();
    for run in constant_runs(values) {
        let (jumps, all) = jumps(checked, channel, &run, possible);
        let ends = found.entry(values[run.start].to_bits()).or_default();
        ends.jumps += jumps;
        ends.all += all;
        ends.is_long |= is_long(checked, &run);
    }
    found
        .into_iter()
        .filter(|(_, ends)| ends.is_long && ends.jumps >= JUMPS && 2 * ends.jumps >= ends.all)
        .map(|(bits, _)| f64::from_bits(bits))
        .collect()
}

fn is_long(checked: &Checked, run: &Range<usize>) -> bool {
    run.len() >= CODE_SAMPLES && checked.duration_s(run) >= CODE_S
}

/// Of the ends of a run, how many are jumps beyond what is possible, and how many have a neighbour.
fn jumps(
    checked: &Checked,
    channel: Channel,
    run: &Range<usize>,
    possible: impl Fn(f64) -> f64,
) -> (usize, usize) {
    let (Some(values), time_s) = (checked.values(channel), checked.log.time_s()) else {
        return (0, 0);
    };
    let before = (0..run.start).rev().find(|&i| values[i].is_finite());
    let after = (run.end..values.len()).find(|&i| values[i].is_finite());
    let neighbours = [before.zip(Some(run.start)), after.zip(Some(run.end - 1))];
    let mut counts = (0, 0);
    for (neighbour, end) in neighbours.into_iter().flatten() {
        let step_s = (time_s[neighbour] - time_s[end]).abs();
        if step_s <= NEIGHBOURS_S {
            let is_jump = (values[neighbour] - values[end]).abs() > possible(step_s);
            counts = (counts.0 + usize::from(is_jump), counts.1 + 1);
        }
    }
    counts
}

/// Gaps that stay the same to the last bit while the speed changes.
fn steady_gaps(checked: &Checked) -> Vec<f64> {
    let Some(gap_m) = checked.values(Channel::LeadGap) else {
        return Vec::new();
    };
    let is_steady = |run: &Range<usize>| {
        let speeds = checked.log.speed_mps()[run.clone()].iter();
        let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
        checked.duration_s(run) >= STEADY_GAP_S && high - low > MOVING_MPS
    };
    let mut values: Vec<f64> = constant_runs(gap_m)
        .filter(is_steady)
        .map(|run| gap_m[run.start])
        .collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Whether a value is the lowest or the highest of its channel.
fn is_extreme(checked: &Checked, channel: Channel, value: f64) -> bool {
    checked.values(channel).is_some_and(|values| {
        !values.iter().any(|v| *v < value) || !values.iter().any(|v| *v > value)
    })
}

#[allow(clippy::float_cmp)] // a code is the same to the last bit
fn samples_of(checked: &Checked, channel: Channel, value: f64) -> Vec<usize> {
    let values = checked.values(channel).unwrap_or_default();
    (0..values.len()).filter(|&i| values[i] == value).collect()
}

/// Removes gaps, and the speed of the car ahead where it has one value at all of them.
fn remove_gap(checked: &mut Checked, samples: &[usize], what: &str) {
    let code = samples.first().and_then(|&first| {
        let lead_mps = checked.values(Channel::LeadSpeed)?;
        let same = |&i: &usize| lead_mps[i].to_bits() == lead_mps[first].to_bits();
        (lead_mps[first].is_finite() && samples.iter().all(same)).then_some(lead_mps[first])
    });
    if let Some(lead_mps) = code {
        let what = format!("{lead_mps} m/s where the gap is {what}");
        remove(checked, Channel::LeadSpeed, samples, &what);
    }
    remove(checked, Channel::LeadGap, samples, what);
}

fn remove(checked: &mut Checked, channel: Channel, samples: &[usize], what: &str) {
    let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else {
        return;
    };
    for &i in samples {
        checked.remove(channel, i..i + 1);
    }
    checked.report(
        FindingKind::Sentinel,
        channel,
        &(first..last + 1),
        Action::Removed,
        format!("{} samples of {what}", samples.len()),
    );
}

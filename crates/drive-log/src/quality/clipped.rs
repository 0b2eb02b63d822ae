//! Values at the end of a sensor's range.

use std::ops::Range;

use super::battery::is_lively;
use super::checked::Checked;
use super::motion::{MOVING_MPS, STANDSTILL_MPS};
use super::runs::constant_runs;
use crate::statistics::{mean, quantile};
use crate::{Action, Channel, FindingKind};

/// A measured extreme is reached for a moment: by three samples at most in 33 trips of a BMW i3. A plateau is one of at least so
/// many seconds and samples together, in runs of so long and so many.
const PLATEAU_S: f64 = 3.0;
const SAMPLES: usize = 20;
const RUN_S: f64 = 0.4;
const RUN_SAMPLES: usize = 3;

/// Share of the other samples in motion that may repeat the one before.
const LIVELY_SHARE: f64 = 0.1;

/// The share of the samples at standstill at which a current of 0 is one without auxiliaries.
const SWITCHED_OFF: f64 = 0.5;

/// A speed limiter makes plateaus too. At the end of the range the car still gathers speed: so much, m/s², is felt more than is usual over
/// the first so many seconds of half of them.
const BEGINNING_S: f64 = 1.5;
const GOES_ON_MPS2: f64 = 0.3;

/// Removes speeds and currents at the end of the range: what was there is not known.
pub(super) fn remove(checked: &mut Checked) {
    remove_at(checked, Channel::Speed, 1.0);
    remove_at(checked, Channel::BatteryCurrent, 1.0);
    remove_at(checked, Channel::BatteryCurrent, -1.0);
}

/// Whether the car still gathers speed where the plateaus of its speed begin.
fn goes_on(checked: &Checked, plateaus: &[Range<usize>]) -> bool {
    let Some(felt_mps2) = checked.values(Channel::Accelerometer) else {
        return false;
    };
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let moving = (0..speed_mps.len()).filter(|&i| speed_mps[i].abs() > MOVING_MPS);
    let mut usual: Vec<f64> = moving
        .map(|i| felt_mps2[i])
        .filter(|a| a.is_finite())
        .collect();
    let Some(usual_mps2) = quantile(&mut usual, 0.5) else {
        return false;
    };
    let beginning = |run: &Range<usize>| {
        let end = time_s.partition_point(|t| *t <= time_s[run.start] + BEGINNING_S);
        mean(felt_mps2[run.start..end.min(run.end)].iter().copied())
    };
    let mut felt: Vec<f64> = plateaus.iter().filter_map(beginning).collect();
    quantile(&mut felt, 0.5).is_some_and(|felt| felt - usual_mps2 > GOES_ON_MPS2)
}

/// At the upper end for 1, at the lower for −1; not where all values are on the other side of 0.
fn remove_at(checked: &mut Checked, channel: Channel, side: f64) {
    let Some(values) = checked.values(channel) else {
        return;
    };
    let end_of = |side: f64| side * values.iter().map(|v| side * v).fold(f64::NAN, f64::max);
    let (end, other) = (end_of(side), end_of(-side));
    let (mut plateaus, mut at_either) = (Vec::new(), Vec::new());
    for run in constant_runs(values) {
        let is_at = |end: f64| bits(values[run.start]) == bits(end);
        let is_long = run.len() >= RUN_SAMPLES && checked.duration_s(&run) >= RUN_S;
        if is_at(end) && is_long && moves(checked, &run) {
            plateaus.push(run.clone());
        }
        if is_at(end) || is_at(other) {
            at_either.push(run);
        }
    }
    let (Some(first), Some(last)) = (plateaus.first(), plateaus.last()) else {
        return;
    };
    let total_s: f64 = plateaus.iter().map(|run| checked.duration_s(run)).sum();
    let samples: usize = plateaus.iter().map(Range::len).sum();
    if total_s < PLATEAU_S
        || samples < SAMPLES
        || side * end < 0.0
        || !is_lively(checked, values, &at_either, LIVELY_SHARE)
        || bits(end) == 0 && is_usual_at_standstill(checked, channel)
    {
        return;
    }
    let figures = format!(
        "{} stretches of exactly {:.3}, {total_s:.0} s in all, and none beyond",
        plateaus.len(),
        f64::from_bits(bits(end))
    );
    let range = first.start..last.end;
    if channel == Channel::Speed && !goes_on(checked, &plateaus) {
        let detail = format!(
            "{figures}: a limiter, or the end of the range, above which speeds are not known"
        );
        return checked.report(FindingKind::Clipped, channel, &range, Action::Kept, detail);
    }
    let detail = format!("{figures}: the end of the range");
    checked.report(
        FindingKind::Clipped,
        channel,
        &range,
        Action::Removed,
        detail,
    );
    for run in plateaus {
        checked.remove(channel, run);
    }
}

/// A car that stands may be charged at one current.
fn moves(checked: &Checked, run: &Range<usize>) -> bool {
    let speed_mps = &checked.log.speed_mps()[run.clone()];
    mean(speed_mps.iter().map(|v| v.abs())).is_some_and(|v| v > MOVING_MPS)
}

/// To compare values; −0 is 0.
fn bits(value: f64) -> u64 {
    (value + 0.0).to_bits()
}

/// Whether the current is 0 while the car stands.
fn is_usual_at_standstill(checked: &Checked, channel: Channel) -> bool {
    let values = checked.values(channel).unwrap_or_default();
    let standing = values
        .iter()
        .zip(checked.log.speed_mps())
        .filter(|(value, v)| value.is_finite() && v.abs() < STANDSTILL_MPS);
    let (zeros, all) = standing.fold((0_usize, 0_usize), |(zeros, all), (value, _)| {
        (zeros + usize::from(*value == 0.0), all + 1)
    });
    zeros as f64 >= SWITCHED_OFF * all as f64
}

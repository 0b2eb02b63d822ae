//! Channels that stand still while the car moves.

use std::ops::Range;

use super::checked::Checked;
use super::runs::constant_runs;
use crate::{Action, Channel, FindingKind};

/// A car this fast moves; below, a speed may be a sensor's offset at standstill.
const MOVING_MPS: f64 = 0.5;

/// Measured at every moment of a drive, so that none is the same to the last bit for seconds, let
/// alone two of them.
const RESTLESS: [Channel; 5] = [
    Channel::Accel,
    Channel::Accelerometer,
    Channel::MotorTorque,
    Channel::BatteryVoltage,
    Channel::BatteryCurrent,
];

/// How long a constant speed must last to be frozen, s. The longest constant phase of the standard
/// cycles has 70 s (NEDC), and simulators drive them to the last bit; a lively sensor never repeats
/// for 10 s.
const TOGETHER_LIVELY_S: f64 = 10.0;
const TOGETHER_S: f64 = 90.0;
const ALONE_LIVELY_S: f64 = 60.0;
const ALONE_S: f64 = 300.0;

/// A speed is lively where under this share of the samples in motion repeats the one before.
const LIVELY_SHARE: f64 = 0.1;

/// Samples in motion that tell whether a speed is lively.
const LIVELY_SAMPLES: usize = 100;

/// Channels that freeze together stop within this time, s: buses have messages of different
/// periods.
const TOGETHER_WITHIN_S: f64 = 10.0;

/// Distance over which no road keeps its elevation to the last digit, m: roads are built with 0.3 %
/// or more for drainage. Recorders with few satellite fixes hold the last one for up to 4.5 km
/// (BMW i3 trips), which is coarse rather than frozen.
const LEVEL_M: f64 = 5000.0;

/// Removes a frozen speed and the channels that froze with it. The first sample of a run may be
/// true and stays.
pub(super) fn remove_speed(checked: &mut Checked) {
    let speed_mps = checked.log.speed_mps();
    let (moving, repeated) = motion(speed_mps);
    let runs: Vec<Range<usize>> = constant_runs(speed_mps)
        .filter(|run| {
            speed_mps[run.start].abs() > MOVING_MPS && checked.duration_s(run) >= TOGETHER_LIVELY_S
        })
        .collect();
    for run in runs {
        let run = frozen_part(checked, run);
        let together = RESTLESS
            .into_iter()
            .filter(|c| freezes_in(checked, *c, &run))
            .count()
            >= 2;
        let lively = is_lively(
            moving.saturating_sub(run.len()),
            repeated.saturating_sub(run.len() - 1),
        );
        let needed_s = match (together, lively) {
            (true, true) => TOGETHER_LIVELY_S,
            (true, false) => TOGETHER_S,
            (false, true) => ALONE_LIVELY_S,
            (false, false) => ALONE_S,
        };
        if checked.duration_s(&run) < needed_s || !together && is_limited(checked, &run) {
            continue;
        }
        if !together && !lively {
            // a test at constant speed looks the same
            report(checked, Channel::Speed, &run, Action::Kept);
            continue;
        }
        let frozen: Vec<Channel> = Channel::ALL
            .into_iter()
            .filter(|c| together && *c != Channel::Speed && stops_with(checked, *c, &run))
            .collect();
        for channel in std::iter::once(Channel::Speed).chain(frozen) {
            report(checked, channel, &run, Action::Removed);
            checked.remove(channel, run.start + 1..run.end);
        }
    }
}

/// Whether a run is at the speed that a limiter may hold, which is reported.
fn is_limited(checked: &Checked, run: &Range<usize>) -> bool {
    let speed_mps = checked.log.speed_mps();
    let is_reported = checked.findings.iter().any(|finding| {
        finding.kind == FindingKind::Clipped
            && finding.action == Action::Kept
            && finding.channel == Channel::Speed.name()
    });
    is_reported && !speed_mps.iter().any(|v| *v > speed_mps[run.start])
}

/// The part of a run in which the two channels that stand still for longest do so too: a rounded speed may have stood before.
fn frozen_part(checked: &Checked, run: Range<usize>) -> Range<usize> {
    let still = RESTLESS.into_iter().filter_map(|channel| {
        let values = &checked.values(channel)?[run.clone()];
        let longest = constant_runs(values).max_by_key(Range::len)?;
        Some(run.start + longest.start..run.start + longest.end)
    });
    let mut still: Vec<Range<usize>> = still.collect();
    still.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let [first, second, ..] = still.as_slice() else {
        return run;
    };
    let part = first.start.max(second.start)..first.end.min(second.end);
    if part.is_empty() || checked.duration_s(&part) < TOGETHER_LIVELY_S {
        return run;
    }
    part
}

fn report(checked: &mut Checked, channel: Channel, run: &Range<usize>, action: Action) {
    let value = checked
        .values(channel)
        .map_or(f64::NAN, |values| values[run.start]);
    let detail = format!(
        "constant at {value:.6} for {:.1} s in motion",
        checked.duration_s(run)
    );
    checked.report(FindingKind::Frozen, channel, run, action, detail);
}

/// Whether a channel is constant during a run and not everywhere.
fn freezes_in(checked: &Checked, channel: Channel, run: &Range<usize>) -> bool {
    checked.values(channel).is_some_and(|values| {
        let same = |v: &f64| v.to_bits() == values[run.start].to_bits();
        values[run.start].is_finite()
            && values[run.clone()].iter().all(same)
            && values.iter().any(|v| v.is_finite() && !same(v))
    })
}

/// Whether a channel freezes in a run, and stops or starts again when it does.
fn stops_with(checked: &Checked, channel: Channel, run: &Range<usize>) -> bool {
    let Some(values) = checked.values(channel) else {
        return false;
    };
    if !freezes_in(checked, channel, run) {
        return false;
    }
    let same = |v: &&f64| v.to_bits() == values[run.start].to_bits();
    let start = run.start - values[..run.start].iter().rev().take_while(same).count();
    let end = run.end + values[run.end..].iter().take_while(same).count();
    let before_s = checked.duration_s(&(start..run.start + 1));
    let after_s = checked.duration_s(&(run.end - 1..end));
    (start > 0 && before_s <= TOGETHER_WITHIN_S)
        || (end < values.len() && after_s <= TOGETHER_WITHIN_S)
}

/// Samples in motion, and how many of them repeat the one before.
fn motion(speed_mps: &[f64]) -> (usize, usize) {
    let moving = speed_mps.iter().filter(|v| v.abs() > MOVING_MPS).count();
    let repeats =
        |pair: &&[f64]| pair[1].abs() > MOVING_MPS && pair[1].to_bits() == pair[0].to_bits();
    (moving, speed_mps.windows(2).filter(repeats).count())
}

fn is_lively(moving: usize, repeated: usize) -> bool {
    moving >= LIVELY_SAMPLES && (repeated as f64) < LIVELY_SHARE * moving as f64
}

/// Removes an elevation that does not change over kilometres. Zero stays: simulators write it for a
/// level road.
pub(super) fn remove_elevation(checked: &mut Checked) {
    let Some(elevation_m) = checked.values(Channel::Elevation) else {
        return;
    };
    let distance_m = checked.distance_m();
    let runs: Vec<Range<usize>> = constant_runs(elevation_m)
        .filter(|run| {
            elevation_m[run.start] != 0.0
                && distance_m[run.end - 1] - distance_m[run.start] >= LEVEL_M
        })
        .collect();
    for run in runs {
        let level_km = (distance_m[run.end - 1] - distance_m[run.start]) / 1e3;
        let detail = format!("constant for {level_km:.2} km");
        checked.report(
            FindingKind::Frozen,
            Channel::Elevation,
            &run,
            Action::Removed,
            detail,
        );
        checked.remove(Channel::Elevation, run);
    }
}

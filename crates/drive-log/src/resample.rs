//! From irregular samples to the uniform grid.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::longitude::{turned_deg, unrolled_deg};
use crate::quality::Checked;
use crate::statistics::median_step_s;
use crate::{
    Action, Channel, DriveLog, Error, Finding, FindingKind, Preparation, RawLog, Smoothing, hann,
};

/// Samples this close to a grid point, in steps, are on it: decimal times such as 0.3 are not
/// multiples of 0.1 in binary.
pub(crate) const ON_GRID: f64 = 1e-6;

/// Samples of a grid at most: more than a month at 10 Hz, and a few GB with all channels.
const MAX_SAMPLES: usize = 1 << 25;

/// Cuts a checked recording into pieces and resamples each.
pub(crate) fn drives(
    checked: Checked,
    options: &Preparation,
) -> Result<(Vec<DriveLog>, Vec<Finding>), Error> {
    let Checked {
        log,
        mut findings,
        cuts,
        ..
    } = checked;
    let valid: Vec<usize> = (0..log.len())
        .filter(|&i| log.speed_mps()[i].is_finite())
        .collect();
    let ranges = pieces(&log, &valid, &cuts, options.max_gap_s, &mut findings);
    if ranges.is_empty() {
        return Err(Error::NoPiece {
            log: log.name().to_owned(),
            samples: log.len(),
            max_gap_s: options.max_gap_s,
        });
    }
    let mut drives = Vec::with_capacity(ranges.len());
    for (i, range) in ranges.iter().enumerate() {
        let name = if ranges.len() == 1 {
            log.name().to_owned()
        } else {
            format!("{}/{}", log.name(), i + 1)
        };
        drives.push(resampled(&log, range.clone(), name, options)?);
    }
    findings.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
    Ok((drives, findings))
}

/// Runs of samples, ends valid, that hold no cut and no gap longer than `max_gap_s` between valid
/// speeds.
fn pieces(
    log: &RawLog,
    valid: &[usize],
    cuts: &[usize],
    max_gap_s: f64,
    findings: &mut Vec<Finding>,
) -> Vec<Range<usize>> {
    let time_s = log.time_s();
    // gaps in time are known by now, those without a speed only here: long ones of both are
    // reported below
    findings.retain(|f| !(f.kind == FindingKind::TimeGap && f.to_s - f.from_s > max_gap_s));
    for finding in findings
        .iter_mut()
        .filter(|f| f.kind == FindingKind::TimeGap)
    {
        finding.action = Action::Interpolated;
    }
    let mut pieces = Vec::new();
    let mut start = 0;
    for end in 1..=valid.len() {
        if end < valid.len() {
            let (from, to) = (valid[end - 1], valid[end]);
            let gap_s = time_s[to] - time_s[from];
            let cuts_up_to = |sample: usize| cuts.partition_point(|cut| *cut <= sample);
            let cut = cuts_up_to(from) < cuts_up_to(to);
            if gap_s > max_gap_s {
                let detail = format!("no valid speed for {gap_s:.3} s, longer than {max_gap_s} s");
                let span_s = (time_s[from], time_s[to]);
                findings.push(Finding::of_time(
                    FindingKind::TimeGap,
                    span_s,
                    Action::Split,
                    detail,
                ));
            } else if !cut {
                continue;
            }
        }
        if end - start >= 2 {
            pieces.push(valid[start]..valid[end - 1] + 1);
        } else if start < end {
            let at_s = time_s[valid[start]];
            let detail = "a single sample is no drive".to_owned();
            findings.push(Finding::of_time(
                FindingKind::TooShort,
                (at_s, at_s),
                Action::Dropped,
                detail,
            ));
        }
        start = end;
    }
    pieces
}

fn resampled(
    log: &RawLog,
    range: Range<usize>,
    name: String,
    options: &Preparation,
) -> Result<DriveLog, Error> {
    let time_s = &log.time_s()[range.clone()];
    let (t0_s, duration_s) = (time_s[0], time_s[time_s.len() - 1] - time_s[0]);
    let steps = duration_s / options.step_s + ON_GRID;
    if steps >= MAX_SAMPLES as f64 {
        return Err(Error::TooManySamples {
            log: name,
            duration_s,
            step_s: options.step_s,
            limit: MAX_SAMPLES,
        });
    }
    let len = steps as usize + 1;
    let mut channels = BTreeMap::new();
    for (channel, values) in log.channels() {
        let values = &values[range.clone()];
        let max_gap_s = if channel == Channel::Speed {
            f64::INFINITY
        } else {
            options.max_gap_s
        };
        let holds = channel == Channel::SpeedLimit;
        let is_longitude = channel == Channel::Longitude;
        let unrolled = is_longitude.then(|| unrolled_deg(values));
        let values = unrolled.as_deref().unwrap_or(values);
        let mut on_grid = interpolated(time_s, values, options.step_s, len, max_gap_s, holds);
        if is_longitude {
            on_grid
                .iter_mut()
                .for_each(|deg| *deg = turned_deg(*deg, 0.0));
        }
        if let (Channel::Speed, Smoothing::Hann(length)) = (channel, options.smooth) {
            on_grid = hann(&on_grid, length);
        }
        channels.insert(channel, on_grid);
    }
    DriveLog::new(name, t0_s, options.step_s, channels)
}

/// Values at `t0 + i·step` between the valid samples around, NaN where these are further apart than
/// `max_gap_s`. A value that `holds` is the last one before, not the line to the next.
fn interpolated(
    time_s: &[f64],
    values: &[f64],
    step_s: f64,
    len: usize,
    max_gap_s: f64,
    holds: bool,
) -> Vec<f64> {
    let mut valid = (0..values.len())
        .filter(|&i| values[i].is_finite())
        .map(|i| (time_s[i], values[i]));
    let (t0_s, near_s) = (time_s[0], ON_GRID * step_s);
    let mut before: Option<(f64, f64)> = None;
    let mut after = valid.next();
    let mut on_grid = Vec::with_capacity(len);
    for i in 0..len {
        let t_s = t0_s + i as f64 * step_s;
        while let Some(sample) = after
            && sample.0 <= t_s + near_s
        {
            before = after;
            after = valid.next();
        }
        on_grid.push(match (before, after) {
            (Some((t, value)), _) if t >= t_s - near_s => value,
            (Some((t, value)), _) if holds => {
                if t_s - t <= max_gap_s {
                    value
                } else {
                    f64::NAN
                }
            }
            (Some((t, value)), Some((next_t, next))) if next_t - t <= max_gap_s => {
                value + (next - value) * ((t_s - t) / (next_t - t))
            }
            _ => f64::NAN,
        });
    }
    on_grid
}

/// A recording that is uniform already, as it is.
pub(crate) fn uniform(log: RawLog, step_s: f64) -> Result<DriveLog, Error> {
    let time_s = log.time_s();
    let t0_s = time_s[0];
    let step_s = recorded_step_s(time_s, step_s);
    let not_uniform = |index: usize, found: String| Error::NotUniform {
        log: log.name().to_owned(),
        index,
        at_s: time_s[index],
        step_s,
        found,
    };
    for (index, &at_s) in time_s.iter().enumerate() {
        let off_s = at_s - on(t0_s, step_s, index);
        if off_s.is_nan() || off_s.abs() > ON_GRID * step_s {
            return Err(not_uniform(index, format!("{off_s:+.6} s off the grid")));
        }
        if !log.speed_mps()[index].is_finite() {
            return Err(not_uniform(index, "no speed".to_owned()));
        }
    }
    DriveLog::new(log.name().to_owned(), t0_s, step_s, log.channels)
}

fn on(t0_s: f64, step_s: f64, index: usize) -> f64 {
    t0_s + index as f64 * step_s
}

/// The step of a uniform recording: the one asked for if it fits, else the mean one, rounded to
/// microseconds if that fits.
fn recorded_step_s(time_s: &[f64], asked_s: f64) -> f64 {
    let last = time_s.len() - 1;
    if last == 0 {
        return asked_s;
    }
    let mean_s = (time_s[last] - time_s[0]) / last as f64;
    let fits = |step_s: f64| {
        step_s > 0.0 && (on(time_s[0], step_s, last) - time_s[last]).abs() <= ON_GRID * step_s
    };
    let rounded_s = (mean_s * 1e6).round() / 1e6;
    if fits(asked_s) {
        asked_s
    } else if fits(rounded_s) {
        rounded_s
    } else if mean_s > 0.0 && mean_s.is_finite() {
        mean_s
    } else {
        // repeated or missing times: the sample that does not fit is named against the median
        median_step_s(time_s).max(f64::MIN_POSITIVE)
    }
}

//! When a held channel was renewed, and the line between its updates.

use super::super::runs::constant_runs;
use super::renewal::Renewal;

/// A value that stays for longer than a long interval, times this, was renewed in between.
const RENEWED: f64 = 1.25;

/// Rounds in which the times of updates are evened out: enough for rows that beat with the updates once in ten or twenty.
const ROUNDS: usize = 100;

/// An update lies after the row before it, by this share of the step to its own.
const AFTER: f64 = 0.01;

/// Even times are better than those of the rows if they leave less than this of the roughness.
const SMOOTHER: f64 = 0.9;

/// An update that is seen in the first row with its value.
#[derive(Debug, Clone, Copy)]
struct Update {
    value: f64,
    /// The row before it is still without, s; the first row with it, s.
    earliest_s: f64,
    latest_s: f64,
}

/// The updates of a stretch without missing values, in order, and their times.
pub(super) struct Updates {
    updates: Vec<Update>,
    time_s: Vec<f64>,
}

impl Updates {
    /// Every change of the value, and the times at which one that stays was renewed.
    ///
    /// Rows see an update late by up to a row. Where even times of updates between the rows make the motion smoother than the
    /// times of the rows, they are taken.
    pub(super) fn of(time_s: &[f64], values: &[f64], renewal: Renewal) -> Self {
        let updates = found(time_s, values, renewal);
        let seen_s: Vec<f64> = updates.iter().map(|update| update.latest_s).collect();
        let even_s = evened_out(&updates);
        let time_s = if roughness(&updates, &even_s) < SMOOTHER * roughness(&updates, &seen_s) {
            even_s
        } else {
            seen_s
        };
        Self { updates, time_s }
    }

    pub(super) fn len(&self) -> usize {
        self.updates.len()
    }

    /// The line between updates at each time; with `keep_gaps`, only the first rows that see one.
    pub(super) fn write(&self, time_s: &[f64], values: &mut [f64], keep_gaps: bool) {
        let mut last = 0;
        for (i, t_s) in time_s.iter().enumerate() {
            let is_before = |k: usize| self.time_s.get(k).is_some_and(|u_s| *u_s <= *t_s);
            let is_new = i == 0 || is_before(last + 1);
            while is_before(last + 1) {
                last += 1;
            }
            if is_new || !keep_gaps {
                values[i] = self.at(last, *t_s, keep_gaps);
            }
        }
    }

    /// The value at a time that follows update `k`.
    fn at(&self, k: usize, t_s: f64, holds: bool) -> f64 {
        let (from, from_s) = (self.updates[k].value, self.time_s[k]);
        match (self.updates.get(k + 1), self.time_s.get(k + 1)) {
            (Some(next), Some(next_s)) if !holds && t_s > from_s => {
                from + (next.value - from) * ((t_s - from_s) / (next_s - from_s))
            }
            _ => from,
        }
    }
}

fn found(time_s: &[f64], values: &[f64], renewal: Renewal) -> Vec<Update> {
    let mut updates = Vec::new();
    for run in constant_runs(values) {
        let (value, start_s) = (values[run.start], time_s[run.start]);
        let before_s = run.start.checked_sub(1).map_or(start_s, |i| time_s[i]);
        let step_s = (start_s - before_s).min(renewal.interval_s);
        updates.push(Update {
            value,
            earliest_s: start_s - (1.0 - AFTER) * step_s,
            latest_s: start_s,
        });
        let end_s = time_s.get(run.end).copied();
        let until_s = end_s.unwrap_or(time_s[run.end - 1]);
        let renewals_s = renewals_s((start_s, until_s), end_s.is_none(), renewal);
        updates.extend(renewals_s.into_iter().map(|at_s| Update {
            value,
            earliest_s: at_s,
            latest_s: at_s,
        }));
    }
    updates
}

/// When a value that stays was renewed, about an interval after each other and before the next value comes.
fn renewals_s((start_s, until_s): (f64, f64), is_last: bool, renewal: Renewal) -> Vec<f64> {
    let stays_s = until_s - start_s;
    let mut renewals_s = Vec::new();
    if stays_s > RENEWED * renewal.long_s {
        let count = (stays_s / renewal.interval_s).round().max(1.0);
        renewals_s.extend((1..count as usize).map(|k| start_s + k as f64 * stays_s / count));
    }
    if is_last && until_s > start_s {
        renewals_s.push(until_s);
    }
    renewals_s
}

/// Times as even as the rows leave it.
fn evened_out(updates: &[Update]) -> Vec<f64> {
    let mut time_s: Vec<f64> = updates.iter().map(|update| update.latest_s).collect();
    for _ in 0..ROUNDS {
        for i in 1..time_s.len().saturating_sub(1) {
            let even_s = 0.5 * (time_s[i - 1] + time_s[i + 1]);
            let Update {
                earliest_s,
                latest_s,
                ..
            } = updates[i];
            // all but the last digits late is as late as the row
            let late = latest_s - even_s < 1e-6 * (latest_s - earliest_s);
            time_s[i] = if late {
                latest_s
            } else {
                even_s.max(earliest_s)
            };
        }
    }
    time_s
}

/// Sum of the squared changes of the slope.
fn roughness(updates: &[Update], time_s: &[f64]) -> f64 {
    let slope = |i: usize| (updates[i + 1].value - updates[i].value) / (time_s[i + 1] - time_s[i]);
    let slopes: Vec<f64> = (0..time_s.len().saturating_sub(1)).map(slope).collect();
    slopes
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).powi(2))
        .sum()
}

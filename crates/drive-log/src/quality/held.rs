//! Values that are repeated in rows until the sensor gives the next one.

use std::ops::Range;

use super::Checked;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// Limits, and powers that are set, hold their values by themselves; everything else is measured all the time.
const SET: [Channel; 4] = [
    Channel::SpeedLimit,
    Channel::AuxPower,
    Channel::HeatingPower,
    Channel::HeatingRequest,
];

/// Changes that tell how often a channel changes.
const LEAST_CHANGES: usize = 10;

/// A value that is sampled in every row goes on by one digit of the channel after it has not moved for a row; over this many
/// digits, it was not looked at in between.
const DIGITS: f64 = 1.9;

/// Such changes come at one rate: this share of them at these multiples of the median interval. Rows at irregular times see
/// an update up to a row late.
const REGULAR_SHARE: f64 = 0.7;
const REGULAR: Range<f64> = 0.5..1.6;

/// And hardly any change of the channel comes sooner.
const SOONER: f64 = 0.75;
const SOONER_SHARE: f64 = 0.1;

/// A speed that is renewed less often is not known in between, s; it is cut there as everywhere. The default of `max_gap_s`.
const SLOWEST_SPEED_S: f64 = 2.0;

/// Puts the line between updates in the place of values that were repeated until the next one.
pub(super) fn collapse(checked: &mut Checked) {
    for channel in Channel::ALL.into_iter().filter(|c| !SET.contains(c)) {
        let Some(values) = checked.values(channel) else {
            continue;
        };
        let time_s = checked.log.time_s();
        let runs: Vec<Range<usize>> = super::constant_runs(values).collect();
        let Some(interval_s) = update_interval_s(time_s, values, &runs) else {
            continue;
        };
        let updates = updates(time_s, values, &runs, interval_s);
        let detail = format!(
            "renewed about every {interval_s:.2} s, {} of {} values are updates",
            updates.len(),
            values.iter().filter(|v| v.is_finite()).count()
        );
        let keep_gaps = channel == Channel::Speed && interval_s > SLOWEST_SPEED_S;
        let renewed = between_updates(time_s, values, &updates, keep_gaps);
        let action = if keep_gaps {
            Action::Removed
        } else {
            Action::Interpolated
        };
        checked.report(
            FindingKind::Held,
            channel,
            &(0..renewed.len()),
            action,
            detail,
        );
        checked.log.channels.insert(channel, renewed);
    }
}

/// Interval at which a held channel is renewed, s; `None` where rows are not slower than the channel.
fn update_interval_s(time_s: &[f64], values: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let changes: Vec<(f64, f64, usize)> = runs
        .windows(2)
        .filter(|pair| pair[0].end == pair[1].start)
        .map(|pair| {
            let (from, to) = (pair[0].start, pair[1].start);
            (
                (values[to] - values[from]).abs(),
                time_s[to] - time_s[from],
                pair[0].len(),
            )
        })
        .collect();
    let mut jumps: Vec<f64> = changes.iter().map(|change| change.0).collect();
    let digit = quantile(&mut jumps, 0.05)?;
    let mut held: Vec<f64> = changes
        .iter()
        .filter(|(jump, _, rows)| *rows >= 2 && *jump >= DIGITS * digit)
        .map(|change| change.1)
        .collect();
    let interval_s = quantile(&mut held, 0.5)?;
    let regular = held
        .iter()
        .filter(|s| REGULAR.contains(&(**s / interval_s)))
        .count();
    let sooner = changes
        .iter()
        .filter(|change| change.1 < SOONER * interval_s)
        .count();
    (held.len() >= LEAST_CHANGES
        && regular as f64 >= REGULAR_SHARE * held.len() as f64
        && sooner as f64 <= SOONER_SHARE * changes.len() as f64)
        .then_some(interval_s)
}

/// The first sample of each run, and in a run that lasts for several intervals those at which it was renewed.
fn updates(time_s: &[f64], values: &[f64], runs: &[Range<usize>], interval_s: f64) -> Vec<usize> {
    let mut updates = Vec::new();
    for run in runs {
        updates.push(run.start);
        let changes_next = values.get(run.end).is_some_and(|v| v.is_finite());
        let until_s = if changes_next {
            time_s[run.end]
        } else {
            time_s[run.end - 1]
        };
        let renewals = ((until_s - time_s[run.start]) / interval_s)
            .round()
            .max(1.0);
        let step_s = (until_s - time_s[run.start]) / renewals;
        let mut next_s = time_s[run.start] + step_s;
        for (i, t) in time_s.iter().enumerate().take(run.end).skip(run.start + 1) {
            if *t >= next_s - 1e-9 && until_s - t >= 0.5 * step_s {
                updates.push(i);
                next_s += step_s;
            }
        }
        if !changes_next && run.len() > 1 && updates.last() != Some(&(run.end - 1)) {
            updates.push(run.end - 1);
        }
    }
    updates
}

/// The line between updates at every sample; missing where the channel was, and between updates where gaps are kept.
fn between_updates(time_s: &[f64], values: &[f64], updates: &[usize], keep_gaps: bool) -> Vec<f64> {
    let mut renewed: Vec<f64> = vec![f64::NAN; values.len()];
    for &i in updates {
        renewed[i] = values[i];
    }
    if keep_gaps {
        return renewed;
    }
    for pair in updates.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if values[from..to].iter().any(|v| !v.is_finite()) {
            continue;
        }
        for i in from + 1..to {
            let share = (time_s[i] - time_s[from]) / (time_s[to] - time_s[from]);
            renewed[i] = values[from] + (values[to] - values[from]) * share;
        }
    }
    renewed
}

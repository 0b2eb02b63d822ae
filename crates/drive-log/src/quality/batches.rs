//! Rows that were buffered, and stamped when the buffer was written.

use std::ops::Range;

use super::checked::Checked;
use crate::statistics::{mean, median_step_s, quantile};
use crate::{Action, Finding, FindingKind};

/// Batches are so many rows, apart by so many times the step within them; how many there must be.
const ROWS: f64 = 3.0;
const APART: f64 = 5.0;
const BATCHES: usize = 20;

/// The share of the batches that must have the usual number of rows, within one, and the usual time to the next, within a part of it.
const REGULAR_SHARE: f64 = 0.8;
const REGULAR_TIME: f64 = 0.3;

/// From one batch to the next the speed changes by at most so many times what it does from row to row: what is measured in bursts
/// changes more.
const CHANGE_TIMES: f64 = 3.0;

/// Spreads the rows of each batch over the time to the next.
pub(super) fn spread(checked: &mut Checked) {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let batches = batches(time_s);
    let Some((rows, period_s)) = regular(time_s, &batches) else {
        return;
    };
    if !is_buffered(speed_mps, &batches) {
        return;
    }
    let mut even_s = time_s.to_vec();
    for batch in &batches {
        let start_s = time_s[batch.start];
        let to_next_s = time_s
            .get(batch.end)
            .map_or(period_s, |next_s| next_s - start_s);
        let row_s = if is_usual(to_next_s, period_s) {
            to_next_s / batch.len() as f64
        } else {
            period_s / rows
        };
        let steps = 0..batch.len();
        for (row, t_s) in steps.zip(&mut even_s[batch.clone()]) {
            *t_s = start_s + row as f64 * row_s;
        }
    }
    if even_s.windows(2).any(|pair| pair[1] <= pair[0]) {
        return;
    }
    let span_s = (even_s[0], even_s[even_s.len() - 1]);
    let detail = format!(
        "rows are stamped in batches of {rows:.0}, {period_s:.3} s from one to the next, while the speed changes from row to row alike: spread evenly"
    );
    checked.log.time_s = even_s;
    checked.findings.push(Finding::of_time(
        FindingKind::Batched,
        span_s,
        Action::Converted,
        detail,
    ));
}

/// Rows that follow each other closely.
fn batches(time_s: &[f64]) -> Vec<Range<usize>> {
    let step_s = median_step_s(time_s);
    let mut batches = Vec::new();
    let mut start = 0;
    for i in 1..=time_s.len() {
        if time_s
            .get(i)
            .is_none_or(|t| t - time_s[i - 1] > APART * step_s)
        {
            batches.push(start..i);
            start = i;
        }
    }
    batches
}

/// The usual number of rows of a batch, and time to the next, s, where most are alike.
fn regular(time_s: &[f64], batches: &[Range<usize>]) -> Option<(f64, f64)> {
    let mut sizes: Vec<f64> = batches.iter().map(|batch| batch.len() as f64).collect();
    let starts_s = || batches.iter().map(|batch| time_s[batch.start]);
    let periods_s = starts_s()
        .zip(starts_s().skip(1))
        .map(|(from, to)| to - from);
    let mut periods_s: Vec<f64> = periods_s.collect();
    let rows = quantile(&mut sizes, 0.5).filter(|rows| *rows >= ROWS)?;
    let period_s = quantile(&mut periods_s, 0.5)?;
    let of_rows = sizes
        .iter()
        .filter(|size| (**size - rows).abs() <= 1.0)
        .count();
    let of_period = periods_s.iter().filter(|s| is_usual(**s, period_s)).count();
    let least = REGULAR_SHARE * batches.len() as f64;
    (batches.len() >= BATCHES && of_rows.min(of_period) as f64 >= least).then_some((rows, period_s))
}

fn is_usual(to_next_s: f64, period_s: f64) -> bool {
    (to_next_s / period_s - 1.0).abs() <= REGULAR_TIME
}

/// Whether the speed changes from batch to batch as it does from row to row.
fn is_buffered(speed_mps: &[f64], batches: &[Range<usize>]) -> bool {
    let change = |to: usize| (speed_mps[to] - speed_mps[to - 1]).abs();
    let across = mean(batches.iter().skip(1).map(|batch| change(batch.start)));
    let within = batches.iter().flat_map(|batch| batch.start + 1..batch.end);
    let within = mean(within.map(change));
    across
        .zip(within)
        .is_some_and(|(across, within)| within > 0.0 && across <= CHANGE_TIMES * within)
}

//! Time that does not run forward.

use super::batches;
use super::checked::Checked;
use crate::statistics::median_step_s;
use crate::{Action, Finding, FindingKind, RawLog};

/// Samples that may come late before it is the clock that was set back.
pub(crate) const MAX_LATE: usize = 5;

/// A step over this many median steps is a gap: at least two samples are lost.
const GAP_STEPS: f64 = 2.5;

/// Makes time strictly increasing.
pub(super) fn repair(checked: &mut Checked) {
    drop_missing(checked);
    if checked.log.time_s.windows(2).any(|pair| pair[1] <= pair[0]) {
        let cut_times_s = reorder(checked);
        drop_repeated(checked);
        let time_s = &checked.log.time_s;
        checked.cuts.extend(
            cut_times_s
                .iter()
                .map(|cut_s| time_s.partition_point(|t| t < cut_s)),
        );
    }
    batches::spread(checked);
    report_gaps(checked);
}

/// Keeps the samples at `order`, in that order, at the times `time_s`.
fn select(log: &mut RawLog, order: &[usize], time_s: Vec<f64>) {
    for values in log.channels.values_mut() {
        *values = order.iter().map(|&i| values[i]).collect();
    }
    log.time_s = time_s;
}

fn drop_missing(checked: &mut Checked) {
    let time_s = checked.log.time_s().to_vec();
    let finite: Vec<usize> = (0..time_s.len())
        .filter(|&i| time_s[i].is_finite())
        .collect();
    let dropped = time_s.len() - finite.len();
    if dropped == 0 {
        return;
    }
    let kept_s: Vec<f64> = finite.iter().map(|&i| time_s[i]).collect();
    let span_s = (
        kept_s.first().copied().unwrap_or(0.0),
        kept_s.last().copied().unwrap_or(0.0),
    );
    let detail = format!("{dropped} samples without a time");
    checked.findings.push(Finding::of_time(
        FindingKind::MissingTime,
        span_s,
        Action::Dropped,
        detail,
    ));
    select(&mut checked.log, &finite, kept_s);
}

/// Puts late samples in order, drops samples ahead of their time and shifts what follows a clock
/// that was set back. Returns the times of the cuts.
fn reorder(checked: &mut Checked) -> Vec<f64> {
    let time_s = checked.log.time_s().to_vec();
    let step_s = median_step_s(&time_s);
    let mut kept: Vec<(f64, usize)> = Vec::with_capacity(time_s.len());
    let mut cut_times_s = Vec::new();
    let (mut latest_s, mut shift_s) = (f64::NEG_INFINITY, 0.0);
    let mut late = 0;
    let mut findings = Vec::new();
    let mut report = |at_s: f64, action: Action, detail: String| {
        findings.push(Finding::of_time(
            FindingKind::BackwardTime,
            (at_s, at_s),
            action,
            detail,
        ));
    };
    for (i, recorded_s) in time_s.iter().enumerate() {
        let mut t_s = recorded_s + shift_s;
        if t_s < latest_s {
            let behind = time_s[i..]
                .iter()
                .take(MAX_LATE + 1)
                .take_while(|t| **t + shift_s < latest_s)
                .count();
            let before_s = kept.len().checked_sub(2).map(|k| kept[k].0);
            if behind <= MAX_LATE {
                late += 1;
            } else if before_s
                .is_some_and(|before_s| before_s < t_s && t_s - before_s <= GAP_STEPS * step_s)
            {
                kept.pop();
                report(
                    latest_s,
                    Action::Dropped,
                    format!("a sample at {latest_s} s between {t_s} s and the sample before"),
                );
                latest_s = t_s;
            } else {
                report(
                    latest_s,
                    Action::Split,
                    format!("clock set back from {latest_s} s to {t_s} s; what follows is shifted"),
                );
                shift_s += latest_s + step_s - t_s;
                t_s = latest_s + step_s;
                cut_times_s.push(t_s);
            }
        }
        latest_s = latest_s.max(t_s);
        kept.push((t_s, i));
    }
    if late > 0 {
        report(
            time_s[0],
            Action::Sorted,
            format!("{late} samples later than their time"),
        );
    }
    checked.findings.extend(findings);
    kept.sort_by(|a, b| a.0.total_cmp(&b.0));
    let order: Vec<usize> = kept.iter().map(|sample| sample.1).collect();
    select(
        &mut checked.log,
        &order,
        kept.iter().map(|sample| sample.0).collect(),
    );
    cut_times_s
}

/// Keeps one sample per time, the first one with a speed.
fn drop_repeated(checked: &mut Checked) {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let mut kept: Vec<usize> = Vec::with_capacity(time_s.len());
    let mut repeated: Option<(f64, f64)> = None;
    for i in 0..time_s.len() {
        match kept.last_mut() {
            Some(last) if time_s[i] <= time_s[*last] => {
                if !speed_mps[*last].is_finite() {
                    *last = i;
                }
                repeated = Some((repeated.map_or(time_s[i], |span| span.0), time_s[i]));
            }
            _ => kept.push(i),
        }
    }
    if let Some(span_s) = repeated {
        let detail = format!(
            "{} samples at the time of another",
            time_s.len() - kept.len()
        );
        let kept_s = kept.iter().map(|&i| time_s[i]).collect();
        checked.findings.push(Finding::of_time(
            FindingKind::RepeatedTime,
            span_s,
            Action::Dropped,
            detail,
        ));
        select(&mut checked.log, &kept, kept_s);
    }
}

fn report_gaps(checked: &mut Checked) {
    let time_s = checked.log.time_s();
    let step_s = median_step_s(time_s);
    let gaps: Vec<Finding> = time_s
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > GAP_STEPS * step_s)
        .map(|pair| {
            let detail = format!(
                "{:.3} s without a sample, where the step is {step_s:.3} s",
                pair[1] - pair[0]
            );
            Finding::of_time(
                FindingKind::TimeGap,
                (pair[0], pair[1]),
                Action::Kept,
                detail,
            )
        })
        .collect();
    checked.findings.extend(gaps);
}

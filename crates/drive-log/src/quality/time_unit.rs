//! Times in another unit than their header says.

use super::checked::Checked;
use super::range::plausible;
use crate::statistics::{median_step_s, quantile};
use crate::{Action, Channel, Finding, FindingKind};

/// Units that are taken for others, and the factor that puts the times right.
const MISTAKES: [(f64, &str); 9] = [
    (1e-6, "us read as s"),
    (1e-3, "ms read as s, or us as ms"),
    (1.0 / 3600.0, "s read as h"),
    (1.0 / 60.0, "s read as min"),
    (60.0, "min read as s"),
    (1e3, "s read as ms"),
    (3600.0, "h read as s"),
    (86_400.0, "days read as s"),
    (1e6, "s read as us"),
];

/// Speeds that tell.
const SAMPLES: usize = 40;

/// Of windows of a hundredth of the log, and at least so many samples, a quarter changes the speed by
/// more than this only in crashes, m/s².
const WINDOW: usize = 10;
const CRASH_MPS2: f64 = 20.0;

/// Changes of the speed by so many m/s, of which each row makes a part, take this time with 8 m/s²: a quarter of them is faster only
/// in crashes. How many there must be.
const CHANGE_MPS: f64 = 5.0;
const CHANGE_S: f64 = 0.625;
const LARGEST_PART: f64 = 0.5;
const CHANGES: usize = 5;

/// A car that stops and reaches this speed, m/s, changes it by more than this in a hundredth of its
/// samples, m/s²: it would take three minutes to 9 m/s.
const STOPPED_MPS: f64 = 1.0;
const DRIVING_MPS: f64 = 8.0;
const CRAWL_MPS2: f64 = 0.05;

/// What a hundredth of the samples exceeds in traffic, m/s², and steps of recorders, s.
const TRAFFIC_MPS2: (f64, f64) = (0.4, 5.0);
const STEP_S: (f64, f64) = (0.002, 10.0);

/// Rows that share a time this far from the next, s, say nothing of what is between.
const COARSE_S: f64 = 10.0;

/// Scales times to which no speed can change, or does; refuses them where the unit cannot be told.
pub(super) fn convert(checked: &mut Checked) {
    let time_s = checked.log.time_s();
    let speeds: Vec<(f64, f64)> = time_s
        .iter()
        .zip(checked.log.speed_mps())
        .filter(|(t, v)| t.is_finite() && v.is_finite())
        .map(|(t, v)| (*t, *v))
        .collect();
    if speeds.len() < SAMPLES {
        return;
    }
    let mut sizes: Vec<f64> = speeds.iter().map(|(_, v)| v.abs()).collect();
    if quantile(&mut sizes, 0.9).is_some_and(|v| v > plausible(Channel::Speed).1) {
        return; // whose unit is another question
    }
    if let Some(step_s) = coarse_step_s(time_s) {
        let detail = format!(
            "most rows have the time of the one before, and the others are {step_s} s later: seconds are not written; record them"
        );
        return report(checked, Action::Refused, detail);
    }
    let window = WINDOW.max(speeds.len() / 100);
    let Some((crash_mps2, crawl_mps2)) = high(&speeds, window, 0.75).zip(high(&speeds, 1, 0.99))
    else {
        return;
    };
    let change_s = change_s(&speeds).filter(|s| *s < CHANGE_S);
    let too_fast = crash_mps2 > CRASH_MPS2 || change_s.is_some();
    if !(too_fast || crawl_mps2 < CRAWL_MPS2 && stops_and_drives(&speeds)) {
        return;
    }
    let step_s = median_step_s(time_s);
    let traffic_mps2 = if too_fast {
        high(&speeds, window, 0.99)
    } else {
        Some(crawl_mps2)
    };
    let fits = |factor: f64| {
        (STEP_S.0..=STEP_S.1).contains(&(step_s * factor))
            && is_round(step_s * factor)
            && traffic_mps2
                .is_some_and(|a| (TRAFFIC_MPS2.0..=TRAFFIC_MPS2.1).contains(&(a / factor)))
    };
    let possible: Vec<(f64, &str)> = MISTAKES
        .into_iter()
        .filter(|(factor, _)| fits(*factor) && (*factor > 1.0) == too_fast)
        .collect();
    let why = if crash_mps2 > CRASH_MPS2 {
        format!("the speed changes by over {crash_mps2:.0} m/s² for a quarter of the time")
    } else if let Some(change_s) = change_s {
        format!(
            "a quarter of all changes of the speed by {CHANGE_MPS} m/s take no more than {change_s:.2} s"
        )
    } else {
        format!(
            "the car stops and drives, and its speed never changes by over {crawl_mps2:.1e} m/s²"
        )
    };
    if let [(factor, unit)] = possible.as_slice() {
        checked.log.time_s.iter_mut().for_each(|t| *t *= factor);
        report(
            checked,
            Action::Scaled,
            format!("{why}: {unit}, times multiplied by {factor}"),
        );
    } else {
        let detail = format!("{why}; name the unit of the time in the header or a layout");
        report(checked, Action::Refused, detail);
    }
}

/// The time that the fastest quarter of the changes of the speed takes, s; `None` where there are few, or most are made in a jump.
fn change_s(speeds: &[(f64, f64)]) -> Option<f64> {
    let first = *speeds.first()?;
    // the last lowest and highest speeds since the last change
    let (mut low, mut high) = (first, first);
    let mut changes_s = Vec::new();
    for pair in speeds.windows(2) {
        let [before, here] = [pair[0], pair[1]];
        if here.0 <= before.0 || (here.1 - before.1).abs() > LARGEST_PART * CHANGE_MPS {
            (low, high) = (here, here);
            continue;
        }
        if here.1 <= low.1 {
            low = here;
        }
        if here.1 >= high.1 {
            high = here;
        }
        let since = if here.1 - low.1 >= CHANGE_MPS {
            low
        } else {
            high
        };
        if (here.1 - since.1).abs() >= CHANGE_MPS {
            changes_s.push(here.0 - since.0);
            (low, high) = (here, here);
        }
    }
    (changes_s.len() >= CHANGES)
        .then(|| quantile(&mut changes_s, 0.25))
        .flatten()
}

/// The step of times so coarse, such as whole minutes, that most rows share theirs with another.
fn coarse_step_s(time_s: &[f64]) -> Option<f64> {
    let shared = time_s
        .windows(2)
        .filter(|pair| pair[1].to_bits() == pair[0].to_bits())
        .count();
    let step_s = median_step_s(time_s);
    (2 * shared > time_s.len() && step_s >= COARSE_S).then_some(step_s)
}

/// The change of speed over a number of samples that a share of the windows in motion stays below,
/// m/s².
pub(super) fn high(speeds: &[(f64, f64)], window: usize, share: f64) -> Option<f64> {
    let rates = (window..speeds.len()).filter_map(|i| {
        let ((t0, v0), (t1, v1)) = (speeds[i - window], speeds[i]);
        (t1 > t0 && v0.max(v1) > STOPPED_MPS).then(|| (v1 - v0).abs() / (t1 - t0))
    });
    quantile(&mut rates.collect::<Vec<f64>>(), share)
}

fn stops_and_drives(speeds: &[(f64, f64)]) -> bool {
    let at = |share| {
        quantile(
            &mut speeds.iter().map(|(_, v)| *v).collect::<Vec<f64>>(),
            share,
        )
    };
    at(0.02).is_some_and(|v| v < STOPPED_MPS) && at(0.9).is_some_and(|v| v > DRIVING_MPS)
}

/// Whether a step is whole seconds or a whole part of one, in whole milliseconds, as recorders have
/// it.
fn is_round(step_s: f64) -> bool {
    let is_whole = |count: f64| (count - count.round()).abs() <= 2e-3 * count;
    is_whole(1e3 * step_s) && is_whole(step_s.max(1.0 / step_s))
}

pub(super) fn report(checked: &mut Checked, action: Action, detail: String) {
    let mut times = checked
        .log
        .time_s()
        .iter()
        .copied()
        .filter(|t| t.is_finite());
    let first_s = times.next().unwrap_or(0.0);
    let span_s = (first_s, times.next_back().unwrap_or(first_s));
    checked
        .findings
        .push(Finding::of_time(FindingKind::Unit, span_s, action, detail));
}

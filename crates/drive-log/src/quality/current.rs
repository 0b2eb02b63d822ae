//! Amps that leave for a moment and come back: spikes of a bus, and 0 where nothing was measured.

use std::ops::Range;

use super::battery::is_lively;
use super::checked::Checked;
use super::motion::MOVING_MPS;
use super::runs::constant_runs;
use crate::statistics::{deviation, off_line, quantile};
use crate::{Action, Channel, FindingKind};

/// A value is a spike for so long at most, s; rows further apart say nothing, as a motor changes its current within them.
const SPIKE_S: f64 = 0.5;

/// Off both values around it, on the same side, by more than the first, A, in rows of 0.1 s, a value is certainly a spike, and by more than
/// the second where there are certain ones. In 33 trips of a BMW i3 it is 21 A at most, and a single time in any over 10 A.
const CERTAIN_A: f64 = 25.0;
const LIKELY_A: f64 = 8.0;
const ROW_S: f64 = 0.1;

/// A current in motion deviates from 0 by 16 to 54 A in those trips; all of these are larger as it is larger than that: in a lorry, or in
/// another unit.
const USUAL_A: f64 = 50.0;

/// Nor are they less than these many times what half of the values in motion are off the line between their neighbours (up to 0.3 A in those trips):
/// a current that was computed from a speed with noise is rough all along.
const CERTAIN_ROUGH: f64 = 40.0;
const LIKELY_ROUGH: f64 = 20.0;

/// And than these many times what half of the values around it, so many to either side, change from one to the next.
const CERTAIN_AROUND: f64 = 6.0;
const LIKELY_AROUND: f64 = 3.0;
const AROUND: usize = 8;

/// So many make it no chance.
const SPIKES: usize = 3;

/// A current of exactly 0 for so long at most, s, is a dropout between two of more than so much, A, of one sign (0.5 A in those trips).
const DROPOUT_S: f64 = 3.0;
const DROPOUT_A: f64 = 4.0;

/// The share of all stretches of 0, those at either end of the log apart, that are dropouts: a current that often comes to 0 by itself
/// may also do so at once.
const DROPOUT_SHARE: f64 = 0.3;

/// Under this share of the samples in motion repeats the one before where a current is measured in every row.
const LIVELY_SHARE: f64 = 0.5;

/// Rounds in which spikes beside spikes come to light.
const ROUNDS: usize = 4;

/// Removes dropouts and spikes of the current.
pub(super) fn remove_spikes(checked: &mut Checked) {
    let dropouts = dropouts(checked);
    let what = "of exactly 0 A, left and entered by jumps: nothing measured";
    remove(checked, FindingKind::Sentinel, &dropouts, what);
    let spikes = spikes(checked);
    let what = "off both values around them by more than a motor changes its current";
    remove(checked, FindingKind::Spike, &spikes, what);
}

fn remove(checked: &mut Checked, kind: FindingKind, runs: &[Range<usize>], what: &str) {
    let (Some(first), Some(last)) = (
        runs.iter().map(|run| run.start).min(),
        runs.iter().map(|run| run.end).max(),
    ) else {
        return;
    };
    let samples: usize = runs.iter().map(Range::len).sum();
    let detail = format!("{samples} samples in {} stretches {what}", runs.len());
    let channel = Channel::BatteryCurrent;
    checked.report(kind, channel, &(first..last), Action::Removed, detail);
    for run in runs {
        checked.remove(channel, run.clone());
    }
}

/// A run of one value between two others.
struct Excursion {
    run: Range<usize>,
    value_a: f64,
    before_a: f64,
    after_a: f64,
    /// From the last sample before it to the first after it, and the longer of the steps to these, s.
    whole_s: f64,
    step_s: f64,
    /// What the values around it change from one to the next, A (median); 0 where it is off by little.
    rough_a: f64,
}

impl Excursion {
    /// How far it is off the nearer of the values around it, on the same side of both; else 0.
    fn depth_a(&self) -> f64 {
        let (before, after) = (self.value_a - self.before_a, self.value_a - self.after_a);
        if before * after > 0.0 {
            before.abs().min(after.abs())
        } else {
            0.0
        }
    }

    /// Whether it is farther off than so much, A, and than so many times what the values around it change.
    fn is_spike(&self, (least_a, around): (f64, f64)) -> bool {
        self.step_s <= SPIKE_S
            && self.whole_s <= 2.0 * SPIKE_S
            && self.depth_a() > around * self.rough_a
            && self.depth_a() > least_a * (self.step_s / ROW_S).max(1.0)
    }

    fn is_dropout(&self, least_a: f64) -> bool {
        self.value_a == 0.0
            && self.step_s <= SPIKE_S
            && self.whole_s <= DROPOUT_S
            && self.depth_a() > least_a * (self.step_s / ROW_S).max(1.0)
    }
}

fn excursions(time_s: &[f64], current_a: &[f64]) -> Vec<Excursion> {
    let runs: Vec<Range<usize>> = constant_runs(current_a).collect();
    let excursion = |at: usize| {
        let [before, run, after] = runs.get(at.checked_sub(1)?..=at + 1)? else {
            return None;
        };
        let (from_s, to_s) = (time_s[before.end - 1], time_s[after.start]);
        let steps_s = (time_s[run.start] - from_s, to_s - time_s[run.end - 1]);
        let excursion = Excursion {
            run: run.clone(),
            value_a: current_a[run.start],
            before_a: current_a[before.start],
            after_a: current_a[after.start],
            whole_s: to_s - from_s,
            step_s: steps_s.0.max(steps_s.1),
            rough_a: 0.0,
        };
        // what is off by less is no spike, however smooth the current is
        if excursion.depth_a() < LIKELY_A {
            return Some(excursion);
        }
        let around = &runs[at.saturating_sub(AROUND)..runs.len().min(at + AROUND + 1)];
        Some(Excursion {
            rough_a: rough_around_a(current_a, around)?,
            ..excursion
        })
    };
    (1..runs.len()).filter_map(excursion).collect()
}

/// What values change from one to the next, A (median).
fn rough_around_a(current_a: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let change_a = |pair: &[Range<usize>]| current_a[pair[1].start] - current_a[pair[0].start];
    let mut changes_a: Vec<f64> = runs.windows(2).map(|pair| change_a(pair).abs()).collect();
    quantile(&mut changes_a, 0.5)
}

/// How many times a usual current one is, at least once.
fn size(checked: &Checked, current_a: &[f64]) -> f64 {
    let moving = checked
        .log
        .speed_mps()
        .iter()
        .zip(current_a)
        .filter(|(v, a)| v.abs() > MOVING_MPS && a.is_finite());
    (deviation(moving.map(|(_, a)| *a)) / USUAL_A).max(1.0)
}

/// What a current in motion is off the line between its neighbours, A.
fn rough_a(checked: &Checked, current_a: &[f64]) -> f64 {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let known = (0..current_a.len()).filter(|&i| current_a[i].is_finite());
    let known: Vec<usize> = known.collect();
    let at = |i: usize| (time_s[i], current_a[i]);
    let moving = known
        .windows(3)
        .filter(|around| speed_mps[around[1]].abs() > MOVING_MPS);
    deviation(moving.map(|around| off_line(at(around[0]), at(around[1]), at(around[2]))))
}

/// Stretches of exactly 0 amps where nothing was measured.
fn dropouts(checked: &Checked) -> Vec<Range<usize>> {
    let Some(current_a) = checked.values(Channel::BatteryCurrent) else {
        return Vec::new();
    };
    // a current that is never regained ends at 0
    if !current_a.iter().any(|a| *a < -DROPOUT_A) {
        return Vec::new();
    }
    let zero_apart = |a: &f64| if *a == 0.0 { f64::NAN } else { *a };
    let apart_a: Vec<f64> = current_a.iter().map(zero_apart).collect();
    let (size, rough_a) = (size(checked, &apart_a), rough_a(checked, &apart_a));
    let least_a = (size * DROPOUT_A).max(LIKELY_ROUGH * rough_a);
    let zeros = excursions(checked.log.time_s(), current_a)
        .into_iter()
        .filter(|excursion| excursion.value_a == 0.0);
    let (dropouts, others): (Vec<Excursion>, Vec<Excursion>) =
        zeros.partition(|zero| zero.is_dropout(least_a));
    let all = dropouts.len() + others.len();
    let dropouts: Vec<Range<usize>> = dropouts.into_iter().map(|zero| zero.run).collect();
    let is_sure = dropouts.len() >= SPIKES
        && dropouts.len() as f64 >= DROPOUT_SHARE * all as f64
        && is_lively(checked, current_a, &dropouts, LIVELY_SHARE);
    if is_sure { dropouts } else { Vec::new() }
}

/// Single values that are no current of a motor.
fn spikes(checked: &Checked) -> Vec<Range<usize>> {
    let Some(current_a) = checked.values(Channel::BatteryCurrent) else {
        return Vec::new();
    };
    let time_s = checked.log.time_s();
    let (size, rough_a) = (size(checked, current_a), rough_a(checked, current_a));
    let certain_a = (size * CERTAIN_A).max(CERTAIN_ROUGH * rough_a);
    let likely_a = (size * LIKELY_A).max(LIKELY_ROUGH * rough_a);
    let is_certain = |excursion: &Excursion| excursion.is_spike((certain_a, CERTAIN_AROUND));
    let excursions_now = excursions(time_s, current_a).into_iter();
    let certain = excursions_now.filter(is_certain).count();
    if certain < SPIKES || !is_lively(checked, current_a, &[], LIVELY_SHARE) {
        return Vec::new();
    }
    let mut left_a = current_a.to_vec();
    let mut spikes = Vec::new();
    for _ in 0..ROUNDS {
        let found = excursions(time_s, &left_a).into_iter();
        let found: Vec<Range<usize>> = found
            .filter(|excursion| excursion.is_spike((likely_a, LIKELY_AROUND)))
            .map(|excursion| excursion.run)
            .collect();
        if found.is_empty() {
            break;
        }
        found
            .iter()
            .for_each(|run| left_a[run.clone()].fill(f64::NAN));
        spikes.extend(found);
    }
    spikes
}

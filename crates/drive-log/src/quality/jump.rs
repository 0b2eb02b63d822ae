//! Jumps that no vehicle makes.

use std::ops::Range;

use super::checked::Checked;
use super::road::STEEPEST;
use crate::statistics::{deviation, off_line};
use crate::{Action, Channel, FindingKind};

/// Acceleration that tyres cannot transmit, m/s², and what a coarse sensor may add in one step,
/// m/s.
const TYRE_LIMIT_MPS2: f64 = 10.0;
const COARSE_STEP_MPS: f64 = 1.0;

/// Braking that is hard but ordinary, m/s²: enough to tell that a jump of the charge is not the
/// estimator's alone.
const HARD_BRAKING_MPS2: f64 = 5.0;

/// Longest step between two samples that are compared, s.
const NEIGHBOURS_S: f64 = 2.0;

/// A jump that is undone within this time is a spike, not a splice, s.
const SPIKE_S: f64 = 2.0;

/// Samples that are searched for the end of an outlier at most: a minute at 100 Hz.
const MAX_BLOCK: usize = 6000;

/// State of charge: 1.5 % in a step of at most 2 s is a rate of 27 per hour, beyond any traction
/// battery, and above the resolution of 1 % that some recorders have.
const CHARGE_STEP_PCT: f64 = 1.5;

/// What satellite navigation may be wrong by from one fix to the next, m: usually, and after a loss
/// of reception.
const ALTITUDE_SPIKE_M: f64 = 5.0;
const ALTITUDE_BLOCK_M: f64 = 40.0;

/// An elevation that scatters by more is noisy, m, and only what is this many standard deviations off is an outlier.
const NOISY_M: f64 = 2.0;
const OUTLIER_DEVIATIONS: f64 = 5.0;

/// Time from one fix to the next, s, and the longest from one to the next but one.
const FIX_S: f64 = 0.999;
const LONGEST_LINE_S: f64 = 10.0;

/// Longest stretch that counts as an outlier of altitude, s: longer, it may be a hill.
const ALTITUDE_BLOCK_S: f64 = 60.0;

/// Removes spikes of the speed and cuts where two recordings were joined.
pub(super) fn cut_speed(checked: &mut Checked) {
    let speed_mps = checked.log.speed_mps().to_vec();
    let time_s = checked.log.time_s().to_vec();
    let mut before: Option<usize> = None;
    let mut i = 0;
    while i < speed_mps.len() {
        if speed_mps[i].is_nan() {
            i += 1;
            continue;
        }
        if let Some(p) = before {
            let (step_s, jump_mps) = (time_s[i] - time_s[p], speed_mps[i] - speed_mps[p]);
            if step_s <= NEIGHBOURS_S && jump_mps.abs() > TYRE_LIMIT_MPS2 * step_s + COARSE_STEP_MPS
            {
                let back =
                    |j: &usize| (speed_mps[*j] - speed_mps[p]).abs() <= 0.25 * jump_mps.abs();
                let spike_end = following(&time_s, i, SPIKE_S).find(back);
                i = report_jump(checked, i, spike_end, (speed_mps[p], speed_mps[i], step_s));
            }
        }
        before = Some(i);
        i += 1;
    }
}

/// The samples after `i`, up to `within_s` later.
fn following(time_s: &[f64], i: usize, within_s: f64) -> impl Iterator<Item = usize> {
    (i + 1..time_s.len())
        .take(MAX_BLOCK)
        .take_while(move |&j| time_s[j] - time_s[i] <= within_s)
}

/// Removes the spike or cuts before `at`; returns the sample to go on with.
fn report_jump(
    checked: &mut Checked,
    at: usize,
    spike_end: Option<usize>,
    (from, to, step_s): (f64, f64, f64),
) -> usize {
    let detail = format!("speed from {from:.2} to {to:.2} m/s in {step_s:.2} s");
    if let Some(end) = spike_end {
        checked.report(
            FindingKind::Spike,
            Channel::Speed,
            &(at..end),
            Action::Removed,
            detail,
        );
        checked.remove(Channel::Speed, at..end);
        return end;
    }
    checked.report(
        FindingKind::Splice,
        Channel::Speed,
        &(at - 1..at + 1),
        Action::Split,
        detail,
    );
    checked.cuts.push(at);
    at
}

/// Reports jumps of the state of charge; cuts where the speed jumps with it.
pub(super) fn cut_state_of_charge(checked: &mut Checked) {
    let Some(soc_pct) = checked.values(Channel::StateOfCharge) else {
        return;
    };
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let mut jumps = Vec::new();
    let known: Vec<usize> = (0..soc_pct.len())
        .filter(|i| soc_pct[*i].is_finite())
        .collect();
    for pair in known.windows(2) {
        let (before, i) = (pair[0], pair[1]);
        let (step_s, step_pct) = (time_s[i] - time_s[before], soc_pct[i] - soc_pct[before]);
        if step_s <= NEIGHBOURS_S && step_pct.abs() > CHARGE_STEP_PCT {
            let cut = (before + 1..=i).find(|k| {
                let step_s = time_s[*k] - time_s[k - 1];
                (speed_mps[*k] - speed_mps[k - 1]).abs() > HARD_BRAKING_MPS2 * step_s
            });
            let detail = format!(
                "state of charge from {} to {} % in {step_s:.2} s",
                soc_pct[before], soc_pct[i]
            );
            jumps.push((before, i, cut, detail));
        }
    }
    for (before, i, cut, detail) in jumps {
        let action = if cut.is_some() {
            Action::Split
        } else {
            Action::Kept
        };
        checked.report(
            FindingKind::Splice,
            Channel::StateOfCharge,
            &(before..i + 1),
            action,
            detail,
        );
        checked.cuts.extend(cut);
    }
}

/// Removes stretches of elevation that a jump enters and a jump leaves; takes large jumps that are not undone
/// off what follows.
pub(super) fn remove_altitude_outliers(checked: &mut Checked) {
    let Some(mut elevation_m) = checked.values(Channel::Elevation).map(<[f64]>::to_vec) else {
        return;
    };
    let mut shifted_m = 0.0;
    let scatter_m = scatter_m(&elevation_m);
    report_noise(checked, &elevation_m);
    let spike_m = ALTITUDE_SPIKE_M.max(OUTLIER_DEVIATIONS * scatter_m);
    let block_m = ALTITUDE_BLOCK_M.max(OUTLIER_DEVIATIONS * scatter_m);
    let distance_m = checked.distance_m();
    let time_s = checked.log.time_s().to_vec();
    let mut before: Option<usize> = None;
    let mut i = 0;
    while i < elevation_m.len() {
        if elevation_m[i].is_nan() {
            i += 1;
            continue;
        }
        if let Some(p) = before {
            let jump_m = (elevation_m[i] - elevation_m[p]).abs()
                - STEEPEST * (distance_m[i] - distance_m[p]);
            if jump_m > spike_m && time_s[i] - time_s[p] <= NEIGHBOURS_S {
                let longest_s = if jump_m > block_m {
                    ALTITUDE_BLOCK_S
                } else {
                    SPIKE_S
                };
                let back = |j: &usize| (elevation_m[*j] - elevation_m[p]).abs() <= 0.5 * jump_m;
                let end = following(&time_s, i, longest_s).find(back);
                let recorded_m = |i: usize| (1e6 * (elevation_m[i] + shifted_m)).round() / 1e6;
                let detail = format!("elevation from {} to {} m", recorded_m(p), recorded_m(i));
                if let Some(end) = end {
                    remove_block(checked, i..end, detail);
                    i = end;
                } else if jump_m > block_m {
                    let step_m = elevation_m[i] - elevation_m[p];
                    elevation_m[i..].iter_mut().for_each(|z| *z -= step_m);
                    shifted_m += step_m;
                    shift_rest(checked, i, step_m, &detail);
                }
            }
        }
        before = Some(i);
        i += 1;
    }
}

/// Standard deviation of the difference of two elevations that follow each other, as noise makes it, m.
fn scatter_m(elevation_m: &[f64]) -> f64 {
    let steps_m = elevation_m.windows(2).map(|pair| pair[1] - pair[0]);
    deviation(steps_m.filter(|step_m| step_m.is_finite()))
}

/// Standard deviation of elevations, m, from how far each is off the line through those a second before and after: between two
/// fixes, elevations scatter less than the fixes.
pub(super) fn noise_m(time_s: &[f64], elevation_m: &[f64]) -> f64 {
    let points = time_s.iter().copied().zip(elevation_m.iter().copied());
    let points: Vec<(f64, f64)> = points.filter(|(_, h)| h.is_finite()).collect();
    let off_m = points.iter().filter_map(|&here| {
        let after = points.partition_point(|point| point.0 < here.0 + FIX_S);
        let before = points.partition_point(|point| point.0 <= here.0 - FIX_S);
        let (before, after) = (points[before.checked_sub(1)?], *points.get(after)?);
        // farther apart, noise is not told from a hill
        (after.0 - before.0 <= LONGEST_LINE_S).then(|| off_line(before, here, after))
    });
    deviation(off_m)
}

fn report_noise(checked: &mut Checked, elevation_m: &[f64]) {
    let deviation_m = noise_m(checked.log.time_s(), elevation_m);
    if deviation_m > NOISY_M {
        let detail = format!(
            "scatters by {deviation_m:.1} m (standard deviation); a slope from it is taken over a window as long as that asks for"
        );
        checked.report(
            FindingKind::Noise,
            Channel::Elevation,
            &(0..elevation_m.len()),
            Action::Kept,
            detail,
        );
    }
}

/// Joins what follows a jump that no road makes: slopes are right on either side.
fn shift_rest(checked: &mut Checked, at: usize, step_m: f64, jump: &str) {
    if let Some(values) = checked.log.channels.get_mut(&Channel::Elevation) {
        values[at..].iter_mut().for_each(|z| *z -= step_m);
    }
    checked.report(
        FindingKind::AltitudeOutlier,
        Channel::Elevation,
        &(at - 1..at + 1),
        Action::Shifted,
        format!("{jump} for good; {step_m:.1} m taken off what follows"),
    );
}

fn remove_block(checked: &mut Checked, block: Range<usize>, detail: String) {
    checked.report(
        FindingKind::AltitudeOutlier,
        Channel::Elevation,
        &block,
        Action::Removed,
        detail,
    );
    checked.remove(Channel::Elevation, block);
}

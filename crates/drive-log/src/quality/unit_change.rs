//! Stretches of a speed in another unit than the rest.

use std::ops::Range;

use super::checked::Checked;
use super::speed_mistake::MISTAKES;
use crate::statistics::near;
use crate::{Action, Channel, FindingKind};

/// Samples further apart are not compared, s; slower than this, a factor is noise, m/s.
const NEIGHBOURS_S: f64 = 2.0;
const MOVING_MPS: f64 = 0.5;

/// A jump on top of what the speed does before and after it, besides what a coarse sensor adds, m/s: one that a car may make,
/// one that it does not make on its own, and what two that undo each other come to in steps of at most a second, m/s². In 70
/// recorded drives the largest jump in such a step has 3.3 m/s², the next ones 2.8.
const JUMP_MPS2: f64 = 1.5;
const STRONG_MPS2: f64 = 4.0;
const PAIR_MPS2: f64 = 5.0;
const SECOND_S: f64 = 1.1;
const COARSE_STEP_MPS: f64 = 0.5;

/// How exactly a factor must explain a jump: within this share of the speed, times the logarithm of
/// the factor, or of what a car does, m/s², and always to a part of the jump; one that is not undone, within the last share.
const EXPLAINED: f64 = 0.1;
const EXPLAINED_MPS2: f64 = 0.75;
const EXPLAINED_PART: f64 = 1.0 / 3.0;
const EXPLAINED_ALONE: f64 = 0.06;

/// Share of all jumps as large that one factor must explain, summed: satellite receivers jump by any.
const SHARE: f64 = 0.7;

/// Once it is converted, a stretch holds no greater change of the speed, m/s².
const HARDEST_MPS2: f64 = 8.0;

/// Within which two factors are the same.
const SAME: f64 = 1e-6;

/// A jump of the speed.
#[derive(Clone, Copy)]
struct Edge {
    at: usize,
    /// Index of the factor between two units by which the speed rises, if it does by one.
    mistake: Option<usize>,
    /// The jump, m/s, and without what a coarse sensor adds over its time, m/s².
    jump_mps: f64,
    jump_mps2: f64,
    step_s: f64,
    /// By how much the factor misses, over the speed and the logarithm of the factor.
    off: f64,
}

/// Two jumps of which the second undoes the first.
type Pair = (Edge, Edge);

/// Converts stretches between two jumps by a factor between units and back; reports the only jump of a
/// recording if it is by such a factor.
pub(super) fn convert(checked: &mut Checked) {
    let edges = edges(checked);
    if let [edge] = edges.as_slice() {
        report_single(checked, *edge);
    }
    let both_mps2 = |(from, to): &Pair| from.jump_mps2 + to.jump_mps2;
    let is_strong = |pair: &&Pair| {
        let is_short = pair.0.step_s.max(pair.1.step_s) <= SECOND_S;
        both_mps2(pair)
            >= if is_short {
                PAIR_MPS2
            } else {
                2.0 * STRONG_MPS2
            }
    };
    let mut pairs = paired(&edges);
    let strongest = pairs
        .iter()
        .max_by(|a, b| both_mps2(a).total_cmp(&both_mps2(b)));
    let Some(mistake) = strongest
        .filter(is_strong)
        .and_then(|(from, _)| from.mistake)
    else {
        return;
    };
    let factor = MISTAKES[mistake].0;
    pairs.retain(|(from, to)| {
        from.mistake == Some(mistake) && is_drivable(checked, from.at..to.at, factor)
    });
    let weakest_mps2 = pairs.iter().fold(f64::INFINITY, |weakest, (from, to)| {
        weakest.min(from.jump_mps2).min(to.jump_mps2)
    });
    let as_large = edges.iter().filter(|e| e.jump_mps2 >= weakest_mps2);
    let all_mps2: f64 = as_large.map(|edge| edge.jump_mps2).sum();
    if !pairs.is_empty() && pairs.iter().map(both_mps2).sum::<f64>() >= SHARE * all_mps2 {
        let stretches = || pairs.iter().map(|(from, to)| from.at..to.at);
        let inside: usize = stretches().map(|range| range.len()).sum();
        let is_minor = 2 * inside < checked.log.len();
        for range in stretches() {
            convert_stretch(checked, range, factor, is_minor);
        }
    }
}

/// Where a speed that is converted as a whole jumps by that factor, or its inverse, as no car does in either unit: one of its parts is in
/// another unit.
pub(super) fn jump_by(checked: &Checked, factor: f64) -> Option<f64> {
    let undrivable = |edge: &Edge| {
        let jump_mps = edge.jump_mps / factor.max(1.0);
        jump_mps > HARDEST_MPS2 * edge.step_s + 2.0 * COARSE_STEP_MPS
    };
    let is_by = |edge: &Edge| {
        let mistake = edge.mistake.map(|mistake| MISTAKES[mistake].0);
        mistake.is_some_and(|by| near(by, factor, SAME) || near(by, 1.0 / factor, SAME))
    };
    let found = edges(checked)
        .into_iter()
        .find(|edge| is_by(edge) && undrivable(edge));
    found.map(|edge| checked.log.time_s()[edge.at])
}

/// Whether a car drives like that once a stretch is divided by a factor.
fn is_drivable(checked: &Checked, range: Range<usize>, factor: f64) -> bool {
    let samples = checked.log.time_s()[range.clone()]
        .iter()
        .zip(&checked.log.speed_mps()[range]);
    let known: Vec<(f64, f64)> = samples
        .filter(|(_, v)| v.is_finite())
        .map(|(t, v)| (*t, v / factor))
        .collect();
    known.windows(2).all(|pair| {
        let (step_s, jump_mps) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        jump_mps.abs() <= HARDEST_MPS2 * step_s + 2.0 * COARSE_STEP_MPS
    })
}

/// The jumps, in order: beside one, the speeds around look like smaller ones.
fn edges(checked: &Checked) -> Vec<Edge> {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let valid: Vec<usize> = (0..speed_mps.len())
        .filter(|&i| speed_mps[i].is_finite())
        .collect();
    let edges: Vec<Option<Edge>> = valid
        .windows(4)
        .map(|around| {
            let is_near = time_s[around[3]] - time_s[around[0]] <= 3.0 * NEIGHBOURS_S;
            is_near.then(|| edge(around, time_s, speed_mps)).flatten()
        })
        .collect();
    let jump = |i: Option<usize>| {
        let edge = i.and_then(|i| edges.get(i).copied().flatten());
        edge.map_or(0.0, |edge| edge.jump_mps)
    };
    let is_largest =
        |i: usize, edge: &Edge| edge.jump_mps > jump(i.checked_sub(1)).max(jump(Some(i + 1)));
    let largest = edges
        .iter()
        .enumerate()
        .filter_map(|(i, edge)| edge.filter(|edge| is_largest(i, edge)));
    largest.collect()
}

/// The jump between the inner two of four samples.
fn edge(around: &[usize], time_s: &[f64], speed_mps: &[f64]) -> Option<Edge> {
    let &[_, before, after, _] = around else {
        return None;
    };
    let (from, to) = (speed_mps[before], speed_mps[after]);
    let accel = |i: usize| {
        let (one, next) = (around[i], around[i + 1]);
        (speed_mps[next] - speed_mps[one]) / (time_s[next] - time_s[one])
    };
    let step_s = time_s[after] - time_s[before];
    let trend = (accel(0), accel(2));
    let off =
        |factor: f64| (to / factor - from - 0.5 * step_s * (trend.0 + trend.1 / factor)).abs();
    let jump_mps = off(1.0);
    if jump_mps <= JUMP_MPS2 * step_s + COARSE_STEP_MPS {
        return None;
    }
    let share = |factor: f64| off(factor) / (from * factor.ln().abs());
    let factors = MISTAKES
        .iter()
        .map(|(factor, _)| (share(*factor), off(*factor)))
        .enumerate();
    let (nearest, (share, off_mps)) = factors.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let explains = from.min(to) >= MOVING_MPS
        && (share <= EXPLAINED || off_mps <= EXPLAINED_MPS2 * step_s)
        && off_mps <= EXPLAINED_PART * jump_mps;
    Some(Edge {
        at: after,
        mistake: explains.then_some(nearest),
        off: share,
        jump_mps,
        jump_mps2: (jump_mps - COARSE_STEP_MPS) / step_s,
        step_s,
    })
}

/// Jumps that the next one undoes.
fn paired(edges: &[Edge]) -> Vec<Pair> {
    let (mut pairs, mut open) = (Vec::new(), Vec::<Edge>::new());
    // the mistakes are in the order of their factors, so that inverses face each other
    let undoes = |last: Option<usize>, next: Option<usize>| {
        last.zip(next)
            .is_some_and(|(last, next)| last + next + 1 == MISTAKES.len())
    };
    for &edge in edges {
        match open.pop_if(|last| undoes(last.mistake, edge.mistake)) {
            Some(last) => pairs.push((last, edge)),
            None => open.push(edge),
        }
    }
    pairs
}

fn convert_stretch(checked: &mut Checked, range: Range<usize>, factor: f64, is_minor: bool) {
    let ends = format!(
        "{} samples between two jumps by the factor {factor:.4} between units",
        range.len()
    );
    if !is_minor {
        let detail = format!("{ends}: one of the two parts is in another unit");
        report(checked, &range, Action::Refused, detail);
        return;
    }
    if let Some(values) = checked.log.channels.get_mut(&Channel::Speed) {
        values[range.clone()].iter_mut().for_each(|v| *v /= factor);
    }
    let detail = format!("{ends}: divided by it");
    report(checked, &range, Action::Scaled, detail);
}

fn report_single(checked: &mut Checked, edge: Edge) {
    let Some(mistake) = edge
        .mistake
        .filter(|_| edge.jump_mps2 > STRONG_MPS2 && edge.off <= EXPLAINED_ALONE)
    else {
        return;
    };
    let factor = MISTAKES[mistake].0;
    let detail = format!(
        "speed jumps by the factor {factor:.4} between units and does not come back: if the unit changes here, cut the log"
    );
    report(checked, &(edge.at - 1..edge.at + 1), Action::Kept, detail);
}

fn report(checked: &mut Checked, range: &Range<usize>, action: Action, detail: String) {
    checked.report(
        FindingKind::UnitChange,
        Channel::Speed,
        range,
        action,
        detail,
    );
}

//! Stretches of a speed in another unit than the rest.

use std::ops::Range;

use super::Checked;
use super::speed_unit::MISTAKES;
use crate::{Action, Channel, FindingKind};

/// Samples further apart are not compared, s; slower than this, a factor is noise, m/s.
const NEIGHBOURS_S: f64 = 2.0;
const MOVING_MPS: f64 = 1.5;

/// A jump on top of what the speed does before and after it: one that a car may make, and one that
/// it does not make on its own, m/s², besides what a coarse sensor adds, m/s.
const JUMP_MPS2: f64 = 1.5;
const STRONG_MPS2: f64 = 4.0;
const COARSE_STEP_MPS: f64 = 0.5;

/// How exactly a factor must explain a jump: within this share of the speed, times the logarithm of
/// the factor.
const EXPLAINED: f64 = 0.15;

/// A sample whose speed is a factor of the one before.
#[derive(Clone, Copy)]
struct Edge {
    at: usize,
    /// Index of the factor by which the speed rises.
    mistake: usize,
    is_strong: bool,
}

/// Converts stretches between two jumps by a factor between units and back; reports a jump by such a
/// factor that is not undone.
pub(super) fn convert(checked: &mut Checked) {
    let edges = edges(checked);
    let (pairs, single) = paired(&edges);
    let known: Vec<usize> = pairs
        .iter()
        .filter(|(from, to)| from.is_strong && to.is_strong)
        .map(|(from, _)| from.mistake)
        .collect();
    let stretches: Vec<(Range<usize>, usize)> = pairs
        .iter()
        .filter(|(from, _)| known.contains(&from.mistake))
        .map(|(from, to)| (from.at..to.at, from.mistake))
        .collect();
    let inside: usize = stretches.iter().map(|(range, _)| range.len()).sum();
    let is_minor = 2 * inside < checked.log.len();
    for (range, mistake) in stretches {
        convert_stretch(checked, range, mistake, is_minor);
    }
    for edge in single.into_iter().filter(|edge| edge.is_strong) {
        report_single(checked, edge);
    }
}

/// The jumps by a factor between two units, in order.
fn edges(checked: &Checked) -> Vec<Edge> {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let valid: Vec<usize> = (0..speed_mps.len())
        .filter(|&i| speed_mps[i].is_finite())
        .collect();
    valid
        .windows(4)
        .filter(|around| time_s[around[3]] - time_s[around[0]] <= 3.0 * NEIGHBOURS_S)
        .filter_map(|around| edge(around, time_s, speed_mps))
        .collect()
}

/// The jump between the inner two of four samples.
fn edge(around: &[usize], time_s: &[f64], speed_mps: &[f64]) -> Option<Edge> {
    let &[_, before, after, _] = around else {
        return None;
    };
    let (from, to) = (speed_mps[before], speed_mps[after]);
    if from.min(to) < MOVING_MPS {
        return None;
    }
    let accel = |i: usize| {
        (speed_mps[around[i + 1]] - speed_mps[around[i]])
            / (time_s[around[i + 1]] - time_s[around[i]])
    };
    let step_s = time_s[after] - time_s[before];
    let off =
        |factor: f64| (to / factor - from - 0.5 * step_s * (accel(0) + accel(2) / factor)).abs();
    let jump_mps = off(1.0);
    let (mistake, (factor, _)) = MISTAKES
        .iter()
        .enumerate()
        .min_by(|(_, a), (_, b)| off(a.0).total_cmp(&off(b.0)))?;
    let is_jump = jump_mps > JUMP_MPS2 * step_s + COARSE_STEP_MPS;
    (is_jump && off(*factor) <= EXPLAINED * from * factor.ln().abs()).then_some(Edge {
        at: after,
        mistake,
        is_strong: jump_mps > STRONG_MPS2 * step_s + COARSE_STEP_MPS,
    })
}

/// Edges that the next one undoes, and those that none does.
fn paired(edges: &[Edge]) -> (Vec<(Edge, Edge)>, Vec<Edge>) {
    let (mut pairs, mut open) = (Vec::new(), Vec::<Edge>::new());
    for &edge in edges {
        // the mistakes are in the order of their factors, so that inverses face each other
        match open.pop_if(|last| last.mistake + edge.mistake + 1 == MISTAKES.len()) {
            Some(last) => pairs.push((last, edge)),
            None => open.push(edge),
        }
    }
    (pairs, open)
}

fn convert_stretch(checked: &mut Checked, range: Range<usize>, mistake: usize, is_minor: bool) {
    let factor = MISTAKES[mistake].0;
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
    let factor = MISTAKES[edge.mistake].0;
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

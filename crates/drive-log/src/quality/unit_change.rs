//! Stretches of a speed in another unit than the rest.

use std::ops::Range;

use super::Checked;
use super::speed_unit::MISTAKES;
use crate::{Action, Channel, FindingKind};

/// Samples further apart are not compared, s; slower than this, a factor is noise, m/s.
const NEIGHBOURS_S: f64 = 2.0;
const MOVING_MPS: f64 = 3.0;

/// A jump on top of what the speed does before and after it: one that a car may make, and one that
/// it does not make on its own, m/s², besides what a coarse sensor adds, m/s.
const JUMP_MPS2: f64 = 1.5;
const STRONG_MPS2: f64 = 4.0;
const COARSE_STEP_MPS: f64 = 0.5;

/// How exactly a factor must explain a jump: within this share of the speed, times the logarithm of
/// the factor; one that is not undone, within the second.
const EXPLAINED: f64 = 0.1;
const EXPLAINED_ALONE: f64 = 0.03;

/// Share of all jumps that one factor must explain: satellite receivers jump by any.
const SHARE: f64 = 0.8;

/// A jump of the speed.
#[derive(Clone, Copy)]
struct Edge {
    at: usize,
    /// Index of the factor between two units by which the speed rises, if it does by one.
    mistake: Option<usize>,
    is_strong: bool,
    /// By how much the factor misses, over the speed and the logarithm of the factor.
    off: f64,
}

/// Converts stretches between two jumps by a factor between units and back; reports the only jump of a
/// recording if it is by such a factor.
pub(super) fn convert(checked: &mut Checked) {
    let edges = edges(checked);
    if let [edge] = edges.as_slice() {
        report_single(checked, *edge);
    }
    let pairs = paired(&edges);
    let Some(mistake) = pairs
        .iter()
        .find(|(from, to)| from.is_strong && to.is_strong)
        .and_then(|(from, _)| from.mistake)
    else {
        return;
    };
    let stretches: Vec<Range<usize>> = pairs
        .iter()
        .filter(|(from, _)| from.mistake == Some(mistake))
        .map(|(from, to)| from.at..to.at)
        .collect();
    if (2 * stretches.len()) as f64 >= SHARE * edges.len() as f64 {
        let inside: usize = stretches.iter().map(Range::len).sum();
        let is_minor = 2 * inside < checked.log.len();
        for range in stretches {
            convert_stretch(checked, range, MISTAKES[mistake].0, is_minor);
        }
    }
}

/// The jumps, in order.
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
    let accel = |i: usize| {
        let (one, next) = (around[i], around[i + 1]);
        (speed_mps[next] - speed_mps[one]) / (time_s[next] - time_s[one])
    };
    let outer_mps = (speed_mps[before] - speed_mps[around[0]])
        .abs()
        .max((speed_mps[around[3]] - to).abs());
    if (to - from).abs() <= outer_mps {
        return None;
    }
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
        .map(|(factor, _)| share(*factor))
        .enumerate();
    let (nearest, share) = factors.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let explains = from.min(to) >= MOVING_MPS && share <= EXPLAINED;
    Some(Edge {
        at: after,
        mistake: explains.then_some(nearest),
        off: share,
        is_strong: jump_mps > STRONG_MPS2 * step_s + COARSE_STEP_MPS,
    })
}

/// Jumps that the next one undoes.
fn paired(edges: &[Edge]) -> Vec<(Edge, Edge)> {
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
        .filter(|_| edge.is_strong && edge.off <= EXPLAINED_ALONE)
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

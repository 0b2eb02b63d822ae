//! The lattice on which rounded speeds lie, whatever the unit they were written in afterwards.

use std::collections::BTreeSet;
use std::ops::Range;

use super::runs::constant_runs;
use crate::statistics::quantile;

/// Units in which speeds are rounded, m/s (1 m/s, knot, mile per hour, km/h), and parts of them.
const UNITS_MPS: [f64; 4] = [1.0, 1.852 / 3.6, 0.44704, 1.0 / 3.6];
const PARTS: [f64; 4] = [1.0, 0.5, 0.2, 0.1];

/// Steps under this are lost in the smoothing, m/s: 0.2 km/h.
const LEAST_STEP_MPS: f64 = 0.05;

/// Changes, or different values, that tell the step, and the share of them that must be a multiple of it.
const LEAST_CHANGES: usize = 20;
const MULTIPLE_SHARE: f64 = 0.98;

/// No rounded speed has more values.
const MOST_VALUES: usize = 4000;

/// How far writing in another unit takes values off the lattice, in steps (0.31 for miles per hour in whole km/h); and the
/// logarithm of the chance that other values come as close.
const OFF: f64 = 0.35;
const BY_CHANCE: f64 = -20.0;

/// Values that are multiples of a step, but for the rounding of their writing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lattice {
    pub(super) step_mps: f64,
    /// How far a value may be from what was rounded, m/s: half a step and the rounding of the writing.
    pub(super) reach_mps: f64,
}

impl Lattice {
    /// `None` where the speed is fine.
    pub(super) fn of(speed_mps: &[f64]) -> Option<Self> {
        let runs: Vec<Range<usize>> = constant_runs(speed_mps).collect();
        let known = known(speed_mps, &runs);
        let by_changes = by_changes(speed_mps, &runs);
        match (known, by_changes) {
            (Some(known), Some(other)) if other.step_mps > 1.01 * known.step_mps => Some(other),
            (known, other) => known.or(other),
        }
    }
}

/// The coarsest step of a known unit on whose multiples the values lie.
fn known(speed_mps: &[f64], runs: &[Range<usize>]) -> Option<Lattice> {
    let mut values = BTreeSet::new();
    for run in runs {
        values.insert((1e6 * speed_mps[run.start]).round() as i64);
        if values.len() > MOST_VALUES {
            return None;
        }
    }
    let mut steps: Vec<f64> = UNITS_MPS
        .iter()
        .flat_map(|unit| PARTS.map(|part| unit * part))
        .collect();
    steps.retain(|step| *step >= LEAST_STEP_MPS);
    steps.sort_by(|a, b| b.total_cmp(a));
    let fits = |step_mps: f64| fitted(speed_mps, runs, &values, step_mps);
    steps.into_iter().find_map(fits)
}

fn fitted(
    speed_mps: &[f64],
    runs: &[Range<usize>],
    values: &BTreeSet<i64>,
    step_mps: f64,
) -> Option<Lattice> {
    let off = |v: f64| (v / step_mps - (v / step_mps).round()).abs();
    let mut offs: Vec<f64> = runs.iter().map(|run| off(speed_mps[run.start])).collect();
    let most = quantile(&mut offs, MULTIPLE_SHARE)?;
    let multiple = |v: &i64| (1e-6 * *v as f64 / step_mps).round() as i64;
    let multiples: BTreeSet<i64> = values.iter().map(multiple).collect();
    let by_chance = multiples.len() as f64 * (2.0 * most).max(1e-3).ln();
    let is_one_each = multiples.len() as f64 >= MULTIPLE_SHARE * values.len() as f64;
    (multiples.len() >= LEAST_CHANGES && most <= OFF && by_chance < BY_CHANCE && is_one_each)
        .then_some(Lattice {
            step_mps,
            reach_mps: (0.5 + most) * step_mps,
        })
}

/// Any step of which the changes are multiples.
fn by_changes(speed_mps: &[f64], runs: &[Range<usize>]) -> Option<Lattice> {
    let mut jumps_mps: Vec<f64> = runs
        .windows(2)
        .filter(|pair| pair[0].end == pair[1].start)
        .map(|pair| (speed_mps[pair[1].start] - speed_mps[pair[0].start]).abs())
        .collect();
    if jumps_mps.len() < LEAST_CHANGES {
        return None;
    }
    let step_mps = quantile(&mut jumps_mps, 0.05)?;
    let is_multiple = |jump: &&f64| {
        let steps = *jump / step_mps;
        (steps - steps.round()).abs() < 1e-3 && steps > 0.5
    };
    let multiples = jumps_mps.iter().filter(is_multiple).count();
    let is_most = multiples as f64 >= MULTIPLE_SHARE * jumps_mps.len() as f64;
    (step_mps >= LEAST_STEP_MPS && is_most).then_some(Lattice {
        step_mps,
        reach_mps: 0.5 * step_mps,
    })
}

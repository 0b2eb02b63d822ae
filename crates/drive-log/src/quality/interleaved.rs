//! Rows of several vehicles between each other, with nothing that tells them apart.

use std::collections::BTreeSet;

use super::checked::Checked;
use super::time::MAX_LATE;
use crate::statistics::median_step_s;
use crate::{Action, Finding, FindingKind};

/// Samples further apart do not say whether there was a jump, s.
const NEIGHBOURS_S: f64 = 2.0;

/// A row is off those before and after it by more than a car turns around, m/s² and m/s, while these are closer to each other by
/// the last figure.
const TURN_MPS2: f64 = 4.0;
const COARSE_STEP_MPS: f64 = 1.0;
const BACK: f64 = 0.5;

/// So many such rows, of so many values both above and below their neighbours, and their share of the rows in motion: a code that
/// comes often has one value.
const ROWS: usize = 20;
const VALUES: usize = 10;
const SHARE: f64 = 0.2;
const MOVING_MPS: f64 = 1.0;

/// A clock that starts anew is one of another recording, with so many rows on average.
const BLOCK_ROWS: usize = 100;

/// Refuses a recording whose speed goes to and fro between two or more.
pub(super) fn refuse(checked: &mut Checked) {
    let blocks = in_order(checked);
    let (mut above, mut below) = (BTreeSet::new(), BTreeSet::new());
    let mut count = 0;
    let triples = blocks.iter().flat_map(|rows| rows.windows(3));
    for around in triples.filter(|around| is_apart(around)) {
        let side = if around[1].1 > around[0].1 {
            &mut above
        } else {
            &mut below
        };
        side.insert(around[1].1.to_bits());
        count += 1;
    }
    let moving = blocks
        .iter()
        .flat_map(|rows| rows.windows(2))
        .filter(|pair| pair[0].1.max(pair[1].1) > MOVING_MPS)
        .count();
    let is_many = count >= ROWS && count as f64 >= SHARE * moving as f64;
    if !is_many || above.len() < VALUES || below.len() < VALUES {
        return;
    }
    let detail = format!(
        "in {count} of {moving} rows in motion the speed is another than before and after, by jumps that no car makes: rows of several \
         vehicles or sensors lie between each other; name the column that tells them apart in split_by of a layout, or give each a file"
    );
    let times_s = || blocks.iter().flatten().map(|row| row.0);
    let span_s = (
        times_s().fold(f64::INFINITY, f64::min),
        times_s().fold(f64::NEG_INFINITY, f64::max),
    );
    let finding = Finding::of_time(FindingKind::Interleaved, span_s, Action::Refused, detail);
    checked.findings.push(finding);
}

/// Times and speeds in the order of time, of each recording on its own where a clock starts anew.
fn in_order(checked: &Checked) -> Vec<Vec<(f64, f64)>> {
    let samples = checked.log.time_s().iter().zip(checked.log.speed_mps());
    let known = samples.filter(|(t, v)| t.is_finite() && v.is_finite());
    let rows: Vec<(f64, f64)> = known.map(|(t, v)| (*t, *v)).collect();
    let late_s = MAX_LATE as f64 * median_step_s(checked.log.time_s());
    let mut latest_s = f64::NEG_INFINITY;
    let mut blocks: Vec<Vec<(f64, f64)>> = Vec::new();
    for row in &rows {
        if row.0 < latest_s - late_s || blocks.is_empty() {
            blocks.push(Vec::new());
            latest_s = f64::NEG_INFINITY;
        }
        latest_s = latest_s.max(row.0);
        if let Some(block) = blocks.last_mut() {
            block.push(*row);
        }
    }
    if blocks.len() * BLOCK_ROWS > rows.len() {
        blocks = vec![rows];
    }
    for block in &mut blocks {
        block.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    blocks
}

/// Whether the middle one of three rows is of another speed than the two around it.
fn is_apart(around: &[(f64, f64)]) -> bool {
    let [before, row, after] = [around[0], around[1], around[2]];
    let away = |other: (f64, f64)| {
        let (step_s, jump_mps) = ((row.0 - other.0).abs(), other.1 - row.1);
        let jumps = step_s <= NEIGHBOURS_S && jump_mps.abs() > COARSE_STEP_MPS + TURN_MPS2 * step_s;
        jumps.then_some(jump_mps)
    };
    away(before).zip(away(after)).is_some_and(|(left, right)| {
        left * right > 0.0 && (left - right).abs() < BACK * left.abs().min(right.abs())
    })
}

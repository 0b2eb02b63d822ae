//! Straight lines in a speed, where nothing was measured.

use std::ops::Range;

use super::checked::Checked;
use super::motion::MOVING_MPS;
use crate::statistics::quantile;
use crate::{Action, Channel, FindingKind};

/// A line of so many seconds and samples that rises or falls by so much, m/s², was drawn: no car keeps to one within this share of
/// what half of its samples are off the line between their neighbours, between the first figures, m/s.
const OFF_MPS: (f64, f64) = (1e-4, 2e-3);
const OFF_SHARE: f64 = 0.25;
const LEAST_S: f64 = 8.0;
const SAMPLES: usize = 20;
const LEAST_MPS2: f64 = 0.01;

/// Samples in motion of which such a share is off the line between its neighbours: cycles are made of lines.
const LIVELY_SHARE: f64 = 0.7;
const LIVELY_SAMPLES: usize = 100;

/// Removes straight lines from a speed that is measured otherwise. Their ends stay.
pub(super) fn remove(checked: &mut Checked) {
    let Some(off_mps) = tolerance_mps(checked) else {
        return;
    };
    for line in lines(checked, off_mps) {
        let speed_mps = checked.log.speed_mps();
        let detail = format!(
            "a straight line from {:.2} to {:.2} m/s for {:.1} s: nothing was measured there",
            speed_mps[line.start],
            speed_mps[line.end - 1],
            checked.duration_s(&line)
        );
        checked.report(
            FindingKind::Filled,
            Channel::Speed,
            &line,
            Action::Removed,
            detail,
        );
        checked.remove(Channel::Speed, line.start + 1..line.end - 1);
    }
}

/// The straight lines, each as long as can be, in order.
fn lines(checked: &Checked, off_mps: f64) -> Vec<Range<usize>> {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let mut lines = Vec::new();
    let mut start = 0;
    while start + 1 < speed_mps.len() {
        let end = line_end(time_s, speed_mps, start, off_mps);
        let line = start..end;
        if line.len() >= SAMPLES && is_line(checked, &line) {
            lines.push(line);
        }
        start = end.max(start + 2) - 1;
    }
    lines
}

fn is_line(checked: &Checked, line: &Range<usize>) -> bool {
    let speed_mps = checked.log.speed_mps();
    let change_mps = speed_mps[line.end - 1] - speed_mps[line.start];
    let duration_s = checked.duration_s(line);
    duration_s >= LEAST_S && change_mps.abs() >= LEAST_MPS2 * duration_s
}

/// The sample after the last that lies, with all between, within a tolerance of a line from `start`.
fn line_end(time_s: &[f64], speed_mps: &[f64], start: usize, off_mps: f64) -> usize {
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in start + 1..speed_mps.len() {
        let (step_s, change_mps) = (time_s[i] - time_s[start], speed_mps[i] - speed_mps[start]);
        least = least.max((change_mps - off_mps) / step_s);
        most = most.min((change_mps + off_mps) / step_s);
        if !(change_mps.is_finite() && least <= most) {
            return i;
        }
    }
    speed_mps.len()
}

/// How far a sample of a line may be off it, m/s; `None` where the speed is hardly ever off the line between two neighbours.
fn tolerance_mps(checked: &Checked) -> Option<f64> {
    let speed_mps = checked.log.speed_mps();
    let off_mps = |around: &[f64]| (around[0] - 2.0 * around[1] + around[2]).abs();
    let moving = speed_mps.windows(3).filter(|around| around[1] > MOVING_MPS);
    let mut sizes: Vec<f64> = moving.map(off_mps).filter(|off| off.is_finite()).collect();
    if sizes.len() < LIVELY_SAMPLES {
        return None;
    }
    let tolerance_mps = OFF_SHARE * quantile(&mut sizes, 0.5)?;
    let tolerance_mps = tolerance_mps.clamp(OFF_MPS.0, OFF_MPS.1);
    let is_lively = quantile(&mut sizes, 1.0 - LIVELY_SHARE)? > tolerance_mps;
    is_lively.then_some(tolerance_mps)
}

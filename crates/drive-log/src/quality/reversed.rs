//! Speeds with the wrong sign.

use std::ops::Range;

use super::checked::Checked;
use crate::{Action, Channel, FindingKind};

/// No car reverses faster for so long, m/s and s.
const REVERSE_MPS: f64 = 8.0;
const LONG_S: f64 = 3.0;

/// Turns the sign of stretches, from one change of sign to the next, in which a car would reverse faster than cars do; whether there are some.
pub(super) fn turn_speed(checked: &mut Checked) -> bool {
    let (time_s, speed_mps) = (checked.log.time_s(), checked.log.speed_mps());
    let stretches: Vec<Range<usize>> = backward(speed_mps)
        .into_iter()
        .filter(|stretch| fast_s(&time_s[stretch.clone()], &speed_mps[stretch.clone()]) > LONG_S)
        .collect();
    for stretch in &stretches {
        let values = checked.log.channels.get_mut(&Channel::Speed);
        let values = values.map(|values| &mut values[stretch.clone()]);
        let values = values.into_iter().flatten();
        let mut fastest_mps = 0.0_f64;
        for value in values {
            *value = -*value;
            fastest_mps = fastest_mps.max(*value);
        }
        let detail = format!("up to {fastest_mps:.1} m/s backward, as no car reverses");
        checked.report(
            FindingKind::Contradicted,
            Channel::Speed,
            stretch,
            Action::SignFlipped,
            detail,
        );
    }
    !stretches.is_empty()
}

/// Stretches without a positive value; what is missing belongs to them.
fn backward(speed_mps: &[f64]) -> Vec<Range<usize>> {
    let mut stretches = Vec::new();
    let mut start = 0;
    for end in 0..=speed_mps.len() {
        if speed_mps.get(end).is_none_or(|speed| *speed > 0.0) {
            if start < end {
                stretches.push(start..end);
            }
            start = end + 1;
        }
    }
    stretches
}

/// How long a stretch is faster than [`REVERSE_MPS`].
fn fast_s(time_s: &[f64], speed_mps: &[f64]) -> f64 {
    let steps = time_s.windows(2).zip(speed_mps);
    let fast = steps.filter(|(_, speed)| **speed < -REVERSE_MPS);
    fast.map(|(step, _)| step[1] - step[0]).sum()
}

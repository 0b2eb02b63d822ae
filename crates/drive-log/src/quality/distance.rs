//! What a recorded way says of the speed.

use super::motion::Span;
use crate::{Channel, RawLog};

/// A way that tells, m, and how many times its smallest step it must be long: odometers count in 0.1 or 1 km.
const LEAST_M: f64 = 300.0;
const LEAST_STEPS: f64 = 15.0;

/// A counter goes back in no more than this share of the seconds: at a reset.
const BACKWARD: f64 = 0.01;

/// How many times the way that the speed makes is the recorded one; `None` where that does not count a way.
pub(super) fn ratio(log: &RawLog, spans: &[Span]) -> Option<f64> {
    let way_m = log.channel(Channel::Distance)?;
    let counted = |span: &Span| {
        let counted_m = way_m[*span.samples.end()] - way_m[*span.samples.start()];
        counted_m
            .is_finite()
            .then_some((counted_m, span.distance_m()))
    };
    let counted: Vec<(f64, f64)> = spans.iter().filter_map(counted).collect();
    let backward = counted
        .iter()
        .filter(|(counted_m, _)| *counted_m < 0.0)
        .count();
    if backward as f64 > BACKWARD * counted.len() as f64 {
        return None;
    }
    let forward = || counted.iter().filter(|(counted_m, _)| *counted_m >= 0.0);
    let recorded_m: f64 = forward().map(|(counted_m, _)| counted_m).sum();
    let driven_m: f64 = forward().map(|(_, driven_m)| driven_m).sum();
    let steps = forward()
        .map(|(counted_m, _)| *counted_m)
        .filter(|m| *m > 0.0);
    let step_m = steps.fold(f64::INFINITY, f64::min);
    (recorded_m >= LEAST_M.max(LEAST_STEPS * step_m)).then(|| driven_m / recorded_m)
}

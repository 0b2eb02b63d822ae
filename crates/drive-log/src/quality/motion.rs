//! What the car does from one second to the next.

use std::ops::RangeInclusive;

use crate::statistics::mean;
use crate::{Channel, RawLog};

/// Less than a second is noise, more blurs gear changes and regeneration; samples that are further
/// apart than the second figure say nothing about what is between them, s.
const SPAN_S: f64 = 1.0;
const LONGEST_S: f64 = 3.0;

/// A car this fast moves, and this slow it stands, m/s.
pub(super) const MOVING_MPS: f64 = 1.0;
pub(super) const STANDSTILL_MPS: f64 = 0.05;

/// Standard gravity, m/s².
pub(super) const GRAVITY_MPS2: f64 = 9.80665;

/// A second of driving, from one sample with a speed to another. Spans share no more than their ends.
pub(super) struct Span {
    pub(super) samples: RangeInclusive<usize>,
    pub(super) duration_s: f64,
    /// Mean of the two ends, m/s.
    pub(super) speed_mps: f64,
    /// Change of the speed over time, m/s².
    pub(super) accel_mps2: f64,
}

/// The seconds of a recording, in order.
pub(super) fn spans(log: &RawLog) -> Vec<Span> {
    let (time_s, speed_mps) = (log.time_s(), log.speed_mps());
    let mut spans = Vec::new();
    let mut from: Option<usize> = None;
    for to in (0..log.len()).filter(|&i| speed_mps[i].is_finite()) {
        let Some(start) = from else {
            from = Some(to);
            continue;
        };
        let span_s = time_s[to] - time_s[start];
        if span_s < 0.99 * SPAN_S {
            continue;
        }
        if span_s <= LONGEST_S {
            spans.push(Span {
                samples: start..=to,
                duration_s: span_s,
                speed_mps: 0.5 * (speed_mps[start] + speed_mps[to]),
                accel_mps2: (speed_mps[to] - speed_mps[start]) / span_s,
            });
        }
        from = Some(to);
    }
    spans
}

/// The seconds of a recording in which the car moves forward.
pub(super) fn moving_spans(log: &RawLog) -> Vec<Span> {
    let mut spans = spans(log);
    spans.retain(|span| span.speed_mps > MOVING_MPS);
    spans
}

impl Span {
    /// Power of inertia per mass, W/kg.
    pub(super) fn inertia(&self) -> f64 {
        self.speed_mps * self.accel_mps2
    }

    pub(super) fn distance_m(&self) -> f64 {
        self.speed_mps.abs() * self.duration_s
    }

    /// Mean of a channel over the span.
    pub(super) fn mean(&self, values: &[f64]) -> Option<f64> {
        mean(values[self.samples.clone()].iter().copied())
    }

    /// Mean battery power, W; the current alone, A, where there is no voltage.
    pub(super) fn battery(&self, log: &RawLog) -> Option<f64> {
        let current_a = log.channel(Channel::BatteryCurrent)?;
        let voltage_v = log.channel(Channel::BatteryVoltage);
        mean(
            self.samples
                .clone()
                .map(|i| current_a[i] * voltage_v.map_or(1.0, |v| v[i])),
        )
    }
}

/// Mean gradient of the road of a drive, from slope or elevation; `None` if neither is known.
pub(super) fn mean_gradient(log: &RawLog, spans: &[Span]) -> Option<f64> {
    if let Some(slope_rad) = log.channel(Channel::Slope) {
        return mean(spans.iter().filter_map(|span| span.mean(slope_rad)));
    }
    let mut known = log
        .channel(Channel::Elevation)?
        .iter()
        .filter(|z| z.is_finite());
    let first_m = known.next()?;
    let last_m = known.next_back()?;
    let distance_m: f64 = spans.iter().map(Span::distance_m).sum();
    Some((last_m - first_m) / distance_m)
}

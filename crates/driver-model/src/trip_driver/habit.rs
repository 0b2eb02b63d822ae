use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::recording::RecordedTrip;
use super::{check_table, row_of, within};
use crate::Error;
use crate::road::limit::LIMITS_PER_MPS;
use crate::statistics::quantile;

const BIAS_MPS: RangeInclusive<f64> = -150.0..=150.0;
const PER_LIMIT: RangeInclusive<f64> = -100.0..=100.0;

/// Wanted speeds are at least 2 m/s, so that every trip ends, and no more than any car's.
const SLOWEST_MPS: f64 = 2.0;
const FASTEST_MPS: f64 = 150.0;

/// A limit seen for less than this has no bias of its own.
const LEAST_SECONDS: f64 = 60.0;

/// Steady driving: acceleration below this over a second, speed above this share of the limit.
const STEADY_MPS2: f64 = 0.3;
const STEADY_SHARE: f64 = 0.6;

/// The speed that a driver wants under a limit `L`: `max(L + β(L), 2 m/s)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WantedSpeed {
    /// `β` of the limits that were seen for a minute, ascending.
    pub by_limit: Vec<LimitHabit>,
    /// `β` of all others.
    pub line: HabitLine,
}

/// Median of the steady speed minus the limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitHabit {
    /// `L`.
    pub limit_mps: f64,
    /// `β`.
    pub bias_mps: f64,
}

/// `β = p0 + p1 L`, least squares through the medians of all limits, weighted by their time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HabitLine {
    /// `p0`.
    pub offset_mps: f64,
    /// `p1`.
    pub per_limit: f64,
}

impl WantedSpeed {
    /// The wanted speed under a limit.
    #[must_use]
    pub fn mps(&self, limit_mps: f64) -> f64 {
        let own = row_of(&self.by_limit, |row| row.limit_mps, limit_mps);
        let line = self.line.offset_mps + self.line.per_limit * limit_mps;
        let bias_mps = own.map_or(line, |row| row.bias_mps);
        (limit_mps + bias_mps).clamp(SLOWEST_MPS, FASTEST_MPS)
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        check_table(&self.by_limit, |row| row.limit_mps)?;
        for row in &self.by_limit {
            within("bias_mps", row.bias_mps, &BIAS_MPS)?;
        }
        within("offset_mps", self.line.offset_mps, &BIAS_MPS)?;
        within("per_limit", self.line.per_limit, &PER_LIMIT)
    }

    /// From steady driving; a driver without any drives the limit.
    pub(super) fn fit(recordings: &[&RecordedTrip]) -> Self {
        let mut seen: BTreeMap<u64, Seen> = BTreeMap::new();
        for recording in recordings {
            collect(recording, &mut seen);
        }
        let medians: Vec<Median> = seen.into_values().filter_map(Seen::median).collect();
        let own = medians.iter().filter(|m| m.seconds >= LEAST_SECONDS);
        Self {
            by_limit: own
                .map(|m| LimitHabit {
                    limit_mps: m.limit_mps,
                    bias_mps: m.bias_mps,
                })
                .collect(),
            line: HabitLine::through(&medians),
        }
    }
}

#[derive(Default)]
struct Seen {
    limit_mps: f64,
    seconds: f64,
    biases_mps: Vec<f64>,
}

struct Median {
    limit_mps: f64,
    seconds: f64,
    bias_mps: f64,
}

impl Seen {
    fn median(mut self) -> Option<Median> {
        self.biases_mps.sort_by(f64::total_cmp);
        Some(Median {
            limit_mps: self.limit_mps,
            seconds: self.seconds,
            bias_mps: quantile(&self.biases_mps, 0.5)?.clamp(*BIAS_MPS.start(), *BIAS_MPS.end()),
        })
    }
}

fn collect(recording: &RecordedTrip, seen: &mut BTreeMap<u64, Seen>) {
    let (v, limit, step_s) = (&recording.speed_mps, &recording.limit_mps, recording.step_s);
    let reach = recording.samples_in(0.5);
    for k in reach..v.len().saturating_sub(reach) {
        let accel_mps2 = (v[k + reach] - v[k - reach]) / (2.0 * reach as f64 * step_s);
        if accel_mps2.abs() >= STEADY_MPS2 || v[k] <= STEADY_SHARE * limit[k] {
            continue;
        }
        let key = (limit[k] * LIMITS_PER_MPS).round() as u64;
        let seen = seen.entry(key).or_default();
        seen.limit_mps = limit[k];
        seen.seconds += step_s;
        seen.biases_mps.push(v[k] - limit[k]);
    }
}

impl HabitLine {
    fn through(medians: &[Median]) -> Self {
        let sum = |of: &dyn Fn(&Median) -> f64| medians.iter().map(|m| m.seconds * of(m)).sum();
        let weight: f64 = sum(&|_| 1.0);
        if weight <= 0.0 {
            return Self::default();
        }
        let limit: f64 = sum(&|m| m.limit_mps) / weight;
        let bias: f64 = sum(&|m| m.bias_mps) / weight;
        let spread: f64 = sum(&|m| (m.limit_mps - limit).powi(2));
        let product: f64 = sum(&|m| (m.limit_mps - limit) * (m.bias_mps - bias));
        let slope = if medians.len() > 1 {
            product / spread
        } else {
            0.0
        };
        let per_limit = slope.clamp(*PER_LIMIT.start(), *PER_LIMIT.end());
        let offset_mps = (bias - per_limit * limit).clamp(*BIAS_MPS.start(), *BIAS_MPS.end());
        Self {
            offset_mps,
            per_limit,
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_has_its_own_bias_or_that_of_the_line() {
        let wanted = WantedSpeed {
            by_limit: vec![LimitHabit {
                limit_mps: 13.89,
                bias_mps: 0.5,
            }],
            line: HabitLine {
                offset_mps: -1.0,
                per_limit: 0.1,
            },
        };
        assert_eq!(wanted.mps(13.89), 13.89 + 0.5);
        assert_eq!(wanted.mps(20.0), 21.0);
        assert_eq!((wanted.mps(1.0), wanted.mps(1e9)), (2.0, 150.0));
    }

    #[test]
    fn the_line_is_weighted_by_time() {
        let median = |limit_mps, bias_mps, seconds| Median {
            limit_mps,
            seconds,
            bias_mps,
        };
        let exact = HabitLine::through(&[median(10.0, 1.0, 5.0), median(20.0, 2.0, 50.0)]);
        assert!((exact.per_limit - 0.1).abs() < 1e-12 && exact.offset_mps.abs() < 1e-12);
        let one = HabitLine::through(&[median(10.0, 1.0, 5.0)]);
        assert_eq!((one.offset_mps, one.per_limit), (1.0, 0.0));
        assert_eq!(HabitLine::through(&[]), HabitLine::default());
    }
}

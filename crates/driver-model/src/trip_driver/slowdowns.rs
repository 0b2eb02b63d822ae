use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::recording::RecordedTrip;
use super::{check_table, row_of, within};
use crate::Error;
use crate::road::limit::LIMITS_PER_MPS;
use crate::road::map::{Stretch, StretchEnd};
use crate::road::{STANDSTILL_MPS, SlowPoint};
use crate::statistics::mean;

/// Slow points this near to the end of a stretch belong to its end, m.
const EDGE_M: f64 = 25.0;

/// A limit driven for less than this has no rate of its own, m.
const LEAST_M: f64 = 1000.0;

const PER_M: RangeInclusive<f64> = 0.0..=0.1;
const SPEED_MPS: RangeInclusive<f64> = STANDSTILL_MPS..=1000.0;

/// Slowdowns that neither limits nor stops explain: how often, and to what speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slowdowns {
    /// By limit, ascending.
    pub by_limit: Vec<LimitSlowdowns>,
    /// Under all other limits: slowdowns per metre.
    pub per_m: f64,
    /// And their mean speed.
    pub speed_mps: f64,
    /// Share of the limit changes with one.
    pub at_change_share: f64,
    /// Mean speed of those.
    pub at_change_mps: f64,
}

/// Slowdowns under a limit, away from stops and limit changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSlowdowns {
    /// The limit.
    pub limit_mps: f64,
    /// Slowdowns per metre.
    pub per_m: f64,
    /// Their mean speed.
    pub speed_mps: f64,
}

impl Slowdowns {
    /// Spread evenly over the stretches of a road; what is left over of a count goes to the next stretch.
    pub(super) fn expected(&self, stretches: &[Stretch]) -> Vec<SlowPoint> {
        let mut points = Vec::new();
        let (mut due, mut due_at_change) = (0.5, 0.5);
        for stretch in stretches {
            let own = row_of(&self.by_limit, |row| row.limit_mps, stretch.limit_mps);
            let (per_m, speed_mps) = own.map_or((self.per_m, self.speed_mps), |row| {
                (row.per_m, row.speed_mps)
            });
            due += per_m * stretch.length_m();
            let count = f64::floor(due);
            due -= count;
            let spacing_m = stretch.length_m() / (count + 1.0);
            points.extend((1..=count as usize).map(|k| SlowPoint {
                position_m: stretch.start_m + k as f64 * spacing_m,
                speed_mps,
            }));
            if stretch.end == StretchEnd::LimitChange {
                due_at_change += self.at_change_share;
                if due_at_change >= 1.0 {
                    due_at_change -= 1.0;
                    points.push(SlowPoint {
                        position_m: stretch.end_m,
                        speed_mps: self.at_change_mps,
                    });
                }
            }
        }
        points
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        check_table(&self.by_limit, |row| row.limit_mps)?;
        for row in &self.by_limit {
            within("slowdowns.by_limit.per_m", row.per_m, &PER_M)?;
            within("slowdowns.by_limit.speed_mps", row.speed_mps, &SPEED_MPS)?;
        }
        within("slowdowns.per_m", self.per_m, &PER_M)?;
        within("slowdowns.speed_mps", self.speed_mps, &SPEED_MPS)?;
        within(
            "slowdowns.at_change_share",
            self.at_change_share,
            &(0.0..=1.0),
        )?;
        within("slowdowns.at_change_mps", self.at_change_mps, &SPEED_MPS)
    }

    pub(super) fn fit(recordings: &[&RecordedTrip]) -> Self {
        let mut counts: BTreeMap<u64, Count> = BTreeMap::new();
        let (mut changes, mut at_changes) = (0_usize, Vec::new());
        for recording in recordings {
            let points = recording.map.slow_points.as_deref().unwrap_or_default();
            for stretch in recording.map.stretches() {
                let key = (stretch.limit_mps * LIMITS_PER_MPS).round() as u64;
                counts.entry(key).or_default().add(&stretch, points);
                if stretch.end == StretchEnd::LimitChange {
                    changes += 1;
                    let near = |p: &&SlowPoint| (p.position_m - stretch.end_m).abs() <= EDGE_M;
                    let first = from(points, stretch.end_m - EDGE_M).iter().find(near);
                    at_changes.extend(first.map(|point| point.speed_mps));
                }
            }
        }
        let all_mps = counts
            .values()
            .flat_map(|c| &c.speeds_mps)
            .chain(&at_changes);
        // Without a slow point the rates are 0 and the speed is of no consequence.
        let speed_mps = mean(all_mps.copied()).unwrap_or(STANDSTILL_MPS);
        let length_m: f64 = counts.values().map(|c| c.length_m).sum();
        let number: usize = counts.values().map(|c| c.speeds_mps.len()).sum();
        let per_m = (number as f64 / length_m.max(1.0)).min(*PER_M.end());
        Self {
            by_limit: counts.values().map(|c| c.row(per_m, speed_mps)).collect(),
            per_m,
            speed_mps,
            at_change_share: at_changes.len() as f64 / changes.max(1) as f64,
            at_change_mps: mean(at_changes).unwrap_or(speed_mps),
        }
    }
}

#[derive(Default)]
struct Count {
    limit_mps: f64,
    length_m: f64,
    speeds_mps: Vec<f64>,
}

impl Count {
    fn add(&mut self, stretch: &Stretch, points: &[SlowPoint]) {
        self.limit_mps = stretch.limit_mps;
        self.length_m += stretch.length_m();
        let inside_m = stretch.end_m - EDGE_M;
        for point in from(points, stretch.start_m) {
            let position_m = point.position_m;
            if position_m > stretch.end_m {
                break;
            }
            let inside = position_m > stretch.start_m + EDGE_M && position_m < inside_m;
            if inside || (stretch.end == StretchEnd::Road && position_m >= inside_m) {
                self.speeds_mps.push(point.speed_mps);
            }
        }
    }

    fn row(&self, per_m: f64, speed_mps: f64) -> LimitSlowdowns {
        let own = self.speeds_mps.len() as f64 / self.length_m;
        LimitSlowdowns {
            limit_mps: self.limit_mps,
            per_m: if self.length_m > LEAST_M {
                own.min(*PER_M.end())
            } else {
                per_m
            },
            speed_mps: mean(self.speeds_mps.iter().copied()).unwrap_or(speed_mps),
        }
    }
}

/// Points from a position on.
fn from(points: &[SlowPoint], from_m: f64) -> &[SlowPoint] {
    &points[points.partition_point(|point| point.position_m < from_m)..]
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn expected_ones_are_as_many_as_the_rate_says() {
        let slowdowns = Slowdowns {
            by_limit: vec![LimitSlowdowns {
                limit_mps: 10.0,
                per_m: 0.002,
                speed_mps: 4.0,
            }],
            per_m: 0.001,
            speed_mps: 6.0,
            at_change_share: 0.5,
            at_change_mps: 5.0,
        };
        let stretch = |k: i32| Stretch {
            start_m: 300.0 * f64::from(k),
            end_m: 300.0 * f64::from(k + 1),
            limit_mps: if k < 50 { 10.0 } else { 20.0 },
            end: StretchEnd::LimitChange,
        };
        let points = slowdowns.expected(&(0..100).map(stretch).collect::<Vec<_>>());
        let number = |speed_mps| points.iter().filter(|p| p.speed_mps == speed_mps).count();
        assert_eq!((number(4.0), number(6.0), number(5.0)), (30, 15, 50));
        assert!(points.is_sorted_by_key(|point| point.position_m));
    }
}

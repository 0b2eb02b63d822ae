//! Counts, bounds and distributions over the runs of a campaign.

use serde::Serialize;

use crate::summary::Summary;
use crate::verdict::Verdict;

/// Widest range of a histogram, in mm.
const HISTOGRAM_MM: f64 = 100.0;

/// Counts and bounds over runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tally {
    /// Number of runs
    pub runs: usize,
    /// Runs with any violation
    #[serde(rename = "unsafe")]
    pub violations: usize,
    /// Runs in which a robot left its lane
    pub lane_departures: usize,
    /// Runs with a headway below zero
    pub headway_violations: usize,
    /// Runs in which two bodies were nearer to each other than the clearance
    pub near_bodies: usize,
    /// Least distance between two bodies, in m; below zero they touched
    pub min_gap_m: Option<f64>,
    /// Least headway barrier, in m
    pub min_h_headway_m: Option<f64>,
    /// Least distance to the edge of the lane, in m
    pub min_lane_clearance_m: f64,
    /// Mean speed of followers, in m/s
    pub mean_speed_mps: f64,
    /// Steps with relaxed rows
    pub relaxed_pct: f64,
    /// Steps of braking
    pub braking_pct: f64,
}

/// Counts in bins of equal width; what lies beyond is counted in the first or the last.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Histogram {
    /// Start of the first bin
    pub from: f64,
    /// Width of a bin
    pub step: f64,
    /// Runs per bin
    pub counts: Vec<usize>,
}

impl Tally {
    pub(crate) fn new(summaries: &[&Summary]) -> Self {
        let all = || summaries.iter().copied();
        let count = |which: fn(&Summary) -> bool| all().filter(|s| which(s)).count();
        let total = |part: fn(&Summary) -> usize| all().map(part).sum::<usize>() as f64;
        let steps = total(|s| s.outcomes.optimal + s.outcomes.relaxed + s.outcomes.braking);
        let headways = all().filter_map(|s| s.min_h_headway_m);
        let gaps = all().filter_map(|s| Some(s.least_distance?.gap_m));
        let clearances = all().map(|s| s.lane_clearance_m);
        let speeds = all().map(|s| s.mean_speed_mps);
        Self {
            runs: summaries.len(),
            violations: count(|s| s.verdict != Verdict::Safe),
            lane_departures: count(|s| s.lane_clearance_m < 0.0),
            headway_violations: count(|s| s.min_h_headway_m.is_some_and(|h| h < 0.0)),
            near_bodies: count(|s| s.bodies_were_near),
            min_gap_m: gaps.min_by(f64::total_cmp),
            min_h_headway_m: headways.min_by(f64::total_cmp),
            min_lane_clearance_m: clearances.min_by(f64::total_cmp).unwrap_or(f64::NAN),
            mean_speed_mps: speeds.sum::<f64>() / summaries.len() as f64,
            relaxed_pct: 100.0 * total(|s| s.outcomes.relaxed) / steps,
            braking_pct: 100.0 * total(|s| s.outcomes.braking) / steps,
        }
    }
}

impl Histogram {
    /// Of values in m, in bins of 2 mm.
    pub(crate) fn new(values_m: impl Iterator<Item = f64>) -> Self {
        let step = 2.0;
        let bins = (2.0 * HISTOGRAM_MM / step) as usize;
        let mut counts = vec![0; bins];
        for value_m in values_m {
            let bin = ((1e3 * value_m + HISTOGRAM_MM) / step).clamp(0.0, (bins - 1) as f64);
            counts[bin as usize] += 1;
        }
        Self {
            from: -HISTOGRAM_MM,
            step,
            counts,
        }
    }
}

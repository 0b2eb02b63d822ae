use drive_log::{Channel, DriveLog};
use serde::Serialize;

use super::Distribution;
use crate::segmentation::lead;

/// Time headway, gap over own speed, while a leader influences.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Headway {
    /// Time behind a leader.
    pub duration_s: f64,
    /// In s.
    pub headway_s: Distribution,
    /// Share of that time with less than 1 s.
    pub under_1_s_pct: f64,
    /// Shares of that time.
    pub bins: Vec<HeadwayBin>,
}

/// A range of headways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeadwayBin {
    /// From here …
    pub from_s: f64,
    /// … to here.
    pub to_s: f64,
    /// Share of the time behind a leader.
    pub share_pct: f64,
}

/// At lower speeds headway is about queueing.
const LEAST_SPEED_MPS: f64 = 20.0 / 3.6;

const BIN_S: f64 = 0.25;

impl Headway {
    /// `None` where no log has a leader near enough.
    pub(super) fn of(logs: &[&DriveLog]) -> Option<Self> {
        let mut headways = Vec::new();
        let (mut duration_s, mut near) = (0.0, 0_usize);
        for log in logs {
            let Some(gap_m) = log.channel(Channel::LeadGap) else {
                continue;
            };
            for (&gap, &speed) in gap_m.iter().zip(log.speed_mps()) {
                if gap > 0.0 && speed >= LEAST_SPEED_MPS && lead::is_near(gap, speed) {
                    headways.push(gap / speed);
                    near += usize::from(gap < speed);
                    duration_s += log.step_s();
                }
            }
        }
        let samples = headways.len() as f64;
        let mut counts = vec![0_usize; (lead::INFLUENCE_GAP_S / BIN_S) as usize];
        for headway in &headways {
            let bin = ((headway / BIN_S) as usize).min(counts.len() - 1);
            counts[bin] += 1;
        }
        let bin = |(k, count): (usize, &usize)| HeadwayBin {
            from_s: k as f64 * BIN_S,
            to_s: (k + 1) as f64 * BIN_S,
            share_pct: 100.0 * *count as f64 / samples,
        };
        Some(Self {
            duration_s,
            under_1_s_pct: 100.0 * near as f64 / samples,
            bins: counts.iter().enumerate().map(bin).collect(),
            headway_s: Distribution::of(headways)?,
        })
    }
}

use drive_log::Channel;

use crate::Motion;
use crate::grid::{above, at_least, below};
use crate::segmentation::lead;

/// Which stretches count as cruising.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CruiseSettings {
    /// Acceleration, in the mean over a second, stays below this; 0.3 m/s².
    pub accel_threshold_mps2: f64,
    /// Faster than this; 30 km/h.
    pub least_speed_mps: f64,
    /// Shorter stretches do not count; 10 s.
    pub min_duration_s: f64,
}

impl Default for CruiseSettings {
    fn default() -> Self {
        Self {
            accel_threshold_mps2: 0.3,
            least_speed_mps: 30.0 / 3.6,
            min_duration_s: 10.0,
        }
    }
}

/// A stretch of cruising without a vehicle ahead, under one limit or none that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct CruiseStretch {
    start_s: f64,
    step_s: f64,
    speed_mps: Vec<f64>,
    limit_mps: Option<f64>,
}

impl CruiseStretch {
    /// Time of the first sample in the drive.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Distance of two samples.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// From first to last sample.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        (self.speed_mps.len() - 1) as f64 * self.step_s
    }

    /// Measured speed, at least two samples.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        &self.speed_mps
    }

    /// Speed limit.
    #[must_use]
    pub fn limit_mps(&self) -> Option<f64> {
        self.limit_mps
    }
}

/// Limits from here on are none: 400 km/h.
const NO_LIMIT_MPS: f64 = 400.0 / 3.6;

/// The longest runs of samples that are fast enough, hardly accelerated in the mean over a second, without a near leader, and
/// under the same limit. The single-sample rule of Table 3.1 would break a cruise at every sample of noise.
#[must_use]
pub fn cruise_stretches(motion: &Motion, settings: &CruiseSettings) -> Vec<CruiseStretch> {
    let log = motion.log();
    let speed = log.speed_mps();
    let reach = (0.5 / log.step_s()).round().max(1.0) as usize;
    let gap_m = log.channel(Channel::LeadGap);
    let limit = |k: usize| {
        let limit = log.channel(Channel::SpeedLimit)?[k];
        (limit > 0.0 && limit < NO_LIMIT_MPS).then_some(limit)
    };
    let cruises = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach).min(speed.len() - 1));
        let accel_mps2 = (speed[to] - speed[from]) / ((to - from).max(1) as f64 * log.step_s());
        above(speed[k], settings.least_speed_mps)
            && below(accel_mps2.abs(), settings.accel_threshold_mps2)
            && !gap_m.is_some_and(|gap| lead::is_near(gap[k], speed[k]))
    };
    let mut stretches = Vec::new();
    let mut start = 0;
    while start < speed.len() {
        if !cruises(start) {
            start += 1;
            continue;
        }
        let own_limit = limit(start);
        let goes_on = |&k: &usize| cruises(k) && limit(k) == own_limit;
        let end = (start..speed.len())
            .take_while(goes_on)
            .last()
            .unwrap_or(start)
            + 1;
        let stretch = CruiseStretch {
            start_s: log.time_s(start),
            step_s: log.step_s(),
            speed_mps: speed[start..end].to_vec(),
            limit_mps: own_limit,
        };
        if end - start >= 2 && at_least(stretch.duration_s(), settings.min_duration_s) {
            stretches.push(stretch);
        }
        start = end;
    }
    stretches
}

//! What a direct prediction may know at a moment: own past, and the road ahead.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::motion::held;
use crate::{DriverChannel, Motion};

/// One predictor. Speeds before the first sample count as the first speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Predictor {
    /// `v(t)`.
    Speed,
    /// `v(t) − v(t − lag)`.
    Change {
        /// Lag.
        lag_s: f64,
    },
    /// Standard deviation of the speed since `t − window`.
    Deviation {
        /// Window.
        window_s: f64,
    },
    /// Mean of the speed since `t − window`.
    Mean {
        /// Window.
        window_s: f64,
    },
    /// Greatest speed since `t − window`.
    Greatest {
        /// Window.
        window_s: f64,
    },
    /// Time since the start of the drive, at most `cap`.
    Elapsed {
        /// Longest time told apart.
        cap_s: f64,
    },
    /// Time since the speed last changed, at most `cap`: standing time, or the age of a reading that is held.
    Unchanged {
        /// Longest time told apart.
        cap_s: f64,
    },
    /// Speed limit at the distance `v(t)·seconds` ahead.
    Limit {
        /// Seconds ahead at the present speed; 0 is the limit here.
        seconds: f64,
    },
    /// Mean slope over the distance `max(v(t)·seconds, 20 m)` ahead.
    Slope {
        /// Seconds ahead at the present speed.
        seconds: f64,
    },
    /// What the driver does now.
    Told {
        /// The channel.
        channel: DriverChannel,
    },
    /// What the driver does now less what he did a lag ago.
    ToldChange {
        /// The channel.
        channel: DriverChannel,
        /// Lag.
        lag_s: f64,
    },
    /// Mean of what the driver did since `t − window`.
    ToldMean {
        /// The channel.
        channel: DriverChannel,
        /// Window.
        window_s: f64,
    },
}

/// A predictor and how much a distance in it counts for kernels, beside 1.
pub(super) type Weighted = (Predictor, f64);

/// Shorter distances ahead say nothing of the slope.
const LEAST_SLOPE_DISTANCE_M: f64 = 20.0;

/// Smaller changes of speed are none.
const NO_CHANGE_MPS: f64 = 1e-6;

/// Predictors for logs with this sampling interval.
pub(super) fn predictors(
    step_s: f64,
    limits: bool,
    slope: bool,
    channels: &[DriverChannel],
) -> Vec<Weighted> {
    use Predictor::{Change, Deviation, Elapsed, Greatest, Limit, Mean, Slope, Speed, Unchanged};
    let change = |lag_s, weight| (Change { lag_s }, weight);
    let mut chosen = vec![(Speed, 2.0)];
    // The latest acceleration, as exactly as the sampling allows.
    if step_s <= 0.2 {
        chosen.extend([change(0.1, 2.0), change(0.3, 1.0), change(1.0, 1.0)]);
    } else {
        chosen.extend([change(1.0, 2.0), change(3.0, 1.0)]);
    }
    chosen.extend([change(2.0, 1.0), change(5.0, 0.5)]);
    chosen.extend([10.0, 20.0, 30.0].map(|lag_s| change(lag_s, 0.25)));
    chosen.extend([5.0, 120.0].map(|window_s| (Deviation { window_s }, 0.25)));
    chosen.push((Mean { window_s: 60.0 }, 0.25));
    chosen.extend([60.0, 120.0].map(|window_s| (Greatest { window_s }, 0.5)));
    chosen.push((Elapsed { cap_s: 600.0 }, 0.5));
    chosen.push((Unchanged { cap_s: 10.0 }, 0.5));
    if limits {
        chosen.extend([0.0, 2.0, 4.0, 6.0, 10.0].map(|seconds| (Limit { seconds }, 0.5)));
    }
    if slope {
        chosen.extend([2.0, 5.0, 10.0].map(|seconds| (Slope { seconds }, 0.25)));
    }
    chosen.extend(
        channels
            .iter()
            .flat_map(|channel| channel.predictors(step_s)),
    );
    chosen
}

impl DriverChannel {
    /// The pedal says most, and its last tenths of a second more than anything: what a driver has just begun goes on. Chosen on drives of
    /// `bmw-i3`.
    fn predictors(self, step_s: f64) -> Vec<Weighted> {
        let channel = self;
        let now = |weight| (Predictor::Told { channel }, weight);
        let change = |lag_s, weight| (Predictor::ToldChange { channel, lag_s }, weight);
        let mean = |window_s, weight| (Predictor::ToldMean { channel, window_s }, weight);
        match self {
            Self::AcceleratorPedal => {
                let mut chosen = vec![now(2.0)];
                if step_s <= 0.2 {
                    chosen.extend([0.1, 0.2, 0.4, 0.8].map(|lag_s| change(lag_s, 1.0)));
                } else {
                    chosen.push(change(1.0, 1.0));
                }
                chosen.extend([1.5, 3.0, 5.0, 8.0].map(|lag_s| change(lag_s, 0.5)));
                chosen.extend([mean(2.0, 0.5), mean(5.0, 0.5), mean(20.0, 0.25)]);
                chosen
            }
            Self::Brake => vec![now(0.5), mean(2.0, 0.5)],
            Self::MotorTorque => vec![now(1.0), change(0.5, 0.5), change(1.0, 0.5), mean(2.0, 0.5)],
            Self::Accelerometer => vec![now(1.0), mean(1.0, 0.5), mean(3.0, 0.5)],
        }
    }

    /// Values with gaps held; 0 where the drive does not have the channel.
    fn values(self, motion: &Motion) -> Arc<[f64]> {
        let recorded = motion.log().channel(self.channel());
        recorded
            .and_then(held)
            .unwrap_or_else(|| vec![0.0; motion.len()].into())
    }
}

/// Rows of predictors of a motion, one per origin: value `j` of origin `i` at `i·predictors + j`.
pub(super) fn rows(motion: &Motion, predictors: &[Predictor], origins: &[usize]) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = predictors
        .iter()
        .map(|predictor| predictor.column(motion, origins))
        .collect();
    (0..origins.len())
        .flat_map(|i| columns.iter().map(move |column| column[i]))
        .collect()
}

impl Predictor {
    /// Whether its times are positive, as those of a file might not be.
    pub(super) fn is_usable(self) -> bool {
        match self {
            Self::Speed | Self::Told { .. } => true,
            Self::Change { lag_s: time_s }
            | Self::Deviation { window_s: time_s }
            | Self::Mean { window_s: time_s }
            | Self::Greatest { window_s: time_s }
            | Self::Elapsed { cap_s: time_s }
            | Self::Unchanged { cap_s: time_s }
            | Self::Limit { seconds: time_s }
            | Self::Slope { seconds: time_s }
            | Self::ToldChange { lag_s: time_s, .. }
            | Self::ToldMean {
                window_s: time_s, ..
            } => (0.0..=1e6).contains(&time_s),
        }
    }

    /// What was before does not matter, but for the limit that is held from then and the filter of the slope.
    pub(super) fn past_s(self) -> f64 {
        match self {
            Self::Speed | Self::Told { .. } | Self::Limit { .. } | Self::Slope { .. } => 0.0,
            Self::Change { lag_s: past_s }
            | Self::Deviation { window_s: past_s }
            | Self::Mean { window_s: past_s }
            | Self::Greatest { window_s: past_s }
            | Self::Elapsed { cap_s: past_s }
            | Self::Unchanged { cap_s: past_s }
            | Self::ToldChange { lag_s: past_s, .. }
            | Self::ToldMean {
                window_s: past_s, ..
            } => past_s,
        }
    }

    fn column(self, motion: &Motion, origins: &[usize]) -> Vec<f64> {
        let v = motion.speed_mps();
        let at = |of: &dyn Fn(usize) -> f64| origins.iter().map(|&i| of(i)).collect();
        match self {
            Self::Speed => at(&|i| v[i]),
            Self::Change { lag_s } => {
                let lag = motion.samples_in(lag_s);
                at(&|i| v[i] - v[i.saturating_sub(lag)])
            }
            Self::Deviation { window_s } => {
                let window = motion.samples_in(window_s);
                at(&|i| deviation(&v[i.saturating_sub(window)..=i]))
            }
            Self::Mean { window_s } => {
                let window = motion.samples_in(window_s);
                at(&|i| mean(&v[i.saturating_sub(window)..=i]))
            }
            Self::Greatest { window_s } => {
                let greatest = running_maximum(v, motion.samples_in(window_s));
                at(&|i| greatest[i])
            }
            Self::Elapsed { cap_s } => at(&|i| (i as f64 * motion.step_s()).min(cap_s)),
            Self::Unchanged { cap_s } => {
                let mut since = 0;
                let last_change = (0..v.len()).map(|i| {
                    if i > 0 && (v[i] - v[i - 1]).abs() > NO_CHANGE_MPS {
                        since = i;
                    }
                    since
                });
                let last_change: Vec<usize> = last_change.collect();
                at(&|i| ((i - last_change[i]) as f64 * motion.step_s()).min(cap_s))
            }
            Self::Limit { seconds } => match motion.limit_mps() {
                Some(limit) => at(&|i| limit[ahead(motion, i, v[i] * seconds)]),
                None => vec![0.0; origins.len()],
            },
            Self::Slope { seconds } => match motion.slope_rad() {
                Some(slope) => at(&|i| {
                    let distance_m = (v[i] * seconds).max(LEAST_SLOPE_DISTANCE_M);
                    mean(&slope[i..=ahead(motion, i, distance_m)])
                }),
                None => vec![0.0; origins.len()],
            },
            Self::Told { channel } => {
                let values = channel.values(motion);
                at(&|i| values[i])
            }
            Self::ToldChange { channel, lag_s } => {
                let (values, lag) = (channel.values(motion), motion.samples_in(lag_s));
                at(&|i| values[i] - values[i.saturating_sub(lag)])
            }
            Self::ToldMean { channel, window_s } => {
                let (values, window) = (channel.values(motion), motion.samples_in(window_s));
                at(&|i| mean(&values[i.saturating_sub(window)..=i]))
            }
        }
    }
}

/// The first sample at least this far ahead, or the last.
fn ahead(motion: &Motion, from: usize, distance_m: f64) -> usize {
    let place = motion.distance_m()[from] + distance_m;
    let behind = motion.distance_m()[from..].partition_point(|&s| s < place);
    (from + behind).min(motion.len() - 1)
}

// Window by window, and not by sums over the drive: a stream, which has only the end of it, must come to the same.

fn mean(window: &[f64]) -> f64 {
    window.iter().sum::<f64>() / window.len() as f64
}

fn deviation(window: &[f64]) -> f64 {
    let mean = mean(window);
    let square = |value: &f64| (value - mean) * (value - mean);
    (window.iter().map(square).sum::<f64>() / window.len() as f64).sqrt()
}

/// Greatest value of each window of `window` samples back and the sample itself.
fn running_maximum(values: &[f64], window: usize) -> Vec<f64> {
    let mut candidates = std::collections::VecDeque::new();
    let maximum = values.iter().enumerate().map(|(i, &value)| {
        while candidates
            .back()
            .is_some_and(|&k: &usize| values[k] <= value)
        {
            candidates.pop_back();
        }
        candidates.push_back(i);
        while candidates.front().is_some_and(|&k| k + window < i) {
            candidates.pop_front();
        }
        candidates.front().map_or(value, |&k| values[k])
    });
    maximum.collect()
}

#[cfg(test)]
mod tests {
    use drive_log::Channel;

    use super::*;

    fn motion(speed_mps: Vec<f64>) -> Motion {
        Motion::of_channels("test", 1.0, [(Channel::Speed, speed_mps)])
    }

    #[test]
    fn windows_are_what_a_slow_loop_finds() {
        let speeds: Vec<f64> = (0..200)
            .map(|i| 10.0 + 5.0 * f64::from(i * i % 17) / 17.0)
            .collect();
        let motion = motion(speeds.clone());
        let origins: Vec<usize> = (0..200).collect();
        let window = |i: usize, n: usize| &speeds[i.saturating_sub(n)..=i];
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        for (i, row) in rows(
            &motion,
            &[
                Predictor::Mean { window_s: 60.0 },
                Predictor::Greatest { window_s: 60.0 },
                Predictor::Deviation { window_s: 5.0 },
            ],
            &origins,
        )
        .chunks_exact(3)
        .enumerate()
        {
            assert!((row[0] - mean(window(i, 60))).abs() < 1e-12);
            let greatest = window(i, 60).iter().copied().fold(0.0, f64::max);
            assert!((row[1] - greatest).abs() < 1e-12);
            let m = mean(window(i, 5));
            let square = window(i, 5).iter().map(|v| (v - m) * (v - m)).sum::<f64>()
                / window(i, 5).len() as f64;
            assert!((row[2] - square.sqrt()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_limit_ahead_is_looked_up_by_distance() {
        let limit_mps = (0..20).map(|i| if i < 10 { 14.0 } else { 8.0 });
        let channels = [
            (Channel::Speed, vec![10.0; 20]),
            (Channel::SpeedLimit, limit_mps.collect()),
        ];
        let motion = Motion::of_channels("test", 1.0, channels);
        let values = rows(&motion, &[Predictor::Limit { seconds: 4.0 }], &[5, 6, 19]);
        assert_eq!(values, [14.0, 8.0, 8.0]);
    }
}

use std::ops::{Range, RangeInclusive};

use drive_log::{Channel, DriveLog};

use crate::Motion;
use crate::grid::{above, at_least, below};
use crate::segmentation::INFLUENCE_GAP_S;

/// Which stretches count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingSettings {
    /// Shorter stretches do not count; 20 s.
    pub min_duration_s: f64,
}

impl Default for FollowingSettings {
    fn default() -> Self {
        Self {
            min_duration_s: 20.0,
        }
    }
}

/// A stretch of a drive behind one leader: at least two samples, all values finite, gaps above 0.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowingStretch {
    log: String,
    start_s: f64,
    step_s: f64,
    speed_mps: Vec<f64>,
    gap_m: Vec<f64>,
    lead_speed_mps: Vec<f64>,
}

impl FollowingStretch {
    /// Name of the log.
    #[must_use]
    pub fn log(&self) -> &str {
        &self.log
    }

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

    /// Measured speed.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        &self.speed_mps
    }

    /// Measured gap to the leader at the same samples, bumper to bumper.
    #[must_use]
    pub fn gap_m(&self) -> &[f64] {
        &self.gap_m
    }

    /// Who drives, as far as the log's name tells: behind `#` the vehicle of a platoon, or a column of vehicles or drivers by which the
    /// file was divided; otherwise the file, whose trips are of one driver.
    #[must_use]
    pub fn driver(&self) -> &str {
        let Some((file, part)) = self.log.split_once('#') else {
            return &self.log;
        };
        let is_who = |column: &&str| {
            let column = column.to_ascii_lowercase();
            WHO.iter().any(|who| column.starts_with(who))
        };
        match part.contains('=') {
            true => part.split(',').find(is_who).unwrap_or(file),
            false => part,
        }
    }

    /// Cut into pieces of about so many seconds, at least two, that share the samples they are cut at; none below three samples.
    #[must_use]
    pub fn pieces(&self, duration_s: f64) -> Vec<Self> {
        let steps = self.speed_mps.len() - 1;
        let wanted = (self.duration_s() / duration_s).round() as usize;
        let pieces = wanted.clamp(2, steps.max(2));
        let cut = |piece: usize| self.cut(piece * steps / pieces..(piece + 1) * steps / pieces + 1);
        if steps < 2 {
            return Vec::new();
        }
        (0..pieces).map(cut).collect()
    }

    fn cut(&self, range: Range<usize>) -> Self {
        Self {
            log: self.log.clone(),
            start_s: self.start_s + range.start as f64 * self.step_s,
            step_s: self.step_s,
            speed_mps: self.speed_mps[range.clone()].to_vec(),
            gap_m: self.gap_m[range.clone()].to_vec(),
            lead_speed_mps: self.lead_speed_mps[range].to_vec(),
        }
    }

    /// Speed of the leader at the same samples.
    #[must_use]
    pub fn lead_speed_mps(&self) -> &[f64] {
        &self.lead_speed_mps
    }
}

/// How columns begin that tell drivers apart.
const WHO: [&str; 4] = ["driver", "veh", "vin", "car"];

/// Below this speed a leader counts as it would at this speed: at standstill no gap is under `5 s · v`, and yet a queue
/// follows.
const SLOW_MPS: f64 = 5.0;

/// Speeds outside are none.
const PLAUSIBLE_MPS: RangeInclusive<f64> = -20.0..=150.0;

/// The gap is compared with what it was this long before and after.
const CHANGE_WINDOW_S: f64 = 0.5;

/// A gap that differs this much from what the speeds make of it is one to another vehicle.
const CHANGE_M: f64 = 3.0;

/// Two vehicles do not change their relative speed faster.
const MAX_RELATIVE_ACCEL_MPS2: f64 = 8.0;

/// A leader's speed that is not recorded is that of its gap over this long before and after.
const SLOPE_WINDOW_S: f64 = 1.0;

/// Cuts the stretches behind one leader out of a log, in linear time.
///
/// A stretch is a longest run of samples with `0 < gap < 5 s · max(v, 5 m/s)` that ends with a change of leader: where
/// over the second around a sample the gap changes by 3 m more or less than the two speeds say, or, without a recorded speed
/// of the leader, where its rate of change jumps. That speed is then the own one plus the slope of the gap over the 2 s
/// around the sample. Empty where the log has no gap.
#[must_use]
pub fn following_stretches(motion: &Motion, settings: &FollowingSettings) -> Vec<FollowingStretch> {
    let log = motion.log();
    let Some(gap_m) = log.channel(Channel::LeadGap) else {
        return Vec::new();
    };
    let recording = Recording {
        log,
        gap_m,
        lead_speed_mps: log.channel(Channel::LeadSpeed),
    };
    let mut stretches = Vec::new();
    let mut start = 0;
    for end in 0..=gap_m.len() {
        if end < gap_m.len() && recording.is_following(end) {
            continue;
        }
        let duration_s = end.saturating_sub(start + 1) as f64 * log.step_s();
        if end - start >= 2 && at_least(duration_s, settings.min_duration_s) {
            stretches.push(recording.cut(start..end));
        }
        start = end + 1;
    }
    stretches
}

struct Recording<'a> {
    log: &'a DriveLog,
    gap_m: &'a [f64],
    lead_speed_mps: Option<&'a [f64]>,
}

impl Recording<'_> {
    fn is_following(&self, k: usize) -> bool {
        let (speed_mps, gap_m) = (self.log.speed_mps()[k], self.gap_m[k]);
        PLAUSIBLE_MPS.contains(&speed_mps)
            && gap_m > 0.0
            && below(gap_m, INFLUENCE_GAP_S * speed_mps.max(SLOW_MPS))
            && !self.changes_leader(k)
    }

    fn changes_leader(&self, k: usize) -> bool {
        let step_s = self.log.step_s();
        let half = samples(CHANGE_WINDOW_S, step_s);
        let first = k.saturating_sub(half);
        let last = (k + half).min(self.gap_m.len() - 1);
        let (before_m, after_m) = (self.gap_m[first], self.gap_m[last]);
        let relative_mps: f64 = (first..last)
            .map(|i| 0.5 * (self.recorded_relative_mps(i) + self.recorded_relative_mps(i + 1)))
            .sum();
        if relative_mps.is_finite() {
            return above((after_m - before_m - relative_mps * step_s).abs(), CHANGE_M);
        }
        if last - k != k - first {
            return false;
        }
        let window_s = half as f64 * step_s;
        let possible_m = CHANGE_M + MAX_RELATIVE_ACCEL_MPS2 * window_s * window_s;
        above((after_m - 2.0 * self.gap_m[k] + before_m).abs(), possible_m)
    }

    /// NaN where the leader's speed is not recorded.
    fn recorded_relative_mps(&self, k: usize) -> f64 {
        self.lead_speed_mps
            .map(|lead| lead[k])
            .filter(|lead_mps| PLAUSIBLE_MPS.contains(lead_mps))
            .map_or(f64::NAN, |lead_mps| lead_mps - self.log.speed_mps()[k])
    }

    fn cut(&self, range: Range<usize>) -> FollowingStretch {
        let lead_speed_mps = range
            .clone()
            .map(|k| {
                let relative_mps = self.recorded_relative_mps(k);
                let relative_mps = if relative_mps.is_finite() {
                    relative_mps
                } else {
                    self.gap_slope_mps(k, &range)
                };
                self.log.speed_mps()[k] + relative_mps
            })
            .collect();
        FollowingStretch {
            log: self.log.name().to_owned(),
            start_s: self.log.time_s(range.start),
            step_s: self.log.step_s(),
            speed_mps: self.log.speed_mps()[range.clone()].to_vec(),
            gap_m: self.gap_m[range].to_vec(),
            lead_speed_mps,
        }
    }

    /// Slope of the least-squares line through the gaps around a sample, within a stretch of at least two.
    fn gap_slope_mps(&self, k: usize, range: &Range<usize>) -> f64 {
        let half = samples(SLOPE_WINDOW_S, self.log.step_s());
        let first = k.saturating_sub(half).max(range.start);
        let window = &self.gap_m[first..(k + half + 1).min(range.end)];
        let middle = 0.5 * (window.len() - 1) as f64;
        let (mut products, mut squares) = (0.0, 0.0);
        for (i, gap_m) in window.iter().enumerate() {
            let offset = i as f64 - middle;
            products += offset * gap_m;
            squares += offset * offset;
        }
        products / (squares * self.log.step_s())
    }
}

/// Samples of a duration, at least one.
fn samples(duration_s: f64, step_s: f64) -> usize {
    (duration_s / step_s).round().max(1.0) as usize
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeMap;

    use drive_log::DriveLog;

    use super::*;

    const STEP_S: f64 = 0.1;

    fn log(gap_m: Vec<f64>, speed_mps: f64, lead_mps: Option<f64>) -> DriveLog {
        let n = gap_m.len();
        let mut channels = BTreeMap::from([
            (Channel::Speed, vec![speed_mps; n]),
            (Channel::LeadGap, gap_m),
        ]);
        if let Some(lead_mps) = lead_mps {
            channels.insert(Channel::LeadSpeed, vec![lead_mps; n]);
        }
        DriveLog::new("log", 7.0, STEP_S, channels).unwrap()
    }

    #[test]
    fn trips_of_a_file_are_of_one_driver_and_vehicles_are_not() {
        let stretch = &stretches(&log(vec![20.0; 300], 10.0, Some(10.0)))[0];
        for (name, driver) in [
            ("part22#AUDI_E_TRON", "AUDI_E_TRON"),
            ("driver_A#trip=5", "driver_A"),
            ("fleet#trip=5,Vehicle=7", "Vehicle=7"),
            ("commute", "commute"),
        ] {
            let stretch = FollowingStretch {
                log: name.to_owned(),
                ..stretch.clone()
            };
            assert_eq!(stretch.driver(), driver);
        }
    }

    fn stretches(log: &DriveLog) -> Vec<FollowingStretch> {
        let motion = Motion::of_log(log, 100.0).unwrap();
        following_stretches(&motion, &FollowingSettings::default())
    }

    #[test]
    fn a_queue_is_followed_at_standstill_and_a_far_leader_is_not() {
        let queue = stretches(&log(vec![3.0; 300], 0.0, Some(0.0)));
        assert!(queue.len() == 1 && (queue[0].duration_s() - 29.9).abs() < 1e-9);
        assert!(stretches(&log(vec![30.0; 300], 0.0, Some(0.0))).is_empty());
        assert!(stretches(&log(vec![49.0; 300], 10.0, Some(10.0))).len() == 1);
        assert!(stretches(&log(vec![51.0; 300], 10.0, Some(10.0))).is_empty());
        assert!(stretches(&log(vec![30.0; 200], 10.0, Some(10.0))).is_empty());
    }

    #[test]
    fn another_leader_begins_another_stretch() {
        // A vehicle cuts in; the ramp is what resampling makes of the jump.
        let gap = |k: usize| (30.0 - 6.0 * k.saturating_sub(298) as f64).max(12.0);
        for lead_mps in [Some(10.0), None] {
            let found = stretches(&log((0..600).map(gap).collect(), 10.0, lead_mps));
            assert_eq!(found.len(), 2, "{lead_mps:?}");
            assert!(found[0].gap_m().iter().all(|gap| *gap > 29.0));
            assert!(found[1].gap_m().iter().all(|gap| *gap < 13.0));
            let start_s = found[1].start_s();
            assert!((37.0..38.0).contains(&start_s), "{start_s}");
        }
    }

    #[test]
    fn a_missing_speed_of_the_leader_comes_from_the_gap() {
        let gap = (0..300).map(|k| 20.0 + 0.05 * f64::from(k));
        let found = stretches(&log(gap.collect(), 12.0, None));
        let lead = found[0].lead_speed_mps();
        assert!(lead.iter().all(|speed| (speed - 12.5).abs() < 1e-9));
    }
}

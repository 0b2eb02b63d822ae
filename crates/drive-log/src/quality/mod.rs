//! What is wrong with a recording, and its repair.
//!
//! Thresholds come from the limits of road vehicles and their sensors; each is given with its reason
//! where it is used.

mod accelerometer;
mod distance;
mod dropout;
mod frozen;
mod heating;
mod held;
mod interleaved;
mod jump;
mod limit_unit;
mod motion;
mod power;
mod quantised;
mod range;
mod sentinel;
mod sign;
mod speed_unit;
pub(crate) mod time;
mod time_unit;
mod unit_change;

pub(crate) use range::plausible;

use std::ops::Range;

use crate::{Action, Channel, Finding, FindingKind, RawLog};

/// A recording without what was found wrong with it.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Checked {
    /// The recording: time strictly increasing, values that cannot be true set to missing.
    pub log: RawLog,
    /// What was found and what was done, in the order of time.
    pub findings: Vec<Finding>,
    /// Samples before which the recording is not continuous, though there is no gap.
    pub(crate) cuts: Vec<usize>,
}

/// Finds what is wrong with a recording and repairs it.
///
/// | what | sign | repair |
/// |---|---|---|
/// | interleaved | a fifth of the rows in motion are of another speed than those around them | refused |
/// | unit of time | no speed changes like this | scaled where one unit is possible, else refused |
/// | time missing, repeated, out of order, set back | | samples dropped, sorted, or cut and shifted |
/// | time gap | a step over 2.5 median steps | none here; [`crate::prepare()`] interpolates or cuts |
/// | missing values | | none |
/// | out of range | outside what a road vehicle can have, such as a negative gap | removed |
/// | sign of the current | battery power and `v·dv/dt` correlate at −0.5 or below, or a drive on a level road charges the battery | flipped; kept where the road is not known; dropped where the sign was not recorded |
/// | dropouts | a speed off both its neighbours, on the same side, by more than a car turns around, for 2 s at most | removed, with all samples of a value that is a code |
/// | codes | one exact speed or gap entered and left by jumps, a gap of 0, a limit of 0 or over 162 km/h | removed |
/// | unit of speed | two jumps by the factor between two units; or motion, speed limit, accelerometer, distance and battery power speak against the speed | scaled where one unit is possible or clearly likely; refused where the speed is impossible; else kept; a channel that is alone against all others is dropped |
/// | unit of limits | steps of 5 m/s, some over 162 km/h | scaled, or dropped |
/// | accelerometer | late, in g, turned around, off level | shifted or scaled; dropped where it does not follow the speed |
/// | frozen speed | constant over 0.5 m/s for 10 s (90 s where the speed often repeats) with two of acceleration, torque, voltage and current; for 60 s alone (kept after 300 s where the speed often repeats) | removed with all that froze |
/// | frozen elevation | constant, and not 0, over 5 km | removed |
/// | splice | speed jumps by more than 10 m/s² · Δt + 1 m/s; state of charge by 1.5 % | cut; kept where the state of charge jumps alone |
/// | spike | such a jump in speed that is undone within 2 s | removed |
/// | altitude outlier | elevation leaves the steepest road by 5 m for 2 s, or by 40 m for a minute | removed |
/// | sentinel | heating in three or more pulses under 3 s of one exact value that the battery does not feel | removed |
/// | pinned | one value over 50 W for half of the heating channel and 300 s | channel dropped |
/// | contradicted | at standstill the battery delivers less than heating and auxiliaries, for half of the time that the heating claims power | channel dropped |
/// | missing heating | none, or dropped, while the heating power that was requested is recorded and not contradicted | request taken in its place |
/// | held | values repeated in rows until the sensor gives the next one | the line between updates |
/// | quantised | a speed in coarse steps | smoothed within half a step |
/// | noise | an elevation that scatters by over 2 m | none here; a slope from it is taken over a window as long as that asks for |
///
/// A standstill, a cruise control and a channel in coarse steps are nothing of this.
pub fn check(log: RawLog) -> Checked {
    let findings = log.findings.clone();
    let mut checked = Checked {
        log,
        findings,
        cuts: Vec::new(),
    };
    interleaved::refuse(&mut checked);
    time_unit::convert(&mut checked);
    time::repair(&mut checked);
    range::report_missing(&mut checked);
    // a unit tells before the range does, in which another unit may leave no more than a part
    range::remove(&mut checked, |channel| !channel.is_motion());
    let interval_s = held::speed_interval_s(&checked);
    dropout::remove_speed(&mut checked, interval_s);
    sentinel::remove_speed(&mut checked, interval_s);
    sentinel::remove_gaps(&mut checked);
    held::collapse(&mut checked);
    sign::flip_current(&mut checked);
    unit_change::convert(&mut checked);
    limit_unit::convert(&mut checked);
    speed_unit::convert(&mut checked);
    range::remove(&mut checked, Channel::is_motion);
    dropout::remove_speed(&mut checked, 0.0);
    sentinel::remove_limits(&mut checked);
    accelerometer::mend(&mut checked);
    frozen::remove_speed(&mut checked);
    frozen::remove_elevation(&mut checked);
    jump::cut_speed(&mut checked);
    jump::cut_state_of_charge(&mut checked);
    jump::remove_altitude_outliers(&mut checked);
    heating::remove_sentinel(&mut checked);
    heating::drop_pinned(&mut checked);
    heating::drop_contradicted(&mut checked);
    heating::take_request(&mut checked);
    quantised::smooth_speed(&mut checked);
    let log = &mut checked.log;
    log.channels.retain(|channel, values| {
        // the way driven was a witness
        *channel == Channel::Speed
            || *channel != Channel::Distance && values.iter().any(|v| v.is_finite())
    });
    checked.cuts.sort_unstable();
    checked
        .findings
        .sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
    checked
}

impl Checked {
    /// Reports a finding about the samples of `range`.
    fn report(
        &mut self,
        kind: FindingKind,
        channel: Channel,
        range: &Range<usize>,
        action: Action,
        detail: String,
    ) {
        let time_s = self.log.time_s();
        let span_s = (
            time_s[range.start],
            time_s[range.end.max(range.start + 1) - 1],
        );
        self.findings
            .push(Finding::of_channel(kind, channel, span_s, action, detail));
    }

    /// Sets the samples of `range` to missing.
    fn remove(&mut self, channel: Channel, range: Range<usize>) {
        if let Some(values) = self.log.channels.get_mut(&channel) {
            values[range].fill(f64::NAN);
        }
    }

    fn values(&self, channel: Channel) -> Option<&[f64]> {
        self.log.channel(channel)
    }

    /// Time between the first and the last sample of `range`, s.
    fn duration_s(&self, range: &Range<usize>) -> f64 {
        let time_s = self.log.time_s();
        time_s[range.end - 1] - time_s[range.start]
    }

    /// Distance driven up to each sample, m. A speed counts until the next, for 2 s at most.
    fn distance_m(&self) -> Vec<f64> {
        let (time_s, speed_mps) = (self.log.time_s(), self.log.speed_mps());
        let mut distance_m = vec![0.0; time_s.len()];
        let (mut known, mut known_m) = (0, 0.0);
        for i in 1..time_s.len() {
            if speed_mps[i - 1].is_finite() {
                (known, known_m) = (i - 1, distance_m[i - 1]);
            }
            let step_m = speed_mps[known].abs() * (time_s[i] - time_s[known]).min(2.0);
            distance_m[i] = if step_m.is_finite() {
                known_m + step_m
            } else {
                known_m
            };
        }
        distance_m
    }
}

/// Runs of finite values that are the same to the last bit, longest possible, in order.
fn constant_runs(values: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        while start < values.len() && !values[start].is_finite() {
            start += 1;
        }
        let first = values.get(start)?.to_bits();
        let len = values[start..]
            .iter()
            .take_while(|v| v.to_bits() == first)
            .count();
        let run = start..start + len;
        start = run.end;
        Some(run)
    })
}

//! When a heater gives what is asked of it, by the battery.

use std::ops::Range;

use super::checked::Checked;
use super::heating::CLAIM_W;
use super::motion::{Span, spans};
use super::power::{NOT_BRAKING_MPS2, ROLLING_MPS2, usual_power};
use crate::{Channel, RawLog};

/// Heat is asked for in stretches of this length, s; so many seconds of one without braking tell.
const WINDOW_S: f64 = 30.0;
const SECONDS: usize = 8;

/// The battery's excess agrees with what is asked for within this share of it.
const AGREES: f64 = 0.35;

/// A request is one of the heater where it is believed for this share of its energy.
const BELIEVED_SHARE: f64 = 0.5;

/// Windows of a drive in which heat is asked for.
pub(super) struct Windows {
    /// Samples of those in which the battery delivers it.
    pub(super) believed: Vec<Range<usize>>,
    /// How many there are in all that tell.
    pub(super) asked: usize,
    /// Share of the energy asked for that is in those that are believed.
    pub(super) share: f64,
}

impl Windows {
    /// What most of the energy that was asked for, and is not delivered, says.
    pub(super) fn contradiction(&self) -> Option<String> {
        let not_pct = 100.0 * (1.0 - self.share);
        (self.share < BELIEVED_SHARE)
            .then(|| format!("{not_pct:.0} % of what is asked for is not felt by the battery"))
    }
}

/// A second of driving without braking.
struct Second {
    from_s: f64,
    terms: [f64; 3],
    battery_w: f64,
    asked_w: f64,
}

/// Judges a request by the power that driving alone takes in the seconds without one; `None` where these are too few.
pub(super) fn judge(checked: &Checked, channel: Channel) -> Option<Windows> {
    let seconds = seconds(checked, channel)?;
    let idle = seconds.iter().filter(|s| s.asked_w < CLAIM_W);
    let idle: Vec<_> = idle.map(|s| (s.terms, s.battery_w)).collect();
    let usual = usual_power(&idle)?;
    let excess_w = |s: &Second| s.battery_w - (0..3).map(|i| usual[i] * s.terms[i]).sum::<f64>();
    let mut windows = Windows {
        believed: Vec::new(),
        asked: 0,
        share: 0.0,
    };
    let (mut asked_w, mut believed_w) = (0.0, 0.0);
    for window in seconds.chunk_by(|a, b| number(a) == number(b)) {
        let n = window.len() as f64;
        let claim_w = window.iter().map(|s| s.asked_w).sum::<f64>() / n;
        if window.len() < SECONDS || claim_w < CLAIM_W {
            continue;
        }
        let off_w = window.iter().map(excess_w).sum::<f64>() / n - claim_w;
        windows.asked += 1;
        asked_w += claim_w;
        if off_w.abs() <= AGREES * claim_w {
            believed_w += claim_w;
            windows
                .believed
                .push(of_window(&checked.log, number(&window[0])));
        }
    }
    windows.share = believed_w / asked_w;
    (windows.asked > 0).then_some(windows)
}

fn seconds(checked: &Checked, channel: Channel) -> Option<Vec<Second>> {
    let log = &checked.log;
    let asked_w = checked.values(channel)?;
    checked.values(Channel::BatteryVoltage)?;
    let beside_w = checked.values(Channel::AuxPower);
    let felt_mps2 = checked.values(Channel::Accelerometer);
    let second = |span: Span| {
        let felt_mps2 = felt_mps2.map_or(Some(span.accel_mps2), |felt| span.mean(felt))?;
        let v = span.speed_mps.abs();
        let beside_w = beside_w.and_then(|aux| span.mean(aux)).unwrap_or(0.0);
        Some(Second {
            from_s: log.time_s()[*span.samples.start()],
            terms: [1.0, v * (felt_mps2 + ROLLING_MPS2), v * v * v],
            battery_w: span.battery(log)? - beside_w,
            asked_w: span.mean(asked_w)?,
        })
    };
    let coasting = spans(log)
        .into_iter()
        .filter(|span| span.accel_mps2 > NOT_BRAKING_MPS2);
    let seconds = coasting.filter_map(second);
    let is_known = |s: &Second| s.battery_w.is_finite() && s.terms[1].is_finite();
    Some(seconds.filter(is_known).collect())
}

/// Number of the window.
fn number(second: &Second) -> i64 {
    (second.from_s / WINDOW_S).floor() as i64
}

fn of_window(log: &RawLog, number: i64) -> Range<usize> {
    let (time_s, number) = (log.time_s(), number as f64);
    let at = |s: f64| time_s.partition_point(|t| *t < s);
    at(number * WINDOW_S)..at((number + 1.0) * WINDOW_S)
}

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

/// A request is none of the heater where for this share of its energy the battery delivers less than the share above.
const CONTRADICTED_SHARE: f64 = 0.5;

/// Windows of a drive in which heat is asked for.
pub(super) struct Windows {
    /// Those in which the battery delivers it.
    pub(super) believed: Vec<Window>,
    /// How many there are in all that tell.
    pub(super) asked: usize,
    /// Share of the energy asked for in those in which the battery delivers next to nothing of it.
    contradicted: f64,
}

/// A window in which the battery delivers what is asked for.
pub(super) struct Window {
    pub(super) samples: Range<usize>,
    /// Whether what the heater is said to take is another power.
    pub(super) is_unsaid: bool,
}

impl Windows {
    /// What says that the request is none of the heater.
    pub(super) fn contradiction(&self) -> Option<String> {
        let pct = 100.0 * self.contradicted;
        (self.contradicted >= CONTRADICTED_SHARE)
            .then(|| format!("the battery does not deliver {pct:.0} % of what is asked for"))
    }
}

/// A second of driving without braking.
struct Second {
    from_s: f64,
    terms: [f64; 3],
    battery_w: f64,
    asked_w: f64,
    /// Of the heater, 0 where it is not known.
    said_w: f64,
}

/// Judges the heating request by the power that driving alone takes in the seconds without heating. `None` where these are too
/// few, and without an accelerometer: a hill takes as much as a heater.
pub(super) fn judge(checked: &Checked) -> Option<Windows> {
    let seconds = seconds(checked)?;
    let idle = seconds.iter().filter(|s| s.asked_w.max(s.said_w) < CLAIM_W);
    let idle: Vec<_> = idle.map(|s| (s.terms, s.battery_w)).collect();
    let usual = usual_power(&idle)?;
    let excess_w = |s: &Second| s.battery_w - (0..3).map(|i| usual[i] * s.terms[i]).sum::<f64>();
    let mut windows = Windows {
        believed: Vec::new(),
        asked: 0,
        contradicted: 0.0,
    };
    let mut all_w = 0.0;
    for window in seconds.chunk_by(|a, b| number(a) == number(b)) {
        let mean =
            |of: &dyn Fn(&Second) -> f64| window.iter().map(of).sum::<f64>() / window.len() as f64;
        let (asked_w, excess_w) = (mean(&|s| s.asked_w), mean(&excess_w));
        if window.len() < SECONDS || asked_w < CLAIM_W {
            continue;
        }
        windows.asked += 1;
        all_w += asked_w;
        if excess_w < AGREES * asked_w {
            windows.contradicted += asked_w;
        } else if (excess_w - asked_w).abs() <= AGREES * asked_w {
            windows.believed.push(Window {
                samples: of_window(&checked.log, number(&window[0])),
                is_unsaid: (mean(&|s| s.said_w) - asked_w).abs() > AGREES * asked_w,
            });
        }
    }
    windows.contradicted /= all_w;
    (windows.asked > 0).then_some(windows)
}

fn seconds(checked: &Checked) -> Option<Vec<Second>> {
    let log = &checked.log;
    let asked_w = checked.values(Channel::HeatingRequest)?;
    checked.values(Channel::BatteryVoltage)?;
    let beside_w = checked.values(Channel::AuxPower);
    let said_w = checked.values(Channel::HeatingPower);
    let felt_mps2 = checked.values(Channel::Accelerometer)?;
    let second = |span: Span| {
        let v = span.speed_mps.abs();
        let mean = |values: Option<&[f64]>| values.and_then(|v| span.mean(v)).unwrap_or(0.0);
        Some(Second {
            from_s: log.time_s()[*span.samples.start()],
            terms: [1.0, v * (span.mean(felt_mps2)? + ROLLING_MPS2), v * v * v],
            battery_w: span.battery(log)? - mean(beside_w),
            asked_w: span.mean(asked_w)?,
            said_w: mean(said_w),
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

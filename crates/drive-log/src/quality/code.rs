//! Codes in measured channels: one exact value in single rows, far outside all others.

use std::collections::BTreeSet;
use std::ops::Range;

use super::checked::Checked;
use super::runs::constant_runs;
use crate::{Action, Channel, FindingKind};

/// What is measured all the time; speeds and gaps have checks of their own.
const MEASURED: [Channel; 8] = [
    Channel::BatteryVoltage,
    Channel::BatteryCurrent,
    Channel::StateOfCharge,
    Channel::MotorTorque,
    Channel::Slope,
    Channel::Accelerometer,
    Channel::AmbientTemperature,
    Channel::BatteryTemperature,
];

/// A code comes so often, stays for this long at most, s, and is off the rest by this share of its range, of so many values.
const TIMES: usize = 3;
const LONGEST_S: f64 = 2.0;
const OFF: f64 = 0.3;
const VALUES: usize = 10;

/// Codes of a channel.
const ROUNDS: usize = 8;

/// Removes the lowest and the highest value of a channel where they are codes.
pub(super) fn remove(checked: &mut Checked) {
    for channel in MEASURED {
        for _ in 0..ROUNDS {
            let found = [1.0, -1.0]
                .into_iter()
                .find_map(|side| code(checked, channel, side));
            let Some((value, runs)) = found else {
                break;
            };
            let range = runs[0].start..runs[runs.len() - 1].end;
            let samples: usize = runs.iter().map(Range::len).sum();
            runs.into_iter()
                .for_each(|run| checked.remove(channel, run));
            let detail = format!(
                "{samples} samples of exactly {value}, for a moment each and far outside all others"
            );
            checked.report(
                FindingKind::Sentinel,
                channel,
                &range,
                Action::Removed,
                detail,
            );
        }
    }
}

/// The highest value, or with `side` −1 the lowest, and its runs, where it is a code.
fn code(checked: &Checked, channel: Channel, side: f64) -> Option<(f64, Vec<Range<usize>>)> {
    let values = checked.values(channel)?;
    let sided = || values.iter().map(|v| side * v).filter(|v| v.is_finite());
    let code = sided().fold(f64::NEG_INFINITY, f64::max);
    let rest = || sided().filter(|v| *v < code);
    let (low, high) = rest().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if !low.is_finite() || high <= low || code - high <= OFF * (high - low) {
        return None;
    }
    let is_varied = rest().map(f64::to_bits).collect::<BTreeSet<_>>().len() >= VALUES;
    let runs: Vec<Range<usize>> = constant_runs(values)
        .filter(|run| side * values[run.start] >= code)
        .collect();
    let is_short = |run: &Range<usize>| checked.duration_s(run) <= LONGEST_S;
    (is_varied && runs.len() >= TIMES && runs.iter().all(is_short)).then_some((side * code, runs))
}

//! Values that are repeated in rows until the sensor gives the next one.

mod renewal;
mod updates;

use std::ops::Range;

use super::checked::Checked;
use super::runs::constant_runs;
use crate::statistics::{mean, quantile};
use crate::{Action, Channel, FindingKind};
use renewal::Renewal;
use updates::Updates;

/// Limits, pedals, and powers that are set, hold their values by themselves, and positions stand with the car; everything else is measured all the
/// time.
const SET: [Channel; 8] = [
    Channel::Latitude,
    Channel::Longitude,
    Channel::SpeedLimit,
    Channel::AcceleratorPedal,
    Channel::Brake,
    Channel::AuxPower,
    Channel::HeatingPower,
    Channel::HeatingRequest,
];

/// What changes slowly stands still between two digits, at irregular times.
const SLOW: [Channel; 6] = [
    Channel::Distance,
    Channel::Slope,
    Channel::Elevation,
    Channel::StateOfCharge,
    Channel::AmbientTemperature,
    Channel::BatteryTemperature,
];

/// A value that is sampled in every row does not stand still for a row while it goes on by this many digits of the channel before
/// and after, in one direction.
const DIGITS: f64 = 1.9;

/// Such stops in the middle of a motion, and their share of all samples in one: 0.07 at most in recorded drives at 0.5 to
/// 10 Hz with 0.01 to 1 km/h, 0.11 where ten rows have nine updates. Volts, amps and accelerations that are as noisy as coarse
/// have 0.12.
const STOPS: usize = 10;
const SHARE_OF_SPEED: f64 = 0.1;
const SHARE: f64 = 0.6;

/// Where so few of all values are in such a motion, the digits are as coarse as the motion, and noise stands still too: up to half
/// of 18 values, 0.15 of 60.
const RARE: f64 = 0.06;

/// Deviation of the times between updates over their mean: 0.38 at most where rows and updates beat or every other update is
/// lost, 0.65 and more where a recorder repeats at random. What changes slowly must be renewed like a clock.
const IRREGULAR: f64 = 0.5;
const IRREGULAR_SLOW: f64 = 0.2;

/// Share of the times that is looked at: the longest may be gaps.
const TYPICAL: f64 = 0.98;

/// A speed that is renewed less often is not known in between, s; it is cut there as everywhere. The default of `max_gap_s`.
const SLOWEST_SPEED_S: f64 = 2.0;

/// Puts the line between updates in the place of values that were repeated until the next one.
pub(super) fn collapse(checked: &mut Checked) {
    for channel in Channel::ALL.into_iter().filter(|c| !SET.contains(c)) {
        let Some(renewal) = renewal(checked, channel) else {
            continue;
        };
        let most = if SLOW.contains(&channel) {
            IRREGULAR_SLOW
        } else {
            IRREGULAR
        };
        if renewal.irregularity <= most {
            renew(checked, channel, renewal);
        } else if channel == Channel::Speed {
            let detail = format!(
                "stands still for a while in the middle of a motion, every {:.1} s on average and at irregular times, as if the rows \
                 repeated it; accelerations are rough",
                renewal.interval_s
            );
            report(checked, channel, Action::Kept, detail);
        }
    }
}

/// Time from update to update of a held speed, s; 0 where it is not held.
pub(super) fn speed_interval_s(checked: &Checked) -> f64 {
    let renewal = renewal(checked, Channel::Speed).filter(|r| r.irregularity <= IRREGULAR);
    renewal.map_or(0.0, |renewal| renewal.long_s)
}

fn renew(checked: &mut Checked, channel: Channel, renewal: Renewal) {
    if let Some(rounding) = checked
        .rounding
        .as_mut()
        .filter(|_| channel == Channel::Speed)
    {
        rounding.interval_s = renewal.interval_s;
    }
    let values = checked.values(channel).unwrap_or_default();
    let keep_gaps = channel == Channel::Speed && renewal.interval_s > SLOWEST_SPEED_S;
    let mut renewed = vec![f64::NAN; values.len()];
    let mut count = 0;
    for stretch in stretches(values) {
        let time_s = &checked.log.time_s()[stretch.clone()];
        let updates = Updates::of(time_s, &values[stretch.clone()], renewal);
        count += updates.len();
        updates.write(time_s, &mut renewed[stretch], keep_gaps);
    }
    let detail = format!(
        "renewed about every {:.2} s, {count} of {} values are updates",
        renewal.interval_s,
        values.iter().filter(|v| v.is_finite()).count()
    );
    let action = if keep_gaps {
        Action::Removed
    } else {
        Action::Interpolated
    };
    report(checked, channel, action, detail);
    checked.log.channels.insert(channel, renewed);
}

fn report(checked: &mut Checked, channel: Channel, action: Action, detail: String) {
    checked.report_all(FindingKind::Held, channel, action, detail);
}

/// Runs of samples with a value.
fn stretches(values: &[f64]) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for run in constant_runs(values) {
        match stretches.last_mut() {
            Some(last) if last.end == run.start => last.end = run.end,
            _ => stretches.push(run),
        }
    }
    stretches
}

/// How a channel is renewed; `None` where rows are not faster than the channel.
fn renewal(checked: &Checked, channel: Channel) -> Option<Renewal> {
    let values = checked.values(channel)?;
    let rounding = checked.rounding.filter(|_| channel == Channel::Speed);
    let step = rounding.map_or(0.0, |rounding| rounding.lattice.step_mps);
    let (moving, all) = in_motion(checked.log.time_s(), values, step);
    let stops = moving.iter().filter(|(_, rows)| *rows > 1).count();
    let is_fine = moving.len() as f64 >= RARE * all as f64;
    let share = if channel == Channel::Speed && is_fine {
        SHARE_OF_SPEED
    } else {
        SHARE
    };
    if stops < STOPS || (stops as f64) < share * moving.len() as f64 {
        return None;
    }
    let mut times_s: Vec<f64> = moving.into_iter().map(|(time_s, _)| time_s).collect();
    let typical = if SLOW.contains(&channel) {
        1.0
    } else {
        TYPICAL
    };
    let longest_s = quantile(&mut times_s, typical)?;
    times_s.retain(|time_s| *time_s <= longest_s);
    let interval_s = mean(times_s.iter().copied())?;
    let variance = mean(times_s.iter().map(|time_s| (time_s - interval_s).powi(2)))?;
    Some(Renewal {
        interval_s,
        long_s: quantile(&mut times_s, 0.9)?,
        irregularity: variance.sqrt() / interval_s,
    })
}

/// How long each value in the middle of a motion stays, s and rows, and how many values there are in all. Digits are no finer than a
/// step that is known.
fn in_motion(time_s: &[f64], values: &[f64], step: f64) -> (Vec<(f64, usize)>, usize) {
    let runs: Vec<Range<usize>> = constant_runs(values).collect();
    let change = |pair: &[Range<usize>]| {
        let change = values[pair[1].start] - values[pair[0].start];
        (pair[0].end == pair[1].start).then_some(change)
    };
    let changes: Vec<Option<f64>> = runs.windows(2).map(change).collect();
    let mut sizes: Vec<f64> = changes.iter().flatten().map(|c| c.abs()).collect();
    let Some(digit) = quantile(&mut sizes, 0.05) else {
        return (Vec::new(), 0);
    };
    let moves = |(before, after): (f64, f64)| {
        before * after > 0.0 && before.abs().min(after.abs()) >= DIGITS * digit.max(step)
    };
    let stays = |i: usize| {
        let changes = changes[i - 1].zip(changes[i])?;
        let stays_s = time_s[runs[i].end] - time_s[runs[i].start];
        moves(changes).then_some((stays_s, runs[i].len()))
    };
    ((1..changes.len()).filter_map(stays).collect(), runs.len())
}

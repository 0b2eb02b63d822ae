//! What is wrong with a recording, and its repair.
//!
//! Thresholds come from the limits of road vehicles and their sensors; each is given with its reason
//! where it is used.

mod accelerometer;
mod batches;
mod battery;
mod charge;
mod checked;
mod clipped;
mod code;
mod current;
mod distance;
mod dropout;
mod elevation;
mod elevation_still;
mod exchanged;
mod filled;
mod frozen;
mod heating;
mod heating_windows;
mod held;
mod interleaved;
mod jump;
mod lattice;
mod limit_unit;
mod motion;
mod noise;
mod pace;
mod pieces;
mod power;
mod quantised;
mod radar;
mod range;
mod reversed;
mod road;
mod row_number;
mod runs;
mod sentinel;
mod sign;
mod slope;
mod speed_mistake;
mod speed_unit;
pub(crate) mod time;
mod time_unit;
mod unit_change;
mod whittaker;
mod wrapped;

pub use checked::Checked;
use quantised::Rounding;
pub(crate) use range::plausible;

use crate::{Channel, RawLog};

/// Finds what is wrong with a recording and repairs it.
///
/// | what | sign | repair |
/// |---|---|---|
/// | interleaved | a fifth of the rows in motion are of another speed than those around them | refused |
/// | unit of time | no speed changes like this | scaled where one unit is possible, else refused |
/// | time missing, repeated, out of order, set back | | samples dropped, sorted, or cut and shifted |
/// | batched | rows stamped together, and a speed that changes from row to row alike | spread evenly |
/// | time gap | a step over 2.5 median steps | none here; [`crate::prepare()`] interpolates or cuts |
/// | times that count rows | whole numbers, and accelerometer, way, or starts and stops say otherwise | scaled, refused or kept |
/// | missing values | | none |
/// | volts and amps exchanged | a voltage varies by half of its mean, and the current hardly | exchanged |
/// | out of range | outside what a road vehicle can have, such as a negative gap | removed |
/// | sign of the current | battery power and `v·dv/dt` correlate at −0.5 or below, or a drive on a level road charges the battery | flipped; kept where the road is not known; dropped where the sign was not recorded |
/// | current that wraps around | large jumps, all alike, forth and back | turned back; dropped where no counter has that range |
/// | current that leaves for a moment | values off both around them, or stretches of exactly 0, by jumps | removed |
/// | current at the end of the range; current, voltage, accelerometer still or 0 V in motion | an extreme again and again; one value while the car accelerates or the current changes | removed |
/// | current offset | the state of charge falls by another current; the battery is charged at standstill | taken off where it is certain; kept |
/// | codes of other channels | one exact value in single rows, far outside all others | removed |
/// | dropouts | a speed off both its neighbours, on the same side, by more than a car turns around, for 2 s at most | removed, with all samples of a value that is a code |
/// | codes | one exact speed or gap entered and left by jumps, a gap of 0, a limit of 0 or over 162 km/h | removed |
/// | unit of speed | two jumps by the factor between two units; or motion, speed limit, accelerometer, distance and battery power speak against the speed | scaled where one unit is possible or clearly likely; refused where the speed is impossible; else kept; a channel that is alone against all others is dropped |
/// | unit of limits | steps of 5 m/s, some over 162 km/h | scaled, or dropped |
/// | accelerometer | late, in g, turned around, off level | shifted or scaled; dropped where it does not follow the speed |
/// | times, slope, elevation | slopes of no street; the two rise by other factors, or by more all along, or have nothing in common; accelerometer or battery feel another road | the wrong one dropped; kept where that is not known; times refused |
/// | gap and speed ahead | the gap does not change as the speeds differ | scaled; removed where it is the last one kept |
/// | frozen speed | constant over 0.5 m/s for 10 s (90 s where the speed often repeats) with two of acceleration, torque, voltage and current; for 60 s alone (kept after 300 s where the speed often repeats) | removed with all that froze |
/// | frozen elevation | constant, and not 0, over 5 km | removed |
/// | splice | speed jumps by more than 10 m/s² · Δt + 1 m/s; state of charge by 1.5 % | cut; kept where the state of charge jumps alone |
/// | spike | such a jump in speed that is undone within 2 s | removed |
/// | contradicted elevation | it stands still over 400 m on which accelerometer and battery feel 18 m | removed there, and what follows set off by as much |
/// | altitude outlier | elevation leaves the steepest road by 5 m for 2 s, or by 40 m for a minute | removed |
/// | sentinel | heating in three or more pulses under 3 s of one exact value that the battery does not feel | removed |
/// | pinned | one value over 50 W for half of the heating channel and 300 s | channel dropped |
/// | contradicted | at standstill the battery delivers less than auxiliaries, or heating and auxiliaries, for half of the time that these claim power | channel dropped |
/// | missing heating | none, or dropped, while the heating power that was requested is recorded and not contradicted | request taken in its place; of one that is contradicted the half minutes in which the battery delivers it |
/// | held | values repeated in rows until the sensor gives the next one | the line between updates |
/// | contradicted | a car that reverses faster than 8 m/s for over 3 s | the sign of the speed turned from standstill to standstill |
/// | clipped, filled | a speed that ends at one value; a straight line | removed; kept where the speed may have been limited |
/// | scattering | a speed off the line between its neighbours, on alternating sides | smoothed |
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
        rounding: None,
    };
    interleaved::refuse(&mut checked);
    time_unit::convert(&mut checked);
    time::repair(&mut checked);
    row_number::judge(&mut checked);
    range::report_missing(&mut checked);
    // a unit tells before the range does, in which another unit may leave no more than a part
    exchanged::put_right(&mut checked);
    // some counters wrap around after more than the range, others are hidden by values out of it
    wrapped::unwrap_current(&mut checked);
    range::remove(&mut checked, |c| !c.is_motion() && *c != Channel::Slope);
    code::remove(&mut checked);
    wrapped::unwrap_current(&mut checked);
    current::remove_spikes(&mut checked);
    battery::remove_dead_voltage(&mut checked);
    let interval_s = held::speed_interval_s(&checked);
    dropout::remove_speed(&mut checked, interval_s);
    sentinel::remove_speed(&mut checked, interval_s);
    sentinel::remove_gaps(&mut checked);
    checked.rounding = Rounding::of(checked.log.speed_mps());
    held::collapse(&mut checked);
    sign::flip_current(&mut checked);
    unit_change::convert(&mut checked);
    limit_unit::convert(&mut checked);
    speed_unit::convert(&mut checked);
    if reversed::turn_speed(&mut checked) {
        speed_unit::convert(&mut checked);
    }
    slope::drop_steep(&mut checked);
    range::remove(&mut checked, |c| c.is_motion() || *c == Channel::Slope);
    dropout::remove_speed(&mut checked, 0.0);
    clipped::remove(&mut checked);
    frozen::remove_speed(&mut checked);
    filled::remove(&mut checked);
    jump::cut_speed(&mut checked);
    let scattered = noise::smooth_speed(&mut checked);
    radar::mend(&mut checked);
    sentinel::remove_limits(&mut checked);
    battery::remove_still_accelerometer(&mut checked);
    accelerometer::mend(&mut checked);
    frozen::remove_elevation(&mut checked);
    jump::remove_altitude_outliers(&mut checked);
    slope::judge(&mut checked);
    elevation::judge(&mut checked);
    elevation_still::mend(&mut checked);
    battery::remove_still(&mut checked);
    pieces::judge(&mut checked);
    charge::judge_offset(&mut checked);
    jump::cut_state_of_charge(&mut checked);
    heating::remove_sentinel(&mut checked);
    heating::drop_pinned(&mut checked);
    heating::drop_contradicted(&mut checked);
    heating::take_request(&mut checked);
    if !scattered {
        quantised::smooth_speed(&mut checked);
    }
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

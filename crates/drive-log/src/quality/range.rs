//! Values that are missing, and values that cannot be.

use std::collections::BTreeSet;

use super::checked::Checked;
use crate::{Action, Channel, FindingKind};

/// What a road vehicle can have, in SI units; wide enough for every one of them.
pub(crate) fn plausible(channel: Channel) -> (f64, f64) {
    match channel {
        // −72 km/h in reverse to the land speed of production cars
        Channel::Speed | Channel::LeadSpeed => (-20.0, 150.0),
        // five times what tyres transmit
        Channel::Accel | Channel::Accelerometer => (-50.0, 50.0),
        Channel::SpeedLimit => (0.0, 100.0),
        // the steepest streets have 0.34 rad
        Channel::Slope => (-0.7, 0.7),
        // the shore of the Dead Sea to the highest roads of the Andes
        Channel::Elevation => (-450.0, 6500.0),
        // more than any road vehicle has behind it
        Channel::Distance => (0.0, 1e10),
        // a negative gap is noise at standstill or a collision; radar sees 300 m
        Channel::LeadGap => (0.0, 1000.0),
        Channel::BatteryVoltage => (0.0, 2000.0),
        Channel::BatteryCurrent => (-5000.0, 5000.0),
        // state of charge is an estimate and may overshoot
        Channel::StateOfCharge => (-1.0, 105.0),
        Channel::MotorTorque => (-2e4, 2e4),
        // a sensor's ends are off by some percent
        Channel::AcceleratorPedal | Channel::Brake => (-5.0, 110.0),
        // a meter's offset may be slightly negative
        Channel::AuxPower | Channel::HeatingPower | Channel::HeatingRequest => (-1e3, 1e5),
        // the coldest and the hottest air that was ever measured, with the sun on the sensor
        Channel::AmbientTemperature => (-90.0, 70.0),
        // cells as cold as the air, to a fire
        Channel::BatteryTemperature => (-60.0, 120.0),
        Channel::Latitude => (-90.0, 90.0),
        Channel::Longitude => (-180.0, 180.0),
    }
}

/// Reports what the recording does not have, one finding per channel. Gap and speed of a lead vehicle that are missing
/// together are no finding: there is none ahead.
pub(super) fn report_missing(checked: &mut Checked) {
    for channel in Channel::ALL {
        let Some(values) = checked.values(channel) else {
            continue;
        };
        let partner = match channel {
            Channel::LeadGap => Some(checked.values(Channel::LeadSpeed)),
            Channel::LeadSpeed => Some(checked.values(Channel::LeadGap)),
            _ => None,
        };
        let expected = |i: usize| match partner {
            Some(partner) => partner.is_some_and(|other| other[i].is_finite()),
            None => true,
        };
        let missing: Vec<usize> = (0..values.len())
            .filter(|&i| values[i].is_nan() && expected(i))
            .collect();
        let (Some(first), Some(last)) = (missing.first(), missing.last()) else {
            continue;
        };
        let stretches = 1 + missing
            .windows(2)
            .filter(|pair| pair[1] > pair[0] + 1)
            .count();
        let all = missing.len() == values.len();
        let detail = format!(
            "{} of {} samples missing, stretches: {stretches}",
            missing.len(),
            values.len()
        );
        let action = if all { Action::Dropped } else { Action::Kept };
        checked.report(
            FindingKind::Missing,
            channel,
            &(*first..last + 1),
            action,
            detail,
        );
    }
}

/// A channel of which a larger share is out of range, and by more values than there are codes, is in another unit, and the rest
/// of it no better.
const MOST: f64 = 0.5;
const CODES: usize = 10;

/// Removes values out of range, one finding per channel, from the channels that `concerns` names.
pub(super) fn remove(checked: &mut Checked, concerns: impl Fn(&Channel) -> bool) {
    for channel in Channel::ALL.into_iter().filter(concerns) {
        let Some(values) = checked.values(channel) else {
            continue;
        };
        let (low, high) = plausible(channel);
        let out: Vec<usize> = (0..values.len())
            .filter(|&i| values[i] < low || values[i] > high)
            .collect();
        let (Some(&first), Some(&last)) = (out.first(), out.last()) else {
            continue;
        };
        let (smallest, largest) = out
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &i| {
                (a.min(values[i]), b.max(values[i]))
            });
        let mut detail = format!(
            "{} values from {smallest} to {largest}, outside {low} to {high}",
            out.len()
        );
        let known = values.iter().filter(|v| v.is_finite()).count();
        let kinds: BTreeSet<u64> = out.iter().map(|&i| values[i].to_bits()).collect();
        let is_most = out.len() as f64 > MOST * known as f64 && kinds.len() > CODES;
        let action = if channel == Channel::Speed && is_most {
            detail.push_str(": check the unit of the speed, perhaps cm/s or 0.01 km/h");
            Action::Refused
        } else if is_most {
            checked.log.channels.remove(&channel);
            Action::Dropped
        } else {
            out.iter().for_each(|&i| checked.remove(channel, i..i + 1));
            Action::Removed
        };
        let range = first..last + 1;
        checked.report(FindingKind::OutOfRange, channel, &range, action, detail);
    }
}

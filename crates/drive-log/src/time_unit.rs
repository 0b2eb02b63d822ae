//! What a column of times in numbers says about its unit.

use crate::statistics::median_step_s;
use crate::unit::Unit;

const DAY_S: f64 = 86_400.0;

/// A time in numbers whose unit the header does not say, where only one unit is possible: seconds
/// and their fractions since 1970 (of the years 2001 to 2096), or a spreadsheet's days since 1900
/// (1954 to 2119).
pub(crate) fn certain(values: &[f64]) -> Option<(Unit, &'static str)> {
    let within = |range: std::ops::Range<f64>| {
        let mut finite = values.iter().filter(|v| v.is_finite()).peekable();
        finite.peek().is_some() && finite.all(|v| range.contains(v))
    };
    if within(2e4..8e4) && (1e-9..0.01).contains(&median_step_s(values)) {
        return Some((Unit::DAY, "days since 1900, as spreadsheets write dates"));
    }
    [
        (1e9, Unit::SECOND, "seconds since 1970"),
        (1e12, Unit::MILLISECOND, "milliseconds since 1970"),
        (1e15, Unit::MICROSECOND, "microseconds since 1970"),
        (1e18, Unit::NANOSECOND, "nanoseconds since 1970"),
    ]
    .into_iter()
    .find(|(from, _, _)| within(*from..4.0 * from))
    .map(|(_, unit, words)| (unit, words))
}

/// Times of day packed into numbers, `095530` for 09:55:30, as seconds since midnight; `None` where
/// they can be seconds as well.
///
/// The last four digits of a count of seconds run through 60 to 99; packed ones leap over them.
pub(crate) fn unpacked(values: &[f64]) -> Option<Vec<f64>> {
    let step_s = median_step_s(values);
    if !(step_s > 0.0 && step_s <= 20.0) {
        return None;
    }
    let mut day_s = 0.0;
    let mut unpacked_s: Vec<f64> = Vec::with_capacity(values.len());
    for packed in values {
        if packed.is_nan() {
            unpacked_s.push(f64::NAN);
            continue;
        }
        let mut of_day_s = of_day(*packed)? + day_s;
        let before_s = unpacked_s.iter().rfind(|t| !t.is_nan());
        if before_s.is_some_and(|before_s| before_s - of_day_s > 0.5 * DAY_S) {
            day_s += DAY_S;
            of_day_s += DAY_S;
        }
        unpacked_s.push(of_day_s);
    }
    leaps_over_the_minute(values, &unpacked_s, step_s).then_some(unpacked_s)
}

fn of_day(packed: f64) -> Option<f64> {
    let whole = packed.floor();
    if !(0.0..240_000.0).contains(&whole) {
        return None;
    }
    let (hours, minutes, seconds) = (
        (whole / 10_000.0).floor(),
        (whole / 100.0).floor() % 100.0,
        whole % 100.0 + packed - whole,
    );
    (minutes < 60.0 && seconds < 60.0).then_some(hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Whether at least one step goes over a minute, and most that do are as short as the others once
/// unpacked.
fn leaps_over_the_minute(packed: &[f64], unpacked_s: &[f64], step_s: f64) -> bool {
    let leaps: Vec<f64> = (1..packed.len())
        .filter(|&i| packed[i] - packed[i - 1] >= 40.0)
        .map(|i| unpacked_s[i] - unpacked_s[i - 1])
        .collect();
    let short = leaps.iter().filter(|leap| **leap <= 2.5 * step_s).count();
    short > 0 && 2 * short > leaps.len()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn units_of_which_only_one_is_possible() {
        let unit = |start: f64, step: f64| {
            let values: Vec<f64> = (0..50).map(|i| start + f64::from(i) * step).collect();
            certain(&values).map(|(unit, _)| unit)
        };
        assert_eq!(unit(1_754_413_076.25, 0.1), Some(Unit::SECOND));
        assert_eq!(unit(1_754_413_076_250.0, 100.0), Some(Unit::MILLISECOND));
        assert_eq!(unit(46_110.08, 1.0 / 86_400.0), Some(Unit::DAY));
        assert_eq!(unit(0.0, 0.1), None);
        assert_eq!(unit(46_110.0, 1.0), None, "seconds of a day");
        assert_eq!(certain(&[f64::NAN]), None);
    }

    #[test]
    fn packed_times_leap_over_the_minute() {
        let packed = |from: u32, to: u32| -> Vec<f64> {
            (from..to)
                .map(|s| f64::from(s / 3600 * 10_000 + s / 60 % 60 * 100 + s % 60))
                .collect()
        };
        let unpacked_s = unpacked(&packed(35_730, 36_030)).unwrap();
        assert_eq!((unpacked_s[0], unpacked_s[299]), (35_730.0, 36_029.0));
        let mut night = packed(86_390, 86_400);
        night.extend(packed(0, 70));
        assert_eq!(unpacked(&night).unwrap()[10], 86_400.0);
        let seconds: Vec<f64> = (0..300).map(f64::from).collect();
        assert_eq!(unpacked(&seconds), None);
        assert_eq!(unpacked(&seconds[..50]), None, "the same either way");
        let hours: Vec<f64> = (0..59).map(|i| f64::from(i) * 100.0).collect();
        assert_eq!(unpacked(&hours), None);
    }
}

//! A date, a clock or both, as one text.

/// The order of the parts of a date such as `03/04/2026`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DateOrder {
    DayMonthYear,
    MonthDayYear,
}

/// A date as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Date {
    /// The year, the month and the day are known.
    Known(u32, u32, u32),
    /// Two numbers, of which one is the day and one the month, and the year.
    Open(u32, u32, u32),
    /// No date that the calendar has.
    Impossible,
}

impl Date {
    /// The number of the day, if the calendar has it.
    pub(crate) fn day(self, order: DateOrder) -> Option<i64> {
        match (self, order) {
            (Date::Known(year, month, day), _)
            | (Date::Open(day, month, year), DateOrder::DayMonthYear)
            | (Date::Open(month, day, year), DateOrder::MonthDayYear) => {
                day_number(year, month, day)
            }
            (Date::Impossible, _) => None,
        }
    }
}

/// A point in time as it is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stamp {
    pub(crate) date: Option<Date>,
    /// Time since midnight, s.
    pub(crate) of_day_s: f64,
    /// How far the clock is ahead of universal time, s, where the text says it.
    pub(crate) zone_s: Option<f64>,
}

/// Reads a text such as `2026-03-29T01:55:00.250+01:00`, `29.03.2026 01:55`, `05-Aug-2026 6:57:56 PM`,
/// `Wed Aug 05 18:57:56 GMT+01:00 2026`, `01:55:00` or `20260329 015500`.
pub(crate) fn stamp(text: &str) -> Option<Stamp> {
    let mut parts = Parts::default();
    let text = split_at_t(text);
    for token in text.split_ascii_whitespace() {
        parts.take(token.trim_end_matches(','))?;
    }
    parts.stamp()
}

/// A blank in place of the `T` between date and clock.
fn split_at_t(text: &str) -> String {
    let bytes = text.as_bytes();
    let digit = |at: Option<usize>| {
        at.and_then(|at| bytes.get(at))
            .is_some_and(u8::is_ascii_digit)
    };
    text.char_indices()
        .map(|(at, c)| {
            let between = digit(at.checked_sub(1)) && digit(Some(at + 1));
            if matches!(c, 'T' | 't') && between {
                ' '
            } else {
                c
            }
        })
        .collect()
}

/// What was read of a text so far.
#[derive(Default)]
struct Parts {
    date: Option<Date>,
    of_day_s: Option<f64>,
    /// Whether the clock has seconds: `05:30` alone may be minutes and seconds.
    has_seconds: bool,
    afternoon: Option<bool>,
    zone_s: Option<f64>,
    year: Option<u32>,
    month: Option<u32>,
    day: Option<u32>,
}

impl Parts {
    /// Takes a part of the text; `None` for what is no part of a date or clock, or is there twice.
    fn take(&mut self, token: &str) -> Option<()> {
        if let Some((clock, afternoon)) = half_of_day(token) {
            set(&mut self.afternoon, afternoon)?;
            return if clock.is_empty() {
                Some(())
            } else {
                self.take(clock)
            };
        }
        if let Some(packed) = token
            .strip_suffix(['Z', 'z'])
            .filter(|rest| packed_clock_s(rest).is_some())
        {
            set(&mut self.zone_s, 0.0)?;
            return self.take(packed);
        }
        if token.contains(':') && token.starts_with(|c: char| c.is_ascii_digit()) {
            let end = token.find(['Z', 'z', '+', '-']).unwrap_or(token.len());
            if end < token.len() {
                set(&mut self.zone_s, zone_s(&token[end..])?)?;
            }
            self.has_seconds = token[..end].matches(':').count() == 2;
            return set(&mut self.of_day_s, clock_s(&token[..end])?);
        }
        if let Some(month) = month_named(token) {
            return set(&mut self.month, month);
        }
        if is_weekday(token) {
            return Some(());
        }
        if let Some(zone_s) = zone_s(token) {
            return set(&mut self.zone_s, zone_s);
        }
        self.take_digits(token)
    }

    fn take_digits(&mut self, token: &str) -> Option<()> {
        if let Some(date) = date(token) {
            return set(&mut self.date, date);
        }
        if let Some(of_day_s) = packed_clock_s(token) {
            self.has_seconds = true;
            return set(&mut self.of_day_s, of_day_s);
        }
        let value = digits(token)?;
        match token.len() {
            1 | 2 => set(&mut self.day, value),
            4 => set(&mut self.year, value),
            _ => None,
        }
    }

    fn stamp(self) -> Option<Stamp> {
        let date = match (self.date, self.year, self.month, self.day) {
            (date, None, None, None) => date,
            (None, Some(year), Some(month), Some(day)) => Some(Date::Known(year, month, day)),
            _ => return None,
        };
        if date.is_none() && !self.has_seconds {
            return None;
        }
        let of_day_s = match (self.of_day_s?, self.afternoon) {
            (clock_s, None) => clock_s,
            (clock_s, Some(afternoon)) if (3600.0..46_800.0).contains(&clock_s) => {
                clock_s % 43_200.0 + if afternoon { 43_200.0 } else { 0.0 }
            }
            _ => return None,
        };
        Some(Stamp {
            date,
            of_day_s,
            zone_s: self.zone_s,
        })
    }
}

/// A clock with `AM` or `PM` after it, which may stand alone, and whether it is the afternoon.
fn half_of_day(token: &str) -> Option<(&str, bool)> {
    let at = token.len().checked_sub(2)?;
    let (clock, half) = (token.get(..at)?, token.get(at..)?);
    let afternoon = half.eq_ignore_ascii_case("PM");
    let clocked = clock.is_empty() || clock.ends_with(|c: char| c.is_ascii_digit());
    (clocked && (afternoon || half.eq_ignore_ascii_case("AM"))).then_some((clock, afternoon))
}

fn set<T>(place: &mut Option<T>, value: T) -> Option<()> {
    place.replace(value).is_none().then_some(())
}

/// Seconds since midnight of `HH:MM` or `HH:MM:SS` with or without a fraction.
fn clock_s(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let (hours, minutes) = (parts.next()?, parts.next()?);
    let seconds = parts.next().unwrap_or("0");
    if parts.next().is_some() {
        return None;
    }
    of_day_s(hours, minutes, seconds)
}

/// Seconds since midnight of `HHMMSS` with or without a fraction.
fn packed_clock_s(text: &str) -> Option<f64> {
    let whole = text.split('.').next()?;
    if whole.len() != 6 || !whole.is_ascii() {
        return None;
    }
    of_day_s(&text[..2], &text[2..4], &text[4..])
}

fn of_day_s(hours: &str, minutes: &str, seconds: &str) -> Option<f64> {
    let (hours, minutes) = (digits(hours)?, digits(minutes)?);
    let whole = digits(seconds.split(['.', ',']).next()?)?;
    let seconds: f64 = seconds.replacen(',', ".", 1).parse().ok()?;
    // 60 is a leap second
    if hours > 23 || minutes > 59 || whole > 60 {
        return None;
    }
    Some(f64::from(hours) * 3600.0 + f64::from(minutes) * 60.0 + seconds)
}

/// A date in digits; `None` for a text that is none, whether the calendar has it or not.
fn date(token: &str) -> Option<Date> {
    if token.len() == 8 && token.bytes().all(|b| b.is_ascii_digit()) {
        return date_of(&token[..4], &token[4..6], &token[6..], '-');
    }
    let mark = token.chars().find(|c| matches!(c, '-' | '/' | '.'))?;
    let mut parts = token.split(mark);
    let (first, second, third) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() {
        return None;
    }
    if let Some(month) = month_named(second) {
        return Some(Date::Known(digits(third)?, month, digits(first)?));
    }
    date_of(first, second, third, mark)
}

/// A year of four digits comes first or last; with points, the day comes before the month.
fn date_of(first: &str, second: &str, third: &str, mark: char) -> Option<Date> {
    let [a, b, c] = [digits(first)?, digits(second)?, digits(third)?];
    Some(match (first.len(), third.len(), mark) {
        (4, 1 | 2, _) => Date::Known(a, b, c),
        (1 | 2, 4, '.') => Date::Known(c, b, a),
        (1 | 2, 4, _) => Date::Open(a, b, c),
        _ => Date::Impossible,
    })
}

fn month_named(text: &str) -> Option<u32> {
    const MONTHS: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    let month = MONTHS.iter().position(|m| m.eq_ignore_ascii_case(text))?;
    u32::try_from(month + 1).ok()
}

fn is_weekday(text: &str) -> bool {
    ["mon", "tue", "wed", "thu", "fri", "sat", "sun"]
        .iter()
        .any(|day| day.eq_ignore_ascii_case(text))
}

/// How far a clock is ahead of universal time, s: `Z`, `UTC`, `GMT+01:00`, `+0100`, `-5`.
fn zone_s(text: &str) -> Option<f64> {
    let upper = text.to_ascii_uppercase();
    let offset = upper
        .strip_prefix("UTC")
        .or_else(|| upper.strip_prefix("GMT"))
        .or_else(|| upper.strip_prefix('Z'))
        .unwrap_or(&upper);
    if offset.is_empty() {
        return Some(0.0);
    }
    let sign = match offset.as_bytes()[0] {
        b'+' => 1.0,
        b'-' => -1.0,
        _ => return None,
    };
    let (hours, minutes) = match &offset[1..] {
        whole if whole.contains(':') => whole.split_once(':')?,
        whole if whole.len() == 4 && whole.is_ascii() => whole.split_at(2),
        whole => (whole, "0"),
    };
    let (hours, minutes) = (digits(hours)?, digits(minutes)?);
    let known = hours <= 14 && minutes < 60;
    known.then(|| sign * f64::from(hours * 3600 + minutes * 60))
}

/// The number of a day since the first of January of the year 1, if there is such a day.
fn day_number(year: u32, month: u32, day: u32) -> Option<i64> {
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let february = if leap { 29 } else { 28 };
    let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let before: &[u32] = lengths.get(..month.checked_sub(1)? as usize)?;
    if !(1..=9999).contains(&year) || day == 0 || day > *lengths.get(before.len())? {
        return None;
    }
    let past = year - 1;
    let days = past * 365 + past / 4 - past / 100 + past / 400 + before.iter().sum::<u32>() + day;
    Some(i64::from(days))
}

fn digits(text: &str) -> Option<u32> {
    (text.len() <= 4 && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn one_moment_in_many_words() {
        let expected = Stamp {
            date: Some(Date::Known(2026, 8, 5)),
            of_day_s: 68_276.25,
            zone_s: None,
        };
        for text in [
            "2026-08-05T18:57:56.250",
            "2026/08/05 18:57:56,250",
            "05.08.2026 18:57:56.250",
            "05-Aug-2026 06:57:56.250 PM",
            "20260805 185756.250",
            "20260805T185756.250",
            "05-Aug-2026 06:57:56.250PM",
            "Wed Aug 05 18:57:56.250 2026",
            "5 Aug 2026, 18:57:56.25",
        ] {
            assert_eq!(stamp(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn zones() {
        for (text, zone_s) in [
            ("2026-03-29T01:55:00Z", 0.0),
            ("2026-03-29T01:55:00+01:00", 3600.0),
            ("2026-03-29 01:55:00 -0530", -19_800.0),
            ("2026-03-29 01:55 UTC", 0.0),
            ("20260329T015500.5Z", 0.0),
            ("Sun Mar 29 01:55:00 GMT+01:00 2026", 3600.0),
        ] {
            assert_eq!(stamp(text).unwrap().zone_s, Some(zone_s), "{text}");
        }
        assert!(stamp("2026-03-29T01:55:00+25:00").is_none());
        assert!(stamp("2026-03-29T01:55:00Z UTC").is_none());
    }

    #[test]
    fn the_order_of_day_and_month_is_open() {
        let date = stamp("03/04/2026 10:00").unwrap().date.unwrap();
        assert_eq!(date, Date::Open(3, 4, 2026));
        let [dmy, mdy] = [DateOrder::DayMonthYear, DateOrder::MonthDayYear];
        assert_eq!(date.day(dmy).unwrap() - date.day(mdy).unwrap(), 30);
        assert_eq!(Date::Open(26, 8, 2019).day(mdy), None);
    }

    #[test]
    fn days_and_times_that_are_not() {
        for text in ["02/29/2021", "02/29/1900", "00/01/2021", "04/31/2021"] {
            let date = date(text).unwrap();
            assert_eq!(date.day(DateOrder::MonthDayYear), None, "{text}");
        }
        assert_eq!(date("03/04/26"), Some(Date::Impossible));
        for text in ["1/2", "", "2021-1", "a/b/c", "+1/1/2021"] {
            assert_eq!(date(text), None, "{text}");
        }
        for text in [
            "24:00:00",
            "1:60:00",
            "1:00:61",
            "x:00:00",
            "1:00:-1",
            "01:00:00:00",
            "1:00:nan",
            "1:30",
            "13:00:00 PM",
            "0:30:00 AM",
            "",
            "12.5",
            "1:00:00 2:00:00",
            "1:00:00PM PM",
            "010000ZZ",
            "tomorrow",
        ] {
            assert_eq!(stamp(text), None, "{text}");
        }
        assert_eq!(stamp("12:30:00 AM").unwrap().of_day_s, 1800.0);
        assert_eq!(stamp("12:30:00 PM").unwrap().of_day_s, 45_000.0);
    }
}

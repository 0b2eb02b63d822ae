//! Time from a date and a clock as text.

use std::path::Path;

use crate::{Action, Error, Finding, FindingKind};

const DAY_S: f64 = 86_400.0;

/// Seconds since the first sample from texts with their lines, and what had to be repaired.
///
/// A date that the calendar does not have, such as `30/00/2006`, is replaced: the clock runs on
/// from its neighbour, over midnight where it must.
pub(crate) fn seconds(
    path: &Path,
    headers: (&str, &str),
    dates: &[(usize, String)],
    clocks: &[(usize, String)],
) -> Result<(Vec<f64>, Option<Finding>), Error> {
    let mut of_day_s = Vec::with_capacity(clocks.len());
    for (line, text) in clocks {
        of_day_s.push(clock_s(text).ok_or_else(|| Error::Clock {
            path: path.to_owned(),
            line: *line,
            header: headers.1.to_owned(),
            text: text.chars().take(60).collect(),
        })?);
    }
    let days: Vec<Option<f64>> = dates.iter().map(|(_, text)| day_number(text)).collect();
    let Some(anchor) = days.iter().position(Option::is_some) else {
        let (line, text) = dates.first().cloned().unwrap_or_default();
        return Err(Error::Clock {
            path: path.to_owned(),
            line,
            header: headers.0.to_owned(),
            text,
        });
    };
    let mut time_s = vec![0.0; days.len()];
    for (i, day) in days.iter().enumerate().skip(anchor) {
        time_s[i] = match day {
            Some(day) => day * DAY_S + of_day_s[i],
            None => time_s[i - 1] + (of_day_s[i] - of_day_s[i - 1]).rem_euclid(DAY_S),
        };
    }
    for i in (0..anchor).rev() {
        time_s[i] = time_s[i + 1] - (of_day_s[i + 1] - of_day_s[i]).rem_euclid(DAY_S);
    }
    let start_s = time_s.first().copied().unwrap_or(0.0);
    for time_s in &mut time_s {
        *time_s -= start_s;
    }
    Ok((time_s.clone(), invalid_dates(&time_s, &days, dates)))
}

fn invalid_dates(
    time_s: &[f64],
    days: &[Option<f64>],
    dates: &[(usize, String)],
) -> Option<Finding> {
    let first = days.iter().position(Option::is_none)?;
    let last = days.iter().rposition(Option::is_none)?;
    let count = days.iter().filter(|day| day.is_none()).count();
    let detail = format!(
        "{count} dates that the calendar does not have, first {:?}",
        dates[first].1
    );
    Some(Finding::of_time(
        FindingKind::InvalidDate,
        (time_s[first], time_s[last]),
        Action::Interpolated,
        detail,
    ))
}

/// Seconds since midnight of `HH:MM:SS` with or without a fraction.
fn clock_s(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let (hours, minutes, seconds) = (
        digits(parts.next()?)?,
        digits(parts.next()?)?,
        parts.next()?,
    );
    let whole = digits(seconds.split('.').next()?)?;
    let seconds: f64 = seconds.parse().ok()?;
    // 60 is a leap second
    if parts.next().is_some() || hours > 23 || minutes > 59 || whole > 60 {
        return None;
    }
    Some(f64::from(hours) * 3600.0 + f64::from(minutes) * 60.0 + seconds)
}

/// The day number of `MM/DD/YYYY` or `YYYY-MM-DD`, if there is such a day.
fn day_number(text: &str) -> Option<f64> {
    let (year, month, day) = if let Some((year, rest)) = text.split_once('-') {
        let (month, day) = rest.split_once('-')?;
        (digits(year)?, digits(month)?, digits(day)?)
    } else {
        let (month, rest) = text.split_once('/')?;
        let (day, year) = rest.split_once('/')?;
        (digits(year)?, digits(month)?, digits(day)?)
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let lengths = [
        31,
        if leap { 29 } else { 28 },
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ];
    let before: &[u32] = lengths.get(..month.checked_sub(1)? as usize)?;
    if !(1..=9999).contains(&year) || day == 0 || day > *lengths.get(before.len())? {
        return None;
    }
    let past = year - 1;
    let days = past * 365 + past / 4 - past / 100 + past / 400 + before.iter().sum::<u32>() + day;
    Some(f64::from(days))
}

fn digits(text: &str) -> Option<u32> {
    (text.len() <= 4 && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    fn times(rows: &[(&str, &str)]) -> (Vec<f64>, Option<Finding>) {
        let column = |text: fn(&(&str, &str)) -> String| -> Vec<(usize, String)> {
            rows.iter()
                .enumerate()
                .map(|(i, row)| (i + 2, text(row)))
                .collect()
        };
        let dates = column(|row| row.0.to_owned());
        let clocks = column(|row| row.1.to_owned());
        seconds(Path::new("log"), ("Date", "Time"), &dates, &clocks).unwrap()
    }

    #[test]
    fn midnight_of_a_leap_day() {
        let (time_s, finding) = times(&[
            ("02/28/2020", "23:59:59"),
            ("02/29/2020", "00:00:00"),
            ("03/01/2020", "00:00:01.5"),
        ]);
        assert_eq!(time_s, [0.0, 1.0, 86_402.5]);
        assert!(finding.is_none());
        let (time_s, _) = times(&[("2019-12-31", "23:59:59"), ("2020-01-01", "00:00:00")]);
        assert_eq!(time_s, [0.0, 1.0]);
    }

    #[test]
    fn impossible_dates_run_on() {
        let rows = [
            ("90/02/2032", "23:59:58"),
            ("02/28/2021", "23:59:59"),
            ("30/00/2006", "00:00:00"),
            ("03/01/2021", "00:00:01"),
        ];
        let (time_s, finding) = times(&rows);
        assert_eq!(time_s, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(finding.unwrap().kind, FindingKind::InvalidDate);
    }

    #[test]
    fn days_that_are_not() {
        for text in [
            "02/29/2021",
            "02/29/1900",
            "13/01/2021",
            "00/01/2021",
            "04/31/2021",
            "1/2",
            "",
            "2021-1",
            "a/b/c",
            "+1/1/2021",
        ] {
            assert_eq!(day_number(text), None, "{text}");
        }
        assert!(day_number("02/29/2000").is_some());
        for text in [
            "24:00:00",
            "1:60:00",
            "1:00:61",
            "1:00",
            "x:00:00",
            "1:00:-1",
            "01:00:00:00",
            "1:00:nan",
        ] {
            assert_eq!(clock_s(text), None, "{text}");
        }
    }
}

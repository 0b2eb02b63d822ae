//! Time from dates and clocks as text.

use std::path::Path;

use crate::note::{About, Note, excerpt};
use crate::number::is_missing;
use crate::stamp::{Date, DateOrder, Stamp, stamp};
use crate::{Action, Error, FindingKind, TableError};

const DAY_S: f64 = 86_400.0;

/// A column of times as text.
pub(crate) struct Clock {
    header: String,
    /// Line and text of each row.
    texts: Vec<(usize, String)>,
    /// `None` where the cell says that there is no value.
    stamps: Vec<Option<Stamp>>,
    /// The order of day and month, where the layout or a date of the file tells it.
    order: Option<DateOrder>,
}

impl Clock {
    /// Reads every text; `order` is what the layout says of dates such as `03/04/2026`.
    pub(crate) fn read(
        path: &Path,
        header: String,
        texts: Vec<(usize, String)>,
        order: Option<DateOrder>,
    ) -> Result<Clock, Error> {
        let mut stamps = Vec::with_capacity(texts.len());
        let mut zoned = None;
        for (line, text) in &texts {
            let read = if is_missing(text) { None } else { stamp(text) };
            let has_zone = read.map(|stamp| stamp.zone_s.is_some());
            let at_odds = has_zone.is_some_and(|has| *zoned.get_or_insert(has) != has);
            if at_odds || (read.is_none() && !is_missing(text)) {
                return Err(not_a_time(path, &header, *line, text));
            }
            stamps.push(read);
        }
        let mut clock = Clock {
            header,
            texts,
            stamps,
            order,
        };
        if clock.order.is_none() {
            clock.order = clock.told_order(path)?;
        }
        clock.require_a_day(path)?;
        Ok(clock)
    }

    fn open_dates(&self) -> impl Iterator<Item = (usize, Date)> {
        self.stamps.iter().enumerate().filter_map(|(row, stamp)| {
            let date = (*stamp)?.date?;
            matches!(date, Date::Open(..)).then_some((row, date))
        })
    }

    /// The order that a day after the twelfth tells.
    fn told_order(&self, path: &Path) -> Result<Option<DateOrder>, Error> {
        let only = |order, other: DateOrder| {
            self.open_dates()
                .find(|(_, date)| date.day(order).is_some() && date.day(other).is_none())
        };
        let day_first = only(DateOrder::DayMonthYear, DateOrder::MonthDayYear);
        let month_first = only(DateOrder::MonthDayYear, DateOrder::DayMonthYear);
        match (day_first, month_first) {
            (None, None) => Ok(None),
            (Some(_), None) => Ok(Some(DateOrder::DayMonthYear)),
            (None, Some(_)) => Ok(Some(DateOrder::MonthDayYear)),
            (Some((a, _)), Some((b, _))) => Err(self.open_order(path, a.max(b))),
        }
    }

    fn open_order(&self, path: &Path, row: usize) -> Error {
        TableError::DateOrder {
            path: path.to_owned(),
            line: self.texts[row].0,
            header: self.header.clone(),
            text: excerpt(&self.texts[row].1),
        }
        .into()
    }

    /// Where every date is none, the column is none of dates.
    fn require_a_day(&self, path: &Path) -> Result<(), Error> {
        let dated = |stamp: &Option<Stamp>| stamp.is_some_and(|s| s.date.is_some());
        let Some(first) = self.stamps.iter().position(dated) else {
            return Ok(());
        };
        let order = self.order.unwrap_or(DateOrder::DayMonthYear);
        let any = |stamp: &Option<Stamp>| {
            stamp.is_some_and(|s| s.date.is_some_and(|date| date.day(order).is_some()))
        };
        if self.stamps.iter().any(any) {
            return Ok(());
        }
        let (line, text) = &self.texts[first];
        Err(not_a_time(path, &self.header, *line, text))
    }

    /// Seconds since the first sample of a log whose rows are `rows`, all if `None`, and what had to
    /// be repaired or taken for granted.
    ///
    /// A date that the calendar does not have, such as `30/00/2006`, is replaced: the clock runs on
    /// from its neighbour, over midnight where it must, as it does where there are no dates.
    pub(crate) fn seconds(
        &self,
        path: &Path,
        rows: Option<&[usize]>,
    ) -> Result<(Vec<f64>, Vec<Note>), Error> {
        let rows: Vec<usize> =
            rows.map_or_else(|| (0..self.stamps.len()).collect(), <[usize]>::to_vec);
        let (order, taken) = self.order_for(path, &rows)?;
        let days: Vec<Option<i64>> = rows
            .iter()
            .map(|row| self.stamps[*row].and_then(|s| s.date?.day(order)))
            .collect();
        let time_s = self.run(&rows, &days);
        let notes = taken.into_iter().chain(self.invalid_dates(&rows, &days));
        Ok((time_s, notes.collect()))
    }

    /// The order of day and month for these rows, and why where no date tells it: it matters only
    /// if the date changes, and then one day must follow the other.
    fn order_for(&self, path: &Path, rows: &[usize]) -> Result<(DateOrder, Option<Note>), Error> {
        if let Some(order) = self.order {
            return Ok((order, None));
        }
        let mut dates: Vec<(usize, Date)> = rows
            .iter()
            .filter_map(|row| Some((*row, self.stamps[*row]?.date?)))
            .filter(|(_, date)| matches!(date, Date::Open(..)))
            .collect();
        dates.dedup_by_key(|(_, date)| *date);
        if dates.len() < 2 {
            return Ok((DateOrder::DayMonthYear, None));
        }
        let follow = |order| {
            dates.windows(2).all(|pair| {
                let [before, after] = [pair[0].1.day(order), pair[1].1.day(order)];
                matches!((before, after), (Some(before), Some(after)) if after - before == 1)
            })
        };
        let (order, name) = match (
            follow(DateOrder::DayMonthYear),
            follow(DateOrder::MonthDayYear),
        ) {
            (true, false) => (DateOrder::DayMonthYear, "D/M/Y"),
            (false, true) => (DateOrder::MonthDayYear, "M/D/Y"),
            _ => return Err(self.open_order(path, dates[1].0)),
        };
        let detail = format!(
            "dates such as {:?} are read as {name}: only so does one day follow the other",
            excerpt(&self.texts[dates[0].0].1)
        );
        let note = Note::of_file(FindingKind::TimeFormat, Action::Converted, detail);
        Ok((order, Some(note)))
    }

    /// Time of each row since the first that has one.
    fn run(&self, rows: &[usize], days: &[Option<i64>]) -> Vec<f64> {
        let of_day_s = |i: usize| {
            self.stamps[rows[i]].map(|stamp| stamp.of_day_s - stamp.zone_s.unwrap_or(0.0))
        };
        let there: Vec<usize> = (0..rows.len()).filter(|&i| of_day_s(i).is_some()).collect();
        let clock_s: Vec<f64> = there.iter().filter_map(|&i| of_day_s(i)).collect();
        let anchor = there.iter().position(|&i| days[i].is_some()).unwrap_or(0);
        let mut run_s = vec![0.0; there.len()];
        let day_0 = there.get(anchor).and_then(|&i| days[i]).unwrap_or(0);
        for k in anchor..there.len() {
            run_s[k] = match days[there[k]] {
                Some(day) => (day - day_0) as f64 * DAY_S + clock_s[k],
                None if k == anchor => clock_s[k],
                None => run_s[k - 1] + nearest(clock_s[k] - clock_s[k - 1]),
            };
        }
        for k in (0..anchor).rev() {
            run_s[k] = run_s[k + 1] - nearest(clock_s[k + 1] - clock_s[k]);
        }
        let mut time_s = vec![f64::NAN; rows.len()];
        for (k, &i) in there.iter().enumerate() {
            time_s[i] = run_s[k] - run_s[0];
        }
        time_s
    }

    fn invalid_dates(&self, rows: &[usize], days: &[Option<i64>]) -> Option<Note> {
        if days.iter().all(Option::is_none) {
            return None;
        }
        let invalid: Vec<usize> = (0..rows.len())
            .filter(|&i| days[i].is_none() && self.stamps[rows[i]].is_some())
            .map(|i| rows[i])
            .collect();
        let (line, text) = &self.texts[*invalid.first()?];
        Some(Note {
            kind: FindingKind::InvalidDate,
            channel: None,
            action: Action::Interpolated,
            about: About::Rows {
                names: (
                    "date that the calendar does not have",
                    "dates that the calendar does not have",
                ),
                rest: format!(", first {:?} in line {line}", excerpt(text)),
                rows: invalid,
            },
        })
    }
}

/// The change of a clock without a date: by less than half a day, over midnight where it must.
fn nearest(change_s: f64) -> f64 {
    (change_s + 0.5 * DAY_S).rem_euclid(DAY_S) - 0.5 * DAY_S
}

fn not_a_time(path: &Path, header: &str, line: usize, text: &str) -> Error {
    TableError::Clock {
        path: path.to_owned(),
        line,
        header: header.to_owned(),
        text: excerpt(text),
    }
    .into()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    fn clock(rows: &[&str]) -> Result<Clock, Error> {
        let texts = rows.iter().enumerate();
        let texts = texts.map(|(i, text)| (i + 2, (*text).to_owned())).collect();
        Clock::read(Path::new("log"), "Time".to_owned(), texts, None)
    }

    fn times(rows: &[&str]) -> (Vec<f64>, Vec<Note>) {
        clock(rows)
            .unwrap()
            .seconds(Path::new("log"), None)
            .unwrap()
    }

    #[test]
    fn midnight_of_a_leap_day() {
        let (time_s, notes) = times(&[
            "02/28/2020 23:59:59",
            "02/29/2020 00:00:00",
            "03/01/2020 00:00:01.5",
        ]);
        assert_eq!(time_s, [0.0, 1.0, 86_402.5]);
        assert!(notes.is_empty());
        let (time_s, _) = times(&["2019-12-31T23:59:59", "2020-01-01T00:00:00"]);
        assert_eq!(time_s, [0.0, 1.0]);
    }

    #[test]
    fn a_clock_without_dates_runs_over_midnight() {
        let (time_s, _) = times(&["23:59:59", "-", "00:00:00", "23:59:59.5", "00:00:01"]);
        assert!(time_s[1].is_nan());
        assert_eq!(
            [time_s[0], time_s[2], time_s[3], time_s[4]],
            [0.0, 1.0, 0.5, 2.0]
        );
    }

    #[test]
    fn the_zone_changes_with_summer_time() {
        let (time_s, _) = times(&["2026-03-29T01:59:59+01:00", "2026-03-29T03:00:00+02:00"]);
        assert_eq!(time_s, [0.0, 1.0]);
        let error = clock(&["2026-03-29T01:59:59+01:00", "2026-03-29T02:00:00"]);
        assert!(error.is_err(), "a zone in some rows only");
    }

    #[test]
    fn impossible_dates_run_on() {
        let (time_s, notes) = times(&[
            "90/02/2032 23:59:58",
            "02/28/2021 23:59:59",
            "30/00/2006 00:00:00",
            "03/01/2021 00:00:01",
        ]);
        assert_eq!(time_s, [0.0, 1.0, 2.0, 3.0]);
        let finding = notes[0].finding(None, &time_s).unwrap();
        assert_eq!(finding.kind, FindingKind::InvalidDate);
        assert!(finding.detail.contains("2 dates") && finding.detail.contains("line 2"));
    }

    #[test]
    fn the_order_of_a_date_is_told_and_not_guessed() {
        assert_eq!(
            times(&["26/8/2019 23:59:59", "27/8/2019 0:00:00"]).0,
            [0.0, 1.0]
        );
        assert_eq!(
            times(&["8/26/2019 23:59:59", "8/27/2019 0:00:00"]).0,
            [0.0, 1.0]
        );
        assert_eq!(
            times(&["3/4/2019 10:00:00", "3/4/2019 10:00:01"]).0,
            [0.0, 1.0]
        );
        let (time_s, notes) = times(&["3/4/2019 23:59:59", "4/4/2019 0:00:00"]);
        assert_eq!(time_s, [0.0, 1.0]);
        assert!(
            notes[0]
                .finding(None, &time_s)
                .unwrap()
                .detail
                .contains("D/M/Y")
        );
        let open = clock(&["3/4/2019 23:59:59", "5/4/2019 0:00:00"]).unwrap();
        assert!(open.seconds(Path::new("log"), None).is_err());
        assert!(clock(&["26/8/2019 10:00", "8/26/2019 10:01"]).is_err());
    }
}

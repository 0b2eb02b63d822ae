//! Rows of a log that is still being written.

mod held;
mod regular;
mod row;

use std::io::{BufRead, Read as _};
use std::path::{Path, PathBuf};

use crate::cells::cell;
use crate::lines::{decoded, fields};
use crate::log::positive;
use crate::plan::{ChannelColumn, Plan, TimeColumns};
use crate::quality::plausible;
use crate::row_width::checked_fields;
use crate::{Channel, Error, canonical};
use held::Held;
use regular::{Arrival, Regular, Sample};
pub use row::Row;

/// Longest line that is read, in bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// Steps within this share of the nominal one are not worth a remark: loggers stamp with some jitter.
const STEP_TOLERANCE: f64 = 0.1;

const CURE: &str = "a stream has whole rows with one delimiter, and no comments";

/// Acceleration that tyres cannot transmit, and what a coarse sensor may add in one step.
const TYRE_LIMIT_MPS2: f64 = 10.0;
const COARSE_STEP_MPS: f64 = 1.0;

/// Reads canonical CSV row by row as it comes, in constant memory: a header with `time_s`,
/// `speed_kmh` and so on, and `,`, `;` or tab as delimiter.
///
/// Samples are put on a grid of the step, with straight lines between rows, as
/// [`prepare`](crate::prepare()) does. Rows without time or speed are left out. Where rows are further
/// apart than the longest gap, or the clock is set back, a new piece starts. Each of these is said in
/// a remark.
#[derive(Debug)]
pub struct RowReader<R> {
    lines: Lines<R>,
    delimiter: u8,
    decimal_comma: Option<bool>,
    headers: Vec<String>,
    time: ChannelColumn,
    speed: ChannelColumn,
    lead_gap: Option<ChannelColumn>,
    columns: Vec<ChannelColumn>,
    told: Vec<Channel>,
    regular: Regular,
    /// Rows since the last usable one.
    left_out: usize,
    told_of_steps: bool,
    held: Held,
}

impl<R: BufRead> RowReader<R> {
    /// Reads the header; `path` is for messages only. A gap longer than `max_gap_s` starts a new
    /// piece.
    ///
    /// # Errors
    /// [`Error::Option`] for a step or gap that is not positive, [`Error::NoData`] without a header,
    /// [`Error::MissingColumn`] and the like for one without time and speed.
    pub fn new(path: &Path, input: R, step_s: f64, max_gap_s: f64) -> Result<Self, Error> {
        positive("step_s", step_s)?;
        positive("max_gap_s", max_gap_s)?;
        let mut lines = Lines {
            path: path.to_owned(),
            input,
            line: 0,
            text: Vec::new(),
        };
        let no_data = |found| Error::NoData {
            path: path.to_owned(),
            found,
        };
        let header = lines.next()?.ok_or_else(|| no_data("an empty stream"))?;
        let (delimiter, headers, plan) = planned(path, header.trim_start_matches('\u{feff}'))?;
        let columns: Vec<ChannelColumn> = plan.logs.into_iter().flat_map(|l| l.columns).collect();
        let column = |channel| columns.iter().find(|c| c.channel == channel).copied();
        let (TimeColumns::Number { column: time, unit }, Some(speed)) =
            (plan.time, column(Channel::Speed))
        else {
            return Err(no_data("no columns of time and speed"));
        };
        Ok(Self {
            lines,
            delimiter,
            decimal_comma: None,
            headers,
            time: ChannelColumn::new(Channel::Speed, time, unit),
            speed,
            lead_gap: column(Channel::LeadGap),
            told: Vec::new(),
            regular: Regular::new(step_s, max_gap_s),
            left_out: 0,
            told_of_steps: false,
            held: Held::default(),
            columns,
        })
    }

    /// Rows that also tell those of the channels that the header has, see [`Row::told`]. The speed limit holds between rows, all else is a
    /// straight line.
    #[must_use]
    pub fn telling(mut self, channels: &[Channel]) -> Self {
        let has = |channel: &&Channel| self.columns.iter().any(|c| c.channel == **channel);
        self.told = channels.iter().filter(has).copied().collect();
        let holds = self.told.iter().map(|c| *c == Channel::SpeedLimit);
        self.regular = self.regular.holding(holds.collect());
        self
    }

    /// The channels that rows tell besides, in this order.
    #[must_use]
    pub fn told(&self) -> &[Channel] {
        &self.told
    }

    /// The next sample, as soon as it is certain; `None` at the end of the input. What was left out or
    /// changed goes to `remark`, with the number of the line.
    ///
    /// # Errors
    /// [`Error::Read`] and [`Error::LongLine`]; [`Error::NoData`] at the end of rows of which none has
    /// time and speed.
    pub fn next_row(&mut self, remark: &mut dyn FnMut(String)) -> Result<Option<Row>, Error> {
        loop {
            if let Some(row) = self.regular.next() {
                return Ok(Some(row));
            }
            let Some(text) = self.lines.next()? else {
                return self.ended(remark).map(|()| None);
            };
            match self.sample(&text, remark) {
                Ok(sample) => self.take(sample, remark),
                Err(what) => self.leave_out(&what, remark),
            }
        }
    }

    /// What a row tells, or what is wrong with it.
    fn sample(&mut self, text: &str, remark: &mut dyn FnMut(String)) -> Result<Sample, String> {
        let (path, line) = (&self.lines.path, self.lines.line);
        let row = checked_fields(path, self.delimiter, self.headers.len(), line, text, CURE)
            .map_err(|error| error.to_string())?;
        let headers = &self.headers;
        let place = |column: ChannelColumn| {
            let header = &headers[column.column];
            format!("{}, line {line}, column {header:?}", path.display())
        };
        let mut value = |column: ChannelColumn| {
            let text = row[column.column];
            let Some(number) = cell(text, &mut self.decimal_comma) else {
                let text: String = text.chars().take(60).collect();
                return Err(format!("{}: {text:?} is not a number", place(column)));
            };
            let mut si = [number];
            column.unit.convert(&mut si, column.sign);
            Ok(si[0])
        };
        let mut required = |column| match value(column)? {
            value if value.is_nan() => Err(format!("{}: no value", place(column))),
            value => Ok(value),
        };
        let (time_s, speed_mps) = (required(self.time)?, required(self.speed)?);
        let in_range = |channel, column, value| {
            possible(channel, value).map_err(|what| format!("{}: {what}", place(column)))
        };
        in_range(Channel::Speed, self.speed, speed_mps)?;
        if let Some(jump) = self
            .regular
            .newest()
            .and_then(|newest| impossible(newest, time_s, speed_mps))
        {
            return Err(format!("{}: {jump}", place(self.speed)));
        }
        let mut or_missing = |column: Option<&ChannelColumn>| {
            let told = column.map(|&column| {
                value(column).and_then(|value| in_range(column.channel, column, value))
            });
            told.unwrap_or(Ok(f64::NAN)).unwrap_or_else(|what| {
                remark(format!("{what}; counted as missing"));
                f64::NAN
            })
        };
        let lead_gap_m = or_missing(self.lead_gap.as_ref());
        let column = |channel: &Channel| self.columns.iter().find(|c| c.channel == *channel);
        let told = self.told.iter().map(|c| or_missing(column(c))).collect();
        Ok(Sample {
            time_s,
            speed_mps,
            lead_gap_m,
            told,
        })
    }

    /// One remark for rows that follow each other.
    fn leave_out(&mut self, what: &str, remark: &mut dyn FnMut(String)) {
        if self.left_out == 0 {
            remark(format!("{what}; left out, as all rows until it is right"));
        }
        self.left_out += 1;
    }

    fn take(&mut self, sample: Sample, remark: &mut dyn FnMut(String)) {
        let place = format!("{}, line {}", self.lines.path.display(), self.lines.line);
        if self.held.is_told_by(sample.speed_mps) {
            remark(format!(
                "{place}: the speed stands still for rows and then jumps, as if rows repeated it; accelerations are none or huge: \
                 send a row per update, or segment the whole log"
            ));
        }
        let newest_s = self.regular.newest_s();
        let (from_s, to_s) = (newest_s.unwrap_or(sample.time_s), sample.time_s);
        let arrival = self.regular.arrive(sample);
        let left_out = match self.left_out {
            1 => "1 row was left out".to_owned(),
            count => format!("{count} rows were left out"),
        };
        let what = match arrival {
            Arrival::Late => {
                let what = format!("{place}: {to_s} s comes after {from_s} s");
                return self.leave_out(&what, remark);
            }
            Arrival::SetBack { .. } => {
                format!("the clock is set back from {from_s} s to {to_s} s; a new piece starts")
            }
            Arrival::Gap { .. } => {
                format!("no speed for {:.3} s; a new piece starts", to_s - from_s)
            }
            Arrival::Follows if self.left_out == 0 => {
                return self.tell_of_steps(&place, to_s - from_s, remark);
            }
            Arrival::Follows if newest_s.is_none() => format!("{left_out} before it"),
            Arrival::Follows => {
                let gap_s = to_s - from_s;
                format!("{left_out}; for {gap_s:.3} s the speed is a straight line")
            }
        };
        self.left_out = 0;
        remark(format!("{place}: {what}"));
        if let Arrival::SetBack { alone: true } | Arrival::Gap { alone: true } = arrival {
            remark(alone(&place, from_s));
        }
    }

    /// Once: a log of another step would fill the screen.
    fn tell_of_steps(&mut self, place: &str, found_s: f64, remark: &mut dyn FnMut(String)) {
        let step_s = self.regular.step_s();
        let is_first = found_s == 0.0;
        let jitter = (found_s - step_s).abs() <= STEP_TOLERANCE * step_s;
        if !(is_first || jitter || self.told_of_steps) {
            self.told_of_steps = true;
            remark(format!(
                "{place}: {found_s:.3} s after the row before, not {step_s} s; straight lines between such rows are sampled every \
                 {step_s} s, the step that was asked for"
            ));
        }
    }

    fn ended(&self, remark: &mut dyn FnMut(String)) -> Result<(), Error> {
        match self.regular.newest_s() {
            None if self.left_out > 0 => Err(Error::NoData {
                path: self.lines.path.clone(),
                found: "no row with time and speed",
            }),
            Some(at_s) if self.regular.is_alone() => {
                remark(alone(&self.lines.path.display().to_string(), at_s));
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// A value that a road vehicle can have, or none.
fn possible(channel: Channel, value: f64) -> Result<f64, String> {
    let (least, most) = plausible(channel);
    if value < least || value > most {
        let name = channel.name();
        return Err(format!("{value} is outside {least} to {most} ({name})"));
    }
    Ok(value)
}

/// What no car does from one row to the next: tyres transmit 10 m/s², a coarse sensor adds 1 m/s, and none goes backward at once.
/// What stays there is a new piece after the longest gap.
fn impossible(newest: &Sample, time_s: f64, speed_mps: f64) -> Option<String> {
    let (step_s, jump_mps) = (time_s - newest.time_s, speed_mps - newest.speed_mps);
    let limit_mps = if speed_mps < 0.0 {
        0.0
    } else {
        COARSE_STEP_MPS
    };
    (step_s > 0.0 && jump_mps.abs() > TYRE_LIMIT_MPS2 * step_s + limit_mps).then(|| {
        format!(
            "speed from {:.2} to {speed_mps:.2} m/s in {step_s:.2} s",
            newest.speed_mps
        )
    })
}

fn alone(place: &str, at_s: f64) -> String {
    format!("{place}: the sample at {at_s} s stands alone, which is no drive; left out")
}

/// Delimiter, headers and columns of a header. The delimiter is the one with which it is canonical.
fn planned(path: &Path, header: &str) -> Result<(u8, Vec<String>, Plan), Error> {
    let cut = |delimiter| -> Vec<String> {
        let mut headers: Vec<String> = fields(header, delimiter)
            .into_iter()
            .map(str::to_owned)
            .collect();
        while headers.last().is_some_and(String::is_empty) {
            headers.pop();
        }
        headers
    };
    let delimiter = [b';', b'\t', b',']
        .into_iter()
        .max_by_key(|&delimiter| cut(delimiter).len())
        .unwrap_or(b',');
    let headers = cut(delimiter);
    let plan = canonical::plan(path, &headers)?;
    Ok((delimiter, headers, plan))
}

/// Lines that are not blank, with their number.
#[derive(Debug)]
struct Lines<R> {
    path: PathBuf,
    input: R,
    line: usize,
    text: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    fn next(&mut self) -> Result<Option<String>, Error> {
        loop {
            self.text.clear();
            let read = (&mut self.input)
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut self.text)
                .map_err(|problem| Error::Read {
                    path: self.path.clone(),
                    problem,
                })?;
            self.line += 1;
            if read as u64 == LONGEST_LINE {
                return Err(Error::LongLine {
                    path: self.path.clone(),
                    line: self.line,
                    limit_bytes: LONGEST_LINE,
                });
            }
            if read == 0 {
                return Ok(None);
            }
            if !self.text.trim_ascii().is_empty() {
                let text = decoded(&self.text);
                return Ok(Some(text.trim_end_matches(['\r', '\n', ' ']).to_owned()));
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

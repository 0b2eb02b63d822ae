//! Rows of a log that is still being written.

use std::io::{BufRead, Read as _};
use std::path::{Path, PathBuf};

use crate::body::checked_fields;
use crate::cells::cell;
use crate::layout::{ChannelColumn, Plan, TimeColumns};
use crate::log::positive;
use crate::text::{decoded, fields};
use crate::{Channel, Error, canonical};

/// Longest line that is read, in bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// A step may differ by this share of the nominal one: loggers stamp with some jitter.
const STEP_TOLERANCE: f64 = 0.1;

/// One sample as it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time on the recording's own clock, s.
    pub time_s: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Distance to a vehicle ahead, m; NaN where there is none.
    pub lead_gap_m: f64,
    /// The first sample of the stream, or the first after a gap.
    pub starts_piece: bool,
}

/// Reads canonical CSV row by row as it comes, in constant memory: a header with `time_s`,
/// `speed_kmh` and so on, and `,`, `;` or tab as delimiter.
///
/// Samples must be a step apart, within a tenth of it. A longer gap than allowed starts a new piece;
/// any other step is an error, as is a row without time or speed. Nothing is repaired or resampled.
#[derive(Debug)]
pub struct RowReader<R> {
    lines: Lines<R>,
    delimiter: u8,
    decimal_comma: Option<bool>,
    headers: Vec<String>,
    time: ChannelColumn,
    speed: ChannelColumn,
    lead_gap: Option<ChannelColumn>,
    step_s: f64,
    max_gap_s: f64,
    last_s: Option<f64>,
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
            step_s,
            max_gap_s,
            last_s: None,
        })
    }

    /// The next row, as soon as its line has ended; `None` at the end of the input.
    ///
    /// # Errors
    /// An [`Error`] that names the line of a row that cannot be read or does not follow in time.
    pub fn next_row(&mut self) -> Result<Option<Row>, Error> {
        let Some(text) = self.lines.next()? else {
            return Ok(None);
        };
        let (path, line) = (&self.lines.path, self.lines.line);
        let row = checked_fields(path, self.delimiter, self.headers.len(), line, &text)?;
        let mut value = |column: ChannelColumn| {
            let text = row[column.column];
            let number = cell(text, &mut self.decimal_comma).ok_or_else(|| Error::Cell {
                path: path.clone(),
                line,
                header: self.headers[column.column].clone(),
                text: text.chars().take(60).collect(),
            })?;
            let mut si = [number];
            column.unit.convert(&mut si, column.sign);
            Ok(si[0])
        };
        let [time_s, speed_mps] = [value(self.time)?, value(self.speed)?];
        let lead_gap_m = self.lead_gap.map_or(Ok(f64::NAN), value)?;
        for (column, value) in [(self.time, time_s), (self.speed, speed_mps)] {
            if value.is_nan() {
                return Err(Error::NoValue {
                    path: path.clone(),
                    line,
                    header: self.headers[column.column].clone(),
                });
            }
        }
        Ok(Some(Row {
            time_s,
            speed_mps,
            lead_gap_m,
            starts_piece: self.starts_piece(time_s)?,
        }))
    }

    fn starts_piece(&mut self, time_s: f64) -> Result<bool, Error> {
        let Some(last_s) = self.last_s.replace(time_s) else {
            return Ok(true);
        };
        let found_s = time_s - last_s;
        if (found_s - self.step_s).abs() <= STEP_TOLERANCE * self.step_s {
            Ok(false)
        } else if found_s > self.max_gap_s {
            Ok(true)
        } else {
            Err(Error::IrregularStep {
                path: self.lines.path.clone(),
                line: self.lines.line,
                time_s,
                found_s,
                step_s: self.step_s,
            })
        }
    }
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
mod tests {
    use super::*;

    fn rows(text: &str) -> Result<Vec<Row>, Error> {
        let mut reader = RowReader::new(Path::new("stdin"), text.as_bytes(), 0.1, 2.0)?;
        let mut rows = Vec::new();
        while let Some(row) = reader.next_row()? {
            rows.push(row);
        }
        Ok(rows)
    }

    #[test]
    fn every_delimiter_and_decimal_mark_reads_alike() {
        let expected = rows("time_s,speed_kmh,lead_gap_m\n0,36,\n0.1,36.36,12.5\n").unwrap();
        assert_eq!(expected.len(), 2);
        assert_eq!(
            (expected[0].speed_mps, expected[0].starts_piece),
            (10.0, true)
        );
        assert!(expected[0].lead_gap_m.is_nan());
        assert_eq!(
            (expected[1].lead_gap_m, expected[1].starts_piece),
            (12.5, false)
        );
        for text in [
            "\u{feff}time_s;speed_kmh;lead_gap_m\r\n0;36;\r\n\r\n0,1;36,36;12,5",
            "LEAD_GAP_M\tx\tv\tt\n\t?\t10\t0\n12.5\t\t10.1\t0.1\n",
        ] {
            for (row, expected) in rows(text).unwrap().iter().zip(&expected) {
                assert_eq!(
                    (row.time_s, row.speed_mps),
                    (expected.time_s, expected.speed_mps)
                );
            }
        }
    }

    #[test]
    fn a_gap_starts_a_piece_and_jitter_is_taken() {
        let rows = rows("t,v\n0,1\n0.109,1\n0.2,1\n5,1\n5.1,1\n").unwrap();
        let starts: Vec<bool> = rows.iter().map(|row| row.starts_piece).collect();
        assert_eq!(starts, [true, false, false, true, false]);
    }

    #[test]
    fn errors_name_the_line() {
        for (text, words) in [
            ("", "empty"),
            ("\n \n", "empty"),
            ("speed_kmh,x\n1,2\n", "time"),
            ("0,1\n0.1,1\n", "speed"),
            ("time_s,speed_furlong\n0,1\n", "speed_furlong"),
            ("t,v\n0,1\n\n0.1,fast\n", "line 4"),
            ("t,v\n0,1\n0.1\n", "line 3"),
            ("t,v\n0,1\n0.1,\n", "line 3"),
            ("t,v\n0,1\n0.3,1\n", "line 3"),
            ("t,v\n0,1\n-0.1,1\n", "line 3"),
            ("t,v\n0,1\n0,1\n", "line 3"),
            ("t;v\n0;1,5\n0,1;1.5\n", "line 3"),
        ] {
            let error = rows(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text:?}: {error}");
        }
        let long = format!("t,v\n0,1{}\n", " ".repeat(1 << 20));
        assert!(rows(&long).unwrap_err().to_string().contains("line 2"));
    }
}

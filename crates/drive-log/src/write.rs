//! From drives to files.

use std::io::Write;

use parquet_table::{Column, Values};

use crate::{DriveLog, Error};

/// Writes a drive as CSV with canonical headers, `time_s` first, in the shortest digits that read
/// back exactly; missing values are empty, and times are rounded to nanoseconds.
///
/// # Errors
/// [`Error::Write`] if `out` fails.
pub fn write_csv(log: &DriveLog, mut out: impl Write) -> Result<(), Error> {
    let mut line = String::from("time_s");
    for (channel, _) in log.channels() {
        line.push(',');
        line.push_str(channel.name());
    }
    let channels: Vec<&[f64]> = log.channels().map(|(_, values)| values).collect();
    let mut write = |line: &str| {
        writeln!(out, "{line}").map_err(|problem| Error::Write {
            log: log.name().to_owned(),
            problem,
        })
    };
    write(&line)?;
    for i in 0..log.len() {
        line.clear();
        line.push_str(&((log.time_s(i) * 1e9).round() / 1e9).to_string());
        for values in &channels {
            line.push(',');
            if !values[i].is_nan() {
                line.push_str(&values[i].to_string());
            }
        }
        write(&line)?;
    }
    Ok(())
}

/// Writes a drive as Parquet with canonical column names, `time_s` first; missing values are null.
///
/// # Errors
/// [`Error::Encode`] if the drive cannot be encoded or `out` fails.
pub fn write_parquet(log: &DriveLog, out: impl Write) -> Result<(), Error> {
    let time_s = (0..log.len()).map(|i| log.time_s(i)).collect();
    let mut columns = vec![Column::new("time_s", Values::Float(time_s))];
    let channels = log.channels();
    columns.extend(
        channels
            .map(|(channel, values)| Column::new(channel.name(), Values::Float(values.to_vec()))),
    );
    parquet_table::write(&columns, &[], out).map_err(|e| Error::Encode {
        log: log.name().to_owned(),
        problem: e.to_string(),
    })
}

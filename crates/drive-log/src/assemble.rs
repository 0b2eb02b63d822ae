//! Builds the logs of a file from its columns.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::columns::Wanted;
use crate::header::normalised;
use crate::note::Note;
use crate::number::number;
use crate::origin::{self, DriveRows};
use crate::plan::{LogPlan, Plan, TimeColumns};
use crate::quality::time::MAX_LATE;
use crate::source::{Reading, Source, seconds};
use crate::{Action, Channel, Error, FindingKind, RawLog};

/// Carries out a plan: reads every column once and builds the logs from them.
pub(crate) fn logs(
    path: &Path,
    source: &Source<'_>,
    plan: &Plan,
    mut notes: Vec<Note>,
) -> Result<Vec<RawLog>, Error> {
    let (drives, divided) = drives(path, source, plan)?;
    notes.extend(divided);
    let (reading, read_as) = Reading::of(path, source, plan)?;
    notes.extend(read_as);
    let columns = wanted(plan, &reading);
    let (mut values, words) = source.numbers(path, &columns, &plan.missing)?;
    remove_codes(&columns, &mut values, &plan.missing);
    notes.extend(words);
    let indices = columns.iter().map(|wanted| wanted.column);
    let file = File {
        path,
        header: time_header(source, plan),
        reading,
        values: indices.zip(values).collect(),
    };
    let samples = file.values.values().map(Vec::len).max().unwrap_or(0);
    finished(path, source, samples, file.logs(plan, &drives, &notes)?)
}

/// The drives of a file, by the columns that divide it.
fn drives(
    path: &Path,
    source: &Source<'_>,
    plan: &Plan,
) -> Result<(Vec<DriveRows>, Vec<Note>), Error> {
    let headers = &source.head().headers;
    let named = || origin::columns(headers);
    let mut columns = plan.split_by.clone().unwrap_or_else(named);
    if plan.split_by.is_none() {
        columns.retain(|column| !is_used(plan, *column));
    }
    let mut kinds = Vec::new();
    for column in columns {
        kinds.push((headers[column].clone(), source.kinds(path, column)?));
    }
    Ok(origin::divided(kinds, plan.split_by.is_some()))
}

/// The value that a column has throughout each log, by the names of the logs.
pub(crate) fn constants(
    path: &Path,
    source: &Source<'_>,
    plan: &Plan,
    header: &str,
) -> Result<BTreeMap<String, String>, Error> {
    let wanted = normalised(header);
    let mut headers = source.head().headers.iter();
    let Some(column) = headers.position(|header| normalised(header) == wanted) else {
        return Ok(BTreeMap::new());
    };
    let kinds = source.kinds(path, column)?;
    let mut constants = BTreeMap::new();
    for drive in drives(path, source, plan)?.0 {
        if let Some(value) = kinds.only(drive.rows.as_deref()) {
            let names = plan.logs.iter().map(|log| log_name(path, log, &drive));
            constants.extend(names.map(|name| (name, value.to_owned())));
        }
    }
    Ok(constants)
}

/// The file's name, and after `#` what tells several logs of it apart.
fn log_name(path: &Path, plan: &LogPlan, drive: &DriveRows) -> String {
    let parts: Vec<&str> = [&plan.part, &drive.part]
        .into_iter()
        .filter_map(Option::as_deref)
        .collect();
    if parts.is_empty() {
        return stem(path);
    }
    format!("{}#{}", stem(path), parts.join(","))
}

fn is_used(plan: &Plan, column: usize) -> bool {
    let mut channels = plan.logs.iter().flat_map(|log| &log.columns);
    channels.any(|c| c.column == column)
}

/// Every column of numbers once. One that is the speed of a log is read as such.
fn wanted(plan: &Plan, reading: &Reading) -> Vec<Wanted> {
    let channels = plan.logs.iter().flat_map(|log| &log.columns);
    let mut wanted: Vec<Wanted> = channels
        .map(|c| Wanted {
            column: c.column,
            unit: c.unit,
            channel: Some(c.channel),
        })
        .chain(reading.wanted())
        .collect();
    wanted.sort_by_key(|w| (w.column, w.channel));
    wanted.dedup_by_key(|w| w.column);
    wanted
}

/// Takes out numbers that the layout calls missing, `-99` say.
fn remove_codes(columns: &[Wanted], values: &mut [Vec<f64>], missing: &[String]) {
    let codes: Vec<f64> = missing.iter().filter_map(|word| number(word)).collect();
    if codes.is_empty() {
        return;
    }
    for (wanted, values) in columns.iter().zip(values) {
        if wanted.channel.is_some() {
            let coded = values.iter_mut().filter(|value| codes.contains(value));
            coded.for_each(|value| *value = f64::NAN);
        }
    }
}

fn time_header(source: &Source<'_>, plan: &Plan) -> String {
    let headers = &source.head().headers;
    match plan.time {
        TimeColumns::Number { column, .. } | TimeColumns::Open { column } => {
            headers[column].clone()
        }
        TimeColumns::DateAndClock { date, clock } => {
            format!("{} {}", headers[date], headers[clock])
        }
    }
}

/// What was read of a file.
struct File<'a> {
    path: &'a Path,
    header: String,
    reading: Reading,
    values: BTreeMap<usize, Vec<f64>>,
}

impl File<'_> {
    /// The logs, and the names of those without any speed.
    fn logs(
        &self,
        plan: &Plan,
        drives: &[DriveRows],
        notes: &[Note],
    ) -> Result<(Vec<RawLog>, Vec<String>), Error> {
        let (mut logs, mut without_speed) = (Vec::new(), Vec::new());
        for drive in drives {
            let rows = drive.rows.as_deref();
            let (time_s, of_time) = self.time_s(rows)?;
            check_direction(self.path, &self.header, &time_s)?;
            for log in &plan.logs {
                // a car that was not there, a cycle of another file; all of them is an error below
                let mut log = match self.raw_log(&time_s, log, drive) {
                    Err(Error::NoSpeed { log, .. }) => {
                        without_speed.push(log);
                        continue;
                    }
                    log => log?,
                };
                let notes = notes.iter().chain(&of_time);
                let findings = notes.filter_map(|note| note.finding(rows, log.time_s()));
                log.findings = findings.collect();
                logs.push(log);
            }
        }
        if plan.logs.len() > 1 {
            without_speed.clear();
        }
        Ok((logs, without_speed))
    }

    fn time_s(&self, rows: Option<&[usize]>) -> Result<(Vec<f64>, Vec<Note>), Error> {
        match &self.reading {
            Reading::Clock(clock) => clock.seconds(self.path, rows),
            Reading::Numbers { column, unit } => {
                let values = selected(self.values.get(column), rows);
                let (time_s, note) = seconds(self.path, &self.header, *unit, values)?;
                Ok((time_s, note.into_iter().collect()))
            }
        }
    }

    fn raw_log(&self, time_s: &[f64], plan: &LogPlan, drive: &DriveRows) -> Result<RawLog, Error> {
        let mut channels = BTreeMap::new();
        let mut len = 0;
        for column in &plan.columns {
            let mut si = selected(self.values.get(&column.column), drive.rows.as_deref());
            column.unit.convert(&mut si, column.sign);
            len = len.max(
                si.iter()
                    .rposition(|v| !v.is_nan())
                    .map_or(0, |last| last + 1),
            );
            channels.insert(column.channel, si);
        }
        if plan.part.is_none() {
            len = time_s.len();
        }
        // where a file holds several logs, one may end before the others
        channels
            .values_mut()
            .for_each(|values| values.truncate(len));
        let name = log_name(self.path, plan, drive);
        let mut log = RawLog::new(name, time_s[..len].to_vec(), channels)?;
        log.origin = drive.origin.clone();
        Ok(log)
    }
}

fn selected(values: Option<&Vec<f64>>, rows: Option<&[usize]>) -> Vec<f64> {
    let values = values.map_or(&[][..], Vec::as_slice);
    match rows {
        None => values.to_vec(),
        Some(rows) => rows.iter().map(|row| values[*row]).collect(),
    }
}

/// Says what the whole file tells: a cut end, and drives that are left out.
fn finished(
    path: &Path,
    source: &Source<'_>,
    samples: usize,
    (mut logs, without_speed): (Vec<RawLog>, Vec<String>),
) -> Result<Vec<RawLog>, Error> {
    if logs.is_empty() {
        return Err(Error::NoSpeed {
            log: path.display().to_string(),
            channel: Channel::Speed.name(),
            samples,
        });
    }
    for log in &mut logs {
        let cut_off = source.cut_off(log.time_s());
        log.findings.extend(cut_off);
    }
    if let (Some(first), false) = (logs.first_mut(), without_speed.is_empty()) {
        let detail = format!("left out for want of a speed: {}", without_speed.join(", "));
        let note = Note::of_file(FindingKind::NoSample, Action::Dropped, detail);
        let finding = note.finding(None, first.time_s());
        first.findings.extend(finding);
    }
    Ok(logs)
}

/// Time that runs backward throughout: sorting would make a drive of what is none.
fn check_direction(path: &Path, header: &str, time_s: &[f64]) -> Result<(), Error> {
    let steps = time_s.len().saturating_sub(1);
    let backward: Vec<f64> = time_s
        .windows(2)
        .filter(|pair| pair[1] < pair[0])
        .map(|pair| pair[1])
        .collect();
    let most = 2 * backward.len() > steps;
    let many = 5 * backward.len() > steps && 10 * far_behind(time_s) > steps;
    match backward.first() {
        Some(&at_s) if most || many => Err(Error::BackwardTime {
            path: path.to_owned(),
            header: header.to_owned(),
            backward: backward.len(),
            samples: time_s.len(),
            at_s,
        }),
        _ => Ok(()),
    }
}

/// Samples that are behind others which came more than a few samples before.
fn far_behind(time_s: &[f64]) -> usize {
    let mut latest_s = f64::NEG_INFINITY;
    let mut behind = 0;
    for (i, t_s) in time_s.iter().enumerate() {
        if let Some(before) = i.checked_sub(MAX_LATE + 1) {
            latest_s = latest_s.max(time_s[before]);
        }
        behind += usize::from(*t_s < latest_s);
    }
    behind
}

/// The file's name without its endings: `TripA01` of `TripA01.csv.gz`.
fn stem(path: &Path) -> String {
    let mut name = PathBuf::from(path.file_name().unwrap_or_default());
    for ending in ["gz", "zst", "csv", "txt", "tsv", "dat", "parquet"] {
        if name
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
        {
            name.set_extension("");
        }
    }
    name.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stem_has_no_endings() {
        for (path, name) in [
            ("a/TripA01.csv.gz", "TripA01"),
            ("D01.txt", "D01"),
            ("x.1.parquet", "x.1"),
            ("-", "-"),
            ("", ""),
        ] {
            assert_eq!(stem(Path::new(path)), name);
        }
    }
}

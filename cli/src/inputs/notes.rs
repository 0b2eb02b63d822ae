//! What stderr says about inputs.

use drive_log::SourcedDrive;
use drive_log::collection::{Beside, NoLog, Repeated};

use crate::flags::Context;
use crate::output;
use crate::words::plural;

/// Files that a note names; the document lists all.
const NAMED: usize = 5;

/// A line on files that are no logs.
pub(super) fn left_out(files: &[NoLog], context: &Context) {
    if !files.is_empty() {
        output::note(context, &format!("left out: {}", listed(files)));
    }
}

/// Lines for logs that were skipped or are there twice.
pub(super) fn beside(beside: &Beside, context: &Context) {
    for log in &beside.skipped {
        output::note(context, &format!("skipped: `{}`: {}", log.path, log.error));
    }
    twice(&beside.twice, context);
    if let Some(map) = &beside.limit_map {
        output::note(context, &map.to_string());
    }
}

/// A line for each of the first, and how many more there are.
pub(crate) fn twice(drives: &[Repeated], context: &Context) {
    for drive in drives.iter().take(NAMED) {
        output::note(context, &drive.to_string());
    }
    if drives.len() > NAMED {
        let more = drives.len() - NAMED;
        output::note(
            context,
            &format!("{more} more are there twice, which --format json lists"),
        );
    }
}

/// How many files are no logs, and the first of them with why.
pub(super) fn listed(files: &[NoLog]) -> String {
    let named = files.iter().take(NAMED);
    let mut names: Vec<String> = named.map(|f| format!("`{}` ({})", f.path, f.why)).collect();
    if files.len() > NAMED {
        let more = files.len() - NAMED;
        names.push(format!("{more} more, which --format json lists"));
    }
    let files = match files.len() {
        1 => "1 file that is no log".to_owned(),
        n => format!("{n} files that are no logs"),
    };
    format!("{files}: {}", names.join(", "))
}

pub(super) fn layouts(inputs: &[SourcedDrive], context: &Context) {
    for input in inputs {
        let (path, layout) = (&input.path, &input.layout);
        let samples = plural(input.drive.samples, "sample");
        output::detail(context, &format!("{path}: layout {layout}, {samples}"));
    }
}

pub(super) fn findings(inputs: &[SourcedDrive], context: &Context) {
    let found: usize = inputs.iter().map(|i| i.drive.findings.len()).sum();
    let logs = inputs
        .iter()
        .filter(|i| !i.drive.findings.is_empty())
        .count();
    if found > 0 {
        output::note(
            context,
            &format!(
                "{} in {logs} of {}; `drivekit inspect` lists them",
                plural(found, "finding"),
                plural(inputs.len(), "log")
            ),
        );
    }
}

//! From paths, folders, globs and stdin to prepared drives.

mod again;
pub(crate) mod files;
mod notes;
mod paths;
mod reading;

use std::collections::BTreeMap;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, bail};
use drive_log::{Drive, Finding, LayoutChoice, LogFile, Preparation};
use serde::Serialize;

use crate::drives::EMBEDDED;
use crate::exit::Outcome;
use crate::flags::{Context, LogArgs, OnError, ReadingArgs};
use crate::progress::Progress;
use paths::{Expanded, Named, expand};
use reading::in_order;

pub(crate) use again::Twice;

/// A prepared drive with where it came from.
pub(crate) struct Input {
    pub(crate) path: String,
    pub(crate) sha256: String,
    pub(crate) layout: String,
    pub(crate) drive: Drive,
}

/// An input as every JSON document lists it.
#[derive(Debug, Serialize)]
pub(crate) struct InputEntry<'a> {
    path: &'a str,
    name: &'a str,
    sha256: &'a str,
    layout: &'a str,
    /// Trip, vehicle and driver, where the file says them, by header.
    origin: &'a BTreeMap<String, String>,
    samples: usize,
    step_s: f64,
    findings: &'a [Finding],
}

/// The files that arguments of logs stand for.
pub(crate) fn files(arguments: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let files = expand(arguments)?.files.into_iter();
    Ok(files.map(|named| named.path).collect())
}

impl Input {
    pub(crate) fn entry(&self) -> InputEntry<'_> {
        InputEntry {
            path: &self.path,
            name: &self.drive.name,
            sha256: &self.sha256,
            layout: &self.layout,
            origin: &self.drive.origin,
            samples: self.drive.samples,
            step_s: self.drive.step_s,
            findings: &self.drive.findings,
        }
    }

    /// Which of the logs of its file it is, where there are several.
    fn part(&self) -> Option<&str> {
        self.drive.name.split_once('#').map(|(_, part)| part)
    }

    /// The file, with the log where there are several: `a/day.csv#trip=3`.
    pub(crate) fn place(&self) -> String {
        match self.part() {
            Some(part) => format!("{}#{part}", self.path),
            None => self.path.clone(),
        }
    }

    /// The same for messages.
    pub(crate) fn label(&self) -> String {
        match self.part() {
            Some(part) => format!("`{}`, {part}", self.path),
            None => format!("`{}`", self.path),
        }
    }
}

/// What was read, and what was not.
#[derive(Default)]
pub(crate) struct Inputs {
    drives: Vec<Input>,
    beside: Beside,
}

/// What the arguments name and the drives do not show, as every JSON document lists it.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Beside {
    /// Files of folders that are no logs.
    left_out: Vec<LeftOut>,
    /// Broken logs, with `--on-error skip`.
    skipped: Vec<Skipped>,
    /// Files and drives that were there already.
    twice: Vec<Twice>,
}

/// A file of a folder that is no log.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LeftOut {
    path: String,
    why: String,
}

/// A log that cannot be used.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Skipped {
    path: String,
    error: String,
}

impl Deref for Inputs {
    type Target = [Input];

    fn deref(&self) -> &[Input] {
        &self.drives
    }
}

impl Inputs {
    pub(crate) fn beside(&self) -> &Beside {
        &self.beside
    }

    /// The error, which says why only one drive is left where others are the same.
    pub(crate) fn explained(&self, error: anyhow::Error) -> anyhow::Error {
        match (&self.drives[..], self.beside.twice.len()) {
            ([one], again @ 1..) => anyhow!(
                "{error:#}; the other {} the same drive as {} and counted once",
                if again == 1 {
                    "log is".to_owned()
                } else {
                    format!("{again} logs are")
                },
                one.label()
            ),
            _ => error,
        }
    }

    /// Negative where a log was skipped.
    pub(crate) fn outcome(&self) -> Outcome {
        if self.beside.skipped.is_empty() {
            Outcome::Done
        } else {
            Outcome::Negative
        }
    }
}

impl Beside {
    /// With what was beside other logs, those of other drivers for example.
    pub(crate) fn with(mut self, other: &Self) -> Self {
        self.left_out.extend_from_slice(&other.left_out);
        self.skipped.extend_from_slice(&other.skipped);
        self.twice.extend_from_slice(&other.twice);
        self
    }
}

/// As [`load_quietly`], with a note on how many findings there are.
pub(crate) fn load(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    let inputs = load_quietly(args, context)?;
    notes::findings(&inputs, context);
    Ok(inputs)
}

/// As [`load`], for what learns: a drive that is there twice, under whatever name, counts once.
pub(crate) fn load_once(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    let inputs = load(args, context)?;
    Ok(again::each_once(inputs, context))
}

/// As [`load_once`], without the drives that are among `own`.
pub(crate) fn load_others(
    args: &LogArgs,
    own: &[Input],
    context: &Context,
) -> anyhow::Result<Inputs> {
    let inputs = load_once(args, context)?;
    Ok(again::without(inputs, own, context))
}

/// Reads, checks and prepares all logs, in parallel over files; several logs of one file stay in its order.
pub(crate) fn load_quietly(args: &LogArgs, context: &Context) -> anyhow::Result<Inputs> {
    if args.logs.is_empty() {
        bail!("no logs given; name files, folders or globs, or `-` for stdin");
    }
    let Expanded {
        files,
        left_out,
        twice,
    } = expand(&args.logs)?;
    let layout = args.reading.layout()?;
    let preparation = args.reading.preparation();
    let progress = Progress::new(context, "reading", files.len());
    let read = in_order(&files, |file| {
        let logs = load_file(&file.path, &layout, &preparation);
        progress.step();
        logs
    })?;
    drop(progress);
    let mut sorted = Sorted::new(left_out, twice);
    for (file, logs) in files.iter().zip(read) {
        sorted.add(file, logs);
    }
    notes::left_out(&sorted.inputs.beside.left_out, context);
    let inputs = sorted.inputs(args.reading.on_error)?;
    notes::beside(&inputs.beside, context);
    notes::layouts(&inputs, context);
    Ok(inputs)
}

/// The drives inside the binary.
pub(crate) fn load_embedded(args: &ReadingArgs, context: &Context) -> anyhow::Result<Inputs> {
    let preparation = args.preparation();
    let read = in_order(&EMBEDDED, |drive| {
        let file = drive_log::read_bytes(drive.path(), drive.bytes(), &LayoutChoice::Auto)?;
        prepare(file, &preparation).into_iter().collect()
    })?;
    let drives: Vec<Vec<Input>> = read.into_iter().collect::<anyhow::Result<_>>()?;
    let inputs = Inputs {
        drives: drives.into_iter().flatten().collect(),
        beside: Beside::default(),
    };
    notes::findings(&inputs, context);
    Ok(inputs)
}

/// The logs of a file, each prepared or not; or why there are none.
fn load_file(
    path: &Path,
    layout: &LayoutChoice,
    preparation: &Preparation,
) -> anyhow::Result<Vec<anyhow::Result<Input>>> {
    let file = if path == Path::new("-") {
        drive_log::read_from(Path::new("stdin"), std::io::stdin().lock(), layout)?
    } else {
        drive_log::read_file(path, layout)?
    };
    Ok(prepare(file, preparation))
}

fn prepare(file: LogFile, preparation: &Preparation) -> Vec<anyhow::Result<Input>> {
    let path = file.path.display().to_string();
    file.logs
        .into_iter()
        .map(|log| {
            let drive =
                drive_log::prepare(log, preparation).with_context(|| format!("`{path}`"))?;
            Ok(Input {
                path: path.clone(),
                sha256: file.sha256.clone(),
                layout: file.layout.clone(),
                drive,
            })
        })
        .collect()
}

/// Drives, files that are no logs, and logs that are broken.
struct Sorted {
    inputs: Inputs,
    broken: Vec<(String, anyhow::Error)>,
}

impl Sorted {
    fn new(left_out: Vec<LeftOut>, twice: Vec<Twice>) -> Self {
        Self {
            inputs: Inputs {
                drives: Vec::new(),
                beside: Beside {
                    left_out,
                    skipped: Vec::new(),
                    twice,
                },
            },
            broken: Vec::new(),
        }
    }

    fn add(&mut self, file: &Named, logs: anyhow::Result<Vec<anyhow::Result<Input>>>) {
        let path = file.path.display().to_string();
        match logs {
            Ok(logs) => {
                for log in logs {
                    match log {
                        Ok(input) => self.inputs.drives.push(input),
                        Err(error) => self.broken.push((path.clone(), error)),
                    }
                }
            }
            Err(error) if file.folder.is_some() && is_no_log(&error) => {
                let what_and_cure = without_path(&error, &path);
                let what = what_and_cure.split(';').next();
                let why = what.unwrap_or(&what_and_cure).to_owned();
                self.inputs.beside.left_out.push(LeftOut { path, why });
            }
            Err(error) => self.broken.push((path, error)),
        }
    }

    fn inputs(mut self, on_error: OnError) -> anyhow::Result<Inputs> {
        if self.inputs.drives.is_empty() || on_error == OnError::Stop {
            self.stop_at_errors()?;
        }
        let skipped = self.broken.into_iter().map(|(path, error)| Skipped {
            error: without_path(&error, &path),
            path,
        });
        self.inputs.beside.skipped = skipped.collect();
        Ok(self.inputs)
    }

    /// One broken log of a folder is an error, and the message names all of them.
    fn stop_at_errors(&mut self) -> anyhow::Result<()> {
        let others = match self.inputs.drives.len() {
            0 => String::new(),
            1 => "; --on-error skip goes on with the other log".to_owned(),
            n => format!("; --on-error skip goes on with the other {n} logs"),
        };
        match self.broken.len() {
            0 if self.inputs.drives.is_empty() => {
                bail!(
                    "no logs but {}",
                    notes::listed(&self.inputs.beside.left_out)
                )
            }
            0 => Ok(()),
            1 if others.is_empty() => Err(self.broken.remove(0).1),
            1 => Err(anyhow!("{:#}{others}", self.broken[0].1)),
            n => {
                let list: Vec<String> = self
                    .broken
                    .iter()
                    .map(|(_, e)| format!("\n  {e:#}"))
                    .collect();
                bail!("{n} logs cannot be used{others}:{}", list.concat())
            }
        }
    }
}

fn is_no_log(error: &anyhow::Error) -> bool {
    error
        .downcast_ref::<drive_log::Error>()
        .is_some_and(drive_log::Error::is_no_log)
}

/// What is wrong, where the path is said already.
fn without_path(error: &anyhow::Error, path: &str) -> String {
    let text = format!("{error:#}");
    let rest = [format!("{path}: "), format!("`{path}`: ")]
        .iter()
        .find_map(|prefix| text.strip_prefix(prefix).map(str::to_owned));
    rest.unwrap_or(text)
}

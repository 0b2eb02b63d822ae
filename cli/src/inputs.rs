//! From paths, folders, globs and stdin to prepared drives.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use drive_log::{Drive, Finding, LayoutChoice, LogFile, Preparation};
use rayon::prelude::*;
use serde::Serialize;

use crate::drives::EMBEDDED;
use crate::flags::{Context, LogArgs, ReadingArgs};
use crate::output;
use crate::progress::Progress;
use crate::words::plural;

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
}

/// As [`load_quietly`], with a note on how many findings there are.
pub(crate) fn load(args: &LogArgs, context: &Context) -> anyhow::Result<Vec<Input>> {
    let inputs = load_quietly(args, context)?;
    mention_findings(&inputs, context);
    Ok(inputs)
}

/// Reads, checks and prepares all logs, in parallel over files; several logs of one file stay in its order.
pub(crate) fn load_quietly(args: &LogArgs, context: &Context) -> anyhow::Result<Vec<Input>> {
    if args.logs.is_empty() {
        bail!("no logs given; name files, folders or globs, or `-` for stdin");
    }
    let paths = expand(&args.logs)?;
    let layout = args.reading.layout()?;
    let preparation = args.reading.preparation();
    let progress = Progress::new(context, "reading", paths.len());
    let inputs = paths
        .par_iter()
        .map(|path| {
            let inputs = load_file(path, &layout, &preparation);
            progress.step();
            inputs
        })
        .collect::<Vec<_>>();
    drop(progress);
    let inputs = all_or_every_error(inputs)?;
    for input in &inputs {
        output::detail(
            context,
            &format!(
                "{}: layout {}, {}",
                input.path,
                input.layout,
                plural(input.drive.samples, "sample")
            ),
        );
    }
    Ok(inputs)
}

/// The drives inside the binary.
pub(crate) fn load_embedded(args: &ReadingArgs, context: &Context) -> anyhow::Result<Vec<Input>> {
    let preparation = args.preparation();
    let inputs = EMBEDDED
        .par_iter()
        .map(|drive| {
            let file = drive_log::read_bytes(drive.path(), drive.bytes(), &LayoutChoice::Auto)?;
            prepare(file, &preparation)
        })
        .collect::<Vec<_>>();
    let inputs = all_or_every_error(inputs)?;
    mention_findings(&inputs, context);
    Ok(inputs)
}

fn load_file(
    path: &Path,
    layout: &LayoutChoice,
    preparation: &Preparation,
) -> anyhow::Result<Vec<Input>> {
    let file = if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin()
            .read_to_end(&mut bytes)
            .context("cannot read stdin")?;
        drive_log::read_bytes(Path::new("stdin"), &bytes, layout)?
    } else {
        drive_log::read_file(path, layout)?
    };
    prepare(file, preparation)
}

fn prepare(file: LogFile, preparation: &Preparation) -> anyhow::Result<Vec<Input>> {
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

/// One bad file in a folder is an error, and the message names all of them.
fn all_or_every_error(results: Vec<anyhow::Result<Vec<Input>>>) -> anyhow::Result<Vec<Input>> {
    let mut inputs = Vec::new();
    let mut errors = Vec::new();
    for result in results {
        match result {
            Ok(of_file) => inputs.extend(of_file),
            Err(error) => errors.push(error),
        }
    }
    match errors.len() {
        0 => Ok(inputs),
        1 => Err(errors.remove(0)),
        n => {
            let list: Vec<String> = errors.iter().map(|e| format!("\n  {e:#}")).collect();
            bail!("{n} logs cannot be used:{}", list.concat())
        }
    }
}

fn mention_findings(inputs: &[Input], context: &Context) {
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

const LOG_SUFFIXES: [&str; 4] = ["csv", "tsv", "txt", "parquet"];
const COMPRESSION_SUFFIXES: [&str; 2] = ["gz", "zst"];

/// Files stay in the order given; a folder's and a glob's come sorted by name.
pub(crate) fn expand(arguments: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for argument in arguments {
        if argument.is_dir() {
            paths.extend(logs_in(argument)?);
        } else if argument == Path::new("-") || argument.exists() {
            paths.push(argument.clone());
        } else {
            paths.extend(matching(argument)?);
        }
    }
    Ok(paths)
}

fn logs_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let failed = || format!("cannot list the folder `{}`", folder.display());
    let mut logs = Vec::new();
    for entry in folder.read_dir().with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        if path.is_file() && looks_like_a_log(&path) {
            logs.push(path);
        }
    }
    if logs.is_empty() {
        bail!(
            "no logs in the folder `{}`; looked for files ending in .{}, also with .gz or .zst",
            folder.display(),
            LOG_SUFFIXES.join(", .")
        );
    }
    logs.sort();
    Ok(logs)
}

fn looks_like_a_log(path: &Path) -> bool {
    let suffix = |path: &Path| {
        path.extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default()
    };
    let last = suffix(path);
    if COMPRESSION_SUFFIXES.contains(&last.as_str()) {
        let stem = path.file_stem().map(Path::new);
        return stem.is_some_and(|stem| LOG_SUFFIXES.contains(&suffix(stem).as_str()));
    }
    LOG_SUFFIXES.contains(&last.as_str())
}

fn matching(pattern: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let text = pattern.to_string_lossy();
    let mut paths = Vec::new();
    for path in
        glob::glob(&text).with_context(|| format!("`{text}` is neither a file nor a glob"))?
    {
        let path = path?;
        if path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        bail!("no such file, folder or match: `{text}`");
    }
    paths.sort();
    Ok(paths)
}

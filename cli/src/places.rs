//! Where a command is asked to write, checked before any work is done.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{Arg, ArgMatches, Command};

use crate::inputs;
use crate::output::check_file_place;
use crate::target::{folder_of, is_stream, resolved};

/// Flags that name a file to write; the others name what is read.
const OUTPUTS: [&str; 4] = ["output", "report", "plot", "trace"];

/// A file that an output may replace, with what is in it and more.
const REPLACED: &str = "update";

/// Flags whose folders and globs stand for the logs in them.
const LOGS: [&str; 3] = ["logs", "prior", "fleet"];

/// Refuses outputs that cannot be written, that are of another format than their name says, that are two in one file, or that
/// are one of the inputs.
pub(crate) fn check(command: &Command, matches: &ArgMatches) -> anyhow::Result<()> {
    let (command, matches) = leaf(command, matches);
    let mut outputs: Vec<Output<'_>> = Vec::new();
    for arg in command.get_arguments().filter(|arg| is_file(arg)) {
        for path in values(arg, matches) {
            let output = Output::new(arg, path)?;
            if let Some(other) = outputs.iter().find(|other| other.is(&output)) {
                bail!(
                    "{} and {} are one file, `{}`; name two",
                    other.flag(),
                    output.flag(),
                    path.display()
                );
            }
            outputs.push(output);
        }
    }
    outputs.retain(|output| output.identity.is_some());
    if outputs.is_empty() {
        return Ok(());
    }
    let is_read = |arg: &&Arg| !is_output(arg) && arg.get_id() != REPLACED;
    for arg in command.get_arguments().filter(is_read) {
        for input in read(arg, matches) {
            refuse_input(&outputs, &input)?;
        }
    }
    Ok(())
}

/// The same of a file that is written without a flag of its own, or read.
pub(crate) fn refuse_overwriting(flag: &str, output: &Path, input: &Path) -> anyhow::Result<()> {
    let written = Identity::of(&resolved(output)?);
    if written.is_none() || written != Identity::of(input) {
        return Ok(());
    }
    bail!(
        "{flag} would write `{}`, an input; name another file",
        output.display()
    )
}

/// The subcommand that runs.
fn leaf<'a>(
    mut command: &'a Command,
    mut matches: &'a ArgMatches,
) -> (&'a Command, &'a ArgMatches) {
    while let Some((name, below)) = matches.subcommand() {
        let Some(found) = command.find_subcommand(name) else {
            break;
        };
        (command, matches) = (found, below);
    }
    (command, matches)
}

fn is_output(arg: &Arg) -> bool {
    OUTPUTS.contains(&arg.get_id().as_str())
}

/// An output that is a file, not a folder.
fn is_file(arg: &Arg) -> bool {
    is_output(arg) && shape(arg).is_some_and(|shape| shape.starts_with("FILE"))
}

/// `FILE.svg` of `--plot FILE.svg`.
fn shape(arg: &Arg) -> Option<&str> {
    let names = arg.get_value_names()?;
    names.first().map(clap::builder::Str::as_str)
}

fn values<'a>(arg: &Arg, matches: &'a ArgMatches) -> impl Iterator<Item = &'a Path> {
    let given = matches.try_get_raw(arg.get_id().as_str());
    let given = given.ok().flatten().into_iter().flatten();
    given.map(Path::new)
}

/// The files that a flag has the command read.
fn read(arg: &Arg, matches: &ArgMatches) -> Vec<PathBuf> {
    let given: Vec<PathBuf> = values(arg, matches).map(Path::to_owned).collect();
    if LOGS.contains(&arg.get_id().as_str()) {
        // What cannot be found is said when it is read.
        return inputs::files(&given).unwrap_or(given);
    }
    given
}

fn refuse_input(outputs: &[Output<'_>], input: &Path) -> anyhow::Result<()> {
    let is_stdin = input == Path::new("-");
    let input = if is_stdin {
        Path::new("/dev/stdin")
    } else {
        input
    };
    let Some(identity) = Identity::of(input) else {
        return Ok(());
    };
    let same = outputs
        .iter()
        .find(|output| output.identity.as_ref() == Some(&identity));
    let Some(output) = same else {
        return Ok(());
    };
    bail!(
        "{} `{}` would overwrite an input, `{}`; name another file (of a pattern after the flag, the shell makes many words)",
        output.flag(),
        output.path.display(),
        input.display()
    )
}

struct Output<'a> {
    arg: &'a Arg,
    path: &'a Path,
    target: PathBuf,
    /// Of a file that is there
    identity: Option<Identity>,
}

impl<'a> Output<'a> {
    fn new(arg: &'a Arg, path: &'a Path) -> anyhow::Result<Self> {
        if is_stream(path) {
            return Ok(Self {
                arg,
                path,
                target: path.to_owned(),
                identity: None,
            });
        }
        check_file_place(path)?;
        check_format(arg, path)?;
        let target = resolved(path)?;
        let identity = Identity::of(&target);
        if identity.is_some() && identity == Identity::of(Path::new("/dev/stdout")) {
            bail!(
                "{} and stdout are one file, `{}`; name another",
                flag(arg),
                path.display()
            );
        }
        Ok(Self {
            arg,
            path,
            target,
            identity,
        })
    }

    fn flag(&self) -> String {
        flag(self.arg)
    }

    fn is(&self, other: &Self) -> bool {
        if is_stream(self.path) || is_stream(other.path) {
            return false;
        }
        let is_same_file = self.identity.is_some() && self.identity == other.identity;
        is_same_file || absolute(&self.target) == absolute(&other.target)
    }
}

fn flag(arg: &Arg) -> String {
    arg.get_long()
        .map_or_else(|| arg.to_string(), |long| format!("--{long}"))
}

/// With the links in its folder followed.
fn absolute(path: &Path) -> PathBuf {
    let folder = fs::canonicalize(folder_of(path)).unwrap_or_default();
    path.file_name()
        .map_or(folder.clone(), |name| folder.join(name))
}

/// The name of a file decides its format; what the flag cannot write is refused.
fn check_format(arg: &Arg, path: &Path) -> anyhow::Result<()> {
    let Some(formats) = shape(arg).and_then(|shape| shape.strip_prefix("FILE.")) else {
        return Ok(());
    };
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    if formats
        .split('|')
        .any(|format| extension.as_deref() == Some(format))
    {
        return Ok(());
    }
    bail!(
        "{} writes .{}, and not `{}`; end its name in .{}",
        flag(arg),
        formats.replace('|', ", ."),
        path.display(),
        formats.replace('|', " or .")
    )
}

/// What makes two paths one file, hard links too.
#[derive(Debug, PartialEq)]
struct Identity {
    #[cfg(unix)]
    device_and_inode: (u64, u64),
    #[cfg(not(unix))]
    path: PathBuf,
}

impl Identity {
    /// Of a file; none of folders, devices and what is not there.
    fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok().filter(Metadata::is_file)?;
        Self::of_found(path, &found)
    }

    #[cfg(unix)]
    fn of_found(_: &Path, found: &Metadata) -> Option<Self> {
        use std::os::unix::fs::MetadataExt as _;
        let device_and_inode = (found.dev(), found.ino());
        Some(Self { device_and_inode })
    }

    #[cfg(not(unix))]
    fn of_found(path: &Path, _: &Metadata) -> Option<Self> {
        let path = fs::canonicalize(path).ok()?;
        Some(Self { path })
    }
}

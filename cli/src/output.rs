//! Data to stdout, talk to stderr, files beside and renamed.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::Serialize;

use crate::flags::Context;
use crate::target::{folder_of, is_stream, resolved};
use crate::temporary::Temporary;

/// Whether someone still reads stdout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reader {
    There,
    Gone,
}

/// Prints one JSON document.
pub(crate) fn print_json(document: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(document)?;
    print_text(&format!("{text}\n"))
}

/// Prints text; colours are stripped where stdout is not a terminal. A reader that has seen enough, such as `head`, changes
/// nothing else of what is done and of how it ends.
pub(crate) fn print_text(text: &str) -> anyhow::Result<()> {
    print_to_reader(text).map(|_| ())
}

/// The same, for who prints as long as someone reads.
pub(crate) fn print_to_reader(text: &str) -> anyhow::Result<Reader> {
    let mut stdout = anstream::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Ok(()) => Ok(Reader::There),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(Reader::Gone),
        Err(error) => Err(error).context("cannot write to stdout"),
    }
}

/// Writes a page and says where.
pub(crate) fn write_page(path: &Path, page: &str, context: &Context) -> anyhow::Result<()> {
    write_file(path, |out| Ok(out.write_all(page.as_bytes())?))?;
    note(context, &format!("report written to {}", path.display()));
    Ok(())
}

/// A remark on stderr, also with `--quiet`.
pub(crate) fn announce(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "\u{1b}[1mnote:\u{1b}[0m {text}");
}

/// A remark on stderr.
pub(crate) fn note(context: &Context, text: &str) {
    if !context.quiet {
        announce(text);
    }
}

/// A remark on stderr with `--verbose`.
pub(crate) fn detail(context: &Context, text: &str) {
    if context.verbose {
        note(context, text);
    }
}

/// Refuses an output path that cannot become a file, before any work is done for it.
pub(crate) fn check_file_place(path: &Path) -> anyhow::Result<()> {
    if path.is_dir() {
        bail!(
            "cannot write `{}`: it is a folder; name a file",
            path.display()
        );
    }
    let target = resolved(path)?;
    match folder_of(&target) {
        folder if folder.is_dir() => Ok(()),
        folder => bail!(
            "cannot write `{}`: no folder `{}`",
            path.display(),
            folder.display()
        ),
    }
}

/// Writes a file beside its place and renames it, so that a failure leaves what was there. A link stays and its target is
/// replaced, permissions are kept, and a device or a pipe is written to.
pub(crate) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let failed = || format!("cannot write `{}`", path.display());
    if is_stream(path) {
        return write_stream(path, write).with_context(failed);
    }
    check_file_place(path)?;
    let target = resolved(path)?;
    let mut file = Temporary::beside(&target).with_context(failed)?;
    buffered(file.as_file_mut(), write).with_context(failed)?;
    file.replace(&target).with_context(failed)
}

/// A reader that has seen enough is no error.
fn write_stream(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut stream = fs::OpenOptions::new().append(true).open(path)?;
    match buffered(&mut stream, write) {
        Err(error) if is_broken_pipe(&error) => Ok(()),
        written => written,
    }
}

fn buffered(
    file: &mut fs::File,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut buffered = std::io::BufWriter::new(file);
    write(&mut buffered)?;
    Ok(buffered.flush()?)
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
    })
}

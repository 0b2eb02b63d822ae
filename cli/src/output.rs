//! Data to stdout, talk to stderr, files beside and renamed.

use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::Serialize;

use crate::flags::Context;

/// Prints one JSON document.
pub(crate) fn print_json(document: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(document)?;
    print_text(&format!("{text}\n"))
}

/// Prints text; colours are stripped where stdout is not a terminal.
pub(crate) fn print_text(text: &str) -> anyhow::Result<()> {
    let mut stdout = anstream::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

/// A remark on stderr.
pub(crate) fn note(context: &Context, text: &str) {
    if !context.quiet {
        let _ = writeln!(anstream::stderr().lock(), "\u{1b}[1mnote:\u{1b}[0m {text}");
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
    match folder_of(path) {
        folder if folder.is_dir() => Ok(()),
        folder => bail!(
            "cannot write `{}`: no folder `{}`",
            path.display(),
            folder.display()
        ),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes a file beside its place and renames it, so that a failure leaves what was there.
pub(crate) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    check_file_place(path)?;
    let failed = || format!("cannot write `{}`", path.display());
    let mut file = readable_like_any_file(tempfile::Builder::new().prefix(".drivekit-"))
        .tempfile_in(folder_of(path))
        .with_context(failed)?;
    {
        let mut buffered = std::io::BufWriter::new(file.as_file_mut());
        write(&mut buffered).with_context(failed)?;
        buffered.flush().with_context(failed)?;
    }
    file.persist(path)
        .map_err(|e| e.error)
        .with_context(failed)?;
    Ok(())
}

/// Temporary files are readable by their owner alone; results follow the umask.
#[cfg(unix)]
fn readable_like_any_file<'a, 'p, 's>(
    builder: &'a mut tempfile::Builder<'p, 's>,
) -> &'a mut tempfile::Builder<'p, 's> {
    use std::os::unix::fs::PermissionsExt as _;
    builder.permissions(std::fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn readable_like_any_file<'a, 'p, 's>(
    builder: &'a mut tempfile::Builder<'p, 's>,
) -> &'a mut tempfile::Builder<'p, 's> {
    builder
}

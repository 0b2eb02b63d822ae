//! Files that are being written, and what becomes of them when a signal ends the program.

use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use tempfile::NamedTempFile;

use crate::target::folder_of;

/// Those that a signal has to remove.
static OPEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
static WATCH: Once = Once::new();

fn open() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Leaves the signals to who has another use for them.
pub(crate) fn leave_signals_alone() {
    WATCH.call_once(|| {});
}

/// A file beside the one that it is going to replace; removed unless it does.
pub(crate) struct Temporary {
    // Dropped first, so that no file is left that nobody knows of.
    file: NamedTempFile,
    _known: Known,
}

/// The path is in [`OPEN`].
struct Known(PathBuf);

impl Drop for Known {
    fn drop(&mut self) {
        open().remove(&self.0);
    }
}

impl Temporary {
    pub(crate) fn beside(target: &Path) -> io::Result<Self> {
        WATCH.call_once(watch_signals);
        let mut open = open();
        let file = readable_like_any_file(tempfile::Builder::new().prefix(".drivekit-"))
            .tempfile_in(folder_of(target))?;
        let path = file.path().to_owned();
        open.insert(path.clone());
        Ok(Self {
            file,
            _known: Known(path),
        })
    }

    pub(crate) fn as_file_mut(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Takes the place of the target, and its permissions.
    pub(crate) fn replace(self, target: &Path) -> io::Result<()> {
        if let Ok(replaced) = target.metadata() {
            self.file
                .as_file()
                .set_permissions(replaced.permissions())?;
        }
        self.file.persist(target).map_err(|error| error.error)?;
        Ok(())
    }
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

/// Signals that end the program remove the files first. Where it cannot be watched for them, files may be left.
#[cfg(unix)]
fn watch_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let watched = [SIGINT, SIGTERM, SIGHUP];
    let watched = watched.into_iter().filter(|signal| !is_ignored(*signal));
    let Ok(mut signals) = signal_hook::iterator::Signals::new(watched) else {
        return;
    };
    let end = move || {
        if let Some(signal) = signals.forever().next() {
            // Held to the end, so that no file is made any more.
            let open = open();
            for path in open.iter() {
                let _ = std::fs::remove_file(path);
            }
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    };
    let _ = std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(end);
}

#[cfg(not(unix))]
fn watch_signals() {}

/// Whether the program was started to ignore a signal, as `nohup` does; known where the system tells.
#[cfg(unix)]
pub(crate) fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

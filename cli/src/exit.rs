//! Exit codes: 0 done, 1 an honest negative, 2 an error.

use std::io::Write;
use std::process::ExitCode;

/// How a run that did not fail ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Everything asked for was done.
    Done,
    /// Done, but a threshold given by the user was missed, or a robot was unsafe.
    Negative,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::SUCCESS,
            Outcome::Negative => Self::from(1),
        }
    }
}

/// Turns a panic, which would be a bug of ours, into an error. Panics that a library catches itself, such as those of
/// a decoder on a damaged file, print nothing.
pub(crate) fn without_panic<T>(
    run: impl FnOnce() -> anyhow::Result<T> + std::panic::UnwindSafe,
) -> anyhow::Result<T> {
    std::panic::set_hook(Box::new(|_| {}));
    std::panic::catch_unwind(run).unwrap_or_else(|cause| {
        let what = cause
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| cause.downcast_ref::<&str>().copied());
        Err(anyhow::anyhow!(
            "a bug in drivekit, please report it: {}",
            what.unwrap_or("unknown panic")
        ))
    })
}

/// Prints an error with its causes to stderr. A reader that closed our stdout is not an error.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    if let Some(usage) = error.downcast_ref::<clap::Error>() {
        let _ = usage.print();
        return ExitCode::from(u8::try_from(usage.exit_code()).unwrap_or(2));
    }
    let broken_pipe = error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    });
    if broken_pipe {
        return ExitCode::SUCCESS;
    }
    let _ = writeln!(
        anstream::stderr().lock(),
        "\u{1b}[1;31merror:\u{1b}[0m {}",
        said(error)
    );
    ExitCode::from(2)
}

/// An error and its causes, but for those that are in what was said before.
fn said(error: &anyhow::Error) -> String {
    let mut said = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if said.is_empty() {
            said = cause;
        } else if !said.contains(&cause) {
            said.push_str(": ");
            said.push_str(&cause);
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::said;

    #[test]
    fn what_an_error_says_of_its_cause_is_not_said_twice() {
        let error = anyhow!("no such file")
            .context("a.csv: no such file")
            .context("replay");
        assert_eq!(said(&error), "replay: a.csv: no such file");
        let error = anyhow!("line 3").context("a.toml");
        assert_eq!(said(&error), "a.toml: line 3");
    }
}

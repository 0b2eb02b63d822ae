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

impl Outcome {
    /// Done only where both are.
    pub(crate) fn and(self, other: Self) -> Self {
        match self {
            Self::Done => other,
            Self::Negative => Self::Negative,
        }
    }
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

/// Prints an error with its causes to stderr.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    if let Some(usage) = error.downcast_ref::<clap::Error>() {
        let _ = usage.print();
        return ExitCode::from(u8::try_from(usage.exit_code()).unwrap_or(2));
    }
    let mut stderr = anstream::stderr().lock();
    let _ = writeln!(stderr, "\u{1b}[1;31merror:\u{1b}[0m {}", told(error));
    if let Some(help) = help(error) {
        let _ = writeln!(stderr, "\u{1b}[1mhelp:\u{1b}[0m {help}");
    }
    ExitCode::from(2)
}

const SHORTER_PHASES: &str = "see --min-duration and --min-gain";

/// The flags that belong to what a library reports.
fn help(error: &anyhow::Error) -> Option<String> {
    use driver_model::Error::{ScaleOfStream, Steps, TooFewPhases};
    let of_model = |error: &driver_model::Error| match error {
        TooFewPhases { .. } => Some(SHORTER_PHASES.to_owned()),
        ScaleOfStream => Some("such as --scale 10,0.5, or --scale none".to_owned()),
        Steps { expected_s, .. } => Some(format!("--step {expected_s} does that")),
        _ => None,
    };
    error.chain().find_map(|cause| {
        if cause.downcast_ref().is_some_and(is_refused) {
            return Some("--raw takes a uniform log as it is".to_owned());
        }
        match cause.downcast_ref() {
            Some(driver_eval::Error::Model(error)) => of_model(error),
            Some(driver_eval::Error::Nothing { .. }) => Some(SHORTER_PHASES.to_owned()),
            _ => cause.downcast_ref().and_then(of_model),
        }
    })
}

/// Whether a log, or one of several, is refused.
fn is_refused(error: &drive_log::Error) -> bool {
    match error {
        drive_log::Error::Refused { .. } => true,
        drive_log::Error::InFile { cause, .. } => is_refused(cause),
        drive_log::Error::Unusable { broken, .. } => broken.iter().any(is_refused),
        _ => false,
    }
}

/// An error with its causes, each said once: some messages tell their cause themselves.
pub(crate) fn told(error: &anyhow::Error) -> String {
    let causes = error.chain().map(ToString::to_string);
    causes.fold(String::new(), |told, cause| {
        if told.is_empty() {
            cause
        } else if told.contains(&cause) {
            told
        } else {
            format!("{told}: {cause}")
        }
    })
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::told;

    #[test]
    fn what_an_error_says_of_its_cause_is_not_said_twice() {
        let error = anyhow!("no such file")
            .context("a.csv: no such file")
            .context("replay");
        assert_eq!(told(&error), "replay: a.csv: no such file");
        let error = anyhow!("line 3").context("a.toml");
        assert_eq!(told(&error), "a.toml: line 3");
    }
}

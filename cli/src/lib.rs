//! The command line `drivekit`: driver models from recorded drives, what driving costs in energy, and safe controllers for robots.
//!
//! This is what the binaries `drivekit` and `ctrl` share; it is no library for others.

mod cli;
mod cmd;
mod config;
mod drives;
mod exit;
mod flags;
mod inputs;
mod listening;
mod names;
mod numbers;
mod output;
mod places;
mod progress;
mod render;
mod require;
mod target;
mod temporary;
mod words;

use std::ffi::OsString;
use std::process::ExitCode;

/// Runs `drivekit` with the arguments of the process.
#[must_use]
pub fn drivekit() -> ExitCode {
    ended(exit::without_panic(|| run(std::env::args_os().collect())))
}

/// Runs `ctrl …` as `drivekit ctrl …`.
#[must_use]
pub fn ctrl() -> ExitCode {
    ended(exit::without_panic(|| {
        let mut args: Vec<OsString> = std::env::args_os().collect();
        args.insert(1.min(args.len()), "ctrl".into());
        run(args)
    }))
}

fn ended(result: anyhow::Result<exit::Outcome>) -> ExitCode {
    match result {
        Ok(outcome) => outcome.into(),
        Err(error) => exit::report(&error),
    }
}

fn run(args: Vec<OsString>) -> anyhow::Result<exit::Outcome> {
    let cli = config::parse(args)?;
    let context = cli.global.context()?;
    cmd::run(&cli.command, &context)
}

//! `drivekit`: driver models from recorded drives, and what driving costs in energy.

mod cli;
mod cmd;
mod config;
mod drives;
mod exit;
mod flags;
mod inputs;
mod output;
mod progress;
mod render;
mod require;

use std::process::ExitCode;

fn main() -> ExitCode {
    match exit::without_panic(run) {
        Ok(outcome) => outcome.into(),
        Err(error) => exit::report(&error),
    }
}

fn run() -> anyhow::Result<exit::Outcome> {
    let cli = config::parse(std::env::args_os())?;
    let context = cli.global.context()?;
    cmd::run(&cli.command, &context)
}

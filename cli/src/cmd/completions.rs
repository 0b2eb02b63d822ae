use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use crate::cli::Cli;
use crate::exit::Outcome;
use crate::output;

/// Print a completion script for a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivekit completions bash > ~/.local/share/bash-completion/completions/drivekit
  drivekit completions zsh > ~/.zfunc/_drivekit")]
pub(crate) struct CompletionsArgs {
    /// Shell to complete for
    shell: Shell,
}

pub(crate) fn run(args: &CompletionsArgs) -> anyhow::Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "drivekit", &mut script);
    output::print_text(&String::from_utf8(script)?)?;
    Ok(Outcome::Done)
}

use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, CommandFactory as _};

use crate::cli::Cli;
use crate::exit::Outcome;
use crate::output;

/// Print the manual page, or write one per subcommand
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivekit man | man -l -
  drivekit man -o ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// Folder for drivekit.1, drivekit-evaluate.1 and so on; stdout gets the first alone if absent
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &ManArgs) -> anyhow::Result<Outcome> {
    let mut command = Cli::command();
    command.build();
    let Some(folder) = &args.output else {
        output::print_text(&page(&command)?)?;
        return Ok(Outcome::Done);
    };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    write_pages(&command, folder)?;
    Ok(Outcome::Done)
}

fn write_pages(command: &clap::Command, folder: &std::path::Path) -> anyhow::Result<()> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let text = page(command)?;
    output::write_file(&folder.join(format!("{name}.1")), |out| {
        Ok(out.write_all(text.as_bytes())?)
    })?;
    command
        .get_subcommands()
        .filter(|sub| sub.get_name() != "help")
        .try_for_each(|sub| write_pages(sub, folder))
}

fn page(command: &clap::Command) -> anyhow::Result<String> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    Ok(String::from_utf8(page)?)
}

//! `--config FILE.toml` gives flags a default.
//!
//! The file is read before the command line is parsed for good, and its values become clap's defaults: a flag on the
//! command line wins, and every value passes the same checks as a flag's.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::parser::ValueSource;
use clap::{ArgAction, CommandFactory as _, FromArgMatches as _};
use toml::{Table, Value};

use crate::cli::{Cli, Command};
use crate::cmd::segment::refuse_idle;
use crate::places;

/// Parses the command line, with defaults from the configuration file it names.
pub(crate) fn parse(args: impl IntoIterator<Item = OsString>) -> anyhow::Result<Cli> {
    let args: Vec<OsString> = args.into_iter().collect();
    let mut command = Cli::command();
    let mut table = Table::new();
    if let Some(path) = config_path(&args) {
        table = read(&path)?;
        command = with_defaults(command, &path, &table)?;
    }
    let matches = command.try_get_matches_from_mut(args)?;
    if let Some(matches) = matches.subcommand_matches("segment") {
        refuse_idle(matches)?;
    }
    places::check(&command, &matches)?;
    let mut cli = Cli::from_arg_matches(&matches)?;
    if let (Command::Fit(args), Some((_, matches))) = (&mut cli.command, matches.subcommand()) {
        let is_given = |id: &&str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let ids = matches.ids().map(clap::Id::as_str);
        let ids = ids.filter(is_given).map(|id| id.replace('_', "-"));
        let of_fit = table.get("fit").and_then(Value::as_table);
        let keys = table.keys().chain(of_fit.into_iter().flat_map(Table::keys));
        args.given = ids.chain(keys.cloned()).collect();
    }
    Ok(cli)
}

fn config_path(args: &[OsString]) -> Option<PathBuf> {
    let mut args = args.iter().skip(1).take_while(|arg| *arg != "--");
    while let Some(arg) = args.next() {
        if arg == "--config" {
            return args.next().map(PathBuf::from);
        }
        if let Some(path) = arg.to_str().and_then(|a| a.strip_prefix("--config=")) {
            return Some(PathBuf::from(path));
        }
    }
    None
}

fn read(path: &Path) -> anyhow::Result<Table> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("cannot read the configuration `{}`", path.display()))?;
    text.parse()
        .with_context(|| format!("`{}` is not TOML", path.display()))
}

/// Top-level keys are flags of whichever subcommands have them; a table `[evaluate]` holds flags of that one alone.
fn with_defaults(
    mut command: clap::Command,
    path: &Path,
    table: &Table,
) -> anyhow::Result<clap::Command> {
    for (key, value) in table {
        let place = format!("`{}`: key `{key}`", path.display());
        command = match value {
            Value::Table(flags) => with_subcommand_defaults(command, &[], key, flags, path)?,
            _ => with_default_everywhere(command, key, value).context(place)?,
        };
    }
    Ok(command)
}

/// `[evaluate]`, and `[ctrl.run]` for a subcommand of one; `above` are the names of the table around it.
fn with_subcommand_defaults(
    command: clap::Command,
    above: &[&str],
    name: &str,
    flags: &Table,
    path: &Path,
) -> anyhow::Result<clap::Command> {
    let names = [above, &[name]].concat();
    let Some(mut subcommand) = command.find_subcommand(name).cloned() else {
        bail!("`{}`: no subcommand `{}`", path.display(), names.join(" "));
    };
    for (key, value) in flags {
        if let Value::Table(flags) = value {
            subcommand = with_subcommand_defaults(subcommand, &names, key, flags, path)?;
            continue;
        }
        let place = format!("`{}`: key `{}.{key}`", path.display(), names.join("."));
        if flag_id(&subcommand, key).is_none() {
            bail!(
                "{place}: `drivekit {}` has no flag --{key}",
                names.join(" ")
            );
        }
        subcommand = with_default(subcommand, key, value).context(place)?;
    }
    Ok(command.mut_subcommand(name, |_| subcommand))
}

fn with_default_everywhere(
    command: clap::Command,
    key: &str,
    value: &Value,
) -> anyhow::Result<clap::Command> {
    if !is_flag_anywhere(&command, key) {
        bail!("no subcommand has a flag --{key}");
    }
    with_default_below(command, key, value)
}

fn is_flag_anywhere(command: &clap::Command, key: &str) -> bool {
    flag_id(command, key).is_some()
        || command
            .get_subcommands()
            .any(|sub| is_flag_anywhere(sub, key))
}

/// For a command and all subcommands that have the flag.
fn with_default_below(
    mut command: clap::Command,
    key: &str,
    value: &Value,
) -> anyhow::Result<clap::Command> {
    let below: Vec<clap::Command> = command.get_subcommands().cloned().collect();
    for subcommand in below {
        let name = subcommand.get_name().to_owned();
        let subcommand = with_default_below(subcommand, key, value)?;
        command = command.mut_subcommand(name, |_| subcommand);
    }
    with_default(command, key, value)
}

fn with_default(command: clap::Command, key: &str, value: &Value) -> anyhow::Result<clap::Command> {
    let Some(id) = flag_id(&command, key) else {
        return Ok(command);
    };
    let values = texts(value)?;
    Ok(command.mut_arg(id, |arg| {
        let arg = arg.required(false);
        match arg.get_action() {
            ArgAction::Append => arg.default_values(values),
            _ => arg.default_value(values.join(",")),
        }
    }))
}

fn flag_id(command: &clap::Command, key: &str) -> Option<String> {
    command
        .get_arguments()
        .find(|arg| arg.get_long() == Some(key) && key != "config" && key != "help")
        .map(|arg| arg.get_id().to_string())
}

fn texts(value: &Value) -> anyhow::Result<Vec<String>> {
    Ok(match value {
        Value::String(text) => vec![text.clone()],
        Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => vec![value.to_string()],
        Value::Array(items) => {
            let items: anyhow::Result<Vec<Vec<String>>> = items.iter().map(texts).collect();
            items?.concat()
        }
        Value::Datetime(_) | Value::Table(_) => {
            bail!("expected a text, a number, true, false or a list of these")
        }
    })
}

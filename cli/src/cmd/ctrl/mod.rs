//! Robots: scenarios in simulation, run logs once more, campaigns, and single states explained.

mod beyond;
mod campaign;
mod check;
mod ended;
mod explain;
mod live;
mod replay;
mod run;
mod run_text;
mod scenario;
mod scenarios;

use clap::Subcommand;

use crate::exit::Outcome;
use crate::flags::Context;

/// Controllers that keep robots in their lane and behind their leader
#[derive(Debug, Subcommand)]
#[command(after_help = "\
Examples:
  drivekit ctrl run --report run.html                     the thesis's first experiment
  drivekit ctrl run --preset hardened --disturb all       noise, latency, lost poses, wrong wheels
  drivekit ctrl check --scenario mine.toml                does it fit its lane, and at what speed?
  drivekit ctrl campaign --runs 10000                     does it ever fail?
  drivekit ctrl replay run.parquet                        every decision again, bit for bit

`ctrl …` is the same as `drivekit ctrl …`.")]
pub(crate) enum CtrlCommand {
    Run(run::RunArgs),
    Replay(replay::ReplayArgs),
    Campaign(campaign::CampaignArgs),
    Check(check::CheckArgs),
    Explain(explain::ExplainArgs),
}

pub(crate) fn run(command: &CtrlCommand, context: &Context) -> anyhow::Result<Outcome> {
    let outcome = match command {
        CtrlCommand::Run(args) => run::run(args, context),
        CtrlCommand::Replay(args) => replay::run(args, context),
        CtrlCommand::Campaign(args) => campaign::run(args, context),
        CtrlCommand::Check(args) => check::run(args, context),
        CtrlCommand::Explain(args) => explain::run(args, context),
    };
    outcome.map_err(with_help)
}

/// What libraries cannot know: the command that makes run logs.
fn with_help(error: anyhow::Error) -> anyhow::Error {
    use testbed_io::Error;
    match error.downcast_ref() {
        Some(Error::Meta(_) | Error::MissingColumn { .. }) => {
            anyhow::anyhow!("{error}; is it one of `ctrl run`?")
        }
        _ => error,
    }
}

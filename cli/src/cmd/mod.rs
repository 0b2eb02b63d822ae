//! One file per subcommand: its flags and how it runs.

pub(crate) mod calibrate;
pub(crate) mod completions;
pub(crate) mod ctrl;
pub(crate) mod energy;
pub(crate) mod evaluate;
pub(crate) mod fit;
pub(crate) mod inspect;
pub(crate) mod left_out;
pub(crate) mod man;
pub(crate) mod model;
pub(crate) mod motions;
pub(crate) mod phases;
pub(crate) mod plan;
pub(crate) mod portrait;
pub(crate) mod predict;
pub(crate) mod prior;
pub(crate) mod road;
pub(crate) mod segment;
pub(crate) mod synth;
pub(crate) mod vehicle;
pub(crate) mod vehicle_arg;

use crate::cli::Command;
use crate::exit::Outcome;
use crate::flags::Context;

pub(crate) fn run(command: &Command, context: &Context) -> anyhow::Result<Outcome> {
    match command {
        Command::Inspect(args) => inspect::run(args, context),
        Command::Segment(args) => segment::run(args, context),
        Command::Energy(args) => energy::run(args, context),
        Command::Calibrate(args) => calibrate::run(args, context),
        Command::Fit(args) => fit::run(args, context),
        Command::Model(command) => model::run(command, context),
        Command::Portrait(args) => portrait::run(args, context),
        Command::Plan(args) => plan::run(args, context),
        Command::Predict(args) => predict::run(args, context),
        Command::Evaluate(args) => evaluate::run(args, context),
        Command::Road(args) => road::run(args, context),
        Command::Synth(args) => synth::run(args, context),
        Command::Vehicle(command) => vehicle::run(command, context),
        Command::Ctrl(command) => ctrl::run(command, context),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
    }
}

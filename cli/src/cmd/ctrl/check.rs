use anyhow::Context as _;
use clap::Args;
use report::terminal::{Table, number};
use serde::Serialize;
use testbed_sim::Adaptation;
use unicycle_cbf::{ControllerSettings, Demands, Preset, Scenario, ScenarioSpec};

use super::beyond;
use super::scenario::ScenarioArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// What a scenario asks of its robots, and what is driven in its place where that does not fit
///
/// Margins for the noise, latency and wheel errors that the scenario states against the width of its lane, the tightest bend, the way to a
/// stand, the room of bodies, crossings. Exit code 1 says that no speed fits.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl check --testbed khepera --scenario on-off
  drivekit ctrl check --scenario mine.toml
  drivekit ctrl check --scenario mine.toml --preset hardened --format json")]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    #[serde(flatten)]
    scenario: ScenarioArgs,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

#[derive(Serialize)]
struct Body<'a> {
    scenario: &'a str,
    fits: Option<bool>,
    slowed: bool,
    notes: Vec<String>,
    #[serde(flatten)]
    demands: Demands,
}

/// The document of what does not fit.
#[derive(Serialize)]
pub(super) struct Refused<'a> {
    pub(super) scenario: &'a str,
    pub(super) fits: bool,
    pub(super) reason: String,
}

pub(crate) fn run(args: &CheckArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/ctrl-check.txt"
    )))?;
    let named = args.scenario.named(Preset::Hardened)?;
    named.spec.disturbances.check().context("disturbances")?;
    let spec = &named.spec.scenario;
    let scenario = match fitting(spec)? {
        Ok(scenario) => scenario,
        Err(reason) => {
            refuse(args, context, &spec.name, reason)?;
            return Ok(Outcome::Negative);
        }
    };
    let demands = Demands::new(&scenario);
    let mut notes = notes(spec, &demands);
    let stated = &spec.controller.hardening;
    notes.extend(beyond::note(&named.spec.disturbances, stated, &demands));
    let missing = missing_guards(&spec.controller);
    let lacks_guards = !missing.is_empty();
    notes.extend(missing);
    let body = Body {
        scenario: &spec.name,
        fits: demands.is_guaranteed.then_some(true),
        slowed: demands.is_slowed(),
        notes,
        demands,
    };
    let inputs = FileInputs::read(args.scenario.files())?;
    let mut document = Document::new("ctrl-check", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text(&document.body, lacks_guards))?,
    }
    Ok(outcome)
}

fn refuse(
    args: &CheckArgs,
    context: &Context,
    scenario: &str,
    reason: String,
) -> anyhow::Result<()> {
    let text = format!("{scenario}\n\ndoes not fit: {reason}\n");
    let body = Refused {
        scenario,
        fits: false,
        reason,
    };
    let inputs = FileInputs::read(args.scenario.files())?;
    let mut document = Document::new("ctrl-check", args, &inputs, body);
    document.judged(&args.require)?;
    match context.format {
        Format::Text => output::print_text(&text),
        Format::Json => output::print_json(&document),
    }
}

/// The scenario, or why no speed fits it.
pub(super) fn fitting(spec: &ScenarioSpec) -> anyhow::Result<Result<Scenario, String>> {
    match Scenario::new(spec.clone()) {
        Ok(scenario) => Ok(Ok(scenario)),
        Err(error @ unicycle_cbf::Error::DoesNotFit { .. }) => Ok(Err(error.to_string())),
        Err(error) => Err(error.into()),
    }
}

/// What a run does otherwise than its scenario says, or takes where it says nothing.
pub(super) fn notes(spec: &ScenarioSpec, demands: &Demands) -> Vec<String> {
    let adaptations = Adaptation::all(spec, demands);
    adaptations.iter().map(ToString::to_string).collect()
}

/// A line for each guard of the hardened preset that settings do not have, and one that says how to get them all.
pub(super) fn missing_guards(settings: &ControllerSettings) -> Vec<String> {
    let missing = settings.missing_guards();
    let mut lines: Vec<String> = missing.iter().map(ToString::to_string).collect();
    if !lines.is_empty() {
        lines.push("`--preset hardened` gives every guard".to_owned());
    }
    lines
}

fn text(body: &Body, lacks_guards: bool) -> String {
    let demands = &body.demands;
    let mut table = Table::new(["demand", "asked or needed", "there is", "unit"]);
    let mut row = |name: &str, asked: String, has: String, unit: &str| {
        table.row([name.to_owned(), asked, has, unit.to_owned()]);
    };
    let mm = |m: f64| number(1e3 * m, 1);
    row(
        "margin of the lane at the wheels' limit",
        mm(demands.margin_at_full_speed_m),
        mm(demands.half_width_m),
        "mm",
    );
    row(
        "margin of the lane as driven",
        mm(demands.margin_m),
        mm(demands.half_width_m),
        "mm",
    );
    row(
        "speed of the wheels",
        number(demands.wheel_limit_mps, 3),
        number(demands.driven_wheel_limit_mps, 3),
        "m/s",
    );
    row(
        "fastest desired speed",
        number(demands.fastest_desired_mps, 3),
        number(demands.driven_wheel_limit_mps, 3),
        "m/s",
    );
    row(
        "way to a stand",
        mm(demands.stopping_m),
        mm(demands.driven_standstill_m),
        "mm, and the standstill gap",
    );
    row(
        "between the middles of two axles",
        mm(demands.least_distance_m),
        mm(demands.driven_standstill_m),
        "mm",
    );
    let mut text = format!("{}\n\n{}", body.scenario, table.render());
    for note in &body.notes {
        text.push_str(&format!("\n- {note}"));
    }
    let verdict = if !demands.is_guaranteed {
        "not known whether it fits: these settings lack guards, and nothing is guaranteed"
    } else if demands.largest_start_m >= demands.half_width_m {
        "fits, but for a start outside of the lane"
    } else if body.slowed {
        "fits at a lower speed than asked for"
    } else {
        "fits as asked"
    };
    let but = if lacks_guards && demands.is_guaranteed {
        "; these settings lack guards"
    } else {
        ""
    };
    format!("{}\n\n{verdict}{but}\n", text.trim_end())
}

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;
use unicycle_cbf::{Demands, Scenario, ScenarioSpec};

use super::beyond;
use super::guards;
use super::scenario::{PresetName, ScenarioArgs};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::output;
use crate::render::json::Document;
use crate::render::table::{Table, number};
use crate::require::{Figures, RequireArgs};

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
    args.require
        .check(&Figures::new(include_str!("../../figures/ctrl-check.txt")))?;
    let named = args.scenario.named(PresetName::Hardened)?;
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
    let missing = guards::missing(&spec.controller);
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
    let (body, mm) = (&spec.body, |m: f64| number(1e3 * m, 1));
    let mut notes = Vec::new();
    if body.radius_m.is_none() {
        let taken = number(body.radius_m(), 3);
        notes.push(format!("the body's radius is not given; {taken} m about the middle of the axle is taken (`radius_m` under [scenario.body])"));
    }
    if body.max_wheel_acceleration_mps2.is_none() && spec.controller.hardening.wheel_rows {
        let taken = number(body.wheel_acceleration_mps2(), 1);
        notes.push(format!("how fast wheels change their speed is not given; {taken} m/s² is taken (`max_wheel_acceleration_mps2` under [scenario.body])"));
    }
    if demands.largest_start_m > demands.half_width_m {
        notes.push(format!(
            "a robot starts {} mm beside the path, outside of its lane of {} mm: the run is unsafe from its start",
            mm(demands.largest_start_m),
            mm(demands.half_width_m)
        ));
    }
    let agile_mps = demands.agile_wheel_speed_mps;
    if let Some(agile_mps) = agile_mps.filter(|mps| *mps < demands.wheel_limit_mps) {
        notes.push(format!(
            "wheels that change their speed by {} m/s² and a turn rate of {} rad/s turn the robot fast enough for this lane, its bends and the stated errors up to {} m/s, and not at {} m/s",
            number(body.wheel_acceleration_mps2(), 2),
            number(body.max_turn_rate_rad_s, 2),
            number(agile_mps, 3),
            number(demands.wheel_limit_mps, 3),
        ));
    }
    let errors_fit = demands.margin_m >= demands.margin_at_full_speed_m;
    if demands.driven_wheel_limit_mps < demands.wheel_limit_mps && !errors_fit {
        notes.push(format!(
            "wheels go at {} m/s at most, and not at {} m/s: then the stated errors of poses and wheels would take {} mm of the half width of {} mm; now they take {} mm",
            number(demands.driven_wheel_limit_mps, 3),
            number(demands.wheel_limit_mps, 3),
            mm(demands.margin_at_full_speed_m),
            mm(demands.half_width_m),
            mm(demands.margin_m),
        ));
    }
    if let Some(bend_m) = demands.tight_bend_m {
        let kept = if demands.kept_within_m < bend_m {
            format!(
                "robots are kept within {} mm of the path",
                mm(demands.kept_within_m)
            )
        } else {
            "on its inner side the nearest point of the path may jump".to_owned()
        };
        notes.push(format!(
            "the lane is wider than the path's tightest bend, whose radius is {} mm; {kept}",
            mm(bend_m)
        ));
    }
    let [set_1ps, driven_1ps] = demands.lane_rate_1ps;
    if driven_1ps < set_1ps {
        notes.push(format!(
            "the lane's rates are {} % of those set: a command is held for {} ms",
            number(100.0 * driven_1ps / set_1ps, 0),
            number(1e3 / spec.rate_hz, 0)
        ));
    }
    let several = spec.robots.len() > 1;
    if several && demands.driven_standstill_m > demands.standstill_m {
        notes.push(format!(
            "the standstill gap is {} mm, and not {} mm: both radii and the clearance",
            mm(demands.driven_standstill_m),
            mm(demands.standstill_m)
        ));
    }
    if several && demands.crossings > 0 {
        notes.push(format!(
            "the path meets itself at {} place(s): one robot at a time goes through, in the order in which they came",
            demands.crossings
        ));
    }
    if several && demands.along_path_instead {
        notes.push(
            "the headway is measured along the path, and not as a chord: the path meets itself"
                .to_owned(),
        );
    }
    if let Some([set_rad, driven_rad]) = demands
        .course_angle_rad
        .filter(|[set, driven]| driven < set)
    {
        notes.push(format!(
            "robots stay within {}° of the path's direction, and not {}°, so that branches are told apart where they meet",
            number(driven_rad.to_degrees(), 0),
            number(set_rad.to_degrees(), 0)
        ));
    }
    notes
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
    } else if demands.largest_start_m > demands.half_width_m {
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

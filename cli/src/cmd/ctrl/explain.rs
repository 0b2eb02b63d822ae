use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use report::terminal::{Table, number};
use serde::Serialize;
use testbed_sim::explain::{Explained, Relaxed, StateSpec};
use unicycle_cbf::{Preset, Scenario};

use super::scenario::ScenarioArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// One state's rows, optimum and multipliers
///
/// The state file is JSON, one state or an array of states, with positions of the point of interest:
/// {"follower": {"x_m": 0.9, "y_m": 0, "speed_mps": 0.2, "heading_rad": 1.57, "turn_rate_rad_s": 0}, "leader": {…}}, and
/// optionally "desired_speed_mps", "lateral" (radial or frenet) and "lane_barrier" (quadratic, braking or exponential).
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl explain --state state.json
  drivekit ctrl explain --testbed robotarium --scenario track --preset hardened --state states.json --format json")]
pub(crate) struct ExplainArgs {
    /// The state or states
    #[arg(long, value_name = "FILE.json")]
    #[serde(skip)]
    state: PathBuf,
    #[command(flatten)]
    #[serde(flatten)]
    scenario: ScenarioArgs,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &ExplainArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/ctrl-explain.txt"
    )))?;
    let named = args.scenario.named(Preset::Thesis)?;
    for text in &named.notes {
        output::note(context, text);
    }
    let scenario = Scenario::new(named.spec.scenario)?;
    let file = args.state.display();
    let text = std::fs::read_to_string(&args.state)
        .with_context(|| format!("cannot read the state `{file}`"))?;
    let states = parse(&text).with_context(|| format!("state `{file}`"))?;
    let explained = states.iter().map(|state| state.explained(&scenario));
    let explained: Vec<Explained> = explained.collect::<Result<_, _>>()?;
    let braking = explained.iter().any(|e| e.braking.is_some());
    let files = args.scenario.files().chain([args.state.clone()]);
    let inputs = FileInputs::read(files)?;
    let body = Body { states: explained };
    let mut document = Document::new("ctrl-explain", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => {
            let texts = document.body.states.iter().map(text_of);
            output::print_text(&texts.collect::<Vec<_>>().join("\n"))?;
        }
    }
    Ok(if braking { Outcome::Negative } else { outcome })
}

fn parse(text: &str) -> serde_json::Result<Vec<StateSpec>> {
    if text.trim_start().starts_with('[') {
        serde_json::from_str(text)
    } else {
        serde_json::from_str(text).map(|state| vec![state])
    }
}

#[derive(Serialize)]
struct Body {
    states: Vec<Explained>,
}

fn text_of(explained: &Explained) -> String {
    let mut text = String::new();
    let mut functions = Table::new(["function", "value", "Lf", "Lg force", "Lg torque"]);
    let mut function = |name: &str, value: f64, lf: f64, lg: [f64; 2]| {
        let cells = [value, lf, lg[0], lg[1]].map(|value| number(value, 6));
        let [value, lf, force, torque] = cells;
        functions.row([name.to_owned(), value, lf, force, torque]);
    };
    if let (Some(v), Some(lf), Some(lg)) = (explained.v, explained.lf_v, explained.lg_v) {
        for (i, name) in ["V1", "V2", "V3"].into_iter().enumerate() {
            function(name, v[i], lf[i], lg[i]);
        }
    }
    if let Some(h) = &explained.headway {
        function("h headway", h.h, h.lf, h.lg);
    }
    for h in &explained.lane {
        function("h lane", h.h, h.lf, h.lg);
    }
    if let Some(h) = &explained.direction {
        function("h direction", h.h, h.lf, h.lg);
    }
    let _ = writeln!(text, "{}", functions.render());
    let mut rows = Table::new([
        "row",
        "force",
        "torque",
        "δ1",
        "δ2",
        "δ3",
        "≤ b",
        "multiplier",
        "active",
    ]);
    for (i, name) in explained.rows.iter().enumerate() {
        let [a0, a1, a2, a3, a4] = explained.a[i].map(|a| number(a, 4));
        rows.row([
            name.name().to_owned(),
            a0,
            a1,
            a2,
            a3,
            a4,
            number(explained.b[i], 6),
            number(explained.multipliers.get(i).copied(), 6),
            if explained.active.contains(&i) {
                "yes"
            } else {
                ""
            }
            .to_owned(),
        ]);
    }
    let _ = writeln!(text, "{}", rows.render());
    if let Some([force, torque, d1, d2, d3]) = explained.optimum {
        let _ = writeln!(
            text,
            "optimum: force {force:.6} N, torque {torque:.6e} N m, δ {d1:.3e}, {d2:.3e}, {d3:.3e}"
        );
    }
    let outcome = match (&explained.relaxed, explained.braking) {
        (Some(Relaxed { row, by }), _) => {
            format!("relaxed: {} gave way by {by:.4}", row.name())
        }
        (None, Some(reason)) => format!("braking: {reason}"),
        (None, None) => "every row holds".to_owned(),
    };
    let _ = writeln!(
        text,
        "{outcome}\ncommand: {:.4} m/s, {:.4} rad/s; wheels {:.4} and {:.4} m/s",
        explained.command.speed_mps,
        explained.command.turn_rate_rad_s,
        explained.command.left_wheel_mps,
        explained.command.right_wheel_mps
    );
    text
}

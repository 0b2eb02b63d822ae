use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use serde::{Deserialize, Serialize};
use unicycle_cbf::cbf::LaneBarrier;
use unicycle_cbf::{
    Controller, Decision, Deviation, Leader, Lie, Outcome as Rung, RowKind, Scenario, State,
};

use super::scenario::{PresetName, ScenarioArgs};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::output;
use crate::render::json::Document;
use crate::render::table::{Table, number};
use crate::require::{Figures, RequireArgs};

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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StateSpec {
    follower: State,
    #[serde(default)]
    leader: Option<State>,
    desired_speed_mps: Option<f64>,
    lateral: Option<Deviation>,
    lane_barrier: Option<Barrier>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Barrier {
    Quadratic,
    Braking,
    Exponential,
}

pub(crate) fn run(args: &ExplainArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&Figures::new(include_str!(
        "../../figures/ctrl-explain.txt"
    )))?;
    let named = args.scenario.named(PresetName::Thesis)?;
    for text in &named.notes {
        output::note(context, text);
    }
    let scenario = Scenario::new(named.spec.scenario)?;
    let file = args.state.display();
    let text = std::fs::read_to_string(&args.state)
        .with_context(|| format!("cannot read the state `{file}`"))?;
    let states = parse(&text).with_context(|| format!("state `{file}`"))?;
    let explained: Vec<Explained> = states
        .iter()
        .map(|state| Explained::new(&scenario, state))
        .collect::<anyhow::Result<_>>()?;
    let braking = explained.iter().any(|e| e.braking.is_some());
    let files = args.scenario.files().chain([args.state.clone()]);
    let inputs = FileInputs::read(files)?;
    let body = Body { states: explained };
    let mut document = Document::new("ctrl-explain", args, &inputs, body);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => {
            let texts = document.body.states.iter().map(Explained::text);
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

#[derive(Serialize)]
struct Explained {
    v: Option<[f64; 3]>,
    lf_v: Option<[f64; 3]>,
    lg_v: Option<[[f64; 2]; 3]>,
    headway: Option<LieEntry>,
    lane: Vec<LieEntry>,
    direction: Option<LieEntry>,
    deviation_m: Option<f64>,
    rows: Vec<RowKind>,
    a: Vec<[f64; 5]>,
    b: Vec<f64>,
    optimum: Option<[f64; 5]>,
    active: Vec<usize>,
    multipliers: Vec<f64>,
    outcome: &'static str,
    relaxed: Option<Relaxed>,
    braking: Option<&'static str>,
    command: Command,
}

/// The row that gave way most, and by how much `a·z` exceeds `b`.
#[derive(Serialize)]
struct Relaxed {
    row: RowKind,
    by: f64,
}

#[derive(Serialize)]
struct Command {
    speed_mps: f64,
    turn_rate_rad_s: f64,
    left_wheel_mps: f64,
    right_wheel_mps: f64,
}

#[derive(Serialize)]
struct LieEntry {
    h: f64,
    lf: f64,
    lg: [f64; 2],
}

impl From<Lie> for LieEntry {
    fn from(lie: Lie) -> Self {
        Self {
            h: lie.value,
            lf: lie.lf,
            lg: lie.lg,
        }
    }
}

impl StateSpec {
    fn controller(&self, scenario: &Scenario) -> anyhow::Result<Controller> {
        let given = scenario.controller();
        let mut settings = given.settings().clone();
        if let Some(deviation) = self.lateral {
            settings.lane.deviation = deviation;
        }
        if let Some(barrier) = self.lane_barrier {
            settings.lane = match barrier {
                Barrier::Quadratic => settings.lane.with(LaneBarrier::QUADRATIC),
                Barrier::Braking => settings.lane.with(LaneBarrier::BRAKING),
                Barrier::Exponential => settings.lane.with(LaneBarrier::EXPONENTIAL),
            };
        }
        let (path, body) = (given.path().clone(), *given.body());
        Ok(Controller::new(path, body, settings, given.hold_s())?)
    }
}

impl Explained {
    fn new(scenario: &Scenario, spec: &StateSpec) -> anyhow::Result<Self> {
        let controller = spec.controller(scenario)?;
        let follower = scenario.starts().len() - 1;
        let mut objectives = scenario.objectives(follower, 0.0);
        if let Some(speed_mps) = spec.desired_speed_mps {
            if !speed_mps.is_finite() {
                bail!("desired_speed_mps is {speed_mps}; it must be finite");
            }
            objectives.desired_speed_mps = speed_mps;
        }
        let leader = spec.leader.map(Leader::known);
        let decision = controller.decide(&spec.follower, leader.as_ref(), &objectives, 0.0);
        Ok(Self::of(&decision))
    }

    fn of(decision: &Decision) -> Self {
        let terms = decision.terms.as_ref();
        let rows = terms.map_or(&[][..], |t| t.rows.as_slice());
        let lyapunov = terms.map(|t| t.lyapunov);
        let solution = terms.map(|t| t.solution);
        let solved = !matches!(decision.outcome, Rung::Braking { .. });
        Self {
            v: lyapunov.map(|v| v.map(|lie| lie.value)),
            lf_v: lyapunov.map(|v| v.map(|lie| lie.lf)),
            lg_v: lyapunov.map(|v| v.map(|lie| lie.lg)),
            headway: terms.and_then(|t| t.headway).map(LieEntry::from),
            lane: terms.map_or_else(Vec::new, |t| {
                t.lane.iter().map(|(_, lie)| lie.into()).collect()
            }),
            direction: terms.and_then(|t| t.direction).map(LieEntry::from),
            deviation_m: terms.map(|t| t.lateral.deviation_m),
            rows: terms.map_or_else(Vec::new, |t| t.rows.kinds().to_vec()),
            a: rows.iter().map(|row| row.a).collect(),
            b: rows.iter().map(|row| row.b).collect(),
            optimum: solution.filter(|_| solved).map(|s| s.z),
            active: solution.map_or_else(Vec::new, |s| {
                (0..rows.len()).filter(|row| s.is_active(*row)).collect()
            }),
            multipliers: solution.map_or_else(Vec::new, |s| s.multipliers[..rows.len()].to_vec()),
            outcome: decision.outcome.name(),
            relaxed: match decision.outcome {
                Rung::Relaxed { row, by } => Some(Relaxed { row, by }),
                _ => None,
            },
            braking: match decision.outcome {
                Rung::Braking { reason } => Some(reason.name()),
                _ => None,
            },
            command: Command {
                speed_mps: decision.speeds.speed_mps,
                turn_rate_rad_s: decision.speeds.turn_rate_rad_s,
                left_wheel_mps: decision.wheels.left_mps,
                right_wheel_mps: decision.wheels.right_mps,
            },
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let mut functions = Table::new(["function", "value", "Lf", "Lg force", "Lg torque"]);
        let mut function = |name: &str, value: f64, lf: f64, lg: [f64; 2]| {
            let cells = [value, lf, lg[0], lg[1]].map(|value| number(value, 6));
            let [value, lf, force, torque] = cells;
            functions.row([name.to_owned(), value, lf, force, torque]);
        };
        if let (Some(v), Some(lf), Some(lg)) = (self.v, self.lf_v, self.lg_v) {
            for (i, name) in ["V1", "V2", "V3"].into_iter().enumerate() {
                function(name, v[i], lf[i], lg[i]);
            }
        }
        if let Some(h) = &self.headway {
            function("h headway", h.h, h.lf, h.lg);
        }
        for h in &self.lane {
            function("h lane", h.h, h.lf, h.lg);
        }
        if let Some(h) = &self.direction {
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
        for (i, name) in self.rows.iter().enumerate() {
            let [a0, a1, a2, a3, a4] = self.a[i].map(|a| number(a, 4));
            rows.row([
                name.name().to_owned(),
                a0,
                a1,
                a2,
                a3,
                a4,
                number(self.b[i], 6),
                number(self.multipliers.get(i).copied(), 6),
                if self.active.contains(&i) { "yes" } else { "" }.to_owned(),
            ]);
        }
        let _ = writeln!(text, "{}", rows.render());
        if let Some([force, torque, d1, d2, d3]) = self.optimum {
            let _ = writeln!(
                text,
                "optimum: force {force:.6} N, torque {torque:.6e} N m, δ {d1:.3e}, {d2:.3e}, {d3:.3e}"
            );
        }
        let outcome = match (&self.relaxed, self.braking) {
            (Some(Relaxed { row, by }), _) => {
                format!("relaxed: {} gave way by {by:.4}", row.name())
            }
            (None, Some(reason)) => format!("braking: {reason}"),
            (None, None) => "every row holds".to_owned(),
        };
        let _ = writeln!(
            text,
            "{outcome}\ncommand: {:.4} m/s, {:.4} rad/s; wheels {:.4} and {:.4} m/s",
            self.command.speed_mps,
            self.command.turn_rate_rad_s,
            self.command.left_wheel_mps,
            self.command.right_wheel_mps
        );
        text
    }
}

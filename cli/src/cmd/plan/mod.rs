mod text;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context as _, bail};
use assistance::{FrontierPoint, ObstacleDocument, PlanDocument, RoadDocument, SampledPlan};
use clap::{ArgGroup, Args};
use ev_energy::StepModel;
use serde::Serialize;
use speed_plan::{Answer, Case, Demand, Problem, Settings, frontier, plan};

use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// The speed over a road that takes the least energy, and how much less any other could take
///
/// Limits, stops, accelerations and the arrival are kept exactly. The bound says how much less energy any other plan could take; where
/// the losses of the car are formulas it is proven. Energy is that of the model of the car; nothing but the leader and the signals is
/// known of traffic.
#[derive(Debug, Args, Serialize)]
#[command(
    group = ArgGroup::new("when").args(["arrive", "price", "frontier"]),
    after_help = "\
Examples:
  drivekit plan --case case.json                       a problem on a grid of its own, checked
  drivekit plan --case case.json --price 3000          when a second is worth 3 kJ
  drivekit plan --case case.json --frontier 8          energy against time
  drivekit plan --case case.json -o plan.csv           as a log that `drivekit energy` reads"
)]
pub(crate) struct PlanArgs {
    /// A problem on a grid of its own, as the reference plans state it
    #[arg(long, value_name = "FILE.json", required = true)]
    case: PathBuf,
    /// Latest arrival after the start, in s
    #[arg(long, value_name = "S", value_parser = numbers::arrival_s)]
    arrive: Option<f64>,
    /// Price of time, in W: what a second is worth in J
    #[arg(long, value_name = "W", value_parser = numbers::price_w)]
    price: Option<f64>,
    /// Plans from the fastest to the cheapest, this many
    #[arg(long, value_name = "N", value_parser = numbers::frontier)]
    frontier: Option<usize>,
    /// Gap to the bound at which the search may end, in %
    #[arg(long, value_name = "PCT", default_value_t = 0.01, value_parser = numbers::gap_pct)]
    max_gap: f64,
    /// Write the plan as a log at 10 Hz
    #[arg(long, short, value_name = "FILE.csv", conflicts_with = "frontier")]
    #[serde(skip)]
    output: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

/// What the subcommand has to say.
#[derive(Debug, Serialize)]
struct Body {
    vehicle: String,
    road: RoadDocument,
    plans: Vec<PlanDocument>,
    /// Where nothing can be driven.
    #[serde(skip_serializing_if = "Option::is_none")]
    obstacle: Option<ObstacleDocument>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    frontier: Vec<FrontierPoint>,
}

pub(crate) fn run(args: &PlanArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require
        .check(&KnownFigures::new(include_str!("../../figures/plan.txt")))?;
    if let Some(path) = &args.output {
        output::check_file_place(path)?;
    }
    let files = FileInputs::read([args.case.clone()])?;
    let name = args.case.display().to_string();
    let text =
        std::fs::read_to_string(&args.case).with_context(|| format!("cannot read `{name}`"))?;
    let case = Case::from_json(&text, &name)?;
    let model = StepModel::new(&case.vehicle);
    let problem = Problem::new(model, case.envelope.clone(), case.columns.clone())
        .with_context(|| name.clone())?;
    let settings = Settings {
        max_gap_pct: args.max_gap,
        ..Settings::default()
    };
    let body = planned(args, &problem, case.latest_arrival_s, &settings, context)?;
    let outcome = if body.obstacle.is_some() {
        Outcome::Negative
    } else {
        Outcome::Done
    };
    let mut document = Document::new("plan", args, &files, body);
    let judged = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text::text(&document.body))?,
    }
    Ok(outcome.and(judged))
}

fn planned(
    args: &PlanArgs,
    problem: &Problem,
    latest_s: Option<f64>,
    settings: &Settings,
    context: &Context,
) -> anyhow::Result<Body> {
    let mut body = Body {
        vehicle: problem.model().vehicle().spec().name.clone(),
        road: RoadDocument::new(problem),
        plans: Vec::new(),
        obstacle: None,
        frontier: Vec::new(),
    };
    if let Some(points) = args.frontier {
        for answer in frontier(problem, points, settings)? {
            match &answer {
                Answer::Plan(plan) => body.frontier.push(FrontierPoint::new(plan)),
                Answer::Obstacle(obstacle) => {
                    body.obstacle = Some(ObstacleDocument::new(problem, obstacle));
                }
            }
        }
        return Ok(body);
    }
    let demand = match (args.arrive, args.price) {
        (Some(latest_s), _) => Demand::Arrival(latest_s),
        (None, Some(price_w)) => Demand::Price(price_w),
        (None, None) => latest_s.map_or(Demand::Price(0.0), Demand::Arrival),
    };
    let started = Instant::now();
    let answer = plan(problem, demand, settings)?;
    let solve_ms = (!context.no_times).then(|| 1e3 * started.elapsed().as_secs_f64());
    match &answer {
        Answer::Plan(plan) => {
            body.plans
                .push(PlanDocument::new(problem, plan, demand, solve_ms)?);
            if let Some(path) = &args.output {
                let log = SampledPlan::new(problem, plan).csv();
                output::write_file(path, |out| Ok(out.write_all(log.as_bytes())?))?;
                output::note(context, &format!("plan written to {}", path.display()));
            }
        }
        Answer::Obstacle(obstacle) => {
            body.obstacle = Some(ObstacleDocument::new(problem, obstacle));
            if args.output.is_some() {
                bail!("there is no plan to write: {obstacle}");
            }
        }
    }
    Ok(body)
}

mod certify;
mod leader;
mod own;
mod picture;
mod potential;
mod source;
mod text;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::bail;
use assistance::{
    FrontierPoint, ObstacleDocument, PlanDocument, RoadDocument, RunDocument, SampledPlan, Style,
    savings_in_words,
};
use certify::Certifier;
use clap::{ArgGroup, Args};
use ev_energy::{StepModel, Vehicle, Weather};
use own::Tasks;
use picture::PictureArgs;
use serde::Serialize;
use source::{Source, SourceInputs};
use speed_plan::{Answer, Demand, HURRY_W, Problem, Settings, frontier, plan};

use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::numbers;
use crate::output;
use crate::render::json::{Document, Listing};
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
  drivekit plan road.toml --vehicle bmw-i3-60ah --arrive 600      in ten minutes, for the least energy
  drivekit plan road.toml --price 3000                            when a second is worth 3 kJ
  drivekit plan road.toml --frontier 8                            energy against time
  drivekit plan road.toml --signals lights.json -o plan.csv       as a log that `drivekit energy` reads
  drivekit plan road.toml --report plan.html                      a page with pictures
  drivekit plan drive.csv                                         the road of a drive, in its time
  drivekit plan --case case.json                                  a problem on a grid of its own
  drivekit plan road.toml --driver trips.json --style 1,free      in the driver's own time, inside his band and outside of it
  drivekit plan logs/ --potential --vehicle bmw-i3-60ah           what recorded trips could have cost"
)]
pub(crate) struct PlanArgs {
    /// A road file (TOML or JSON, see `drivekit road`), or a log of a drive along the road; with --potential logs: files, folders or globs
    #[arg(value_name = "ROAD|LOG")]
    #[serde(skip)]
    road: Vec<PathBuf>,
    /// What recorded trips could have cost: each with its own stops and arrival, no faster than driven near by
    #[arg(long, requires = "road", conflicts_with_all = ["case", "arrive", "price", "frontier", "accel", "slowest", "signals", "leader", "output", "plot", "report", "driver", "style", "certify"])]
    potential: bool,
    /// Layout of the log: auto, the name of a built-in one, or a TOML file
    #[arg(long, default_value = "auto", value_name = "LAYOUT")]
    layout: String,
    /// Map with speed limits for a log with positions: GeoJSON lines with `maxspeed`
    #[arg(long, value_name = "FILE.geojson")]
    limit_map: Option<PathBuf>,
    /// A problem on a grid of its own: car, nodes, limits and windows in one JSON file
    #[arg(long, value_name = "FILE.json")]
    case: Option<PathBuf>,
    /// Vehicle: a built-in name (see `drivekit vehicle list`) or a TOML file; b250e if left out
    #[arg(long, value_name = "NAME|FILE")]
    vehicle: Option<String>,
    /// Latest arrival after the start, in s
    #[arg(long, value_name = "S", value_parser = numbers::arrival_s)]
    arrive: Option<f64>,
    /// Price of time, in W: what a second is worth in J
    #[arg(long, value_name = "W", value_parser = numbers::price_w)]
    price: Option<f64>,
    /// Plans from the fastest to the cheapest, this many
    #[arg(long, value_name = "N", value_parser = numbers::frontier)]
    frontier: Option<usize>,
    /// Trip driver whose own way the plan is beside of, and whose time it takes if no other is given: a model file of `drivekit fit --model
    /// trip-driver`
    #[arg(long, value_name = "MODEL.json")]
    driver: Option<PathBuf>,
    /// How closely to keep to the driver: half-widths of the band around his own speed, or free; several make several plans [default: 1]
    #[arg(long, value_name = "1|free", value_delimiter = ',', value_parser = numbers::style)]
    style: Option<Vec<Style>>,
    /// Strongest braking and acceleration, in m/s² [default: -2,1.5; with --driver the driver's own]
    #[arg(long, value_name = "MIN,MAX", value_parser = numbers::accels_mps2, allow_hyphen_values = true)]
    accel: Option<[f64; 2]>,
    /// Slowest speed where the car does not stand, in km/h [default: 1.8]
    #[arg(long, value_name = "KMH", value_parser = numbers::slowest_kmh)]
    slowest: Option<f64>,
    /// Power of the auxiliaries in place of the vehicle's, in W
    #[arg(long, value_name = "W", value_parser = numbers::aux_power_w)]
    aux_power: Option<f64>,
    /// Temperature of the air, in °C
    #[arg(long, value_name = "C", value_parser = numbers::temperature_degc, allow_hyphen_values = true)]
    temperature: Option<f64>,
    /// Signals in place of the road's: a JSON list of {position_m, green_s: [[from, to], …]} or {position_m, cycle_s, green_from_s, green_s}
    #[arg(long, value_name = "FILE.json")]
    signals: Option<PathBuf>,
    /// The car ahead: positions on the road over time, a CSV file with the columns time_s, position_m
    #[arg(long, value_name = "FILE.csv")]
    leader: Option<PathBuf>,
    /// Gap to the bound at which the search may end, in %
    #[arg(long, value_name = "PCT", default_value_t = 0.01, value_parser = numbers::gap_pct)]
    max_gap: f64,
    /// Time after which the search ends with the best plan that it has, in s
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = numbers::budget_s)]
    budget: f64,
    /// What says how much less any other plan could take
    #[arg(long, value_enum, default_value_t = Certifier::Bound, value_name = "BY", conflicts_with = "frontier")]
    certify: Certifier,
    /// Write the plan as a log at 10 Hz
    #[arg(long, short, value_name = "FILE.csv", conflicts_with = "frontier")]
    #[serde(skip)]
    output: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    pictures: PictureArgs,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

/// What the subcommand has to say.
#[derive(Debug, Serialize)]
struct Body {
    vehicle: String,
    road: RoadDocument,
    /// What was assumed, changed or left out.
    findings: Vec<String>,
    plans: Vec<PlanDocument>,
    /// The driver's own way.
    #[serde(skip_serializing_if = "Option::is_none")]
    own: Option<RunDocument>,
    /// Where nothing can be driven.
    #[serde(skip_serializing_if = "Option::is_none")]
    obstacle: Option<ObstacleDocument>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    frontier: Vec<FrontierPoint>,
}

/// Places that are named where a plan saves most.
const PLACES: usize = 3;

pub(crate) fn run(args: &PlanArgs, context: &Context) -> anyhow::Result<Outcome> {
    if args.potential {
        return potential::run(args, context);
    }
    args.require
        .check(&KnownFigures::new(include_str!("../../figures/plan.txt")))?;
    let source = Source::read(args, context)?;
    for finding in &source.findings {
        output::note(context, finding);
    }
    let model = model(args, &source.vehicle)?;
    let problem = Problem::new(model, source.envelope.clone(), source.columns.clone())?;
    let settings = Settings {
        max_gap_pct: args.max_gap,
        budget_s: Some(args.budget),
    };
    let road = RoadDocument::new(&problem);
    let tasks = Tasks::of(args, &source, problem)?;
    for finding in &tasks.findings {
        output::note(context, finding);
    }
    let body = planned(args, &tasks, road, &source, &settings, context)?;
    let outcome = if body.obstacle.is_some() {
        Outcome::Negative
    } else {
        Outcome::Done
    };
    let listing: Listing = match &source.inputs {
        SourceInputs::Files(files) => files.into(),
        SourceInputs::Logs(logs) => logs.into(),
    };
    let mut document = Document::new("plan", args, listing, body);
    let judged = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text::text(&document.body))?,
    }
    args.pictures.write(&document, context)?;
    Ok(outcome.and(judged))
}

/// The car with the auxiliaries and in the weather that are asked for.
fn model<'a>(args: &PlanArgs, vehicle: &'a Vehicle) -> anyhow::Result<StepModel<'a>> {
    let mut model = StepModel::new(vehicle);
    if let Some(temperature_degc) = args.temperature {
        model = model.in_weather(&Weather {
            temperature_degc,
            elevation_m: 0.0,
        })?;
    }
    if let Some(power_w) = args.aux_power {
        model = model.with_auxiliary_power(power_w)?;
    }
    Ok(model)
}

fn planned(
    args: &PlanArgs,
    tasks: &Tasks,
    road: RoadDocument,
    source: &Source,
    settings: &Settings,
    context: &Context,
) -> anyhow::Result<Body> {
    let mut body = Body {
        vehicle: source.vehicle.spec().name.clone(),
        road,
        findings: [source.findings.as_slice(), &tasks.findings].concat(),
        plans: Vec::new(),
        own: None,
        obstacle: None,
        frontier: Vec::new(),
    };
    if args.styles() > 1 && (args.output.is_some() || args.frontier.is_some()) {
        bail!("--output and --frontier are of one plan; give one --style");
    }
    for (style, problem) in &tasks.styled {
        if let (Some(own), None) = (&tasks.own, &body.own) {
            body.own = Some(RunDocument::new(&tasks.road, &own.run)?);
        }
        match args.frontier {
            Some(points) => add_frontier(&mut body, problem, points, settings)?,
            None => add_plan(
                args,
                &mut body,
                tasks,
                (*style, problem),
                source,
                settings,
                context,
            )?,
        }
    }
    if let Some(finding) = beyond_leader(source, &body) {
        output::note(context, &finding);
        body.findings.push(finding);
    }
    Ok(body)
}

/// Said where plans are still under way when nothing is known of the leader any more.
fn beyond_leader(source: &Source, body: &Body) -> Option<String> {
    let road = source.road.as_ref()?;
    let last = road.leader.last()?;
    let plans = body.plans.iter().map(|plan| plan.run.time_s);
    let frontier = body.frontier.iter().map(|point| point.time_s);
    let latest_s = plans.chain(frontier).fold(0.0, f64::max);
    (last.position_m < road.length_m && latest_s > last.time_s).then(|| {
        format!(
            "the leader is at {:.1} m after {:.1} s; what it does after that is not known and holds nobody up",
            last.position_m, last.time_s
        )
    })
}

fn add_frontier(
    body: &mut Body,
    problem: &Problem,
    points: usize,
    settings: &Settings,
) -> anyhow::Result<()> {
    for answer in frontier(problem, points, settings)? {
        match &answer {
            Answer::Plan(plan) => body.frontier.push(FrontierPoint::new(plan)),
            Answer::Obstacle(obstacle) => {
                body.obstacle = Some(ObstacleDocument::new(problem, obstacle));
            }
        }
    }
    Ok(())
}

fn add_plan(
    args: &PlanArgs,
    body: &mut Body,
    tasks: &Tasks,
    (style, problem): (Option<Style>, &Problem),
    source: &Source,
    settings: &Settings,
    context: &Context,
) -> anyhow::Result<()> {
    let demand = match (args.arrive, args.price) {
        (Some(latest_s), _) => Demand::Arrival(latest_s),
        (None, Some(price_w)) => Demand::Price(price_w),
        (None, None) => match tasks.demand.or(source.arrival_s.map(Demand::Arrival)) {
            Some(demand) => demand,
            None if args.case.is_some() => Demand::Price(0.0),
            None => unhurried(problem, settings)?,
        },
    };
    let started = Instant::now();
    let answer = plan(problem, demand, settings)?;
    if started.elapsed().as_secs_f64() > args.budget {
        let words = "the search ended with its time, see --budget: the gap says what is left open";
        body.findings.push(words.to_owned());
        output::note(context, words);
    }
    let solve_ms = (!context.no_times).then(|| 1e3 * started.elapsed().as_secs_f64());
    match &answer {
        Answer::Plan(plan) => {
            let mut document = PlanDocument::new(&tasks.road, plan, demand, solve_ms)?;
            document.style = style;
            if let (Some(own), Some(of_own)) = (&tasks.own, &body.own) {
                document.style_distance = Some(own.distance(problem, &plan.run));
                document.saves_most = savings_in_words(&document.run.nodes, &of_own.nodes, PLACES);
            }
            document.certificate = args.certify.certificate(problem, demand, plan, context)?;
            body.plans.push(document);
            if let Some(path) = &args.output {
                let log = SampledPlan::new(&tasks.road, &plan.run).csv();
                output::write_file(path, |out| Ok(out.write_all(log.as_bytes())?))?;
                output::note(context, &format!("plan written to {}", path.display()));
            }
        }
        Answer::Obstacle(obstacle) => {
            if args.output.is_some() {
                bail!("there is no plan to write: {}", obstacle.words(problem));
            }
            body.obstacle = Some(ObstacleDocument::new(problem, obstacle));
        }
    }
    Ok(())
}

impl PlanArgs {
    fn styles(&self) -> usize {
        self.style.as_ref().map_or(1, Vec::len)
    }
}

/// Nobody said when: 5 % over the earliest arrival, lights and leader included.
fn unhurried(problem: &Problem, settings: &Settings) -> anyhow::Result<Demand> {
    const SHARE: f64 = 1.05;
    let columns = problem.columns();
    let in_traffic = !columns.signals.is_empty() || !columns.earliest_s.is_empty();
    let hurry = Demand::Price(if in_traffic { HURRY_W } else { 0.0 });
    Ok(match plan(problem, hurry, settings)?.plan() {
        Some(plan) if in_traffic => Demand::Arrival(SHARE * plan.run.time_s),
        Some(plan) => Demand::Arrival(SHARE * plan.earliest_arrival_s),
        None => hurry,
    })
}

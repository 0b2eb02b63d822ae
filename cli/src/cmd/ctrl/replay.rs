use std::path::{Path, PathBuf};

use clap::Args;
use report::terminal::{Table, number};
use serde::Serialize;
use testbed_io::log_file;
use testbed_io::recorded::{self, RecordingLayout};
use testbed_io::{Lane, RunFile, Shadow, lengthen, scenario_of, shadow};
use testbed_sim::summary::outcomes_of;
use testbed_sim::{Replay, Summary, Timing, Verdict};
use unicycle_cbf::{Preset, Scenario, ScenarioSpec, Testbed};

use super::run::clear_times;
use super::run_text::{nearest_line, verdict, why_not_known};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::names::named;
use crate::output;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// From which difference of durations on there is something to say, in s.
const NOTED_S: f64 = 0.1;

/// Every decision of a run log once more, or controllers beside recorded poses
///
/// A run log holds the poses that arrived and all settings, so that every decision is repeated and compared bit for bit; exit
/// code 1 says that one differs or that the run was unsafe, 2 that it is not known whether it was safe. With --poses the controllers decide at every step beside robots that were recorded elsewhere
/// and do what they did: are poses like these good enough, and what would the controllers have done?
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl run -o run.parquet && drivekit ctrl replay run.parquet
  drivekit ctrl replay --poses mrclam Robot1_Groundtruth.dat Robot2_Groundtruth.dat
  drivekit ctrl replay --poses csv --scenario mine.toml poses.csv")]
pub(crate) struct ReplayArgs {
    /// A run log (.parquet, .csv or .mcap), or with --poses files or a folder of recorded poses, the robots from the front
    #[arg(value_name = "FILE", required = true)]
    #[serde(skip)]
    files: Vec<PathBuf>,
    /// The files are poses recorded elsewhere, in this layout
    #[arg(long, value_parser = named::<RecordingLayout>(), value_name = "LAYOUT")]
    poses: Option<RecordingLayout>,
    /// Robots that the controllers take them for
    #[arg(long, value_parser = named::<Testbed>(), default_value = "robotarium", requires = "poses")]
    testbed: Testbed,
    /// Settings of the controllers
    #[arg(long, value_parser = named::<Preset>(), default_value = "hardened", requires = "poses")]
    preset: Preset,
    /// Scenario file with path and lane; without it a circular lane is laid around the poses
    #[arg(long, value_name = "FILE.toml", requires = "poses")]
    scenario: Option<PathBuf>,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &ReplayArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/ctrl-replay.txt"
    )))?;
    match (args.poses, args.files.as_slice()) {
        (Some(layout), files) => beside(args, files, layout, context),
        (None, [file]) => again(args, file, context),
        (None, _) => {
            anyhow::bail!("one run log at a time; for poses recorded elsewhere give --poses")
        }
    }
}

#[derive(Serialize)]
struct Again<'a> {
    scenario: &'a str,
    testbed: &'a str,
    #[serde(flatten)]
    replay: &'a Replay,
}

fn again(args: &ReplayArgs, file: &Path, context: &Context) -> anyhow::Result<Outcome> {
    let table = log_file::read(file)?;
    let log = table.run_log()?;
    let mut replay = log.replay()?;
    anyhow::ensure!(
        replay.decisions > 0,
        "{}: there is no whole step in it, so that nothing was compared",
        file.display()
    );
    if let Some(judged) = table.judged()? {
        judged.apply(&mut replay);
    }
    let body = Again {
        scenario: &log.scenario.name,
        testbed: &log.scenario.testbed,
        replay: &replay,
    };
    if replay.truncated {
        output::note(
            context,
            &format!("{} is cut off; what is whole was replayed", file.display()),
        );
    }
    let inputs = FileInputs::read([file.to_owned()])?;
    let mut document = Document::new("ctrl-replay", args, &inputs, body);
    let judged = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&again_text(&replay))?,
    }
    if replay.different > 0 {
        return Ok(Outcome::Negative);
    }
    Ok(judged.and(outcome(replay.verdict, &replay.doubts)?))
}

fn outcome(verdict: Verdict, doubts: &[String]) -> anyhow::Result<Outcome> {
    match verdict {
        Verdict::Safe => Ok(Outcome::Done),
        Verdict::Unsafe => Ok(Outcome::Negative),
        Verdict::NotKnown => anyhow::bail!(
            "whether the robots were safe is not known: {}",
            why_not_known(doubts)
        ),
    }
}

fn again_text(replay: &Replay) -> String {
    let nearest = nearest_line(replay.least_distance.as_ref());
    format!("{}{nearest}{}\n", compared(replay), judged(replay))
}

fn judged(replay: &Replay) -> String {
    let verdict = match (replay.verdict, replay.first_unsafe_s) {
        (Verdict::Safe, _) => "the robots were safe at the steps of the log".to_owned(),
        (_, Some(time_s)) => format!("the robots were UNSAFE from {time_s:.2} s on"),
        (Verdict::Unsafe, None) => {
            "the robots were UNSAFE by what the session saw between the steps of the log, or after its last command".to_owned()
        }
        (_, None) => format!(
            "NOT KNOWN whether the robots were safe: {}",
            why_not_known(&replay.doubts)
        ),
    };
    match &replay.least_distance {
        Some(least) => format!(
            "{verdict}; there bodies were {} mm apart at least",
            number(1e3 * least.gap_m, 1)
        ),
        None => verdict,
    }
}

fn compared(replay: &Replay) -> String {
    match &replay.first {
        None => format!(
            "{} decisions, every one the same bit for bit\n",
            replay.decisions
        ),
        Some(first) => format!(
            "{} decisions, {} differ; the first at step {}, robot {}: {} was {}, is {}\n",
            replay.decisions,
            replay.different,
            first.tick,
            first.robot,
            first.column,
            first.logged,
            first.computed
        ),
    }
}

#[derive(Serialize)]
struct Beside<'a> {
    robots: Vec<Recorded<'a>>,
    rate_hz: f64,
    #[serde(flatten)]
    summary: &'a Summary,
    doubts: &'a [String],
    r#loop: Timing,
}

#[derive(Serialize)]
struct Recorded<'a> {
    name: &'a str,
    poses: usize,
    findings: &'a [recorded::Finding],
    outcomes: std::collections::BTreeMap<String, usize>,
}

fn beside(
    args: &ReplayArgs,
    files: &[PathBuf],
    layout: RecordingLayout,
    context: &Context,
) -> anyhow::Result<Outcome> {
    let recording = recorded::read_recording(files, layout)?;
    let (spec, lane) = match &args.scenario {
        Some(file) => {
            let mut spec = RunFile::read(file)?.scenario;
            let end_s = recording.end_s();
            let had_s = lengthen(&mut spec, &recording).unwrap_or(spec.duration_s);
            if (had_s - end_s).abs() >= NOTED_S {
                let judged = if had_s < end_s {
                    "all of it is judged"
                } else {
                    "of what was after it nothing is known"
                };
                let text = format!(
                    "the scenario lasts {had_s:.1} s and the recording {end_s:.1} s: {judged}"
                );
                output::note(context, &text);
            }
            (spec, Lane::Given)
        }
        None => {
            let settings = args.testbed.scenario("straight", args.preset)?.controller;
            let spec = scenario_of(&recording, args.testbed, settings)?;
            output::note(context, &laid(&spec));
            (spec, Lane::Laid)
        }
    };
    let scenario = Scenario::new(spec)?;
    let Shadow {
        mut ticks,
        summary,
        doubts,
    } = shadow(&scenario, &recording, lane)?;
    if context.no_times {
        clear_times(&mut ticks);
    }
    let robots = recording
        .robots
        .iter()
        .enumerate()
        .map(|(robot, recorded)| Recorded {
            name: &recorded.name,
            poses: recorded.poses.len(),
            findings: &recorded.findings,
            outcomes: outcomes_of(&ticks, robot),
        });
    let body = Beside {
        robots: robots.collect(),
        rate_hz: scenario.spec().rate_hz,
        summary: &summary,
        doubts: &doubts,
        r#loop: Timing::new(&ticks, scenario.controller().hold_s()),
    };
    let inputs = FileInputs::read(args.scenario.iter().chain(files).cloned())?;
    let mut document = Document::new("ctrl-replay", args, &inputs, body);
    let judged = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&beside_text(&document.body))?,
    }
    Ok(judged.and(outcome(summary.verdict, &doubts)?))
}

/// The lane that robots are judged by where none is given.
fn laid(spec: &ScenarioSpec) -> String {
    let half_width_m = spec.controller.lane.half_width_m;
    format!(
        "no lane is given: robots are judged by a circle about the middle of the last robot's poses, with a lane of ±{half_width_m:.2} m; \
         whoever leaves it is not called unsafe (`--scenario` gives the lane)"
    )
}

fn beside_text(body: &Beside) -> String {
    let mut table = Table::new(["robot", "poses", "findings", "outcomes of the controller"]);
    for robot in &body.robots {
        let outcomes = robot
            .outcomes
            .iter()
            .map(|(name, count)| format!("{name} {count}"));
        let findings = robot.findings.iter().map(|finding| finding.detail.clone());
        table.row([
            robot.name.to_owned(),
            robot.poses.to_string(),
            findings.collect::<Vec<_>>().join("; "),
            outcomes.collect::<Vec<_>>().join(", "),
        ]);
    }
    format!(
        "{}\n{} steps at {} Hz; median step {} µs, 99 % within {} µs, {} late\n{}{}\n",
        table.render(),
        body.summary.steps,
        body.rate_hz,
        number(body.r#loop.median_us, 2),
        number(body.r#loop.p99_us, 2),
        body.r#loop.missed,
        nearest_line(body.summary.least_distance.as_ref()),
        verdict(body.summary, body.doubts)
    )
}

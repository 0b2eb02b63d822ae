use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;
use testbed_io::live::{LinkSpec, LiveReport, Session};
use testbed_io::log_file::{self, LogFormat};
use testbed_io::{LoggedRun, RunFile};
use testbed_sim::figures::Event;
use testbed_sim::{Disturbances, Group, Summary, Tick, Timing, Verdict};
use unicycle_cbf::{Demands, Preset, Scenario};

use super::beyond;
use super::check;
use super::ended::Ended;
use super::live::{self, LiveArgs, LiveSession};
use super::run_text::{text, why_not_known};
use super::scenario::{Named, ScenarioArgs};
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::inputs::files::FileInputs;
use crate::names::named;
use crate::numbers;
use crate::output;
use crate::places;
use crate::render::json::Document;
use crate::require::{KnownFigures, RequireArgs};

/// Run a scenario on simulated robots, or with --live on real ones
///
/// Every robot has a controller of its own: a quadratic program that keeps the lane and the headway by barriers, and goes for the
/// desired speed and the path as far as they allow. Exit code 1 says that a robot left its lane or came too close.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit ctrl run --testbed robotarium --scenario track --report run.html
  drivekit ctrl run --preset hardened --disturb all --seed 7 -o run.mcap   for Foxglove
  drivekit ctrl run --show-config > mine.toml && drivekit ctrl run --scenario mine.toml
  drivekit ctrl run --scenario track --testbed robotarium --path oval.csv
  drivekit ctrl run --show-link khepera > lab.toml                       who and where the real robots are
  drivekit ctrl run --live lab.toml --view -o run.mcap                   real robots, with a page to watch and stop them")]
pub(crate) struct RunArgs {
    /// Print what would be run, as a file for --scenario, and end
    #[arg(long)]
    #[serde(skip)]
    show_config: bool,
    /// Disturbances of the simulated testbed [default: none, or those of the file]
    #[arg(long, value_parser = named::<Group>(), value_name = "GROUP")]
    disturb: Option<Group>,
    /// Seed of all random numbers [default: 1, or that of the file]
    #[arg(long)]
    seed: Option<u64>,
    /// Length of the run, in s [default: 60, or that of the file]
    #[arg(long, value_parser = numbers::run_duration_s, value_name = "S")]
    duration: Option<f64>,
    /// Run log to write: .parquet, .csv or .mcap
    #[arg(long, short, value_name = "FILE.parquet|csv|mcap")]
    #[serde(skip)]
    output: Option<PathBuf>,
    /// Write one self-contained page with an animated view and pictures
    #[arg(long, value_name = "FILE.html")]
    #[serde(skip)]
    report: Option<PathBuf>,
    #[command(flatten)]
    #[serde(flatten)]
    scenario: ScenarioArgs,
    #[command(flatten)]
    #[serde(flatten)]
    live: LiveArgs,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

pub(crate) fn run(args: &RunArgs, context: &Context) -> anyhow::Result<Outcome> {
    if let Some(kind) = args.live.show_link {
        output::print_text(kind.text())?;
        return Ok(Outcome::Done);
    }
    args.require.check(&KnownFigures::new(include_str!(
        "../../figures/ctrl-run.txt"
    )))?;
    let named = args.named(context)?;
    let inputs = args.inputs(&named)?;
    let scenario = match (&named.spec.link, check::fitting(&named.spec.scenario)) {
        (None, Ok(Err(reason))) => {
            output::note(context, &format!("not run, it does not fit: {reason}"));
            if context.format == Format::Json {
                let body = check::Refused {
                    scenario: &named.spec.scenario.name,
                    fits: false,
                    reason,
                };
                output::print_json(&Document::new("ctrl-run", args, &inputs, body))?;
            }
            return Ok(Outcome::Negative);
        }
        (_, Ok(Err(reason))) => anyhow::bail!(reason),
        (_, Ok(Ok(scenario))) => scenario,
        (link, Err(error)) => return Err(live::by_id(error, link.as_ref())),
    };
    if args.show_config {
        // Where robots are is the business of another file.
        let spec = RunFile {
            link: None,
            scenario: scenario.spec().clone(),
            ..named.spec
        };
        output::print_text(&toml::to_string(&spec)?)?;
        return Ok(Outcome::Done);
    }
    let demands = Demands::new(&scenario);
    let mut notes = check::notes(&named.spec.scenario, &demands);
    let stated = &named.spec.scenario.controller.hardening;
    notes.extend(beyond::note(&named.spec.disturbances, stated, &demands));
    for note in notes {
        output::note(context, &note);
    }
    let outputs = args.outputs()?;
    let ended = ended(&named.spec, &scenario, &outputs, context)?;
    let shown = outputs.save(&ended.run, context).and_then(|()| {
        let mut body = Body::new(&named, &ended);
        if outputs.report.is_some() {
            body.figures = Some(ended.run.figures(&scenario)?);
            body.events = Event::all(&scenario);
        }
        let mut document = Document::new("ctrl-run", args, &inputs, body);
        let judged = document.judged(&args.require)?;
        outputs.show(document, &text(&named, &ended), context)?;
        Ok(judged)
    });
    // Robots that may still move are worse than a file that cannot be written.
    let outcome = outcome(&ended)?;
    let judged = shown?;
    Ok(match outcome {
        Outcome::Done => judged,
        Outcome::Negative => outcome,
    })
}

fn outcome(ended: &Ended) -> anyhow::Result<Outcome> {
    if let Some(live) = &ended.live {
        live::check(live)?;
    }
    match ended.summary.verdict {
        Verdict::Safe => Ok(Outcome::Done),
        Verdict::Unsafe => Ok(Outcome::Negative),
        Verdict::NotKnown => anyhow::bail!(
            "whether it was safe is not known: {}",
            why_not_known(ended.doubts())
        ),
    }
}

impl RunArgs {
    fn named(&self, context: &Context) -> anyhow::Result<Named> {
        let preset = match self.live.live {
            Some(_) => Preset::Hardened,
            None => Preset::Thesis,
        };
        let mut named = self.scenario.named(preset)?;
        for text in &named.notes {
            output::note(context, text);
        }
        let spec = &mut named.spec;
        if let Some(group) = self.disturb {
            spec.disturbances = Disturbances::HARD.only(group);
        }
        if let Some(seed) = self.seed {
            spec.seed = seed;
        }
        if let Some(duration_s) = self.duration {
            spec.scenario.duration_s = duration_s;
        }
        spec.disturbances.check().context("disturbances")?;
        self.live.prepare(spec, context)?;
        Ok(named)
    }

    /// Scenario, path, link, and the run log whose poses a link plays; none of them is written.
    fn inputs(&self, named: &Named) -> anyhow::Result<FileInputs> {
        let link = named.spec.link.as_ref();
        let recording = link.and_then(LinkSpec::recording).map(Path::to_owned);
        let files = self.scenario.files().chain(self.live.live.clone());
        let files: Vec<PathBuf> = files.chain(recording).collect();
        for file in &files {
            if let Some(report) = &self.report {
                places::refuse_overwriting("--report", report, file)?;
            }
            if let Some(log) = &self.output {
                places::refuse_overwriting("--output", log, file)?;
                if link.is_some() {
                    let journal = live::partial(log);
                    places::refuse_overwriting(
                        "--output, whose journal is beside it,",
                        &journal,
                        file,
                    )?;
                }
            }
        }
        FileInputs::read(files)
    }

    fn outputs(&self) -> anyhow::Result<Outputs> {
        let log = self.output.as_ref().map(|path| {
            let format = LogFormat::from_path(path)?;
            anyhow::Ok((path.clone(), format))
        });
        Ok(Outputs {
            log: log.transpose()?,
            report: self.report.clone(),
            view: self.live.view,
        })
    }
}

/// Where a run goes beside the terminal.
struct Outputs {
    log: Option<(PathBuf, LogFormat)>,
    report: Option<PathBuf>,
    view: Option<SocketAddr>,
}

fn ended(
    spec: &RunFile,
    scenario: &Scenario,
    outputs: &Outputs,
    context: &Context,
) -> anyhow::Result<Ended> {
    let (run, summary, live) = match &spec.link {
        None => {
            let (mut run, summary) = spec.simulate()?;
            if context.no_times {
                clear_times(&mut run.ticks);
            } else if matches!(outputs.log, Some((_, LogFormat::Mcap))) {
                run.started_unix_s = Some(live::unix_now_s());
            }
            (run, summary, None)
        }
        Some(link) => {
            let session = LiveSession {
                spec,
                session: Session { scenario, link },
                log: outputs.log.as_ref().map(|(path, _)| path.as_path()),
                view: outputs.view,
            };
            let (run, summary, live) = session.run(context)?;
            (run, summary, Some(live))
        }
    };
    Ok(Ended {
        timing: Timing::new(&run.ticks, scenario.controller().hold_s()),
        run,
        summary,
        live,
    })
}

impl Outputs {
    fn save(&self, run: &LoggedRun, context: &Context) -> anyhow::Result<()> {
        let Some((path, format)) = &self.log else {
            return Ok(());
        };
        let table = run.to_table()?;
        output::write_file(path, |out| Ok(log_file::write(&table, *format, out)?))?;
        output::note(context, &format!("run log written to {}", path.display()));
        if run.spec.link.is_some() {
            live::remove_journal(path);
        }
        Ok(())
    }

    /// Report and document.
    fn show<C: Serialize>(
        &self,
        mut document: Document<'_, C, Body<'_>>,
        text: &str,
        context: &Context,
    ) -> anyhow::Result<()> {
        if let Some(path) = &self.report {
            let page = report::CONTROL.filled(&serde_json::to_value(&document)?);
            output::write_page(path, &page, context)?;
            document.body.figures = None;
        }
        let link = document.body.spec.link.as_ref();
        if link.is_some_and(LinkSpec::writes_to_stdout) {
            output::note(context, text);
            return Ok(());
        }
        match context.format {
            Format::Json => output::print_json(&document),
            Format::Text => output::print_text(text),
        }
    }
}

/// Of single decisions, which differ from run to run.
pub(super) fn clear_times(ticks: &mut [Tick]) {
    for tick in ticks {
        tick.step_us = f64::NAN;
    }
}

#[derive(Serialize)]
struct Body<'a> {
    scenario: &'a str,
    testbed: &'a str,
    preset: Option<Preset>,
    seed: u64,
    rate_hz: f64,
    disturbed: bool,
    #[serde(flatten)]
    summary: &'a Summary,
    /// Seconds of each robot from the front without a usable pose
    #[serde(skip_serializing_if = "Option::is_none")]
    unseen_s: Option<&'a [f64]>,
    r#loop: Timing,
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<&'a LiveReport>,
    reproduces: &'static [&'static str],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    events: Vec<Event>,
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<testbed_sim::RunFigures>,
    spec: &'a RunFile,
}

impl<'a> Body<'a> {
    fn new(named: &'a Named, ended: &'a Ended) -> Self {
        let scenario = &named.spec.scenario;
        Self {
            scenario: &scenario.name,
            testbed: &scenario.testbed,
            preset: named.preset,
            seed: named.spec.seed,
            rate_hz: scenario.rate_hz,
            disturbed: !named.spec.disturbances.is_none(),
            summary: &ended.summary,
            unseen_s: ended.live.as_ref().map(|live| live.unseen_s.as_slice()),
            r#loop: ended.timing,
            live: ended.live.as_ref(),
            reproduces: named.figures,
            events: Vec::new(),
            figures: None,
            spec: &named.spec,
        }
    }
}

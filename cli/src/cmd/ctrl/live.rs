//! Real robots: a session on a link, its journal and its view.

use std::io::Write as _;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::Context as _;
use clap::Args;
use live_view::{NewestPlaces, Snapshot, View};
use report::terminal::number;
use serde::Serialize;
use testbed_io::live::{Ending, LinkSpec, LinkTemplate, LiveReport, Session, StopSwitch, Update};
use testbed_io::log_file::Journal;
use testbed_io::{Judged, LoggedRun, RunFile};
use testbed_sim::Summary;
use unicycle_cbf::Scenario;

use super::check::missing_guards;
use crate::flags::Context;
use crate::names::named;
use crate::output;
use crate::temporary;

/// Watchdog of controllers that have none, in s.
const MAX_POSE_AGE_S: f64 = 0.3;

/// Real robots.
#[derive(Debug, Args, Serialize)]
#[command(next_help_heading = "Real robots")]
pub(crate) struct LiveArgs {
    /// Run on the testbed that this file describes; see --show-link. Controllers are hardened unless --preset or the scenario file
    /// says otherwise, which is then said
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["disturb", "seed"])]
    pub(crate) live: Option<PathBuf>,
    /// Print a file for --live to start from, and end
    #[arg(long, value_parser = named::<LinkTemplate>(), value_name = "KIND")]
    #[serde(skip)]
    pub(crate) show_link: Option<LinkTemplate>,
    /// Serve a page with a live view and a stop button, on a free port of this computer or on this address
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:0", requires = "live")]
    #[serde(skip)]
    pub(crate) view: Option<SocketAddr>,
}

impl LiveArgs {
    /// Sees to it that the scenario can run on real robots, if that is asked for.
    pub(crate) fn prepare(&self, spec: &mut RunFile, context: &Context) -> anyhow::Result<()> {
        let Some(file) = &self.live else {
            if spec.link.is_some() {
                anyhow::bail!(
                    "the scenario was run on real robots: take [link] out of the file, or name a link with --live"
                );
            }
            return Ok(());
        };
        if !spec.disturbances.is_none() {
            anyhow::bail!(
                "the scenario asks for disturbances, which only simulated robots have; take them out, or leave --live out"
            );
        }
        for text in missing_guards(&spec.scenario.controller) {
            output::note(context, &text);
        }
        let hardening = &mut spec.scenario.controller.hardening;
        if hardening.max_pose_age_s.is_none() {
            hardening.max_pose_age_s = Some(MAX_POSE_AGE_S);
            let text = format!(
                "no watchdog in these settings: on real robots they stop after {MAX_POSE_AGE_S} s without a pose"
            );
            output::note(context, &text);
        }
        let text = std::fs::read_to_string(file)
            .with_context(|| format!("cannot read the link `{}`", file.display()))?;
        let link = toml::from_str(&text);
        spec.link = Some(link.with_context(|| format!("link `{}`", file.display()))?);
        Ok(())
    }
}

/// A session, and what is made of it on the way.
pub(crate) struct LiveSession<'a> {
    pub(crate) spec: &'a RunFile,
    pub(crate) session: Session<'a>,
    pub(crate) log: Option<&'a Path>,
    pub(crate) view: Option<SocketAddr>,
}

impl LiveSession<'_> {
    /// Runs it, and gives the run with all its ticks.
    pub(crate) fn run(
        &self,
        context: &Context,
    ) -> anyhow::Result<(LoggedRun, Summary, LiveReport)> {
        let stop = StopSwitch::default();
        watch_signals(&stop)?;
        let (scenario, link) = (self.session.scenario, self.session.link);
        let view = self.view.map(|at| view(at, scenario, &stop, context));
        let view = view.transpose()?;
        let journal = self
            .log
            .map(|log| Journal::create(&partial(log), self.spec));
        let journal = journal.transpose()?;
        let notes = Notes::start(context)?;
        // No growing in the loop.
        let mut kept = Vec::with_capacity(scenario.steps() * link.robots.len());
        let mut started_unix_s = None;
        let mut places = NewestPlaces::new(scenario);
        let ended = self.session.run(&stop, |update| match update {
            Update::Note(note) => {
                let text = note.to_string();
                if let Some(view) = &view {
                    view.note(&text);
                }
                notes.show(text);
            }
            Update::Step {
                ticks,
                pose_ages_s,
                counts,
                missed,
            } => {
                let time_s = ticks.first().map_or(0.0, |tick| tick.time_s);
                let started_s = *started_unix_s.get_or_insert_with(|| unix_now_s() - time_s);
                let add = |journal: &Journal| journal.add(ticks, started_s);
                if journal.as_ref().is_some_and(|journal| !add(journal)) && !stop.is_on() {
                    stop.stop();
                    notes.show("the run log takes no more; stopping".to_owned());
                }
                kept.extend_from_slice(ticks);
                if let Some(view) = &view {
                    let robots = places.robots(ticks, pose_ages_s, &link.robots);
                    view.show(Snapshot {
                        time_s,
                        duration_s: scenario.spec().duration_s,
                        robots,
                        late_us: ticks.first().map_or(0.0, |tick| tick.late_us),
                        missed,
                        dropped: counts.dropped(),
                    });
                }
            }
        });
        notes.finish();
        if let Ok((_, report)) = &ended {
            warn_of_untold(report);
            if let Some(view) = &view {
                view.ended(&ending_text(&report.ending));
            }
        }
        if let Some(Err(error)) = journal.map(Journal::finish) {
            output::note(context, &format!("{error:#}"));
        }
        if let (Err(_), Some(log)) = (&ended, self.log) {
            // It never started.
            remove_journal(log);
        }
        let (summary, report) = ended?;
        let run = LoggedRun {
            spec: self.spec.clone(),
            ticks: kept,
            started_unix_s,
            judged: Some(Judged {
                verdict: summary.verdict,
                doubts: report.doubts.clone(),
            }),
        };
        Ok((run, summary, report))
    }
}

/// The wall clock, in s since 1970.
pub(crate) fn unix_now_s() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

/// Signals that would end or suspend the program stop the robots instead.
fn watch_signals(stop: &StopSwitch) -> anyhow::Result<()> {
    temporary::leave_signals_alone();
    #[cfg(unix)]
    use signal_hook::consts::{SIGHUP, SIGQUIT, SIGTSTP};
    use signal_hook::consts::{SIGINT, SIGTERM};
    let signals = [
        SIGINT,
        SIGTERM,
        #[cfg(unix)]
        SIGHUP,
        #[cfg(unix)]
        SIGQUIT,
        #[cfg(unix)]
        SIGTSTP,
    ];
    for signal in signals {
        signal_hook::flag::register(signal, stop.flag()).context("cannot watch for signals")?;
    }
    Ok(())
}

/// Notes on stderr by a thread of their own: a reader that does not read must not hold up the loop.
struct Notes {
    texts: SyncSender<String>,
    thread: JoinHandle<()>,
}

impl Notes {
    fn start(context: &Context) -> anyhow::Result<Self> {
        let (texts, waiting) = sync_channel::<String>(64);
        let context = *context;
        let thread = std::thread::Builder::new().name("notes".to_owned());
        let thread = thread.spawn(move || {
            for text in waiting {
                output::note(&context, &text);
            }
        })?;
        Ok(Self { texts, thread })
    }

    fn show(&self, text: String) {
        let _ = self.texts.try_send(text);
    }

    /// Waits for what is still to be shown, but not for ever.
    fn finish(self) {
        drop(self.texts);
        for _ in 0..100 {
            if self.thread.is_finished() {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// The journal beside a run log: `run.partial.csv` for `run.mcap`. It stays if the program is killed.
pub(crate) fn partial(log: &Path) -> PathBuf {
    log.with_extension("partial.csv")
}

/// The run log is written; the journal says no more than it.
pub(crate) fn remove_journal(log: &Path) {
    let _ = std::fs::remove_file(partial(log));
}

/// Before anything else that may fail, and also with `--quiet`.
fn warn_of_untold(report: &LiveReport) {
    if let Some(text) = untold(report) {
        let _ = writeln!(
            anstream::stderr().lock(),
            "\u{1b}[1;31mwarning:\u{1b}[0m {text}"
        );
    }
}

fn untold(report: &LiveReport) -> Option<String> {
    let ids = report.untold.iter().map(ToString::to_string);
    let ids = ids.collect::<Vec<_>>().join(", ");
    let text = || format!("robots {ids} may not have got the command to stand: STOP THEM BY HAND");
    (!report.untold.is_empty()).then(text)
}

/// Who sits before real robots knows them by their ids.
pub(crate) fn by_id(error: anyhow::Error, link: Option<&LinkSpec>) -> anyhow::Error {
    let Some(unicycle_cbf::Error::Start { robot, what }) = error.downcast_ref() else {
        return error;
    };
    match link.and_then(|link| link.robots.get(*robot)) {
        Some(id) => anyhow::anyhow!("robot {id} {what}"),
        None => error,
    }
}

/// A link that was lost, or robots that may still move, are errors.
pub(crate) fn check(report: &LiveReport) -> anyhow::Result<()> {
    if let Some(text) = untold(report) {
        anyhow::bail!(text);
    }
    if let Ending::Lost(what) = &report.ending {
        anyhow::bail!("the link was lost: {what}");
    }
    Ok(())
}

/// Rows of the table of figures.
pub(crate) fn rows(report: &LiveReport, row: &mut impl FnMut(&str, String, &str)) {
    let deadlines = &report.deadlines;
    row("deadlines missed", deadlines.missed.to_string(), "");
    row(
        "99 % of steps begin late by",
        number(deadlines.late_p99_us, 0),
        "µs",
    );
    row("poses used", report.received.poses.to_string(), "");
    for (reason, count) in report.received.dropped() {
        row(&format!("dropped: {reason}"), count.to_string(), "");
    }
    let unseen = report.unseen_s.iter().zip(&report.longest_unseen_s);
    for (id, (all_s, longest_s)) in report.robots.iter().zip(unseen) {
        if *all_s > 0.0 {
            let (all, longest) = (number(*all_s, 1), number(*longest_s, 1));
            let value = format!("{all}, at most {longest} at a time");
            row(&format!("robot {id} unseen"), value, "s");
        }
    }
    let commands = &report.commands;
    row("commands sent", commands.sent.to_string(), "");
    let others = [
        ("commands acknowledged", commands.acknowledged),
        ("commands not sent", commands.failed),
        ("answers from other addresses", commands.stranger),
        ("answers that are none", commands.malformed),
    ];
    for (name, count) in others.into_iter().filter(|(_, count)| *count > 0) {
        row(name, count.to_string(), "");
    }
}

pub(crate) fn ending_text(ending: &Ending) -> String {
    match ending {
        Ending::Finished => "finished".to_owned(),
        Ending::Stopped => "stopped".to_owned(),
        Ending::Lost(what) => format!("link lost: {what}"),
    }
}

fn view(
    address: SocketAddr,
    scenario: &Scenario,
    stop: &StopSwitch,
    context: &Context,
) -> anyhow::Result<View> {
    let stop = stop.clone();
    let view = View::start(address, scenario, Box::new(move || stop.stop()))?;
    output::note(context, &format!("view: {}", view.control_url()));
    output::note(context, &format!("to watch only: {}", view.watch_url()));
    Ok(view)
}

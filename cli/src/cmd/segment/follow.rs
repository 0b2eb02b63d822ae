//! Segments of a drive that is still going on, one line each.

use std::io::BufReader;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use anyhow::bail;
use drive_log::{Row, RowReader, Smoothing};
use driver_model::segmentation::{PhaseStream, Reading, Scaling, StreamedPhase};
use report::terminal::number;

use super::args::SegmentArgs;
use super::output::SegmentEntry;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::output::{Reader, note, print_to_reader};
#[cfg(unix)]
use crate::temporary::is_ignored;

const STDIN: &str = "stdin";

/// Rows that are read ahead.
const READ_AHEAD: usize = 256;

/// What the loop waits for.
enum Told {
    Row(Row),
    Remark(String),
    /// No more rows: the stream has ended, it cannot be read, or the user ends it.
    End(Result<(), drive_log::Error>),
}

pub(super) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    let reading = &args.logs.reading;
    if args.logs.logs.iter().any(|path| path != Path::new("-")) {
        bail!("--follow reads stdin: `logger | drivekit segment - --follow`");
    }
    if !matches!(reading.layout.as_str(), "auto" | "canonical") {
        bail!("--follow reads canonical headers such as time_s,speed_kmh; leave --layout out");
    }
    let method = args.method.resolved(Scaling::WLTC)?;
    let smoothing = if reading.raw {
        Smoothing::None
    } else {
        reading.smooth
    };
    let stream = PhaseStream::new(&method.rules()?, reading.step, smoothing)?;
    if args.method.scale.is_none() {
        note(
            context,
            "speed and acceleration are divided by half their ranges in the WLTC; --scale V,A sets others",
        );
    }
    let told = listen(reading.step, reading.max_gap)?;
    follow(&told, &stream, context)?;
    Ok(Outcome::Done)
}

/// Rows come from a thread, so that a signal is heard while it waits for the next.
fn listen(step_s: f64, max_gap_s: f64) -> anyhow::Result<Receiver<Told>> {
    let (teller, told) = sync_channel(READ_AHEAD);
    end_on_signals(&teller)?;
    std::thread::Builder::new()
        .name("rows".to_owned())
        .spawn(move || {
            let ended = read(step_s, max_gap_s, &teller);
            let _ = teller.send(Told::End(ended));
        })?;
    Ok(told)
}

fn read(step_s: f64, max_gap_s: f64, teller: &SyncSender<Told>) -> Result<(), drive_log::Error> {
    let input = BufReader::new(std::io::stdin());
    let mut rows = RowReader::new(Path::new(STDIN), input, step_s, max_gap_s)?;
    let mut remark = |text| {
        let _ = teller.send(Told::Remark(text));
    };
    while let Some(row) = rows.next_row(&mut remark)? {
        if teller.send(Told::Row(row)).is_err() {
            break;
        }
    }
    Ok(())
}

/// What is buffered is printed before the program ends.
#[cfg(unix)]
fn end_on_signals(teller: &SyncSender<Told>) -> anyhow::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let watched = [SIGINT, SIGTERM, SIGHUP];
    let watched = watched.into_iter().filter(|signal| !is_ignored(*signal));
    let mut signals = signal_hook::iterator::Signals::new(watched)?;
    let teller = teller.clone();
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            if signals.forever().next().is_some() {
                let _ = teller.send(Told::End(Ok(())));
            }
        })?;
    Ok(())
}

#[cfg(not(unix))]
fn end_on_signals(_: &SyncSender<Told>) -> anyhow::Result<()> {
    Ok(())
}

/// Starts from a fresh stream, anew with every piece. Whatever ends it, what was read is printed to its end.
fn follow(told: &Receiver<Told>, fresh: &PhaseStream, context: &Context) -> anyhow::Result<()> {
    let mut printed = Printed::new(context.format);
    let mut stream = fresh.clone();
    let mut ended = Ok(());
    for told in told {
        match told {
            Told::Remark(text) => note(context, &text),
            Told::End(end) => {
                ended = end;
                break;
            }
            Told::Row(row) => {
                if row.starts_piece {
                    let before = std::mem::replace(&mut stream, fresh.clone());
                    printed.phases(&before.finish()?)?;
                    printed.piece_ends();
                }
                printed.sample()?;
                let phase = stream.push(Reading {
                    time_s: row.time_s,
                    speed_mps: row.speed_mps,
                    lead_gap_m: row.lead_gap_m,
                })?;
                printed.phases(phase.as_slice())?;
            }
        }
        if printed.reader == Reader::Gone {
            return Ok(());
        }
    }
    printed.phases(&stream.finish()?)?;
    Ok(ended?)
}

/// The lines so far.
struct Printed {
    format: Format,
    samples: usize,
    before_piece: usize,
    has_header: bool,
    reader: Reader,
}

impl Printed {
    fn new(format: Format) -> Self {
        Self {
            format,
            samples: 0,
            before_piece: 0,
            has_header: format == Format::Json,
            reader: Reader::There,
        }
    }

    /// Before the first phase, so that who waits sees that rows come.
    fn sample(&mut self) -> anyhow::Result<()> {
        self.samples += 1;
        if !self.has_header {
            self.has_header = true;
            self.reader = print_to_reader(&header())?;
        }
        Ok(())
    }

    /// One line each, seen at once by whoever reads.
    fn phases(&mut self, phases: &[StreamedPhase]) -> anyhow::Result<()> {
        for phase in phases {
            let phase = StreamedPhase {
                start: phase.start + self.before_piece,
                end: phase.end + self.before_piece,
                ..*phase
            };
            self.reader = print_to_reader(&match self.format {
                Format::Json => serde_json::to_string(&SegmentEntry::from(&phase))? + "\n",
                Format::Text => line(&phase),
            })?;
        }
        Ok(())
    }

    fn piece_ends(&mut self) {
        self.before_piece = self.samples;
    }
}

fn header() -> String {
    format!(
        "\u{1b}[1m{:>10}  {:>10}  {:12}  {:>9}  {:>9}  leader\u{1b}[0m\n",
        "from s", "to s", "phase", "mean km/h", "mean m/s²"
    )
}

fn line(phase: &StreamedPhase) -> String {
    let line = format!(
        "{:>10}  {:>10}  {:12}  {:>9}  {:>9}  {}",
        number(phase.start_s, 1),
        number(phase.end_s, 1),
        phase.kind.name(),
        number(phase.mean_speed_mps * 3.6, 1),
        number(phase.mean_accel_mps2, 2),
        if phase.lead_influenced { "yes" } else { "" },
    );
    line.trim_end().to_owned() + "\n"
}

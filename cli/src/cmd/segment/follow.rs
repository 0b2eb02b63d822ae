//! Segments of a drive that is still going on, one line each.

use std::sync::mpsc::Receiver;

use driver_model::segmentation::{PhaseStream, Reading, Scaling, StreamedPhase};
use report::terminal::number;

use super::args::SegmentArgs;
use super::output::SegmentEntry;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::listening::{self, Told, listen};
use crate::output::{Reader, note, print_to_reader};

pub(super) fn run(args: &SegmentArgs, context: &Context) -> anyhow::Result<Outcome> {
    listening::check(&args.logs, "segment")?;
    let method = args.method.resolved(Scaling::WLTC)?;
    let smoothing = listening::smoothing(&args.logs);
    let stream = PhaseStream::new(&method.rules()?, args.logs.reading.step, smoothing)?;
    if args.method.scale.is_none() {
        note(
            context,
            "speed and acceleration are divided by half their ranges in the WLTC; --scale V,A sets others",
        );
    }
    follow(&listen(&args.logs, &[])?, &stream, context)?;
    Ok(Outcome::Done)
}

/// Starts from a fresh stream, anew with every piece. Whatever ends it, what was read is printed to its end.
fn follow(told: &Receiver<Told>, fresh: &PhaseStream, context: &Context) -> anyhow::Result<()> {
    let mut printed = Printed::new(context.format);
    let mut stream = fresh.clone();
    let mut ended = Ok(());
    for told in told {
        match told {
            Told::Columns(_) => {}
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

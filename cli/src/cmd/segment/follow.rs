//! Segments of a drive that is still going on, one line each.

use std::io::BufRead;
use std::path::Path;

use anyhow::bail;
use drive_log::{RowReader, Smoothing};
use driver_model::{PhaseStream, Reading, Scaling, StreamedPhase};

use super::SegmentArgs;
use super::output::SegmentEntry;
use crate::exit::Outcome;
use crate::flags::{Context, Format};
use crate::output::{note, print_text};
use crate::render::table::number;

const STDIN: &str = "stdin";

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
    follow(std::io::stdin().lock(), &stream, args, context.format)?;
    Ok(Outcome::Done)
}

/// Starts from a fresh stream, anew after every gap.
fn follow(
    input: impl BufRead,
    fresh: &PhaseStream,
    args: &SegmentArgs,
    format: Format,
) -> anyhow::Result<()> {
    let reading = &args.logs.reading;
    let mut rows = RowReader::new(Path::new(STDIN), input, reading.step, reading.max_gap)?;
    if format == Format::Text {
        print_text(&header())?;
    }
    let mut stream = fresh.clone();
    let mut before_piece = 0;
    let mut samples = 0;
    while let Some(row) = rows.next_row()? {
        if row.starts_piece {
            let ended = std::mem::replace(&mut stream, fresh.clone());
            print(&ended.finish()?, before_piece, format)?;
            before_piece = samples;
        }
        samples += 1;
        let phase = stream.push(Reading {
            time_s: row.time_s,
            speed_mps: row.speed_mps,
            lead_gap_m: row.lead_gap_m,
        })?;
        print(phase.as_slice(), before_piece, format)?;
    }
    print(&stream.finish()?, before_piece, format)
}

/// One line each, seen at once by whoever reads.
fn print(phases: &[StreamedPhase], before_piece: usize, format: Format) -> anyhow::Result<()> {
    for phase in phases {
        let phase = StreamedPhase {
            start: phase.start + before_piece,
            end: phase.end + before_piece,
            ..*phase
        };
        print_text(&match format {
            Format::Json => serde_json::to_string(&SegmentEntry::from(&phase))? + "\n",
            Format::Text => line(&phase),
        })?;
    }
    Ok(())
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

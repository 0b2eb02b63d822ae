//! Rows of a drive that is still going on, from stdin.

use std::io::BufReader;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use anyhow::bail;
use drive_log::{Channel, Row, RowReader, Smoothing};

use crate::flags::LogArgs;
#[cfg(unix)]
use crate::temporary::is_ignored;

const STDIN: &str = "stdin";

/// Rows that are read ahead.
const READ_AHEAD: usize = 256;

/// What who listens waits for.
pub(crate) enum Told {
    /// What rows tell besides, before the first.
    Columns(Vec<Channel>),
    Row(Row),
    Remark(String),
    /// No more rows: the stream has ended, it cannot be read, or the user ends it.
    End(Result<(), drive_log::Error>),
}

/// Refuses what cannot be listened to.
pub(crate) fn check(args: &LogArgs, command: &str) -> anyhow::Result<()> {
    if args.logs.iter().any(|path| path != Path::new("-")) {
        bail!("--follow reads stdin: `logger | drivekit {command} - --follow`");
    }
    if !matches!(args.reading.layout.as_str(), "auto" | "canonical") {
        bail!("--follow reads canonical headers such as time_s,speed_kmh; leave --layout out");
    }
    if args.reading.limit_map.is_some() {
        bail!("--follow takes limits from the stream; leave --limit-map out");
    }
    Ok(())
}

/// How the speed of a stream is smoothed.
pub(crate) fn smoothing(args: &LogArgs) -> Smoothing {
    if args.reading.raw {
        Smoothing::None
    } else {
        args.reading.smooth
    }
}

/// Rows come from a thread, so that a signal is heard while it waits for the next.
pub(crate) fn listen(
    args: &LogArgs,
    channels: &'static [Channel],
) -> anyhow::Result<Receiver<Told>> {
    let (teller, told) = sync_channel(READ_AHEAD);
    end_on_signals(&teller)?;
    let (step_s, max_gap_s) = (args.reading.step, args.reading.max_gap);
    std::thread::Builder::new()
        .name("rows".to_owned())
        .spawn(move || {
            let ended = read(step_s, max_gap_s, channels, &teller);
            let _ = teller.send(Told::End(ended));
        })?;
    Ok(told)
}

fn read(
    step_s: f64,
    max_gap_s: f64,
    channels: &[Channel],
    teller: &SyncSender<Told>,
) -> Result<(), drive_log::Error> {
    let input = BufReader::new(std::io::stdin());
    let rows = RowReader::new(Path::new(STDIN), input, step_s, max_gap_s)?;
    let mut rows = rows.telling(channels);
    let _ = teller.send(Told::Columns(rows.told().to_vec()));
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

//! Commands as JSON lines, in datagrams or to a program.

use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::udp::UdpRobots;
use super::{Command, CommandCounts, CommandSink, Silence};
use crate::Error;
use crate::live::json_lines::lines;

/// All commands of a step in one datagram to one address.
#[derive(Debug)]
pub(in crate::live) struct JsonUdpCommands {
    peer: UdpRobots,
    ids: Vec<u32>,
}

impl JsonUdpCommands {
    /// # Errors
    ///
    /// No socket.
    pub(in crate::live) fn open(address: SocketAddr, ids: &[u32]) -> Result<Self, Error> {
        Ok(Self {
            peer: UdpRobots::bind(&[address], 0)?,
            ids: ids.to_vec(),
        })
    }
}

fn zeros(ids: &[u32]) -> Vec<u8> {
    let commands: Vec<Command> = (0..ids.len()).map(Command::zero).collect();
    lines(ids, &commands)
}

impl CommandSink for JsonUdpCommands {
    fn send(&mut self, commands: &[Command]) {
        self.peer.send(0, &lines(&self.ids, commands));
    }

    fn stop(&mut self, _patience: Duration) -> Vec<usize> {
        // Nothing says that zeros arrived.
        let zeros = zeros(&self.ids);
        if self.peer.repeat(&zeros).is_empty() {
            return Vec::new();
        }
        (0..self.ids.len()).collect()
    }

    fn silence(&self) -> Option<Silence> {
        None
    }

    fn counts(&self) -> CommandCounts {
        self.peer.counts()
    }
}

/// Lines to a program, written by a thread of their own: a program that does not read must not hold up the loop.
#[derive(Debug)]
pub(in crate::live) struct JsonWriter {
    ids: Vec<u32>,
    lines: Option<SyncSender<Vec<u8>>>,
    thread: Option<JoinHandle<()>>,
    written: Arc<AtomicU64>,
    handed_over: u64,
    counts: CommandCounts,
    last_written: (u64, Instant),
}

impl JsonWriter {
    /// Writes to `out`.
    ///
    /// # Errors
    ///
    /// No thread.
    pub(in crate::live) fn start(
        mut out: impl Write + Send + 'static,
        ids: &[u32],
    ) -> Result<Self, Error> {
        let (sender, receiver) = sync_channel::<Vec<u8>>(2);
        let written = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&written);
        let write = move || {
            for text in receiver {
                if out.write_all(&text).and_then(|()| out.flush()).is_err() {
                    return;
                }
                count.fetch_add(1, Ordering::Relaxed);
            }
        };
        let thread = std::thread::Builder::new()
            .name("json commands".to_owned())
            .spawn(write)
            .map_err(|source| Error::no_thread("json commands", &source))?;
        Ok(Self {
            ids: ids.to_vec(),
            lines: Some(sender),
            thread: Some(thread),
            written,
            handed_over: 0,
            counts: CommandCounts::default(),
            last_written: (0, Instant::now()),
        })
    }

    fn is_written(&self) -> bool {
        self.written.load(Ordering::Relaxed) == self.handed_over
    }

    /// Whether the text was taken, which it is not while the program does not read.
    fn hand_over(&mut self, text: Vec<u8>) -> bool {
        let taken = self.lines.as_ref().map(|lines| lines.try_send(text));
        let taken = matches!(taken, Some(Ok(())));
        self.handed_over += u64::from(taken);
        taken
    }
}

impl CommandSink for JsonWriter {
    fn send(&mut self, commands: &[Command]) {
        let text = lines(&self.ids, commands);
        if self.hand_over(text) {
            self.counts.sent += 1;
        } else {
            self.counts.failed += 1;
        }
        let written = self.written.load(Ordering::Relaxed);
        if written > self.last_written.0 {
            self.last_written = (written, Instant::now());
        }
    }

    fn stop(&mut self, patience: Duration) -> Vec<usize> {
        let start = Instant::now();
        let zeros = zeros(&self.ids);
        let mut given = self.hand_over(zeros.clone());
        while start.elapsed() < patience && !(given && self.is_written()) {
            std::thread::sleep(Duration::from_millis(5));
            given = given || self.hand_over(zeros.clone());
        }
        if given && self.is_written() {
            return Vec::new();
        }
        (0..self.ids.len()).collect()
    }

    fn silence(&self) -> Option<Silence> {
        Some(Silence {
            peer: "the program that takes the commands".to_owned(),
            for_s: self.last_written.1.elapsed().as_secs_f64(),
        })
    }

    fn counts(&self) -> CommandCounts {
        self.counts
    }
}

impl Drop for JsonWriter {
    fn drop(&mut self) {
        self.lines = None;
        // One that still writes to a program that does not read is left alone.
        if self.is_written()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

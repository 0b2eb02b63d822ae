//! Robots stand when the loop hangs.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::{Command, CommandCounts, CommandSink, Silence};
use crate::Error;
use crate::live::real_time::into_real_time_class;

/// Without commands for this long, robots are told to stand.
const PATIENCE: Duration = Duration::from_millis(300);
/// For robots to confirm that they stand when nobody asked before the end.
const LAST_PATIENCE: Duration = Duration::from_secs(1);
const ROUND: Duration = Duration::from_millis(50);

/// A sink with a thread beside it that sends zeros when nobody else sends.
pub(in crate::live) struct DeadMan {
    sink: Arc<Mutex<Watched>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

struct Watched {
    sink: Box<dyn CommandSink>,
    last: Instant,
}

impl DeadMan {
    /// Takes over a sink that gets commands once per period; until the first ones, robots are told to stand.
    pub(in crate::live) fn beside(
        sink: Box<dyn CommandSink>,
        robots: usize,
        period_s: f64,
    ) -> Result<Self, Error> {
        let patience = PATIENCE.max(Duration::from_secs_f64(2.5 * period_s));
        let sink = Arc::new(Mutex::new(Watched {
            sink,
            last: Instant::now(),
        }));
        let mut dead_man = Self {
            sink: Arc::clone(&sink),
            ended: Arc::default(),
            thread: None,
        };
        let ended = Arc::clone(&dead_man.ended);
        let thread = std::thread::Builder::new().name("dead man".to_owned());
        let spawned = thread.spawn(move || {
            into_real_time_class();
            let zeros: Vec<Command> = (0..robots).map(Command::zero).collect();
            while !ended.load(Ordering::Relaxed) {
                std::thread::sleep(ROUND);
                let mut watched = lock(&sink);
                if watched.last.elapsed() > patience && !ended.load(Ordering::Relaxed) {
                    watched.sink.send(&zeros);
                }
            }
        });
        match spawned {
            Ok(thread) => dead_man.thread = Some(thread),
            Err(source) => return Err(Error::no_thread("dead man", &source)),
        }
        Ok(dead_man)
    }

    pub(in crate::live) fn send(&self, commands: &[Command]) {
        let mut watched = lock(&self.sink);
        watched.sink.send(commands);
        watched.last = Instant::now();
    }

    /// See [`CommandSink::stop`].
    pub(in crate::live) fn stop(&self, patience: Duration) -> Vec<usize> {
        self.ended.store(true, Ordering::Relaxed);
        lock(&self.sink).sink.stop(patience)
    }

    pub(in crate::live) fn silence(&self) -> Option<Silence> {
        lock(&self.sink).sink.silence()
    }

    pub(in crate::live) fn counts(&self) -> CommandCounts {
        lock(&self.sink).sink.counts()
    }
}

impl Drop for DeadMan {
    /// Also on the way out of a panic, and of an error before the start.
    fn drop(&mut self) {
        if !self.ended.load(Ordering::Relaxed) {
            self.stop(LAST_PATIENCE);
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A sink that panicked may still be able to send zeros.
fn lock(sink: &Mutex<Watched>) -> MutexGuard<'_, Watched> {
    sink.lock().unwrap_or_else(PoisonError::into_inner)
}

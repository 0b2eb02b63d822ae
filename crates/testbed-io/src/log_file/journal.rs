//! A run log that is written while the run goes on, so that it is whole up to the last step whatever ends the program.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use testbed_sim::Tick;

use super::csv::Sheet;
use crate::Error;
use crate::run_file::RunFile;
use crate::run_table::Columns;

/// Steps that wait for a slow disk: at 50 Hz those of 20 s.
const WAITING: usize = 1000;

/// The ticks of a step, and the wall clock at 0 s, in s since 1970.
type Step = (Vec<Tick>, f64);

/// A CSV run log under way. A thread writes each step as a whole, so that a slow disk does not hold up the loop.
#[derive(Debug)]
pub struct Journal {
    steps: Option<SyncSender<Step>>,
    thread: Option<JoinHandle<std::io::Result<()>>>,
}

impl Journal {
    /// Makes the file and writes its header.
    ///
    /// # Errors
    ///
    /// A file that is there already, perhaps of a session that was killed, or that cannot be written.
    pub fn create(path: &Path, spec: &RunFile) -> Result<Self, Error> {
        let failed = |source| Error::Write { source };
        let file = File::create_new(path).map_err(|source| match source.kind() {
            std::io::ErrorKind::AlreadyExists => Error::Content {
                path: path.to_owned(),
                place: String::new(),
                found: "it is there, perhaps of a session that was killed".to_owned(),
                help: "replay it, move it away, or log to another file".to_owned(),
            },
            _ => failed(source),
        })?;
        let half_width_m = spec.half_width_m();
        let columns = move |started_unix_s| Columns {
            half_width_m,
            started_unix_s: Some(started_unix_s),
        };
        let file = BufWriter::with_capacity(1 << 16, file);
        let sheet = Sheet::start(&spec.to_json()?, &columns(0.0).of(&[]), file).map_err(failed)?;
        let (sender, receiver) = sync_channel(WAITING);
        let thread = std::thread::Builder::new().name("run log".to_owned());
        let thread = thread.spawn(move || write(sheet, &receiver, columns));
        Ok(Self {
            steps: Some(sender),
            thread: Some(thread.map_err(failed)?),
        })
    }

    /// Adds the ticks of a step, without waiting. `started_unix_s` is the wall clock at 0 s, in s since 1970. False says that
    /// the file takes no more.
    pub fn add(&self, ticks: &[Tick], started_unix_s: f64) -> bool {
        let step = (ticks.to_vec(), started_unix_s);
        let steps = self.steps.as_ref();
        steps.is_some_and(|steps| steps.try_send(step).is_ok())
    }

    /// Writes what is left.
    ///
    /// # Errors
    ///
    /// A step that could not be written.
    pub fn finish(mut self) -> Result<(), Error> {
        self.close().map_err(|source| Error::Write { source })
    }

    fn close(&mut self) -> std::io::Result<()> {
        self.steps = None;
        let Some(thread) = self.thread.take() else {
            return Ok(());
        };
        let panicked = |_| Err(std::io::Error::other("the thread that writes panicked"));
        thread.join().unwrap_or_else(panicked)
    }
}

impl Drop for Journal {
    /// What was added is in the file also after a panic.
    fn drop(&mut self) {
        let _ = self.close();
    }
}

fn write(
    mut sheet: Sheet<BufWriter<File>>,
    steps: &Receiver<Step>,
    columns: impl Fn(f64) -> Columns,
) -> std::io::Result<()> {
    for (ticks, started_unix_s) in steps {
        sheet.add(&columns(started_unix_s).of(&ticks))?;
    }
    sheet.finish()?.get_ref().sync_all()
}

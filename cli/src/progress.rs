//! A progress bar on stderr, for work that takes over a second, when stderr is a terminal.

use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::flags::Context;

/// What the bar counts: this many a step.
const PARTS: u64 = 1000;

const SHOW_AFTER: Duration = Duration::from_secs(1);

pub(crate) struct Progress {
    bar: ProgressBar,
    started: Instant,
    shown: bool,
}

impl Progress {
    pub(crate) fn new(context: &Context, what: &'static str, steps: usize) -> Self {
        let bar =
            ProgressBar::with_draw_target(Some(steps as u64 * PARTS), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {percent} % {eta}") {
            bar.set_style(style);
        }
        bar.set_message(what);
        Self {
            bar,
            started: Instant::now(),
            shown: !context.quiet && std::io::stderr().is_terminal(),
        }
    }

    /// Shows the bar at once, where the first step takes long.
    pub(crate) fn show(&self) {
        if self.shown {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.tick();
        }
    }

    /// For the number of steps that was not known at first.
    pub(crate) fn set_steps(&self, steps: usize) {
        self.bar.set_length(steps as u64 * PARTS);
    }

    /// One step is done; callable from any thread.
    pub(crate) fn step(&self) {
        self.advance(PARTS);
    }

    /// A step that is done bit by bit.
    pub(crate) fn part(&self) -> Part<'_> {
        Part {
            progress: self,
            done: AtomicU64::new(0),
        }
    }

    fn advance(&self, parts: u64) {
        if self.shown && self.bar.is_hidden() && self.started.elapsed() > SHOW_AFTER {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(parts);
    }
}

/// One step, see [`Progress::part`].
pub(crate) struct Part<'a> {
    progress: &'a Progress,
    done: AtomicU64,
}

impl Part<'_> {
    /// The step is done up to this share, from 0 to 1; callable from any thread.
    pub(crate) fn at(&self, share: f64) {
        let parts = (share.clamp(0.0, 1.0) * PARTS as f64) as u64;
        let before = self.done.fetch_max(parts, Ordering::Relaxed);
        self.progress.advance(parts.saturating_sub(before));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

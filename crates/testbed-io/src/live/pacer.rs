//! Deadlines of the loop: absolute, so that lateness does not add up.

use serde::Serialize;

use super::clock::Clock;
use crate::timing::at_share;

/// Wakes the loop at whole multiples of a period.
#[derive(Debug, Clone)]
pub(super) struct Pacer {
    clock: Clock,
    start_s: f64,
    period_s: f64,
    /// Number of the next deadline
    next: u64,
    fast: bool,
    late_s: Vec<f64>,
    missed: u64,
}

/// How punctual the loop was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deadlines {
    /// Deadlines that passed before the commands of the one before were out
    pub missed: u64,
    /// By how much steps began late, in µs: half of them less than this
    pub late_median_us: f64,
    /// 99 % of them less than this
    pub late_p99_us: f64,
    /// The latest
    pub late_max_us: f64,
}

impl Pacer {
    /// The first deadline is now. Without waiting if `fast`, on a clock on which no time passes in between.
    pub(super) fn new(clock: Clock, period_s: f64, fast: bool) -> Self {
        Self {
            clock,
            start_s: if fast { 0.0 } else { clock.now_s() },
            period_s,
            next: 0,
            fast,
            late_s: Vec::new(),
            missed: 0,
        }
    }

    /// The first deadline is now.
    pub(super) fn restart(&mut self) {
        if !self.fast {
            self.start_s = self.clock.now_s();
        }
    }

    /// Zero of the loop's time on the clock.
    pub(super) fn start_s(&self) -> f64 {
        self.start_s
    }

    /// The loop's time, in s.
    pub(super) fn now_s(&self) -> f64 {
        self.clock.now_s() - self.start_s
    }

    /// Whether there was a deadline.
    pub(super) fn has_begun(&self) -> bool {
        !self.late_s.is_empty()
    }

    /// Waits for the next deadline; gives the time since the start and how late it is, in s.
    pub(super) fn wait(&mut self) -> (f64, f64) {
        let due_s = self.next as f64 * self.period_s;
        let (now_s, late_s) = if self.fast {
            (due_s, 0.0)
        } else {
            self.clock.sleep_until(self.start_s + due_s);
            let now_s = self.clock.now_s() - self.start_s;
            (now_s, now_s - due_s)
        };
        self.late_s.push(late_s);
        (now_s, late_s)
    }

    /// The work of the deadline is done. Deadlines that have passed meanwhile are missed and left out.
    pub(super) fn done(&mut self) {
        self.next += 1;
        if self.fast {
            return;
        }
        let passed = (self.clock.now_s() - self.start_s) / self.period_s;
        let missed = (passed.floor() as u64 + 1).saturating_sub(self.next);
        self.missed += missed;
        self.next += missed;
    }

    pub(super) fn missed(&self) -> u64 {
        self.missed
    }

    pub(super) fn deadlines(&self) -> Deadlines {
        let mut late_s = self.late_s.clone();
        late_s.sort_by(f64::total_cmp);
        let at = |share: f64| 1e6 * at_share(&late_s, share);
        Deadlines {
            missed: self.missed,
            late_median_us: at(0.5),
            late_p99_us: at(0.99),
            late_max_us: at(1.0),
        }
    }
}

//! Time of a session.

use std::time::{Duration, Instant};

/// A monotonic clock that starts at zero. Copies show the same time.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// Zero is now.
    #[must_use]
    pub fn start() -> Self {
        Self {
            start: Instant::now(),
        }
    }

    /// In s.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Sleeps until `time_s`, or not at all if that has passed.
    pub fn sleep_until(&self, time_s: f64) {
        let left_s = time_s - self.now_s();
        if left_s > 0.0 {
            std::thread::sleep(Duration::from_secs_f64(left_s));
        }
    }
}

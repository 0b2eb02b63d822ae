use std::time::{Duration, Instant};

use crate::Status;

/// Measures a fit and says when it has taken too long.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deadline {
    started: Instant,
    limit: Option<Duration>,
    max_iterations: usize,
}

impl Deadline {
    pub(crate) fn new(max_iterations: usize, time_limit_s: Option<f64>) -> Self {
        Self {
            started: Instant::now(),
            limit: time_limit_s.and_then(|s| Duration::try_from_secs_f64(s).ok()),
            max_iterations,
        }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Why to stop now, if at all.
    pub(crate) fn passed(&self, iterations: usize) -> Option<Status> {
        if iterations >= self.max_iterations {
            Some(Status::IterationLimit)
        } else if self
            .limit
            .is_some_and(|limit| self.started.elapsed() >= limit)
        {
            Some(Status::TimeLimit)
        } else {
            None
        }
    }

    pub(crate) fn max_iterations(&self) -> usize {
        self.max_iterations
    }
}

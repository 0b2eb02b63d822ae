//! Who stands because of whom, and whether that goes round in a circle.

/// How long robots stand and wait for each other before that is a deadlock, in s.
const DEADLOCK_S: f64 = 3.0;

/// A robot that stands because of another one.
#[derive(Debug, Clone, Copy)]
struct Hold {
    by: usize,
    since_s: f64,
}

/// By robot.
#[derive(Debug, Clone)]
pub(crate) struct Holds {
    held: Vec<Option<Hold>>,
}

impl Holds {
    pub(crate) fn new(robots: usize) -> Self {
        Self {
            held: vec![None; robots],
        }
    }

    /// A robot stands because of another one, or does not.
    pub(crate) fn add(&mut self, robot: usize, now_s: f64, by: Option<usize>) {
        self.held[robot] = by.map(|by| {
            let known = self.held[robot].filter(|known| known.by == by);
            known.unwrap_or(Hold { by, since_s: now_s })
        });
    }

    /// Whether a robot waits for one that waits, and so on, for itself, all for some time.
    pub(crate) fn is_in_a_circle(&self, robot: usize, now_s: f64) -> bool {
        let mut at = robot;
        for _ in 0..self.held.len() {
            match self.held[at] {
                Some(hold) if now_s - hold.since_s >= DEADLOCK_S => at = hold.by,
                _ => return false,
            }
            if at == robot {
                return true;
            }
        }
        false
    }
}

//! Speeds that are repeated in rows until the sensor gives the next one.

/// Rows of one speed in motion, and the jump that ends them, m/s: a car that keeps its speed, or one in whole km/h, does not.
const ROWS: usize = 3;
const JUMP_MPS: f64 = 0.5;

/// Jumps that tell, and their share of all changes in motion.
const JUMPS: usize = 10;
const SHARE: f64 = 0.5;

/// Counts jumps between rows that stand still.
#[derive(Debug, Default)]
pub(super) struct Held {
    speed_mps: f64,
    rows: usize,
    changes: usize,
    jumps: usize,
    told: bool,
}

impl Held {
    /// Whether it is certain now, once.
    pub(super) fn is_told_by(&mut self, speed_mps: f64) -> bool {
        let jump_mps = (speed_mps - self.speed_mps).abs();
        let moves = speed_mps.min(self.speed_mps) > 0.0;
        if jump_mps == 0.0 {
            self.rows += 1;
            return false;
        }
        self.changes += usize::from(moves);
        self.jumps += usize::from(moves && self.rows >= ROWS && jump_mps > JUMP_MPS);
        (self.speed_mps, self.rows) = (speed_mps, 1);
        let is_held = self.jumps >= JUMPS && self.jumps as f64 >= SHARE * self.changes as f64;
        is_held && !std::mem::replace(&mut self.told, true)
    }
}

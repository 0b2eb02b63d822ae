/// A bound on the time at which a node is passed, or left after waiting there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeBound {
    pub(crate) node: usize,
    /// After the stand at the node, dwell and wait, rather than on arrival.
    pub(crate) after_wait: bool,
    /// No later than the time; otherwise no earlier.
    pub(crate) at_most: bool,
    pub(crate) time_s: f64,
}

impl TimeBound {
    pub(super) fn sign(&self) -> f64 {
        if self.at_most { 1.0 } else { -1.0 }
    }

    /// Whether time spent standing at a node counts.
    pub(crate) fn includes_wait_at(&self, node: usize) -> bool {
        node < self.node || (self.after_wait && node == self.node)
    }
}

/// What is solved.
#[derive(Debug, Clone, Default)]
pub(crate) struct Task {
    /// Price of time on the whole trip, W.
    pub(crate) price_w: f64,
    pub(crate) time_bounds: Vec<TimeBound>,
    /// Nodes where the car stands and may wait for as long as it likes.
    pub(crate) waits: Vec<usize>,
}

impl Task {
    /// Price of the time that is spent standing at a node, W.
    pub(crate) fn price_of_wait(&self, node: usize, multipliers_w: &[f64]) -> f64 {
        let bounds = self.time_bounds.iter().zip(multipliers_w);
        let later = bounds.filter(|(bound, _)| bound.includes_wait_at(node));
        self.price_w + later.map(|(bound, m)| bound.sign() * m).sum::<f64>()
    }
}

/// How precisely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Precision {
    /// Barrier at the end, J.
    pub(crate) barrier_j: f64,
    pub(crate) most_iterations: usize,
}

impl Default for Precision {
    fn default() -> Self {
        Self {
            barrier_j: 2e-3,
            most_iterations: 150,
        }
    }
}

/// Where the method ended.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    /// Squared speeds, m²/s².
    pub(crate) z: Vec<f64>,
    /// Waits, s.
    pub(crate) waits_s: Vec<f64>,
    /// Multiplier of every time bound, W; at least 0.
    pub(crate) multipliers_w: Vec<f64>,
    /// Price of time of every step, W.
    pub(crate) step_price_w: Vec<f64>,
    /// Derivative of the step before a node by the node's squared speed, J/(m²/s²).
    pub(crate) potential: Vec<f64>,
    /// Multipliers of the largest and the smallest acceleration of every step, J/(m/s²).
    pub(crate) accel_multiplier: Vec<[f64; 2]>,
    /// Width of rounded kinks at the end, N.
    pub(crate) kink_width_n: f64,
    pub(crate) converged: bool,
}

use crate::plan::energy_scale_j;
use crate::problem::{Problem, mean_speed};

/// A motion over the nodes with its exact energy and times.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) z: Vec<f64>,
    /// Dwells and waits at every node, s.
    pub(crate) stood_s: Vec<f64>,
    /// Arrival at every node, s.
    pub(crate) arrival_s: Vec<f64>,
    pub(crate) step_energy_j: Vec<f64>,
    /// Infinite where motor or battery cannot drive it.
    pub(crate) energy_j: f64,
}

impl Drive {
    /// From squared speeds and waits at some nodes.
    pub(crate) fn new(problem: &Problem, z: Vec<f64>, waits: &[(usize, f64)]) -> Self {
        let mut stood_s = problem.columns.dwell_s.clone();
        if let Some(last) = stood_s.last_mut() {
            // The trip ends on arrival.
            *last = 0.0;
        }
        for &(node, wait_s) in waits {
            stood_s[node] += wait_s;
        }
        let mut arrival_s = Vec::with_capacity(z.len());
        let mut step_energy_j = Vec::with_capacity(z.len());
        let mut time_s = 0.0;
        arrival_s.push(0.0);
        for (k, step) in problem.steps.iter().enumerate() {
            time_s += stood_s[k] + step.length_m() / mean_speed(z[k], z[k + 1]);
            arrival_s.push(time_s);
            step_energy_j.push(problem.model.energy_j(step, z[k].sqrt(), z[k + 1].sqrt()));
        }
        let standing = |(node, stood_s): (usize, &f64)| {
            if *stood_s > 0.0 {
                problem.standing_power_w(node) * stood_s
            } else {
                0.0
            }
        };
        let energy_j = step_energy_j.iter().sum::<f64>()
            + stood_s.iter().enumerate().map(standing).sum::<f64>();
        Self {
            z,
            stood_s,
            arrival_s,
            step_energy_j,
            energy_j,
        }
    }

    pub(crate) fn time_s(&self) -> f64 {
        self.arrival_s.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn scale_j(&self) -> f64 {
        energy_scale_j(self.energy_j, &self.step_energy_j)
    }

    /// When a node is left, s.
    pub(crate) fn leaving_s(&self, node: usize) -> f64 {
        self.arrival_s[node] + self.stood_s[node]
    }
}

/// Times at which squared speeds pass every node, dwells included, s.
pub(crate) fn passing_s(problem: &Problem, z: &[f64]) -> Vec<f64> {
    let mut time_s = 0.0;
    let steps = problem.steps.iter().enumerate().map(|(k, step)| {
        time_s += problem.columns.dwell_s[k] + step.length_m() / mean_speed(z[k], z[k + 1]);
        time_s
    });
    std::iter::once(0.0).chain(steps).collect()
}

use crate::outcome::Obstacle;
use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;

/// A motion over the nodes of a road.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Speed at every node, m/s; constant acceleration between.
    pub speed_mps: Vec<f64>,
    /// Arrival at every node, s after the start, before any stand there.
    pub arrival_s: Vec<f64>,
    /// Time that the car stands at every node, dwells included, s.
    pub stood_s: Vec<f64>,
    /// Energy from the cells of every step, J.
    pub step_energy_j: Vec<f64>,
    /// Energy from the cells, stands included, J.
    pub energy_j: f64,
    /// Arrival at the end, s.
    pub time_s: f64,
}

impl Run {
    /// The fastest motion within limits and accelerations, signals and leader aside.
    ///
    /// # Errors
    /// The obstacle where there is none.
    pub fn fastest(problem: &Problem) -> Result<Self, Obstacle> {
        let reachable = Reachable::new(problem)?;
        Ok(Drive::new(problem, reachable.high, &[]).into())
    }

    /// The same motion that also stands at some nodes, each with its time in s. Where it moves there, standing makes no motion.
    #[must_use]
    pub fn with_stands(&self, problem: &Problem, stands: &[(usize, f64)]) -> Self {
        let z = self.speed_mps.iter().map(|v| v * v).collect();
        Drive::new(problem, z, stands).into()
    }

    /// What percentages of the energy refer to, J: it may be near 0 downhill.
    #[must_use]
    pub fn energy_scale_j(&self) -> f64 {
        energy_scale_j(self.energy_j, &self.step_energy_j)
    }
}

fn energy_scale_j(energy_j: f64, step_energy_j: &[f64]) -> f64 {
    let turned_over: f64 = step_energy_j.iter().map(|energy| energy.abs()).sum();
    energy_j.abs().max(0.1 * turned_over)
}

impl From<Drive> for Run {
    fn from(drive: Drive) -> Self {
        Self {
            speed_mps: drive.z.iter().map(|z| z.sqrt()).collect(),
            time_s: drive.time_s(),
            energy_j: drive.energy_j,
            arrival_s: drive.arrival_s,
            stood_s: drive.stood_s,
            step_energy_j: drive.step_energy_j,
        }
    }
}

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

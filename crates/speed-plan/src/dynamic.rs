//! Nested dynamic programming over the speeds of all nodes: a coarse grid over the reachable box, then finer ones around the path.
//!
//! It finds the plan of least energy at given prices of time among all speeds, convex or not, and takes losses by table.

use crate::problem::Problem;
use crate::reachable::Reachable;

/// Speeds per node in the first grid, and in those around a path.
const COARSE: usize = 36;
const FINE: usize = 13;

/// How much narrower the grid of a level is than that of the level before.
const NARROWER: f64 = 1.0 / 6.0;

/// A path that runs along the edge of its tube moves it, at most as often as this in a level.
const MOST_MOVES: usize = 8;

/// Accelerations may be beyond their limits by rounding, m/s².
const ROUNDING_MPS2: f64 = 1e-9;

/// A path through the nodes, and what it costs.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    /// Speeds, m/s.
    pub(crate) speed_mps: Vec<f64>,
    /// Energy of all steps and time at its price, J.
    pub(crate) cost_j: f64,
    /// Half the width of the next tube at every node, m/s.
    half_mps: Vec<f64>,
    /// Slope of the cost that is left from a node on by its squared speed, J/(m²/s²).
    pub(crate) slope: Vec<f64>,
}

/// The path of least cost at the price of time of every step, in W; refined `levels` times. `None` where none was found.
pub(crate) fn cheapest(
    problem: &Problem,
    reachable: &Reachable,
    step_price_w: &[f64],
    levels: usize,
) -> Option<Path> {
    let grids: Vec<Vec<f64>> = edges(reachable)
        .map(|(low, high)| even(low, high, COARSE))
        .collect();
    let mut path = best_path(problem, step_price_w, &grids)?;
    path.half_mps = edges(reachable)
        .map(|(low, high)| 1.5 * (high - low) / COARSE as f64)
        .collect();
    for _ in 0..levels {
        path = refined(problem, reachable, step_price_w, path);
    }
    Some(path)
}

/// The cheapest path within a tube around another, which moves while the path runs along its edge.
pub(crate) fn refined(
    problem: &Problem,
    reachable: &Reachable,
    step_price_w: &[f64],
    mut path: Path,
) -> Path {
    let half_mps = path.half_mps.clone();
    for _ in 0..MOST_MOVES {
        let grids = tube(reachable, &path.speed_mps, &half_mps);
        let Some(better) = best_path(problem, step_price_w, &grids) else {
            break;
        };
        let inside = |k: usize| {
            let moved = (better.speed_mps[k] - path.speed_mps[k]).abs();
            moved < 0.99 * half_mps[k] || half_mps[k] <= 0.0
        };
        let settled = (0..half_mps.len()).all(inside) || better.cost_j >= path.cost_j;
        if better.cost_j <= path.cost_j {
            path = better;
        }
        if settled {
            break;
        }
    }
    path.half_mps = half_mps.iter().map(|half| NARROWER * half).collect();
    path
}

impl Path {
    /// As a path to look around for cheaper ones, up to a change of speeds in m/s.
    pub(crate) fn around(mut self, half_mps: f64) -> Self {
        self.half_mps.fill(half_mps);
        self.cost_j = f64::INFINITY;
        self
    }
}

fn edges(reachable: &Reachable) -> impl Iterator<Item = (f64, f64)> {
    reachable
        .low
        .iter()
        .zip(&reachable.high)
        .map(|(low, high)| (low.sqrt(), high.sqrt()))
}

fn even(low: f64, high: f64, count: usize) -> Vec<f64> {
    if high - low < 1e-9 {
        return vec![high];
    }
    let last = (count - 1) as f64;
    (0..count)
        .map(|k| low + (high - low) * (k as f64 / last))
        .collect()
}

/// Speeds around a path, within the box; the path and the edges of the box are always among them.
fn tube(reachable: &Reachable, path: &[f64], half_mps: &[f64]) -> Vec<Vec<f64>> {
    edges(reachable)
        .zip(path.iter().zip(half_mps))
        .map(|((low, high), (&at, &half))| {
            if high - low < 1e-9 {
                return vec![high];
            }
            let mut speeds = even((at - half).max(low), (at + half).min(high), FINE);
            speeds.extend([low, at, high]);
            speeds.sort_by(f64::total_cmp);
            speeds.dedup();
            speeds
        })
        .collect()
}

fn best_path(problem: &Problem, step_price_w: &[f64], grids: &[Vec<f64>]) -> Option<Path> {
    let steps = problem.steps.len();
    let mut to_go = vec![0.0; grids[steps].len()];
    let mut choices: Vec<Vec<u16>> = Vec::with_capacity(steps);
    let mut slope = vec![0.0; steps + 1];
    let mut energy_j = Vec::new();
    for step in (0..steps).rev() {
        let road = &problem.steps[step];
        let (from, to) = (&grids[step], &grids[step + 1]);
        energy_j.resize(to.len(), 0.0);
        let mut costs = Vec::with_capacity(from.len());
        let mut chosen = Vec::with_capacity(from.len());
        for &v0 in from {
            // Only what the accelerations reach; the speeds are in order.
            let (first, last) = within(problem, step, v0, to);
            let row = &mut energy_j[..last - first];
            problem.model.energies_j(road, v0, &to[first..last], row);
            let twice_m = 2.0 * step_price_w[step] * road.length_m();
            let (mut least, mut choice) = (f64::INFINITY, u16::MAX);
            for k in first..last {
                let cost = energy_j[k - first] + twice_m / (v0 + to[k]) + to_go[k];
                if cost < least {
                    (least, choice) = (cost, k as u16);
                }
            }
            costs.push(least);
            chosen.push(choice);
        }
        slope[step] = fitted_slope(from, &costs);
        to_go = costs;
        choices.push(chosen);
    }
    let mut at = (0..to_go.len()).min_by(|a, b| to_go[*a].total_cmp(&to_go[*b]))?;
    let cost_j = to_go[at];
    if !cost_j.is_finite() {
        return None;
    }
    let mut speed_mps = vec![grids[0][at]];
    for step in 0..steps {
        at = usize::from(choices[steps - 1 - step][at]);
        speed_mps.push(grids[step + 1][at]);
    }
    Some(Path {
        half_mps: vec![0.0; speed_mps.len()],
        speed_mps,
        cost_j,
        slope,
    })
}

/// Slope of the costs of squared speeds by least squares, of those that can be driven.
fn fitted_slope(speed_mps: &[f64], cost_j: &[f64]) -> f64 {
    let points = || {
        speed_mps
            .iter()
            .map(|v| v * v)
            .zip(cost_j)
            .filter(|(_, cost)| cost.is_finite())
    };
    let count = points().count() as f64;
    let (mean_z, mean_cost) = points().fold((0.0, 0.0), |(z_sum, cost_sum), (z, cost)| {
        (z_sum + z / count, cost_sum + cost / count)
    });
    let (along, square) = points().fold((0.0, 0.0), |(along, square), (z, cost)| {
        (
            along + (z - mean_z) * (cost - mean_cost),
            square + (z - mean_z) * (z - mean_z),
        )
    });
    if square > 0.0 { along / square } else { 0.0 }
}

/// The range of end speeds whose acceleration is allowed.
pub(crate) fn within(problem: &Problem, step: usize, v0: f64, to: &[f64]) -> (usize, usize) {
    let twice_m = 2.0 * problem.steps[step].length_m();
    let accel = |v1: f64| (v1 - v0) * (v1 + v0) / twice_m;
    let mean = |v1: f64| 0.5 * (v0 + v1);
    let envelope = &problem.envelope;
    let first = to.partition_point(|&v1| {
        accel(v1) < envelope.min_at(mean(v1)).accel_mps2 - ROUNDING_MPS2 || v0 + v1 <= 0.0
    });
    let last =
        to.partition_point(|&v1| accel(v1) <= envelope.max_at(mean(v1)).accel_mps2 + ROUNDING_MPS2);
    (first, last.max(first))
}

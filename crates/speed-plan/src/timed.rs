//! Dynamic programming with the time as a state: which window of every light to take, and where to stand, behind a leader or not.
//!
//! Every node has labels by speed and by bin of time. A label keeps its true time, and of those in a bin the cheapest stays. What it
//! finds can be driven and is a first plan; it proves nothing.

use crate::drive::passing_s;
use crate::dynamic::within;
use crate::problem::Problem;
use crate::reachable::Reachable;

/// Speeds per node, besides those of starting from and braking to the lights.
const SPEEDS: usize = 18;

/// Width of a bin of time where there is room, s, and the room for all labels.
const BIN_S: f64 = 1.0;
const MOST_LABELS: usize = 8_000_000;

/// A leader is kept to but for rounding, s.
const ROUNDING_S: f64 = 1e-9;

/// A motion past all lights.
#[derive(Debug, Clone)]
pub(crate) struct Passage {
    /// Squared speeds, m²/s².
    pub(crate) z: Vec<f64>,
    /// Signals where the car stands, and for how long besides their dwells, s.
    pub(crate) waits: Vec<(usize, f64)>,
}

/// What counts.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Aim {
    /// Energy and time at a price in W.
    Energy { price_w: f64 },
    /// Time alone.
    Time,
}

/// No motion was found beyond a node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocked {
    pub(crate) node: usize,
    /// When the first car would be there, s.
    pub(crate) earliest_s: f64,
}

/// The best motion that arrives in time, of those that the grid holds.
///
/// `reachable` has to hold those that stand at lights, too.
pub(crate) fn passage(
    problem: &Problem,
    reachable: &Reachable,
    aim: Aim,
    latest_s: f64,
) -> Result<Passage, Blocked> {
    let grid = Grid::new(problem, reachable, latest_s);
    let nodes = problem.nodes();
    let mut labels = Labels::none(&grid, 0);
    for speed in 0..grid.speeds_mps[0].len() {
        labels.offer(speed, 0.0, 0.0, 0.0, NO_PARENT);
    }
    let mut parents = Vec::with_capacity(nodes);
    for step in 0..nodes - 1 {
        labels.leave(problem, step, aim);
        let next = labels.driven(problem, step, aim);
        parents.push(std::mem::take(&mut labels.parent));
        if !next.any() {
            return Err(Blocked {
                node: step + 1,
                earliest_s: grid.fastest_s[step + 1],
            });
        }
        labels = next;
    }
    labels.leave(problem, nodes - 1, aim);
    let Some((speed, bin)) = labels.cheapest(latest_s) else {
        return Err(Blocked {
            node: nodes - 1,
            earliest_s: grid.fastest_s[nodes - 1],
        });
    };
    parents.push(labels.parent);
    Ok(grid.traced(problem, &parents, speed * grid.bins + bin))
}

const NO_PARENT: u32 = u32::MAX;

struct Grid {
    /// Speeds of every node, m/s, in order.
    speeds_mps: Vec<Vec<f64>>,
    /// Earliest arrival at every node, s.
    fastest_s: Vec<f64>,
    bins: usize,
    bin_s: f64,
}

impl Grid {
    fn new(problem: &Problem, reachable: &Reachable, latest_s: f64) -> Self {
        let nodes = problem.nodes();
        let fastest_s = passing_s(problem, &reachable.high);
        let slack_s = (latest_s - fastest_s[nodes - 1]).max(0.0) + BIN_S;
        let room = (MOST_LABELS / (nodes * (SPEEDS + 4))).max(16);
        let bins = ((slack_s / BIN_S).ceil() as usize).clamp(1, room);
        Self {
            speeds_mps: speeds_mps(problem, reachable),
            fastest_s,
            bins,
            bin_s: slack_s / bins as f64,
        }
    }

    /// The bin of a time at a node, none where it is too late to arrive in time.
    fn bin(&self, since_fastest_s: f64) -> Option<usize> {
        let bin = (since_fastest_s / self.bin_s).max(0.0) as usize;
        (bin < self.bins).then_some(bin)
    }

    fn traced(&self, problem: &Problem, parents: &[Vec<u32>], last: usize) -> Passage {
        let nodes = parents.len();
        let mut label = last;
        let mut z = vec![0.0; nodes];
        for node in (0..nodes).rev() {
            let speed = self.speeds_mps[node][label / self.bins];
            z[node] = speed * speed;
            label = parents[node][label] as usize;
        }
        let mut waits = Vec::new();
        let mut delay_s = 0.0;
        let driven_s = passing_s(problem, &z);
        for signal in &problem.columns.signals {
            let ready_s = driven_s[signal.node] + problem.dwell_s(signal.node) + delay_s;
            if let Some(green_s) = next_green_s(&signal.green_s, ready_s)
                && green_s > ready_s
            {
                waits.push((signal.node, green_s - ready_s));
                delay_s += green_s - ready_s;
            }
        }
        Passage { z, waits }
    }
}

/// Evenly over the range of every node, with the fastest starts from and the latest braking to every light.
fn speeds_mps(problem: &Problem, reachable: &Reachable) -> Vec<Vec<f64>> {
    let (low, high) = (&reachable.low, &reachable.high);
    let edges = low
        .iter()
        .zip(high)
        .map(|(low, high)| (low.sqrt(), high.sqrt()));
    let mut speeds: Vec<Vec<f64>> = edges
        .map(|(low, high)| {
            let last = (SPEEDS - 1) as f64;
            let between = (0..SPEEDS).map(|k| low + (high - low) * (k as f64 / last));
            between.collect()
        })
        .collect();
    for signal in &problem.columns.signals {
        speeds[signal.node].push(0.0);
        for (node, z) in reachable.around_stand(problem, signal.node) {
            speeds[node].push(z.sqrt());
        }
    }
    for speeds in &mut speeds {
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|a, b| *a - *b < 1e-9);
    }
    speeds
}

/// When a light that is reached at a time may be left, s; none where it stays red.
fn next_green_s(green_s: &[[f64; 2]], ready_s: f64) -> Option<f64> {
    let after = green_s.partition_point(|window| window[1] < ready_s);
    green_s.get(after).map(|window| window[0].max(ready_s))
}

struct Labels<'a> {
    grid: &'a Grid,
    /// Bins count from here, s.
    from_s: f64,
    /// By speed and bin; infinite where there is none.
    cost: Vec<f64>,
    time_s: Vec<f64>,
    parent: Vec<u32>,
}

impl<'a> Labels<'a> {
    fn none(grid: &'a Grid, node: usize) -> Self {
        let count = grid.speeds_mps[node].len() * grid.bins;
        Self {
            grid,
            from_s: grid.fastest_s[node],
            cost: vec![f64::INFINITY; count],
            time_s: vec![0.0; count],
            parent: vec![NO_PARENT; count],
        }
    }

    #[inline]
    fn offer(&mut self, speed: usize, since_s: f64, time_s: f64, cost: f64, parent: u32) {
        let Some(bin) = self.grid.bin(since_s) else {
            return;
        };
        let label = speed * self.grid.bins + bin;
        if cost < self.cost[label] {
            self.cost[label] = cost;
            self.time_s[label] = time_s;
            self.parent[label] = parent;
        }
    }

    fn any(&self) -> bool {
        self.cost.iter().any(|cost| cost.is_finite())
    }

    fn cheapest(&self, latest_s: f64) -> Option<(usize, usize)> {
        let in_time =
            |label: &usize| self.cost[*label].is_finite() && self.time_s[*label] <= latest_s;
        let best = (0..self.cost.len())
            .filter(in_time)
            .min_by(|a, b| self.cost[*a].total_cmp(&self.cost[*b]))?;
        Some((best / self.grid.bins, best % self.grid.bins))
    }

    /// From arriving at a node to leaving it: dwells, and green or waiting for it.
    fn leave(&mut self, problem: &Problem, node: usize, aim: Aim) {
        let grid = self.grid;
        let dwell_s = problem.dwell_s(node);
        let signal = problem.columns.signals.iter().find(|s| s.node == node);
        if dwell_s <= 0.0 && signal.is_none() {
            return;
        }
        let standing_w = problem.standing_power_w(node);
        let per_s = match aim {
            Aim::Energy { price_w } => standing_w + price_w,
            Aim::Time => 1.0,
        };
        let arrived = std::mem::replace(self, Self::none(grid, node));
        self.from_s += dwell_s;
        for (label, cost) in arrived.cost.iter().enumerate() {
            if !cost.is_finite() {
                continue;
            }
            let speed = label / grid.bins;
            let ready_s = arrived.time_s[label] + dwell_s;
            let leaves_s = match signal {
                None => ready_s,
                Some(signal) => match next_green_s(&signal.green_s, ready_s) {
                    Some(green_s) if green_s <= ready_s => ready_s,
                    Some(green_s) if grid.speeds_mps[node][speed] <= 0.0 => green_s,
                    _ => continue,
                },
            };
            let cost = cost + per_s * (leaves_s - arrived.time_s[label]);
            let since_s = leaves_s - self.from_s;
            self.offer(speed, since_s, leaves_s, cost, arrived.parent[label]);
        }
    }

    /// Labels of the next node.
    fn driven(&self, problem: &Problem, step: usize, aim: Aim) -> Self {
        let grid = self.grid;
        let mut next = Self::none(grid, step + 1);
        let road = &problem.steps[step];
        let earliest_s = match problem.columns.earliest_s.get(step + 1) {
            Some(earliest_s) => earliest_s - ROUNDING_S,
            None => f64::NEG_INFINITY,
        };
        let to = &grid.speeds_mps[step + 1];
        let mut energy_j = vec![0.0; to.len()];
        for (speed, &v0) in grid.speeds_mps[step].iter().enumerate() {
            let row = speed * grid.bins..(speed + 1) * grid.bins;
            if self.cost[row.clone()].iter().all(|cost| cost.is_infinite()) {
                continue;
            }
            let (first, last) = within(problem, step, v0, to);
            problem
                .model
                .energies_j(road, v0, &to[first..last], &mut energy_j[first..last]);
            for (faster, &v1) in to.iter().enumerate().take(last).skip(first) {
                let takes_s = 2.0 * road.length_m() / (v0 + v1);
                let step_cost = match aim {
                    Aim::Energy { price_w } => energy_j[faster] + price_w * takes_s,
                    Aim::Time if energy_j[faster].is_finite() => takes_s,
                    Aim::Time => f64::INFINITY,
                };
                if !step_cost.is_finite() {
                    continue;
                }
                for label in row.clone() {
                    let cost = self.cost[label];
                    let time_s = self.time_s[label] + takes_s;
                    if cost.is_finite() && time_s >= earliest_s {
                        let since_s = time_s - next.from_s;
                        next.offer(faster, since_s, time_s, cost + step_cost, label as u32);
                    }
                }
            }
        }
        next
    }
}

//! Where a plan saves most against another run, in words.

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

use serde::Serialize;

use crate::document::{Effort, Nodes};

/// Speeds that differ by less are the same, m/s.
const SAME_MPS: f64 = 0.1;

/// A run that gains or loses less than this over a piece is steady there, m/s.
const STEADY_MPS: f64 = 1.5;

/// Pedals that are left nearer together are left at the same place, m.
const SAME_PLACE_M: f64 = 5.0;

/// What a plan does differently over a piece of road.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "does")]
pub enum Difference {
    /// It leaves the pedal earlier.
    LiftsOffEarlier {
        /// By so much, m.
        by_m: f64,
    },
    /// It speeds up less hard.
    AcceleratesLess,
    /// It slows down less hard.
    BrakesLess,
    /// It is slower.
    Slower {
        /// By so much in the mean, m/s.
        by_mps: f64,
    },
    /// It is faster.
    Faster {
        /// By so much in the mean, m/s.
        by_mps: f64,
    },
}

/// A piece of road where a plan takes less energy than another run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Saving {
    /// Where it begins, m.
    pub from_m: f64,
    /// Where it ends, m.
    pub to_m: f64,
    /// How much less energy the plan takes from the cells, J.
    pub saved_j: f64,
    /// How much later the plan is at its end than if it had taken the time of the other run, s; standing aside.
    pub later_s: f64,
    /// What it does differently.
    #[serde(flatten)]
    pub difference: Difference,
    /// As advice to a driver.
    pub words: String,
}

/// The places, at most so many, where a plan saves most against another run over the same nodes, the greatest first; none where the nodes differ.
///
/// The road is cut where both stand and where their speeds meet, so that neither takes speed along that the other has to gain.
#[must_use]
pub fn savings_in_words(plan: &Nodes, own: &Nodes, most: usize) -> Vec<Saving> {
    if !have_same_nodes(plan, own) {
        return Vec::new();
    }
    let mut savings: Vec<Saving> = pieces(&plan.speed_mps, &own.speed_mps)
        .into_iter()
        .map(|(from, to)| Piece {
            plan,
            own,
            from,
            to,
        })
        .map(|piece| piece.saving())
        .filter(|saving| saving.saved_j > 0.0)
        .collect();
    savings.sort_by(|a, b| b.saved_j.total_cmp(&a.saved_j));
    savings.truncate(most);
    savings
}

fn have_same_nodes(plan: &Nodes, own: &Nodes) -> bool {
    let nodes = plan.position_m.len();
    let is_whole = |run: &Nodes| {
        let steps = [run.effort.len(), run.energy_j.len()];
        run.speed_mps.len() == nodes && steps.iter().all(|steps| steps + 1 == nodes)
    };
    let apart = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-3;
    let places = plan.position_m.iter().zip(&own.position_m);
    own.position_m.len() == nodes && !places.clone().any(apart) && is_whole(plan) && is_whole(own)
}

/// First and last node of the pieces in which one run is faster than the other throughout.
fn pieces(plan_mps: &[f64], own_mps: &[f64]) -> Vec<(usize, usize)> {
    let side = |k: usize| {
        let faster_mps = plan_mps[k] - own_mps[k];
        if faster_mps.abs() < SAME_MPS {
            0
        } else {
            faster_mps.signum() as i8
        }
    };
    let mut pieces = Vec::new();
    let (mut from, mut current) = (0, 0);
    for k in 1..plan_mps.len() {
        let here = side(k);
        if here == current {
            continue;
        }
        if current != 0 {
            // Speeds that cross between two nodes do so nearer to one of them.
            let differs = |k: usize| (plan_mps[k] - own_mps[k]).abs();
            let to = if here == 0 || differs(k) < differs(k - 1) {
                k
            } else {
                k - 1
            };
            if to > from {
                pieces.push((from, to));
            }
            from = to;
        } else {
            from = k - 1;
        }
        current = here;
    }
    let last = plan_mps.len().saturating_sub(1);
    if current != 0 && last > from {
        pieces.push((from, last));
    }
    pieces
}

struct Piece<'a> {
    plan: &'a Nodes,
    own: &'a Nodes,
    from: usize,
    to: usize,
}

impl Piece<'_> {
    fn saving(&self) -> Saving {
        let energy_j = |run: &Nodes| run.energy_j[self.from..self.to].iter().sum::<f64>();
        let position_m = &self.plan.position_m;
        let difference = self.difference();
        Saving {
            from_m: position_m[self.from],
            to_m: position_m[self.to],
            saved_j: energy_j(self.own) - energy_j(self.plan),
            later_s: self.takes_s(self.plan) - self.takes_s(self.own),
            words: self.words(difference),
            difference,
        }
    }

    /// Time in motion.
    fn takes_s(&self, run: &Nodes) -> f64 {
        let step_s = |k: usize| {
            let length_m = run.position_m[k + 1] - run.position_m[k];
            2.0 * length_m / (run.speed_mps[k] + run.speed_mps[k + 1])
        };
        (self.from..self.to)
            .map(step_s)
            .filter(|s| s.is_finite())
            .sum()
    }

    /// What of the plan stands out: where it leaves the pedal before a slower place, how it gains or loses speed, how fast it is.
    fn difference(&self) -> Difference {
        let length_m = self.plan.position_m[self.to] - self.plan.position_m[self.from];
        let by_mps = length_m / self.takes_s(self.plan) - length_m / self.takes_s(self.own);
        let ends = |run: &Nodes| [run.speed_mps[self.from], run.speed_mps[self.to]];
        let [begin_mps, end_mps] = ends(self.own);
        let fastest_mps = self.fastest(self.own);
        if by_mps >= 0.0 {
            let slows = begin_mps - end_mps > STEADY_MPS;
            return if slows && self.hardest(self.plan, -1.0) < self.hardest(self.own, -1.0) {
                Difference::BrakesLess
            } else {
                Difference::Faster { by_mps }
            };
        }
        if fastest_mps - end_mps > STEADY_MPS {
            let by_m = self.off_pedal_m(self.own) - self.off_pedal_m(self.plan);
            if by_m > SAME_PLACE_M {
                return Difference::LiftsOffEarlier { by_m };
            }
            if self.hardest(self.plan, -1.0) < self.hardest(self.own, -1.0) {
                return Difference::BrakesLess;
            }
        }
        let gains = fastest_mps - begin_mps > STEADY_MPS;
        if gains && self.hardest(self.plan, 1.0) < self.hardest(self.own, 1.0) {
            return Difference::AcceleratesLess;
        }
        Difference::Slower { by_mps: -by_mps }
    }

    fn fastest(&self, run: &Nodes) -> f64 {
        run.speed_mps[self.from..=self.to]
            .iter()
            .copied()
            .fold(0.0, f64::max)
    }

    /// The strongest acceleration, or braking for −1, in m/s².
    fn hardest(&self, run: &Nodes, sign: f64) -> f64 {
        let accel = |k: usize| {
            let (from_mps, to_mps) = (run.speed_mps[k], run.speed_mps[k + 1]);
            let length_m = run.position_m[k + 1] - run.position_m[k];
            sign * (to_mps * to_mps - from_mps * from_mps) / (2.0 * length_m)
        };
        (self.from..self.to).map(accel).fold(0.0, f64::max)
    }

    /// Where the motor drives for the last time.
    fn off_pedal_m(&self, run: &Nodes) -> f64 {
        let pushes = |k: &usize| run.effort[*k] == Effort::Drives;
        let last = (self.from..self.to).rev().find(pushes);
        last.map_or(run.position_m[self.from], |k| run.position_m[k + 1])
    }

    fn words(&self, difference: Difference) -> String {
        let km = |node: usize| format!("km {:.2}", self.plan.position_m[node] / 1e3);
        let (from, to) = (km(self.from), km(self.to));
        match difference {
            Difference::LiftsOffEarlier { by_m } => {
                format!("Leave the pedal {by_m:.0} m earlier before {to}")
            }
            Difference::AcceleratesLess => format!("Accelerate less hard from {from} on"),
            Difference::BrakesLess => format!("Brake less hard before {to}"),
            Difference::Slower { by_mps } => {
                format!("Drive {:.1} km/h slower from {from} to {to}", 3.6 * by_mps)
            }
            Difference::Faster { by_mps } => {
                format!("Drive {:.1} km/h faster from {from} to {to}", 3.6 * by_mps)
            }
        }
    }
}

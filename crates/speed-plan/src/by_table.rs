//! Plans for cars whose losses are a table: by dynamic programming, with a bound whose minima are searched numerically.

use crate::drive::{Drive, passing_s};
use crate::dynamic::{Path, cheapest, refined};
use crate::error::Error;
use crate::outcome::Obstacle;
use crate::plan::{Answer, Arrival, Demand, Plan, Proof};
use crate::problem::{Problem, mean_speed};
use crate::reachable::Reachable;

/// Refinements of a path from scratch, and of one that is nearly right.
const LEVELS: usize = 3;
const WARM_LEVELS: usize = 3;

/// How far a path is looked for around one at another price, m/s.
const WARM_MPS: f64 = 2.0;

/// Two plans whose arrivals are this near to each other, as a share, are mixed.
const NEAR: f64 = 3e-3;

/// Highest price of time that is tried, W.
const HIGHEST_PRICE_W: f64 = 1e9;

pub(crate) fn plan_by_table(problem: &Problem, demand: Demand) -> Result<Answer, Error> {
    if !problem.columns.signals.is_empty() || !problem.columns.earliest_s.is_empty() {
        return Err(Error::TableInTraffic);
    }
    let reachable = match Reachable::new(problem) {
        Ok(reachable) => reachable,
        Err(obstacle) => return Ok(Answer::Obstacle(obstacle)),
    };
    let earliest_arrival_s = passing_s(problem, &reachable.high)
        .last()
        .copied()
        .unwrap_or(0.0);
    let by_price = ByPrice {
        problem,
        reachable: &reachable,
    };
    let (drive, price_w, arrival) = match demand {
        Demand::Price(price_w) => (
            by_price.drive(&by_price.path(price_w, None)),
            price_w,
            Arrival::AsAsked,
        ),
        Demand::Arrival(latest_s) => {
            if earliest_arrival_s > latest_s + 1e-7 {
                return Ok(Answer::Obstacle(Obstacle::TooLate { earliest_arrival_s }));
            }
            by_price.arriving(latest_s)
        }
    };
    let path = by_price.path(price_w, None);
    // Of plans that arrive no later than this one, or than was asked for.
    let latest_s = match demand {
        Demand::Price(_) => drive.time_s(),
        Demand::Arrival(latest_s) => latest_s,
    };
    let lower_bound_j = by_price.lower_bound_j(&path, price_w, latest_s);
    let scale_j = drive.scale_j();
    Ok(Answer::Plan(Box::new(Plan {
        arrival,
        earliest_arrival_s,
        price_w: Some(price_w),
        lower_bound_j,
        gap_pct: 100.0 * (drive.energy_j - lower_bound_j) / scale_j,
        proof: Proof::Numerical,
        solved: 1,
        run: drive.into(),
    })))
}

struct ByPrice<'a> {
    problem: &'a Problem<'a>,
    reachable: &'a Reachable,
}

impl ByPrice<'_> {
    fn path(&self, price_w: f64, near: Option<&Path>) -> Option<Path> {
        let prices = vec![price_w; self.problem.steps.len()];
        let Some(near) = near else {
            return cheapest(self.problem, self.reachable, &prices, LEVELS);
        };
        let mut path = near.clone().around(WARM_MPS);
        for _ in 0..WARM_LEVELS {
            path = refined(self.problem, self.reachable, &prices, path);
        }
        Some(path)
    }

    /// The fastest where there is no path: the upper edge of the box is always one.
    fn drive(&self, path: &Option<Path>) -> Drive {
        let z = path.as_ref().map_or_else(
            || self.reachable.high.clone(),
            |path| path.speed_mps.iter().map(|v| v * v).collect(),
        );
        Drive::new(self.problem, z, &[])
    }

    /// The plan that arrives at a time, its price, and whether it had to.
    fn arriving(&self, latest_s: f64) -> (Drive, f64, Arrival) {
        let free = self.path(0.0, None);
        let mut slow = self.drive(&free);
        if slow.time_s() <= latest_s {
            return (slow, 0.0, Arrival::Early);
        }
        let (mut low_w, mut high_w) = (0.0, 1e3);
        let mut near = free;
        let mut fast = loop {
            let path = self.path(high_w, near.as_ref());
            let drive = self.drive(&path);
            near = path;
            if drive.time_s() <= latest_s {
                break drive;
            }
            (slow, low_w) = (drive, high_w);
            high_w *= 4.0;
            if high_w > HIGHEST_PRICE_W {
                break Drive::new(self.problem, self.reachable.high.clone(), &[]);
            }
        };
        for _ in 0..30 {
            if slow.time_s() - fast.time_s() < NEAR * latest_s || high_w - low_w < 1e-6 * high_w {
                break;
            }
            let middle_w = (low_w.max(1.0) * high_w).sqrt();
            let path = self.path(middle_w, near.as_ref());
            let drive = self.drive(&path);
            near = path;
            if drive.time_s() <= latest_s {
                (fast, high_w) = (drive, middle_w);
            } else {
                (slow, low_w) = (drive, middle_w);
            }
        }
        let share = (latest_s - fast.time_s()) / (slow.time_s() - fast.time_s());
        (
            self.mixed(&fast, &slow, latest_s),
            low_w + (1.0 - share) * (high_w - low_w),
            Arrival::AsAsked,
        )
    }

    /// A mix of two plans in the squared speeds that arrives at a time between theirs; the fast one where accelerations that are given over the
    /// speed do not allow it. Other limits are linear there.
    fn mixed(&self, fast: &Drive, slow: &Drive, latest_s: f64) -> Drive {
        let mix = |share: f64| {
            let both = fast.z.iter().zip(&slow.z);
            let z = both
                .map(|(fast, slow)| fast + share * (slow - fast))
                .collect();
            Drive::new(self.problem, z, &[])
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if mix(middle).time_s() <= latest_s {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mixed = mix(low);
        if mixed.energy_j.is_finite() && self.problem.keeps_envelope(&mixed.z) {
            mixed
        } else {
            fast.clone()
        }
    }

    /// As of [`crate::bound`], with the slopes of the cost that is left as potentials and minima by raster and zoom.
    fn lower_bound_j(&self, path: &Option<Path>, price_w: f64, latest_s: f64) -> f64 {
        let Some(path) = path else {
            return f64::NEG_INFINITY;
        };
        let problem = self.problem;
        let last = problem.steps.len();
        let p: Vec<f64> = path.slope.iter().map(|slope| -slope).collect();
        let steps: f64 = (0..last)
            .map(|k| {
                let at = [path.speed_mps[k], path.speed_mps[k + 1]];
                self.least_j(k, price_w, [p[k], p[k + 1]], at)
            })
            .sum();
        let ends = p[last] * self.reachable.high[last] - p[0] * self.reachable.high[0];
        let stands: f64 = (0..last)
            .map(|k| problem.columns.dwell_s[k] * (problem.standing_power_w(k) + price_w))
            .sum();
        steps + ends + stands - price_w * latest_s
    }

    fn least_j(&self, step: usize, price_w: f64, p: [f64; 2], at: [f64; 2]) -> f64 {
        const POINTS: usize = 24;
        let road = &self.problem.steps[step];
        let edge = |node: usize| {
            [
                self.reachable.low[node].sqrt(),
                self.reachable.high[node].sqrt(),
            ]
        };
        let (from, to) = (edge(step), edge(step + 1));
        let cost = |v0: f64, v1: f64| {
            let accel = (v1 * v1 - v0 * v0) / (2.0 * road.length_m());
            let mean = 0.5 * (v0 + v1);
            let envelope = &self.problem.envelope;
            let allowed =
                envelope.min_at(mean).accel_mps2 - 1e-9..=envelope.max_at(mean).accel_mps2 + 1e-9;
            if v0 + v1 <= 0.0 || !allowed.contains(&accel) {
                return f64::INFINITY;
            }
            self.problem.model.energy_j(road, v0, v1)
                + price_w * road.length_m() / mean_speed(v0 * v0, v1 * v1)
                + p[0] * v0 * v0
                - p[1] * v1 * v1
        };
        let mut best = (cost(at[0], at[1]), at);
        let mut half = [from[1] - from[0], to[1] - to[0]];
        let mut middle = [0.5 * (from[0] + from[1]), 0.5 * (to[0] + to[1])];
        half = half.map(|width| 0.5 * width);
        for _ in 0..4 {
            for i in 0..=POINTS {
                let v0 = middle[0] + half[0] * (2.0 * i as f64 / POINTS as f64 - 1.0);
                for j in 0..=POINTS {
                    let v1 = middle[1] + half[1] * (2.0 * j as f64 / POINTS as f64 - 1.0);
                    let place = [v0.clamp(from[0], from[1]), v1.clamp(to[0], to[1])];
                    let value = cost(place[0], place[1]);
                    if value < best.0 {
                        best = (value, place);
                    }
                }
            }
            middle = best.1;
            half = half.map(|half| 0.15 * half);
        }
        best.0
    }
}

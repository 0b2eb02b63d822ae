use crate::outcome::Obstacle;
use crate::problem::{Problem, mean_speed};

/// Down to the square of 0.5 m/s a lowest speed gives way where the car cannot be that fast yet, or no longer.
const CRAWL_Z: f64 = 0.25 * (1.0 - 1e-9);

/// Squared speeds in m²/s² that a plan can have at every node: some plan within limits and accelerations passes each of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reachable {
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
}

impl Reachable {
    /// Forward with the largest acceleration and the strongest braking, then backward.
    ///
    /// The highest speeds that can be reached form a plan, the fastest one, and so do the lowest (the feasible set is a lattice).
    pub(crate) fn new(problem: &Problem) -> Result<Self, Obstacle> {
        Self::within(problem, problem.min_z.clone(), problem.max_z.clone(), 1.0)
    }

    /// Between other squared speeds, with a share of the accelerations that are allowed. Lowest speeds give way where the fastest plan is slower.
    pub(crate) fn within(
        problem: &Problem,
        mut low: Vec<f64>,
        mut high: Vec<f64>,
        share: f64,
    ) -> Result<Self, Obstacle> {
        let beyond =
            |step, here, direction, limits| beyond(problem, share, step, here, direction, limits);
        let nodes = problem.nodes();
        give_way(problem, share, &mut low, &high);
        for k in 1..nodes {
            let step = k - 1;
            let fastest = beyond(step, high[step], Direction::Forward, Limits::Strongest);
            if fastest < low[k] {
                return Err(too_slow(problem, step, high[step]));
            }
            high[k] = high[k].min(fastest);
            let slowest = beyond(step, low[step], Direction::Forward, Limits::Braking);
            if slowest > high[k] * (1.0 + 1e-12) {
                return Err(cannot_stop(problem, k, low[step]));
            }
            low[k] = low[k].max(slowest.min(high[k]));
        }
        for step in (0..nodes - 1).rev() {
            let fastest = beyond(step, high[step + 1], Direction::Backward, Limits::Braking);
            if fastest < low[step] * (1.0 - 1e-12) {
                return Err(cannot_stop(problem, step + 1, low[step]));
            }
            high[step] = high[step].min(fastest.max(low[step]));
            let slowest = beyond(step, low[step + 1], Direction::Backward, Limits::Strongest);
            if slowest > high[step] * (1.0 + 1e-12) {
                return Err(too_slow(problem, step, high[step]));
            }
            low[step] = low[step].max(slowest.min(high[step]));
        }
        Ok(Self { low, high })
    }

    /// Ranges of squared speeds that hold every plan between others that were asked for, also those that stand at some nodes; at such a node, those
    /// that pass it.
    ///
    /// Beyond a stand a car may be slower than else, as it has to start, and before one, as it needs no momentum. Where limits change with the speed
    /// faster than `2v/h`, the fastest plan is not the fastest at every node: a slower start has a lower mean speed, at which more may be allowed.
    pub(crate) fn outer(self, problem: &Problem, asked: [&[f64]; 2], may_stand: &[usize]) -> Self {
        let nodes = problem.nodes();
        let [asked_low, asked_high] = asked;
        // Lowest speeds give way where they do without a stand, and where the car stands before or after.
        let beside_stands = beside_stands(problem, may_stand, asked_high);
        let lowest = |node: usize| asked_low[node].min(self.low[node]).min(beside_stands[node]);
        // No end is faster than the largest acceleration of the envelope takes it.
        let mut fastest = asked_high[0];
        let steep_z: Vec<f64> = (0..nodes - 1)
            .map(|step| {
                let from = fastest;
                let top_mps = mean_speed(from, asked_high[step + 1]);
                let (_, most) = problem.envelope.range(0.0, top_mps);
                let reach = 2.0 * problem.steps[step].length_m() * most;
                fastest = asked_high[step + 1].min(from + reach);
                let slowest = lowest(step).min(lowest(step + 1));
                steep_below_z(problem, step, slowest.sqrt(), mean_speed(from, fastest))
            })
            .collect();
        if may_stand.is_empty() && steep_z.iter().all(|z| *z <= 0.0) {
            return self;
        }
        let passing_or_standing = |node: usize, low: f64| {
            if may_stand.contains(&node) { 0.0 } else { low }
        };
        let mut low: Vec<f64> = (0..nodes).map(lowest).collect();
        let mut high = asked_high.to_vec();
        // The squared speed at the other end of a step, or what no acceleration at any speed goes beyond.
        let ends = |step: usize, low: &[f64], high: &[f64], here: f64, direction, limits| {
            let root = beyond(problem, 1.0, step, here, direction, limits);
            let steep = steep_z[step];
            if steep <= 0.0 {
                return root;
            }
            let slowest = mean_speed(
                passing_or_standing(step, low[step]),
                passing_or_standing(step + 1, low[step + 1]),
            );
            let top_mps = mean_speed(high[step], high[step + 1]);
            let (min, max) = problem.envelope.range(slowest, top_mps);
            let reach = 2.0 * problem.steps[step].length_m();
            match (direction, limits) {
                // Both ends beyond the steep speeds, the other end below them, or this one.
                (Direction::Forward, Limits::Strongest) => {
                    root.max(steep).max(here.min(steep) + reach * max)
                }
                (Direction::Backward, Limits::Braking) => {
                    root.max(steep).max(here.min(steep) - reach * min)
                }
                (Direction::Forward, Limits::Braking) => (here + reach * min).max(0.0),
                (Direction::Backward, Limits::Strongest) => (here - reach * max).max(0.0),
            }
        };
        for k in 1..nodes {
            let step = k - 1;
            let fastest = ends(
                step,
                &low,
                &high,
                high[step],
                Direction::Forward,
                Limits::Strongest,
            );
            high[k] = high[k].min(fastest);
            let before = passing_or_standing(step, low[step]);
            let braked = ends(
                step,
                &low,
                &high,
                before,
                Direction::Forward,
                Limits::Braking,
            );
            low[k] = low[k].max(braked).min(high[k]);
        }
        for step in (0..nodes - 1).rev() {
            let next = passing_or_standing(step + 1, low[step + 1]);
            let needed = ends(
                step,
                &low,
                &high,
                next,
                Direction::Backward,
                Limits::Strongest,
            );
            let braked = ends(
                step,
                &low,
                &high,
                high[step + 1],
                Direction::Backward,
                Limits::Braking,
            );
            high[step] = high[step].min(braked.max(low[step]));
            low[step] = low[step].max(needed.min(high[step]));
        }
        Self { low, high }
    }

    /// The squared speeds at nodes around a stand of the latest braking to it and of the fastest start from it, while they are below the fastest.
    pub(crate) fn around_stand(&self, problem: &Problem, stand: usize) -> Vec<(usize, f64)> {
        let mut speeds = Vec::new();
        let mut here = 0.0;
        for step in (0..stand).rev() {
            here = beyond(
                problem,
                1.0,
                step,
                here,
                Direction::Backward,
                Limits::Braking,
            );
            if here >= self.high[step] {
                break;
            }
            speeds.push((step, here));
        }
        here = 0.0;
        for step in stand..problem.nodes() - 1 {
            here = beyond(
                problem,
                1.0,
                step,
                here,
                Direction::Forward,
                Limits::Strongest,
            );
            if here >= self.high[step + 1] || here <= 0.0 {
                break;
            }
            speeds.push((step + 1, here));
        }
        speeds
    }

    pub(crate) fn is_fixed(&self, node: usize) -> bool {
        self.high[node] - self.low[node] <= 1e-9 * (1.0 + self.high[node])
    }
}

/// Lowers squared speeds to those of the fastest plan, but not below [`CRAWL_Z`], nor at the ends, where they are given.
fn give_way(problem: &Problem, share: f64, low: &mut [f64], high: &[f64]) {
    let mut fastest = high.to_vec();
    for k in 1..fastest.len() {
        let reached = beyond(
            problem,
            share,
            k - 1,
            fastest[k - 1],
            Direction::Forward,
            Limits::Strongest,
        );
        fastest[k] = fastest[k].min(reached);
    }
    for k in (0..fastest.len() - 1).rev() {
        let braked = beyond(
            problem,
            share,
            k,
            fastest[k + 1],
            Direction::Backward,
            Limits::Braking,
        );
        fastest[k] = fastest[k].min(braked);
    }
    for k in 1..low.len() - 1 {
        if fastest[k] < low[k] && fastest[k] >= CRAWL_Z {
            low[k] = fastest[k];
        }
    }
}

/// The highest squared speed at every node of cars that stand at one of several nodes before or after it; infinite where that says nothing.
fn beside_stands(problem: &Problem, stands: &[usize], high: &[f64]) -> Vec<f64> {
    let mut fastest = vec![f64::INFINITY; problem.nodes()];
    if stands.is_empty() {
        return fastest;
    }
    let stand_or = |node: usize, z: f64| if stands.contains(&node) { 0.0 } else { z };
    let next = |step: usize, from: usize, z: f64, direction, limits| {
        if z < high[from] {
            beyond(problem, 1.0, step, z, direction, limits)
        } else {
            f64::INFINITY
        }
    };
    let mut after = f64::INFINITY;
    for (step, fastest) in fastest.iter_mut().skip(1).enumerate() {
        let here = stand_or(step, after);
        after = next(step, step, here, Direction::Forward, Limits::Strongest);
        *fastest = after;
    }
    let mut before = f64::INFINITY;
    for k in (0..fastest.len() - 1).rev() {
        let here = stand_or(k + 1, before);
        before = next(k, k + 1, here, Direction::Backward, Limits::Braking);
        fastest[k] = fastest[k].min(before);
    }
    fastest
}

/// The squared speed of both ends from which on the fastest end of a step belongs to the fastest start: there limits change by no more than
/// `2v/h` per change of the mean speed. 0 where they do at every speed of a range.
fn steep_below_z(problem: &Problem, step: usize, slowest_mps: f64, fastest_mps: f64) -> f64 {
    let length_m = problem.steps[step].length_m();
    let mut from_mps = 0.5 * problem.envelope.steepest_per_s() * length_m;
    let (_, comfort) = problem.envelope.range(slowest_mps, fastest_mps);
    if problem.may_be_weaker(step, [slowest_mps, fastest_mps], comfort) {
        from_mps = from_mps.max(problem.weaker_steep_below_mps(step, fastest_mps, comfort));
    }
    if from_mps <= slowest_mps {
        0.0
    } else {
        from_mps * from_mps
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Direction {
    Forward,
    Backward,
}

#[derive(Clone, Copy, PartialEq)]
enum Limits {
    Strongest,
    Braking,
}

/// The squared speed at the other end of a step whose acceleration is at a limit; at least 0.
fn beyond(
    problem: &Problem,
    share: f64,
    step: usize,
    here: f64,
    direction: Direction,
    limits: Limits,
) -> f64 {
    let sign = if direction == Direction::Forward {
        1.0
    } else {
        -1.0
    };
    let reach = 2.0 * problem.steps[step].length_m() * sign;
    let limit = |other: f64| {
        let speed_mps = mean_speed(here, other);
        match limits {
            Limits::Strongest => gentler(problem.max_accel(step, speed_mps), share),
            Limits::Braking => share * problem.min_accel(speed_mps),
        }
    };
    // Where the limit is that of any speed, this is the solution.
    let first = (here + reach * limit(here)).max(0.0);
    let residual = |other: f64| other - here - reach * limit(other);
    let error = residual(first);
    if error.abs() <= 1e-12 * (1.0 + here) {
        return first;
    }
    bracketed_root(residual, first, error)
}

/// Where a car must lose speed uphill, it loses more.
fn gentler(accel: f64, share: f64) -> f64 {
    if accel > 0.0 {
        share * accel
    } else {
        accel / share
    }
}

/// Root of an increasing function of a squared speed near a first guess; 0 where it lies below.
fn bracketed_root(residual: impl Fn(f64) -> f64, first: f64, error: f64) -> f64 {
    let (mut low, mut high) = (first, first);
    let (mut at_low, mut at_high) = (error, error);
    let mut width = error.abs();
    for _ in 0..60 {
        if at_low <= 0.0 && at_high >= 0.0 {
            break;
        }
        if at_high < 0.0 {
            high += width;
            at_high = residual(high);
        } else if low <= 0.0 {
            return 0.0;
        } else {
            low = (low - width).max(0.0);
            at_low = residual(low);
        }
        width *= 2.0;
    }
    // Regula falsi after Illinois.
    for _ in 0..80 {
        if high - low <= 1e-13 * (1.0 + high) {
            break;
        }
        let share = if at_high > at_low {
            -at_low / (at_high - at_low)
        } else {
            0.5
        };
        let middle = low + share.clamp(1e-3, 1.0 - 1e-3) * (high - low);
        let at_middle = residual(middle);
        if at_middle > 0.0 {
            (high, at_high) = (middle, at_middle);
            at_low *= 0.5;
        } else {
            (low, at_low) = (middle, at_middle);
            at_high *= 0.5;
        }
        if at_middle.abs() <= 1e-13 * (1.0 + middle) {
            return middle;
        }
    }
    0.5 * (low + high)
}

/// Why the slowest speed cannot be held in a step that begins at the highest squared speed that can be reached.
fn too_slow(problem: &Problem, step: usize, from_z: f64) -> Obstacle {
    let position_m = problem.columns.position_m[step];
    let speed_mps = mean_speed(from_z, problem.min_z[step + 1]);
    let given_mps2 = problem.max_accel(step, speed_mps);
    if problem.strongest_accel(step, speed_mps) <= given_mps2 {
        return Obstacle::TooSteep {
            position_m,
            slope_rad: problem.columns.slope_rad[step],
        };
    }
    Obstacle::CannotAccelerate {
        position_m,
        needed_mps2: (problem.min_z[step + 1] - from_z) / (2.0 * problem.steps[step].length_m()),
        allowed_mps2: given_mps2,
    }
}

/// Braking from a speed that cannot be avoided to what the end of a step allows takes too much.
fn cannot_stop(problem: &Problem, node: usize, from_z: f64) -> Obstacle {
    let length_m = problem.steps[node - 1].length_m();
    let to_z = problem.max_z[node];
    Obstacle::CannotStop {
        position_m: problem.columns.position_m[node],
        needed_mps2: (to_z - from_z) / (2.0 * length_m),
        allowed_mps2: problem.min_accel(mean_speed(from_z, to_z)),
    }
}

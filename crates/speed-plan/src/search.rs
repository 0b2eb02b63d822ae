//! Branch and bound over what is not convex: before or after a red, passing or standing, faster or slower at a light.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::time::Instant;

use ev_energy::StepFormula;

use crate::bound::lower_bound;
use crate::drive::{Drive, passing_s};
use crate::error::Error;
use crate::interior_point::{InteriorPoint, Precision, Solution, Task, TimeBound};
use crate::outcome::Obstacle;
use crate::plan::{Answer, Arrival, Demand, Plan, Proof, Settings};
use crate::problem::{Problem, Signal};
use crate::reachable::Reachable;
use crate::timed::{Aim, Blocked, passage};

/// Problems that are solved at most.
const MOST_SOLVED: usize = 400;

/// Problems that are solved before a plan past lights and leader is looked for by other means.
const PATIENCE: usize = 10;

/// Rounds in which bounds of a leader are added to a part, at most.
const MOST_ROUNDS: usize = 15;

/// Share of the accelerations at the first plan of the interior point.
const GENTLE: f64 = 0.7;

/// Barrier at the start, J.
const FIRST_BARRIER_J: f64 = 300.0;

/// Barrier at the start from a plan that is nearly right, J, and how far towards such a plan the start lies.
const WARM_BARRIER_J: f64 = 10.0;
const NEARNESS: f64 = 0.97;

/// Below this price of time in W the arrival does not bind.
const NO_PRICE_W: f64 = 1e-2;

/// Time bounds may be missed by rounding, s.
const ROUNDING_S: f64 = 1e-7;

/// How a signal is passed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Visit {
    /// `None` while it is open whether the car stands there.
    stands: Option<bool>,
    earliest_s: f64,
    latest_s: f64,
}

/// A part of all plans.
#[derive(Debug, Clone)]
struct Part {
    visits: Vec<Visit>,
    /// Ranges of squared speeds at some nodes.
    cuts: Vec<(usize, f64, f64)>,
    /// No plan in it takes less, J.
    bound_j: f64,
}

impl Part {
    /// Those that stand at a signal, and those that pass it.
    fn decided(&self, index: usize) -> Vec<Self> {
        let with = |stands| {
            let mut child = self.clone();
            child.visits[index].stands = Some(stands);
            child
        };
        vec![with(true), with(false)]
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound_j.total_cmp(&self.bound_j)
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

/// The best plan of a part, its bound and its prices.
struct Relaxed {
    drive: Drive,
    bound_j: f64,
    standing_extra_j: Vec<f64>,
    weakest: (usize, f64),
    solution: Solution,
    reachable: Reachable,
    task: Task,
    feasible: bool,
}

enum Relaxation {
    Solved(Box<Relaxed>),
    /// No plan is in the part.
    Empty,
    /// None is without a stand at one of the signals where that is open, of which this is the first.
    Undecided(usize),
    /// None was found.
    Failed,
}

pub(crate) struct Search<'a> {
    problem: &'a Problem<'a>,
    formula: StepFormula,
    demand: Demand,
    settings: Settings,
    precision: Precision,
    started: Instant,
    solved: usize,
    best: Option<Relaxed>,
    /// Whether a plan past lights and leader was looked for, and what was found: one, or where it ends.
    in_time: Option<Result<Drive, Blocked>>,
    /// Squared speeds of a plan that is expected to be near.
    near: Option<Vec<f64>>,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        problem: &'a Problem<'a>,
        formula: StepFormula,
        demand: Demand,
        settings: Settings,
        near: Option<Vec<f64>>,
    ) -> Self {
        Self {
            problem,
            formula,
            demand,
            settings,
            precision: Precision::default(),
            started: Instant::now(),
            solved: 0,
            best: None,
            in_time: None,
            near,
        }
    }

    /// What counts: energy, and time at its price.
    fn cost_j(&self, drive: &Drive) -> f64 {
        match self.demand {
            Demand::Arrival(_) => drive.energy_j,
            Demand::Price(price_w) => drive.energy_j + price_w * drive.time_s(),
        }
    }

    pub(crate) fn run(mut self) -> Result<Answer, Error> {
        let reachable = match Reachable::new(self.problem) {
            Ok(reachable) => reachable,
            Err(obstacle) => return Ok(Answer::Obstacle(obstacle)),
        };
        let fastest_s = passing_s(self.problem, &reachable.high);
        let earliest_arrival_s = fastest_s.last().copied().unwrap_or(0.0);
        if let Demand::Arrival(latest_s) = self.demand
            && earliest_arrival_s > latest_s + ROUNDING_S
        {
            return Ok(Answer::Obstacle(Obstacle::TooLate { earliest_arrival_s }));
        }
        self.precision = self.precision_for(&reachable);
        let mut open = BinaryHeap::from([Part {
            visits: vec![
                Visit {
                    stands: None,
                    earliest_s: f64::NEG_INFINITY,
                    latest_s: f64::INFINITY,
                };
                self.problem.columns.signals.len()
            ],
            cuts: Vec::new(),
            bound_j: f64::NEG_INFINITY,
        }]);
        // The lowest bound of what was set aside without being looked into further.
        let mut left_j = f64::INFINITY;
        while let Some(part) = open.pop() {
            if self.best.is_none() && (self.solved >= PATIENCE || self.is_late()) {
                self.look_in_time(&reachable);
            }
            if self.is_good_enough(part.bound_j) || self.is_over() {
                left_j = left_j.min(part.bound_j);
                break;
            }
            let relaxed = match self.relax(&part) {
                Relaxation::Solved(relaxed) => *relaxed,
                Relaxation::Empty => continue,
                Relaxation::Undecided(index) => {
                    open.extend(part.decided(index));
                    continue;
                }
                Relaxation::Failed => {
                    left_j = left_j.min(part.bound_j);
                    continue;
                }
            };
            let bound_j = relaxed.bound_j.max(part.bound_j);
            let with_stands_j: f64 = relaxed
                .standing_extra_j
                .iter()
                .map(|extra| extra.min(0.0))
                .sum();
            let part = Part {
                bound_j: (bound_j + with_stands_j).max(part.bound_j),
                ..part
            };
            if self.is_good_enough(part.bound_j) {
                left_j = left_j.min(part.bound_j);
                continue;
            }
            let children = self.split(&part, &relaxed);
            let keeps = self.keeps_signals(&relaxed.drive);
            if relaxed.feasible && keeps && self.improves(&relaxed.drive) {
                self.best = Some(relaxed);
            }
            if children.is_empty() {
                left_j = left_j.min(part.bound_j);
            }
            open.extend(children);
        }
        left_j = open.iter().map(|part| part.bound_j).fold(left_j, f64::min);
        if self.best.is_none() {
            self.look_in_time(&reachable);
        }
        Ok(self.answer(left_j, earliest_arrival_s, &reachable))
    }

    /// A barrier that costs a twentieth of the gap that is asked for.
    fn precision_for(&self, reachable: &Reachable) -> Precision {
        let fastest = Drive::new(self.problem, reachable.high.clone(), &[]);
        let gap_j = 0.01 * self.settings.max_gap_pct * fastest.scale_j();
        let bounds = 4.0 * self.problem.nodes() as f64;
        Precision {
            barrier_j: (0.05 * gap_j / bounds).clamp(1e-3, 5e-2),
            ..Precision::default()
        }
    }

    fn improves(&self, drive: &Drive) -> bool {
        drive.energy_j.is_finite()
            && self
                .best
                .as_ref()
                .is_none_or(|best| self.cost_j(drive) < self.cost_j(&best.drive))
    }

    fn is_good_enough(&self, bound_j: f64) -> bool {
        self.best.as_ref().is_some_and(|best| {
            self.cost_j(&best.drive) - bound_j
                <= 0.01 * self.settings.max_gap_pct * best.drive.scale_j()
        })
    }

    fn is_late(&self) -> bool {
        let late = |budget_s| self.started.elapsed().as_secs_f64() > budget_s;
        self.settings.budget_s.is_some_and(late)
    }

    fn is_over(&self) -> bool {
        let has_looked = self.best.is_some() || self.in_time.is_some();
        has_looked && self.is_late() || self.solved >= MOST_SOLVED
    }

    /// A first plan by dynamic programming over time, where there are lights or a leader: its windows and stands are those of a part.
    fn look_in_time(&mut self, whole: &Reachable) {
        let columns = &self.problem.columns;
        let is_free = columns.signals.is_empty() && columns.earliest_s.is_empty();
        if is_free || self.in_time.is_some() {
            return;
        }
        let found = match self.demand {
            Demand::Arrival(latest_s) => {
                self.passage(whole, Aim::Energy { price_w: 0.0 }, latest_s)
            }
            Demand::Price(price_w) => self.passage_ever(whole, Aim::Energy { price_w }),
        };
        if let Ok(drive) = &found {
            let part = self.part_of(drive);
            if let Relaxation::Solved(mut relaxed) = self.relax(&part)
                && relaxed.feasible
                && self.keeps_signals(&relaxed.drive)
            {
                // Of its windows alone.
                relaxed.bound_j = f64::NEG_INFINITY;
                self.best = Some(*relaxed);
            }
        }
        self.in_time = Some(found);
    }

    fn passage(&self, whole: &Reachable, aim: Aim, latest_s: f64) -> Result<Drive, Blocked> {
        let problem = self.problem;
        let lights: Vec<usize> = problem.columns.signals.iter().map(|s| s.node).collect();
        let outer = whole
            .clone()
            .outer(problem, [&problem.min_z, &problem.max_z], &lights);
        let passage = passage(problem, &outer, aim, latest_s)?;
        Ok(Drive::new(problem, passage.z, &passage.waits))
    }

    /// The same at whatever time, up to when the last light has turned green and the leader is gone.
    fn passage_ever(&self, whole: &Reachable, aim: Aim) -> Result<Drive, Blocked> {
        let columns = &self.problem.columns;
        let fastest_s = passing_s(self.problem, &whole.high);
        let alone_s = 2.0 * fastest_s.last().copied().unwrap_or(0.0) + 300.0;
        let greens = columns.signals.iter().filter_map(|s| s.green_s.last());
        let last_s = greens
            .map(|window| window[0])
            .chain(columns.earliest_s.iter().copied())
            .fold(0.0, f64::max);
        let mut latest_s = alone_s;
        loop {
            match self.passage(whole, aim, latest_s) {
                Err(_) if latest_s < alone_s + last_s => latest_s *= 4.0,
                found => return found,
            }
        }
    }

    /// The part that takes the windows of a drive, and stands where it does.
    fn part_of(&self, drive: &Drive) -> Part {
        let visit = |signal: &Signal| {
            let leaving_s = drive.leaving_s(signal.node);
            let holds =
                |window: &&[f64; 2]| window[0] - 1e-6 <= leaving_s && leaving_s <= window[1] + 1e-6;
            let window = signal.green_s.iter().find(holds);
            let [earliest_s, latest_s] = window
                .copied()
                .unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            Visit {
                stands: Some(drive.z[signal.node] <= 0.0),
                earliest_s,
                latest_s,
            }
        };
        Part {
            visits: self.problem.columns.signals.iter().map(visit).collect(),
            cuts: Vec::new(),
            bound_j: f64::NEG_INFINITY,
        }
    }

    fn keeps_signals(&self, drive: &Drive) -> bool {
        self.problem.columns.signals.iter().all(|signal| {
            let time_s = drive.leaving_s(signal.node);
            red_at(&signal.green_s, time_s).is_none()
        })
    }

    /// The best plan of a part with its bound.
    fn relax(&mut self, part: &Part) -> Relaxation {
        let problem = self.problem;
        let (mut low, mut high) = (problem.min_z.clone(), problem.max_z.clone());
        let mut task = Task::default();
        if let Demand::Price(price_w) = self.demand {
            task.price_w = price_w;
        }
        let bound = |node, at_most, time_s| TimeBound {
            node,
            after_wait: true,
            at_most,
            time_s,
        };
        let mut may_stand = Vec::new();
        for (signal, visit) in problem.columns.signals.iter().zip(&part.visits) {
            match visit.stands {
                Some(true) => task.waits.push(signal.node),
                Some(false) => {}
                None => may_stand.push(signal.node),
            }
            if visit.earliest_s.is_finite() {
                task.time_bounds
                    .push(bound(signal.node, false, visit.earliest_s));
            }
            if visit.latest_s.is_finite() {
                task.time_bounds
                    .push(bound(signal.node, true, visit.latest_s));
            }
        }
        for &(node, least, most) in &part.cuts {
            low[node] = low[node].max(least);
            high[node] = high[node].min(most);
        }
        // A cut is of those that pass.
        for &node in &task.waits {
            (low[node], high[node]) = (0.0, 0.0);
        }
        let open = part.visits.iter().position(|visit| visit.stands.is_none());
        if let Demand::Arrival(latest_s) = self.demand {
            task.time_bounds.push(TimeBound {
                node: problem.nodes() - 1,
                after_wait: false,
                at_most: true,
                time_s: latest_s,
            });
        }
        let Ok(reachable) = Reachable::within(problem, low.clone(), high.clone(), 1.0) else {
            return self.none_passes(open);
        };
        let outer = reachable.clone().outer(problem, [&low, &high], &may_stand);
        if !self.can_be_early(&task, &outer) {
            return Relaxation::Empty;
        }
        if !self.can_be_late(&task, &outer) {
            return self.none_passes(open);
        }
        let mut start = self.start(&reachable, &low, &high);
        let mut barrier_j = FIRST_BARRIER_J;
        if let Some(near) = &self.near {
            let clear = |(start, near): (&f64, &f64)| start + NEARNESS * (near - start);
            start = start.iter().zip(near).map(clear).collect();
            barrier_j = WARM_BARRIER_J;
        }
        let mut rounds = 0;
        loop {
            let Some(ip) =
                InteriorPoint::new(problem, self.formula, &reachable, &task, start, barrier_j)
            else {
                return Relaxation::Failed;
            };
            let solution = ip.solve(self.precision);
            self.solved += 1;
            if !solution.is_finite() {
                return Relaxation::Failed;
            }
            let waits: Vec<(usize, f64)> = task
                .waits
                .iter()
                .copied()
                .zip(solution.waits_s.iter().copied())
                .collect();
            let drive = Drive::new(problem, solution.z.clone(), &waits);
            let behind = self.too_close(&drive);
            rounds += 1;
            if behind.is_empty() || rounds >= MOST_ROUNDS || self.solved >= MOST_SOLVED {
                let feasible = behind.is_empty() && keeps(&task, &drive);
                let bound = lower_bound(
                    problem,
                    &self.formula,
                    &outer,
                    &task,
                    &solution,
                    0.1 * 0.01 * self.settings.max_gap_pct * drive.scale_j(),
                    &may_stand,
                );
                return Relaxation::Solved(Box::new(Relaxed {
                    drive,
                    bound_j: bound.energy_j,
                    standing_extra_j: bound.standing_extra_j,
                    weakest: bound.weakest,
                    solution,
                    reachable,
                    task,
                    feasible,
                }));
            }
            let earliest_s = &problem.columns.earliest_s;
            task.time_bounds
                .extend(behind.iter().map(|&node| TimeBound {
                    node,
                    after_wait: false,
                    at_most: false,
                    time_s: earliest_s[node],
                }));
            start = solution.z;
            barrier_j = WARM_BARRIER_J;
        }
    }

    /// What follows from no plan passing all signals where standing is open.
    fn none_passes(&mut self, open: Option<usize>) -> Relaxation {
        let Some(index) = open else {
            return Relaxation::Empty;
        };
        // Counted, so that many signals do not keep the search for ever.
        self.solved += 1;
        Relaxation::Undecided(index)
    }

    /// When squared speeds pass or leave the node of a time bound, waits aside, s.
    fn passing_s(&self, bound: &TimeBound, passing_s: &[f64]) -> f64 {
        let dwell_s = if bound.after_wait {
            self.problem.dwell_s(bound.node)
        } else {
            0.0
        };
        passing_s[bound.node] + dwell_s
    }

    /// Whether the fastest plan keeps every latest time.
    fn can_be_early(&self, task: &Task, reachable: &Reachable) -> bool {
        let fastest_s = passing_s(self.problem, &reachable.high);
        let fastest = |bound: &TimeBound| self.passing_s(bound, &fastest_s);
        let bounds = task.time_bounds.iter();
        bounds.clone().filter(|bound| bound.at_most).all(|bound| {
            let before = |other: &&TimeBound| {
                let at_once = other.node == bound.node && other.after_wait == bound.after_wait;
                !other.at_most && (other.node < bound.node || at_once)
            };
            let earliest_s = bounds
                .clone()
                .filter(before)
                .map(|other| other.time_s + fastest(bound) - fastest(other))
                .fold(fastest(bound), f64::max);
            earliest_s <= bound.time_s + ROUNDING_S
        })
    }

    /// Whether the slowest plan keeps every earliest time, where it may not wait before.
    fn can_be_late(&self, task: &Task, reachable: &Reachable) -> bool {
        let slowest_s = passing_s(self.problem, &reachable.low);
        let first_wait = task.waits.iter().copied().min().unwrap_or(usize::MAX);
        let mut earliest = task.time_bounds.iter().filter(|bound| !bound.at_most);
        earliest.all(|bound| {
            bound.node >= first_wait
                || self.passing_s(bound, &slowest_s) >= bound.time_s - ROUNDING_S
        })
    }

    /// Squared speeds strictly within the box, at gentle accelerations where they suffice.
    fn start(&self, reachable: &Reachable, low: &[f64], high: &[f64]) -> Vec<f64> {
        for share in [GENTLE, 0.9, 0.98] {
            if let Ok(gentle) = Reachable::within(self.problem, low.to_vec(), high.to_vec(), share)
            {
                return inside(&gentle, reachable);
            }
        }
        inside(reachable, reachable)
    }

    /// Nodes where a drive is the furthest ahead of what the leader allows, one for every stretch.
    fn too_close(&self, drive: &Drive) -> Vec<usize> {
        let earliest_s = &self.problem.columns.earliest_s;
        let ahead = |k: usize| earliest_s[k] - drive.arrival_s[k];
        (1..earliest_s.len())
            .filter(|&k| {
                let here = ahead(k);
                let next = if k + 1 < earliest_s.len() {
                    ahead(k + 1)
                } else {
                    f64::NEG_INFINITY
                };
                here > ROUNDING_S && here >= ahead(k - 1) && here >= next
            })
            .collect()
    }

    /// Smaller parts; none where nothing is left to divide.
    fn split(&self, part: &Part, relaxed: &Relaxed) -> Vec<Part> {
        let signals = &self.problem.columns.signals;
        for (index, signal) in signals.iter().enumerate() {
            let time_s = relaxed.drive.leaving_s(signal.node);
            if let Some([from_s, to_s]) = red_at(&signal.green_s, time_s) {
                return around_red(part, index, from_s, to_s);
            }
        }
        // All lights are green: standing at one could still be cheaper where the bound says so.
        let open: Vec<usize> = (0..signals.len())
            .filter(|&k| part.visits[k].stands.is_none())
            .collect();
        for (&index, extra) in open.iter().zip(&relaxed.standing_extra_j) {
            if *extra < 0.0 {
                return part.decided(index);
            }
        }
        self.split_speed(part, relaxed)
    }

    /// Halves the range of speeds where the car has to dawdle: there prices of time are below 0.
    fn split_speed(&self, part: &Part, relaxed: &Relaxed) -> Vec<Part> {
        if !relaxed.feasible && relaxed.solution.converged {
            return Vec::new();
        }
        let (step, loss_j) = relaxed.weakest;
        let width =
            |node: usize| relaxed.reachable.high[node].sqrt() - relaxed.reachable.low[node].sqrt();
        let node = if width(step) >= width(step + 1) {
            step
        } else {
            step + 1
        };
        if loss_j <= 0.0 || relaxed.solution.step_price_w[step] >= 0.0 {
            return Vec::new();
        }
        let (low, high) = (
            relaxed.reachable.low[node].sqrt(),
            relaxed.reachable.high[node].sqrt(),
        );
        if high - low < 0.02 {
            return Vec::new();
        }
        let planned = relaxed.drive.z[node].sqrt();
        let middle = planned
            .clamp(low + 0.2 * (high - low), high - 0.2 * (high - low))
            .powi(2);
        let within = |least: f64, most: f64| {
            let mut child = part.clone();
            child.cuts.push((node, least, most));
            child
        };
        // Where it is open whether the car stands, speeds beyond the range of those that pass are possible.
        vec![within(0.0, middle), within(middle, f64::INFINITY)]
    }

    fn answer(mut self, left_j: f64, earliest_arrival_s: f64, whole: &Reachable) -> Answer {
        let Some(best) = self.best.take() else {
            return match self.in_time.take() {
                Some(Ok(drive)) => {
                    let plan = self.unpolished(drive, left_j, earliest_arrival_s);
                    Answer::Plan(Box::new(plan))
                }
                _ => Answer::Obstacle(self.obstacle(whole)),
            };
        };
        let price_w = match self.demand {
            Demand::Price(price_w) => price_w,
            Demand::Arrival(_) => best.solution.multipliers_w_at_end(&best.task),
        };
        let drive = self.at_arrival(&best, price_w);
        let spent_on_time_j = match self.demand {
            Demand::Price(price_w) => price_w * drive.time_s(),
            Demand::Arrival(_) => 0.0,
        };
        // Where nothing is left open, the part of the best plan says what there is to say.
        let least_j = if left_j < f64::INFINITY {
            left_j
        } else {
            best.bound_j
        };
        let lower_bound_j = self.unrefuted_j(least_j, &drive) - spent_on_time_j;
        let early = matches!(self.demand, Demand::Arrival(latest_s)
            if price_w < NO_PRICE_W && drive.time_s() < latest_s - 1e-6);
        let scale_j = drive.scale_j();
        Answer::Plan(Box::new(Plan {
            arrival: if early {
                Arrival::Early
            } else {
                Arrival::AsAsked
            },
            earliest_arrival_s,
            price_w: Some(if early { 0.0 } else { price_w }),
            lower_bound_j,
            gap_pct: 100.0 * (drive.energy_j - lower_bound_j) / scale_j,
            proof: Proof::Proven,
            solved: self.solved,
            run: drive.into(),
        }))
    }

    /// A bound of the parts that were looked at, none where a drive refutes it: then a part was taken for empty that is not.
    fn unrefuted_j(&self, least_j: f64, drive: &Drive) -> f64 {
        if least_j <= self.cost_j(drive) + 1e-9 * drive.scale_j() {
            least_j
        } else {
            f64::NEG_INFINITY
        }
    }

    /// A plan of the dynamic program that no interior point made better, whose price of time is known only where it was given.
    fn unpolished(&self, drive: Drive, left_j: f64, earliest_arrival_s: f64) -> Plan {
        let price_w = match self.demand {
            Demand::Price(price_w) => Some(price_w),
            Demand::Arrival(_) => None,
        };
        let least_j = self.unrefuted_j(left_j, &drive);
        let lower_bound_j = least_j - price_w.unwrap_or(0.0) * drive.time_s();
        Plan {
            arrival: Arrival::AsAsked,
            earliest_arrival_s,
            price_w,
            lower_bound_j,
            gap_pct: 100.0 * (drive.energy_j - lower_bound_j) / drive.scale_j(),
            proof: Proof::Proven,
            solved: self.solved,
            run: drive.into(),
        }
    }

    /// The plan, moved by a hair towards the fastest or the slowest until it arrives when it was asked to.
    fn at_arrival(&self, best: &Relaxed, price_w: f64) -> Drive {
        let Demand::Arrival(latest_s) = self.demand else {
            return best.drive.clone();
        };
        let late_s = best.drive.time_s() - latest_s;
        if price_w < NO_PRICE_W || late_s.abs() < 1e-9 || late_s.abs() > 1e-2 {
            return best.drive.clone();
        }
        let edge = if late_s > 0.0 {
            &best.reachable.high
        } else {
            &best.reachable.low
        };
        let waits: Vec<(usize, f64)> = best
            .task
            .waits
            .iter()
            .copied()
            .zip(best.solution.waits_s.iter().copied())
            .collect();
        let moved = |share: f64| {
            let z = best
                .drive
                .z
                .iter()
                .zip(edge)
                .map(|(z, edge)| z + share * (edge - z))
                .collect();
            Drive::new(self.problem, z, &waits)
        };
        let (mut share, mut width) = (0.0, 1e-6);
        let mut drive = best.drive.clone();
        for _ in 0..60 {
            let next = moved(share + width);
            let crossed = (next.time_s() - latest_s) * late_s <= 0.0;
            if crossed && width < 1e-15 {
                break;
            }
            if crossed {
                width *= 0.25;
            } else {
                (share, drive) = (share + width, next);
                width *= 2.0;
            }
        }
        if drive.energy_j.is_finite() && keeps(&best.task, &drive) {
            drive
        } else {
            best.drive.clone()
        }
    }

    /// Why there is no plan, where limits and accelerations alone allow one.
    fn obstacle(&self, whole: &Reachable) -> Obstacle {
        let problem = self.problem;
        let fastest_s = passing_s(problem, &whole.high);
        let arrival_s = fastest_s.last().copied().unwrap_or(0.0);
        let held_up_s = problem
            .columns
            .earliest_s
            .iter()
            .zip(&fastest_s)
            .map(|(earliest_s, fastest_s)| earliest_s + arrival_s - fastest_s)
            .fold(arrival_s, f64::max);
        if let Demand::Arrival(latest_s) = self.demand
            && held_up_s > latest_s
        {
            return Obstacle::LeaderBlocks {
                earliest_arrival_s: held_up_s,
            };
        }
        let leaving_s = |node: usize| fastest_s[node] + problem.dwell_s(node);
        let mut earliest_s = leaving_s(0);
        let mut before = 0;
        for signal in &problem.columns.signals {
            let reached_s = earliest_s + leaving_s(signal.node) - leaving_s(before);
            let window = signal.green_s.iter().find(|[_, to_s]| *to_s >= reached_s);
            let latest_s = match self.demand {
                Demand::Arrival(latest_s) => latest_s - (arrival_s - leaving_s(signal.node)),
                Demand::Price(_) => f64::INFINITY,
            };
            match window {
                Some([from_s, _]) if from_s.max(reached_s) <= latest_s => {
                    (earliest_s, before) = (from_s.max(reached_s), signal.node);
                }
                _ => {
                    return Obstacle::SignalsUnreachable {
                        node: signal.node,
                        earliest_s: reached_s,
                        latest_s,
                    };
                }
            }
        }
        match self.passage_ever(whole, Aim::Time) {
            Ok(drive) => Obstacle::TooLate {
                earliest_arrival_s: drive.time_s(),
            },
            Err(blocked) => self.blocked(blocked, held_up_s),
        }
    }

    /// What is in the way where no time helps.
    fn blocked(&self, blocked: Blocked, held_up_s: f64) -> Obstacle {
        let signals = &self.problem.columns.signals;
        let last = signals.iter().rfind(|signal| signal.node < blocked.node);
        match last {
            Some(signal) => Obstacle::SignalsUnreachable {
                node: signal.node,
                earliest_s: blocked.earliest_s,
                latest_s: signal.green_s.last().map_or(0.0, |window| window[1]),
            },
            None => Obstacle::LeaderBlocks {
                earliest_arrival_s: held_up_s,
            },
        }
    }
}

impl Solution {
    fn is_finite(&self) -> bool {
        let all = [
            &self.z,
            &self.waits_s,
            &self.multipliers_w,
            &self.step_price_w,
        ];
        all.into_iter().flatten().all(|value| value.is_finite())
    }

    /// Multiplier of the last time bound, that of the arrival.
    fn multipliers_w_at_end(&self, task: &Task) -> f64 {
        let bounds = task.time_bounds.iter().zip(&self.multipliers_w);
        let arrival = bounds.filter(|(bound, _)| bound.at_most && !bound.after_wait);
        arrival.map(|(_, multiplier)| *multiplier).sum()
    }
}

fn inside(gentle: &Reachable, whole: &Reachable) -> Vec<f64> {
    let edges = gentle.low.iter().zip(&gentle.high);
    let outer = whole.low.iter().zip(&whole.high);
    edges
        .zip(outer)
        .map(|((low, high), (least, most))| {
            let z = low + 0.6 * (high - low);
            z.clamp(least + 1e-3 * (most - least), most - 1e-3 * (most - least))
        })
        .collect()
}

fn keeps(task: &Task, drive: &Drive) -> bool {
    task.time_bounds.iter().all(|bound| {
        let time_s = if bound.after_wait {
            drive.leaving_s(bound.node)
        } else {
            drive.arrival_s[bound.node]
        };
        if bound.at_most {
            time_s <= bound.time_s + 1e-6
        } else {
            time_s >= bound.time_s - 1e-6
        }
    })
}

/// The red in which a time lies, from the end of the window before to the begin of the one after; both may be infinite.
fn red_at(green_s: &[[f64; 2]], time_s: f64) -> Option<[f64; 2]> {
    let after = green_s.partition_point(|window| window[1] < time_s - 1e-6);
    let to_s = green_s.get(after).map_or(f64::INFINITY, |window| window[0]);
    if to_s <= time_s + 1e-6 {
        return None;
    }
    let from_s = after
        .checked_sub(1)
        .map_or(f64::NEG_INFINITY, |k| green_s[k][1]);
    Some([from_s, to_s])
}

/// Passing or standing, before a red or after it.
fn around_red(part: &Part, index: usize, from_s: f64, to_s: f64) -> Vec<Part> {
    let mut children = Vec::new();
    let visit = part.visits[index];
    let stands: &[bool] = match visit.stands {
        None => &[false, true],
        Some(true) => &[true],
        Some(false) => &[false],
    };
    for &stands in stands {
        for (earliest_s, latest_s) in [(visit.earliest_s, from_s), (to_s, visit.latest_s)] {
            if earliest_s <= latest_s && latest_s > f64::NEG_INFINITY && earliest_s < f64::INFINITY
            {
                let mut child = part.clone();
                child.visits[index] = Visit {
                    stands: Some(stands),
                    earliest_s,
                    latest_s,
                };
                children.push(child);
            }
        }
    }
    children
}

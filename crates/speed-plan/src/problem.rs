use ev_energy::{RoadStep, StepModel};

use crate::envelope::{Envelope, Limit};
use crate::error::Error;

/// More nodes than any road needs: 1000 km at 1 m.
const MOST_NODES: usize = 1_000_001;

/// Earliest passage of a node that the leader does not hold up, s.
pub const NO_LEADER_S: f64 = -1e9;

/// A road as the planner takes it: one value per node, or per step between two nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Position of every node, m; increasing.
    pub position_m: Vec<f64>,
    /// Mean slope angle of every step, rad, positive uphill; one less than nodes.
    pub slope_rad: Vec<f64>,
    /// Lowest speed at every node, m/s; 0 where the car stands.
    pub min_mps: Vec<f64>,
    /// Highest speed at every node, m/s.
    pub max_mps: Vec<f64>,
    /// Time that the car stands at every node, s.
    pub dwell_s: Vec<f64>,
    /// Signals, in the order of their nodes.
    pub signals: Vec<Signal>,
    /// Earliest passage of every node behind a leader, s, [`NO_LEADER_S`] where it holds nobody up; empty without one.
    pub earliest_s: Vec<f64>,
}

/// A traffic signal at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its node.
    pub node: usize,
    /// From when to when it can be passed, s after the start of the trip; in order.
    pub green_s: Vec<[f64; 2]>,
}

/// A road, a car and the accelerations that are allowed: what a plan is made for. Everything in it is checked.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    pub(crate) model: StepModel<'a>,
    pub(crate) envelope: Envelope,
    pub(crate) columns: Columns,
    pub(crate) steps: Vec<RoadStep>,
    /// Squares of the lowest and the highest speeds, m²/s².
    pub(crate) min_z: Vec<f64>,
    pub(crate) max_z: Vec<f64>,
}

impl<'a> Problem<'a> {
    /// Checks a problem.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Value`] with the channel and the index for what does not fit, is out of order or out of range.
    pub fn new(model: StepModel<'a>, envelope: Envelope, columns: Columns) -> Result<Self, Error> {
        check(&columns)?;
        let steps = columns
            .position_m
            .windows(2)
            .zip(&columns.slope_rad)
            .map(|(ends, &slope_rad)| RoadStep::new(ends[1] - ends[0], slope_rad))
            .collect();
        let squares = |values: &[f64]| values.iter().map(|v| v * v).collect();
        Ok(Self {
            min_z: squares(&columns.min_mps),
            max_z: squares(&columns.max_mps),
            model,
            envelope,
            columns,
            steps,
        })
    }

    /// The road.
    #[must_use]
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Its steps, one less than nodes.
    #[must_use]
    pub fn steps(&self) -> &[RoadStep] {
        &self.steps
    }

    /// The car.
    #[must_use]
    pub fn model(&self) -> &StepModel<'a> {
        &self.model
    }

    /// Accelerations that are allowed.
    #[must_use]
    pub fn envelope(&self) -> &Envelope {
        &self.envelope
    }

    /// Number of nodes, at least two.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.columns.position_m.len()
    }

    /// Slope angle of a node, the mean of its two steps, rad.
    #[must_use]
    pub fn node_slope_rad(&self, node: usize) -> f64 {
        let slope_rad = &self.columns.slope_rad;
        let (before, after) = (node.saturating_sub(1), node.min(slope_rad.len() - 1));
        0.5 * (slope_rad[before] + slope_rad[after])
    }

    /// Power of the car that stands at a node, W.
    #[must_use]
    pub fn standing_power_w(&self, node: usize) -> f64 {
        self.model.standing_power_w(self.node_slope_rad(node))
    }

    /// How long the car stands at a node at least, s; the trip ends on arrival.
    pub(crate) fn dwell_s(&self, node: usize) -> f64 {
        if node + 1 < self.nodes() {
            self.columns.dwell_s[node]
        } else {
            0.0
        }
    }

    /// Largest acceleration in a step at a mean speed, by the envelope and by what motor and battery give.
    pub(crate) fn max_accel(&self, step: usize, speed_mps: f64) -> f64 {
        let comfort = self.envelope.max_at(speed_mps).accel_mps2;
        comfort.min(self.strongest_accel(step, speed_mps))
    }

    /// Largest acceleration in a step at a mean speed by what motor and battery give.
    pub(crate) fn strongest_accel(&self, step: usize, speed_mps: f64) -> f64 {
        // A hair inside, so that rounding never asks for more than there is.
        let spare_n = (1.0 - 1e-9) * self.model.propulsion_limit_n(speed_mps)
            - self.model.resistance_n(&self.steps[step], speed_mps);
        spare_n / self.model.vehicle().effective_mass_kg()
    }

    /// Whether motor and battery may give less than an acceleration at some mean speed within a range.
    pub(crate) fn may_be_weaker(&self, step: usize, range_mps: [f64; 2], accel: f64) -> bool {
        // Force falls with the speed, and resistance is largest at an end.
        let road = &self.steps[step];
        let resistance_n = range_mps
            .map(|speed_mps| self.model.resistance_n(road, speed_mps))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        let spare_n = (1.0 - 1e-9) * self.model.propulsion_limit_n(range_mps[1]) - resistance_n;
        spare_n < accel * self.model.vehicle().effective_mass_kg()
    }

    /// The speed in m/s from which on what motor and battery give in a step, where it is less than an acceleration, falls by no more than
    /// `2v/h` per rise of the speed.
    ///
    /// A force that power limits falls by `G/w`, one that the battery limits by `(G + L'/γ_p c)/w` at most.
    pub(crate) fn weaker_steep_below_mps(&self, step: usize, top_mps: f64, accel: f64) -> f64 {
        let vehicle = self.model.vehicle();
        let Some(formula) = self.model.formula() else {
            return f64::INFINITY;
        };
        if formula.motor_speed_per_mps * top_mps > vehicle.spec().motor.max_speed_rad_s {
            // Beyond its highest speed the motor gives nothing.
            return f64::INFINITY;
        }
        let road = &self.steps[step];
        let mass_kg = formula.effective_mass_kg;
        let resistance_n = formula.standing_force_n(road)
            + (formula.linear_n_per_mps.max(0.0) + formula.quadratic_n_per_mps2 * top_mps)
                * top_mps;
        let idle_w_per_mps = formula.iron_w_per_mps
            + 3.0 * formula.windage_w_per_mps3 * top_mps * top_mps
            + formula.weakening_w / formula.weakening_from_mps;
        let gear = formula.propelling_nm_per_n * formula.motor_speed_per_mps;
        let force_n = (mass_kg * accel + resistance_n).max(0.0) + idle_w_per_mps / gear;
        let by_air = formula.linear_n_per_mps.abs() + 2.0 * formula.quadratic_n_per_mps2 * top_mps;
        // 2 m v/h ≥ by_air + force/v
        let square = 2.0 * mass_kg / road.length_m();
        (by_air + (by_air * by_air + 4.0 * square * force_n).sqrt()) / (2.0 * square)
    }

    /// [`Self::strongest_accel`] with its slope over the speed.
    pub(crate) fn strongest(&self, step: usize, speed_mps: f64) -> Limit {
        let width = 1e-4 * (1.0 + speed_mps);
        let below = self.strongest_accel(step, speed_mps - width);
        let above = self.strongest_accel(step, speed_mps + width);
        Limit {
            accel_mps2: self.strongest_accel(step, speed_mps),
            per_s: (above - below) / (2.0 * width),
        }
    }

    /// Whether squared speeds keep the accelerations of the envelope, but for rounding.
    pub(crate) fn keeps_envelope(&self, z: &[f64]) -> bool {
        const ROUNDING_MPS2: f64 = 1e-7;
        self.steps.iter().zip(z.windows(2)).all(|(step, ends)| {
            let accel = (ends[1] - ends[0]) / (2.0 * step.length_m());
            let speed_mps = mean_speed(ends[0], ends[1]);
            let least = self.envelope.min_at(speed_mps).accel_mps2;
            let most = self.envelope.max_at(speed_mps).accel_mps2;
            (least - ROUNDING_MPS2..=most + ROUNDING_MPS2).contains(&accel)
        })
    }

    pub(crate) fn min_accel(&self, speed_mps: f64) -> f64 {
        self.envelope.min_at(speed_mps).accel_mps2
    }
}

/// Mean speed in m/s between two squared ones.
#[inline(always)]
pub(crate) fn mean_speed(from_z: f64, to_z: f64) -> f64 {
    0.5 * (from_z.sqrt() + to_z.sqrt())
}

fn check(columns: &Columns) -> Result<(), Error> {
    let nodes = columns.position_m.len();
    if !(2..=MOST_NODES).contains(&nodes) {
        return Err(Error::Setting {
            name: "nodes",
            value: nodes as f64,
            expected: "a road has 2 to 1000001 nodes",
        });
    }
    let earliest = if columns.earliest_s.is_empty() {
        0
    } else {
        nodes
    };
    for (channel, values, expected) in [
        ("slope_rad", &columns.slope_rad, nodes - 1),
        ("min_mps", &columns.min_mps, nodes),
        ("max_mps", &columns.max_mps, nodes),
        ("dwell_s", &columns.dwell_s, nodes),
        ("earliest_s", &columns.earliest_s, earliest),
    ] {
        if values.len() != expected {
            return Err(Error::Length {
                channel,
                found: values.len(),
                expected,
            });
        }
    }
    let within = |channel, values: &[f64], min: f64, max: f64, problem| match values
        .iter()
        .position(|v| !(min..=max).contains(v))
    {
        None => Ok(()),
        Some(index) => Err(Error::Value {
            channel,
            index,
            value: values[index],
            problem,
        }),
    };
    within(
        "position_m",
        &columns.position_m,
        -1e7,
        1e7,
        "within ±10000 km",
    )?;
    within(
        "slope_rad",
        &columns.slope_rad,
        -0.5,
        0.5,
        "within ±0.5 rad",
    )?;
    within(
        "min_mps",
        &columns.min_mps,
        0.0,
        150.0,
        "within 0 and 150 m/s",
    )?;
    within(
        "max_mps",
        &columns.max_mps,
        0.0,
        150.0,
        "within 0 and 150 m/s",
    )?;
    within("dwell_s", &columns.dwell_s, 0.0, 1e6, "within 0 and 10⁶ s")?;
    within(
        "earliest_s",
        &columns.earliest_s,
        -1e9,
        1e9,
        "within ±10⁹ s",
    )?;
    for index in 0..nodes {
        let fail = |channel, value, problem| {
            Err(Error::Value {
                channel,
                index,
                value,
                problem,
            })
        };
        let (min, max) = (columns.min_mps[index], columns.max_mps[index]);
        if min > max {
            return fail("min_mps", min, "above the highest speed there");
        }
        if min <= 0.0 && max > 0.0 {
            return fail(
                "min_mps",
                min,
                "0 only where the car stands and the highest speed is 0 too",
            );
        }
        if max > 0.0 && columns.dwell_s[index] > 0.0 {
            return fail(
                "dwell_s",
                columns.dwell_s[index],
                "the car does not stand there",
            );
        }
        if index == 0 {
            continue;
        }
        let length_m = columns.position_m[index] - columns.position_m[index - 1];
        if !(1e-3..=1e5).contains(&length_m) {
            return fail(
                "position_m",
                columns.position_m[index],
                "not 1 mm to 100 km beyond the one before",
            );
        }
        if max <= 0.0 && columns.max_mps[index - 1] <= 0.0 {
            return fail(
                "max_mps",
                max,
                "the car stands at both ends of a step and never gets there",
            );
        }
    }
    check_signals(&columns.signals, nodes)
}

fn check_signals(signals: &[Signal], nodes: usize) -> Result<(), Error> {
    let mut before = 0;
    for (index, signal) in signals.iter().enumerate() {
        let node = signal.node as f64;
        let fail = |value, problem| {
            Err(Error::Value {
                channel: "signals",
                index,
                value,
                problem,
            })
        };
        if signal.node <= before || signal.node >= nodes {
            return fail(
                node,
                "no node after those of the signal before and of the start",
            );
        }
        before = signal.node;
        let mut end_s = f64::NEG_INFINITY;
        for &[from_s, to_s] in &signal.green_s {
            if !(from_s.abs() <= 1e9 && to_s.abs() <= 1e9 && from_s < to_s) {
                return fail(
                    from_s,
                    "a green window that does not end after it begins, within ±10⁹ s",
                );
            }
            if from_s <= end_s {
                return fail(
                    from_s,
                    "a green window that begins before the one before it ends",
                );
            }
            end_s = to_s;
        }
    }
    Ok(())
}

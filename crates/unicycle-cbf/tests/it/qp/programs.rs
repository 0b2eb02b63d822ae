//! Programs of several kinds, and what a solution looks like in them, independently of the solver.

use std::array::from_fn;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use unicycle_cbf::qp::{MAX_ROWS, Row, Solution, VARIABLES};

pub(super) type Vector = [f64; VARIABLES];

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn norm(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// A program with its rows brought to unit normals in `y = W^(1/2) z`, independently of the solver.
#[derive(Debug, Clone)]
pub(super) struct Program {
    pub(super) weights: Vector,
    pub(super) rows: Vec<Row>,
}

/// What a solution looks like in `y`.
pub(super) struct Scaled {
    pub(super) y: Vector,
    pub(super) rows: Vec<Row>,
    pub(super) multipliers: Vec<f64>,
}

impl Program {
    pub(super) fn length(&self, row: &Row) -> f64 {
        let length = norm(&from_fn(|i| row.a[i] / self.weights[i].sqrt()));
        if length > 0.0 { length } else { 1.0 }
    }

    pub(super) fn scaled(&self, solution: &Solution) -> Scaled {
        let lengths = self.rows.iter().map(|row| self.length(row));
        let scaled = |row: &Row| Row {
            a: from_fn(|i| row.a[i] / self.weights[i].sqrt() / self.length(row)),
            b: row.b / self.length(row),
        };
        Scaled {
            y: from_fn(|i| solution.z[i] * self.weights[i].sqrt()),
            rows: self.rows.iter().map(scaled).collect(),
            multipliers: (solution.multipliers.iter().zip(lengths))
                .map(|(multiplier, length)| 0.5 * multiplier * length)
                .collect(),
        }
    }
}

impl Scaled {
    pub(super) fn largest_offset(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |most, row| most.max(row.b.abs()))
    }

    pub(super) fn largest_multiplier(&self) -> f64 {
        self.multipliers.iter().fold(0.0, |most, l| most.max(*l))
    }

    /// Unit of distances: that of the optimum from the origin, else of the nearest row.
    pub(super) fn unit(&self) -> f64 {
        let offsets = self.rows.iter().map(|row| row.b.abs());
        let nearest = offsets.filter(|b| *b > 0.0).fold(f64::INFINITY, f64::min);
        match norm(&self.y) {
            length if length > 0.0 => length,
            _ if nearest.is_finite() => nearest,
            _ => 1.0,
        }
    }

    /// Residual of the conditions of an optimum, relative.
    pub(super) fn residual(&self) -> f64 {
        let length = norm(&self.y);
        let size = length.max(self.largest_multiplier()).max(f64::MIN_POSITIVE);
        let (mut gradient, mut worst) = (self.y, 0.0_f64);
        for (row, multiplier) in self.rows.iter().zip(&self.multipliers) {
            let reach = length + row.b.abs();
            let excess = dot(&row.a, &self.y) - row.b;
            if reach > 0.0 && norm(&row.a) > 0.0 {
                worst = worst.max(excess / reach);
                worst = worst.max(multiplier / size * excess.abs() / reach);
            }
            worst = worst.max(-multiplier / size);
            gradient = from_fn(|i| gradient[i] + multiplier * row.a[i]);
        }
        worst.max(norm(&gradient) / size)
    }

    /// Every row is either clearly active or clearly not: interior points then converge sharply.
    pub(super) fn is_strict(&self) -> bool {
        let least = 1e-4 * self.unit();
        let clear = |(row, multiplier): (&Row, &f64)| {
            *multiplier > least || row.b - dot(&row.a, &self.y) > least
        };
        self.rows.iter().zip(&self.multipliers).all(clear)
    }

    /// How much a change of the right sides changes the objective.
    pub(super) fn sensitivity(&self) -> f64 {
        self.largest_multiplier() / norm(&self.y).max(f64::MIN_POSITIVE)
    }

    /// For a proof that rows contradict each other, relative to the sum of its multipliers: how far the normals are from adding up to
    /// zero, and by how much the rows miss each other.
    pub(super) fn proof(&self) -> (f64, f64) {
        let sum: f64 = self.multipliers.iter().sum();
        let (mut normal, mut offset) = ([0.0; VARIABLES], 0.0);
        for (row, multiplier) in self.rows.iter().zip(&self.multipliers) {
            normal = from_fn(|i| normal[i] + multiplier * row.a[i]);
            offset += multiplier * row.b;
        }
        (norm(&normal) / sum, -offset / sum)
    }
}

pub(super) const FAMILIES: u32 = 6;

/// Random programs: dense, badly scaled and feasible, small integers, badly scaled, multiples of other rows, and rows like those of
/// the controller.
pub(super) fn program(random: &mut ChaCha8Rng, family: u32) -> Program {
    let normal = |random: &mut ChaCha8Rng| -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    };
    let spread = |random: &mut ChaCha8Rng, low: f64, high: f64| -> f64 {
        let size = 10_f64.powf(low + (high - low) * random.random::<f64>());
        if random.random::<bool>() { size } else { -size }
    };
    let count = random.random_range(0..=MAX_ROWS);
    let (low, high) = match family {
        0 | 2 => (0.0, 0.0),
        4 | 5 => (-3.0, 6.0),
        _ => (-6.0, 9.0),
    };
    let weights: Vector = from_fn(|_| spread(random, low, high).abs());
    let inside: Vector = from_fn(|i| normal(random) / weights[i].sqrt());
    let mut rows: Vec<Row> = Vec::new();
    while rows.len() < count {
        let mut row = Row {
            a: from_fn(|_| normal(random)),
            b: normal(random) + 0.5,
        };
        match family {
            0 => {}
            1 | 3 => {
                let full = random.random::<f64>();
                row.a = from_fn(|_| {
                    let size = spread(random, -6.0, 5.0);
                    if random.random::<f64>() < full {
                        size
                    } else {
                        0.0
                    }
                });
                let length = norm(&from_fn(|i| row.a[i] / weights[i].sqrt()));
                row.b = if family == 1 {
                    dot(&row.a, &inside) + normal(random).abs() * length
                } else {
                    length * row.b
                };
            }
            2 => {
                row.a = from_fn(|_| f64::from(random.random_range(-2..=2)));
                row.b = f64::from(random.random_range(-1..=3));
            }
            4 if rows.len() > 1 && random.random() => {
                let (first, second) = (
                    rows[random.random_range(0..rows.len())],
                    rows[random.random_range(0..rows.len())],
                );
                let factor = spread(random, -3.0, 3.0);
                let share = [0.0, normal(random)][random.random_range(0..2)];
                let room = [0.0, normal(random).abs()][random.random_range(0..2)];
                row.a = from_fn(|i| factor * (first.a[i] + share * second.a[i]));
                row.b = factor * (first.b + share * second.b) + room * factor.abs();
            }
            4 => {}
            _ => {
                let slack = 2 + rows.len();
                row.a = from_fn(|i| match i {
                    0 => spread(random, -2.0, 2.0),
                    1 => spread(random, 0.0, 5.0),
                    _ if i == slack => -1.0,
                    _ => 0.0,
                });
                row.b = spread(random, -4.0, 0.0);
                if slack >= VARIABLES {
                    row.b = row.b.abs();
                }
            }
        }
        rows.push(row);
    }
    Program { weights, rows }
}

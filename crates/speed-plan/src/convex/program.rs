//! A linear objective under linear and second-order cone constraints, written down row by row for Clarabel.

use std::ops::{Add, Mul, Neg, Sub};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus,
    SupportedConeT,
};

use super::Convergence;

/// `constant + Σ coefficient · variable`.
#[derive(Debug, Clone, Default)]
pub(super) struct Affine {
    constant: f64,
    terms: Vec<(usize, f64)>,
}

#[derive(Debug, Default)]
pub(super) struct ConeProgram {
    variables: usize,
    objective: Affine,
    not_negative: Vec<Affine>,
    cones: Vec<[Affine; 3]>,
}

/// What the solver says of a program.
pub(super) struct Optimum {
    /// Objective of the dual: no point of the program has less.
    pub(super) bound: f64,
    pub(super) convergence: Convergence,
    pub(super) iterations: u32,
}

impl ConeProgram {
    pub(super) fn variable(&mut self) -> Affine {
        self.variables += 1;
        Affine {
            constant: 0.0,
            terms: vec![(self.variables - 1, 1.0)],
        }
    }

    /// Adds to what is minimised.
    pub(super) fn pay(&mut self, cost: Affine) {
        let objective = std::mem::take(&mut self.objective);
        self.objective = objective + cost;
    }

    /// `larger ≥ smaller`.
    pub(super) fn at_least(&mut self, larger: &Affine, smaller: &Affine) {
        self.not_negative.push(larger.clone() - smaller.clone());
    }

    /// `x y ≥ root²` with `x, y ≥ 0`: `‖(2 root, x − y)‖ ≤ x + y`. Best where `x` and `y` are of one size.
    pub(super) fn product_at_least(&mut self, x: &Affine, y: &Affine, root: &Affine) {
        self.cones.push([
            x.clone() + y.clone(),
            root.clone() * 2.0,
            x.clone() - y.clone(),
        ]);
    }

    pub(super) fn solve(&self) -> Optimum {
        let rows: Vec<&Affine> = self
            .not_negative
            .iter()
            .chain(self.cones.iter().flatten())
            .collect();
        // Clarabel takes `A x + s = b` with `s` in the cones.
        let (mut at_row, mut at_column, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (row, expression) in rows.iter().enumerate() {
            for (variable, coefficient) in expression.gathered() {
                at_row.push(row);
                at_column.push(variable);
                values.push(-coefficient);
            }
        }
        let matrix =
            CscMatrix::new_from_triplets(rows.len(), self.variables, at_row, at_column, values);
        let right: Vec<f64> = rows.iter().map(|row| row.constant).collect();
        let mut costs = vec![0.0; self.variables];
        for &(variable, cost) in &self.objective.terms {
            costs[variable] += cost;
        }
        let mut cones: Vec<SupportedConeT<f64>> = vec![NonnegativeConeT(self.not_negative.len())];
        cones.extend(self.cones.iter().map(|_| SecondOrderConeT(3)));
        let nothing_squared = CscMatrix::zeros((self.variables, self.variables));
        let settings = DefaultSettings {
            verbose: false,
            ..DefaultSettings::default()
        };
        let solver =
            DefaultSolver::new(&nothing_squared, &costs, &matrix, &right, &cones, settings);
        let Ok(mut solver) = solver else {
            return Optimum {
                bound: f64::NEG_INFINITY,
                convergence: Convergence::Failed,
                iterations: 0,
            };
        };
        solver.solve();
        let solution = &solver.solution;
        Optimum {
            bound: self.objective.constant + solution.obj_val_dual,
            convergence: match solution.status {
                SolverStatus::Solved => Convergence::Solved,
                SolverStatus::AlmostSolved => Convergence::AlmostSolved,
                _ => Convergence::Failed,
            },
            iterations: solution.iterations,
        }
    }
}

impl Affine {
    /// Every variable once.
    fn gathered(&self) -> Vec<(usize, f64)> {
        let mut terms = self.terms.clone();
        terms.sort_by_key(|term| term.0);
        terms.dedup_by(|term, kept| {
            let same = term.0 == kept.0;
            if same {
                kept.1 += term.1;
            }
            same
        });
        terms
    }
}

impl From<f64> for Affine {
    fn from(constant: f64) -> Self {
        Self {
            constant,
            terms: Vec::new(),
        }
    }
}

impl Add for Affine {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.constant += other.constant;
        self.terms.extend(other.terms);
        self
    }
}

impl Add<f64> for Affine {
    type Output = Self;

    fn add(mut self, constant: f64) -> Self {
        self.constant += constant;
        self
    }
}

impl Neg for Affine {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Affine {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul<f64> for Affine {
    type Output = Self;

    fn mul(mut self, factor: f64) -> Self {
        self.constant *= factor;
        for (_, coefficient) in &mut self.terms {
            *coefficient *= factor;
        }
        self
    }
}

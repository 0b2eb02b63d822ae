//! The interior point method of Clarabel as a judge of a hundred thousand programs.

use std::array::from_fn;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use unicycle_cbf::qp::{Solution, Status, VARIABLES, solve};

use super::programs::{FAMILIES, Program, Scaled, Vector, norm, program};

/// `y` of the optimum in the unit of the program, and how sure it is.
fn by_clarabel(scaled: &Scaled) -> (SolverStatus, Vector) {
    let count = scaled.rows.len();
    let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
    for i in 0..VARIABLES {
        for (j, row) in scaled.rows.iter().enumerate() {
            if row.a[i] != 0.0 {
                places.push(j);
                values.push(row.a[i]);
            }
        }
        starts.push(places.len());
    }
    let hessian = CscMatrix::identity(VARIABLES);
    let rows = CscMatrix::new(count, VARIABLES, starts, places, values);
    let right: Vec<f64> = scaled
        .rows
        .iter()
        .map(|row| row.b / scaled.unit())
        .collect();
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-12)
        .tol_gap_rel(1e-12)
        .tol_feas(1e-12)
        .build()
        .unwrap();
    let cones = [NonnegativeConeT(count)];
    let mut solver =
        DefaultSolver::new(&hessian, &[0.0; VARIABLES], &rows, &right, &cones, settings).unwrap();
    solver.solve();
    (solver.solution.status, from_fn(|i| solver.solution.x[i]))
}

/// Worst figures over many programs.
#[derive(Debug, Default)]
pub(super) struct Worst {
    residual: f64,
    own_residual: f64,
    optimal: u32,
    infeasible: u32,
    iterations: u32,
    compared: u32,
    strict: u32,
    strict_distance: f64,
    distance: f64,
    far: u32,
    near_border: u32,
    unsure: u32,
}

impl Worst {
    /// The conditions of an optimum, or the proof that there is none.
    pub(super) fn check(&mut self, program: &Program) -> (Solution, Scaled) {
        let solution = solve(&program.weights, &program.rows);
        let scaled = program.scaled(&solution);
        self.iterations = self.iterations.max(solution.iterations);
        match solution.status {
            Status::Optimal => {
                self.optimal += 1;
                let own = solution.kkt_residual(&program.weights, &program.rows);
                self.own_residual = self.own_residual.max(own);
                self.residual = self.residual.max(scaled.residual());
                assert!(own <= 1e-9 && scaled.residual() <= 1e-9, "{program:?}");
            }
            Status::Infeasible => {
                self.infeasible += 1;
                let (normal, gap) = scaled.proof();
                assert!(
                    normal <= 1e-13 && gap > -1e-15,
                    "{normal:e} {gap:e} {program:?}"
                );
            }
            status => panic!("{status:?} for {program:?}"),
        }
        (solution, scaled)
    }

    /// The residual proves that rows declared feasible are, multipliers prove that others are not. Clarabel may see a program
    /// differently only close to the border between them, where a relative change of 1e-6 of the right sides crosses it.
    fn judge(&mut self, program: &Program, solution: &Solution, scaled: &Scaled) {
        let (status, y) = by_clarabel(scaled);
        let optimal = solution.status == Status::Optimal;
        let near_border = if optimal {
            scaled.sensitivity() > 1e4 || norm(&scaled.y) > 1e4 * scaled.largest_offset()
        } else {
            scaled.proof().1 < 1e-6 * scaled.largest_offset()
        };
        match status {
            _ if optimal && near_border => self.near_border += 1,
            SolverStatus::Solved if optimal => {
                self.compared += 1;
                let distance = norm(&from_fn(|i| y[i] - scaled.y[i] / scaled.unit()));
                if scaled.is_strict() {
                    self.strict += 1;
                    self.strict_distance = self.strict_distance.max(distance);
                    // A gap of 1e-12, to which the peer solves, allows for √2 1e-6.
                    assert!(distance <= 1.5e-6, "{distance:e} {program:?}");
                    self.far += u32::from(distance > 1e-7);
                } else {
                    self.distance = self.distance.max(distance);
                    assert!(distance <= 1e-5, "{distance:e} {program:?}");
                }
            }
            SolverStatus::Solved => assert!(near_border, "{program:?}"),
            SolverStatus::PrimalInfeasible => assert!(!optimal, "{program:?}"),
            _ => self.unsure += 1,
        }
    }
}

#[test]
fn a_hundred_thousand_optima_agree() {
    let mut random = ChaCha8Rng::seed_from_u64(1983);
    for family in 0..FAMILIES {
        let mut worst = Worst::default();
        for _ in 0..100_002 / FAMILIES {
            let program = program(&mut random, family);
            let (solution, scaled) = worst.check(&program);
            worst.judge(&program, &solution, &scaled);
        }
        println!("family {family}: {worst:?}");
        assert!(worst.far <= 2, "{worst:?}");
    }
}

//! One control step: eleven rows, optimum found by this crate and by the interior point method of Clarabel.
//!
//! The rows are those of a Robotarium robot behind another one: speed, turn rate, path, headway as the robot ahead moves, both
//! edges of the lane, headway were it to stop, and the wheel speeds within their limits.

#![allow(clippy::unwrap_used, missing_docs)]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT,
};
use divan::{Bencher, black_box};
use unicycle_cbf::qp::{Row, Status, solve};

const WEIGHTS: [f64; 5] = [1.0, 1.0, 1e5, 0.1, 1e6];

const ROWS: [([f64; 5], f64); 11] = [
    ([-2.2813208, 0.0, -1.0, 0.0, 0.0], -0.022013437),
    ([0.0, -35581.45, 0.0, -1.0, 0.0], -3.165099),
    ([1.739133, -111.18299, 0.0, 0.0, -1.0], 0.0037350391),
    ([50.0, 0.0, 0.0, 0.0, 0.0], 0.46970608),
    ([1.7711803, -113.27885, 0.0, 0.0, 0.0], 0.017607429),
    ([-1.7711803, 113.27885, 0.0, 0.0, 0.0], 0.14186252),
    ([50.0, 0.0, 0.0, 0.0, 0.0], 0.41970608),
    ([0.55, 18.15, 0.0, 0.0, 0.0], 0.29128861),
    ([-0.55, -18.15, 0.0, 0.0, 0.0], 0.10871139),
    ([0.55, -18.15, 0.0, 0.0, 0.0], 0.095590637),
    ([-0.55, 18.15, 0.0, 0.0, 0.0], 0.30440936),
];

fn main() {
    divan::main();
}

/// More room on all right sides: three active rows without, then two, then none.
const ROOM: [f64; 3] = [0.0, 0.02, 5.0];

fn rows(room: f64) -> Vec<Row> {
    let row = |(a, b): &([f64; 5], f64)| Row { a: *a, b: b + room };
    ROWS.iter().map(row).collect()
}

#[divan::bench(args = ROOM)]
fn dual_active_set(bencher: Bencher, room: f64) {
    let rows = rows(room);
    assert_eq!(solve(&WEIGHTS, &rows).status, Status::Optimal);
    bencher.bench_local(|| solve(black_box(&WEIGHTS), black_box(&rows)));
}

struct Program {
    hessian: CscMatrix<f64>,
    rows: CscMatrix<f64>,
    right: Vec<f64>,
    settings: DefaultSettings<f64>,
}

impl Program {
    fn new(rows: &[Row]) -> Self {
        let dense: Vec<[f64; 5]> = rows.iter().map(|row| row.a).collect();
        let mut hessian = CscMatrix::identity(5);
        hessian.nzval = WEIGHTS.iter().map(|w| 2.0 * w).collect();
        Self {
            hessian,
            rows: CscMatrix::from(&dense),
            right: rows.iter().map(|row| row.b).collect(),
            settings: DefaultSettingsBuilder::default()
                .verbose(false)
                .build()
                .unwrap(),
        }
    }

    fn solver(&self) -> DefaultSolver<f64> {
        let cones = [NonnegativeConeT(self.right.len())];
        let (hessian, rows) = (&self.hessian, &self.rows);
        let settings = self.settings.clone();
        DefaultSolver::new(hessian, &[0.0; 5], rows, &self.right, &cones, settings).unwrap()
    }
}

#[divan::bench(args = ROOM)]
fn clarabel_set_up_and_solved(bencher: Bencher, room: f64) {
    let program = Program::new(&rows(room));
    bencher.bench_local(|| {
        let mut solver = program.solver();
        solver.solve();
        solver.solution.x[0]
    });
}

#[divan::bench(args = ROOM)]
fn clarabel_solved(bencher: Bencher, room: f64) {
    let program = Program::new(&rows(room));
    bencher
        .with_inputs(|| program.solver())
        .bench_local_values(|mut solver| {
            solver.solve();
            solver
        });
}

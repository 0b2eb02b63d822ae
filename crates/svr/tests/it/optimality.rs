//! Solutions of random problems are optimal by everything that can be computed from their coefficients, and an interior
//! point solver of quadratic programmes finds no better ones.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use proptest::prelude::*;
use svr::{Fit, Kernel, Response, Samples, Status, fit};

use crate::problem::{
    KERNELS, Naive, Random, Worth, greatest_difference, naive_kernel, penalty, precise, predict,
    standardised,
};

#[derive(Debug, Clone)]
struct Case {
    n: usize,
    d: usize,
    kernel: Kernel,
    box_constraint: f64,
    tube_epsilon: f64,
    response_scale: f64,
    weighted: bool,
    seed: u64,
}

fn cases(most: usize) -> impl Strategy<Value = Case> {
    (
        (2..=most, 1..6_usize, 0..KERNELS.len()),
        (
            -3.0..=3.0_f64,
            prop_oneof![Just(0.0), 0.0..1.0_f64],
            -3..=3_i32,
        ),
        any::<bool>(),
        any::<u64>(),
    )
        .prop_map(|((n, d, kernel), (c, tube, scale), weighted, seed)| {
            let response_scale = 10_f64.powi(scale);
            // What is hard depends on C per unit of the response: far beyond these, the rounding of Kβ is above the tolerance,
            // and the normal matrix of an interpolating linear model cannot be factored.
            let box_constraint = 10_f64.powf(c) * response_scale;
            Case {
                n,
                d,
                kernel: KERNELS[kernel],
                box_constraint,
                tube_epsilon: tube * response_scale,
                response_scale,
                weighted,
                seed,
            }
        })
}

struct Solved {
    case: Case,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Predictors on the scale of the fit.
    scaled: Vec<f64>,
    naive: Naive,
    fit: Fit,
    /// What the fit was told: share of the objective for the linear kernel, in units of the response for the others.
    tolerance: f64,
}

fn solve(case: Case) -> Solved {
    solve_within(case, 10_000_000)
}

fn solve_within(case: Case, max_iterations: usize) -> Solved {
    let mut random = Random(case.seed);
    let (n, d) = (case.n, case.d);
    // Columns in various units; some take few values, so that samples coincide.
    let columns: Vec<(f64, bool)> = (0..d)
        .map(|_| (10_f64.powf(3.0 * random.signed()), random.unit() < 0.3))
        .collect();
    let mut x = Vec::with_capacity(n * d);
    let mut y = Vec::with_capacity(n);
    for _ in 0..n {
        let row: Vec<f64> = (0..d).map(|_| random.normal()).collect();
        let columns = row.iter().zip(&columns);
        x.extend(columns.map(|(x, (unit, coarse))| unit * if *coarse { x.round() } else { *x }));
        let value = crate::problem::smooth(&row) + 0.5 * random.normal();
        y.push(case.response_scale * value);
    }
    let weights: Vec<f64> = (0..n)
        .map(|_| match random.unit() {
            u if !case.weighted || u < 0.2 => 1.0,
            u if u < 0.4 => 0.0,
            u => 3.0 * (u - 0.4),
        })
        .collect();
    let tolerance = match case.kernel {
        Kernel::Linear => 1e-9,
        _ => 1e-9 * case.response_scale,
    };
    let mut settings = precise(case.kernel, tolerance);
    settings.stopping.max_iterations = max_iterations;
    let response = Response::new(&y).expect("responses");
    let response = if case.weighted {
        response.weighted(&weights).expect("weights")
    } else {
        response
    };
    let fit = fit(
        &Samples::new(&x, d).expect("samples"),
        &response,
        &settings,
        &penalty(case.box_constraint, case.tube_epsilon),
    )
    .expect("a fit");
    let scaled = standardised(&x, d, &x);
    let naive = Naive::new(
        case.kernel,
        fit.model.kernel_scale(),
        &scaled,
        d,
        &y,
        weights.iter().map(|w| case.box_constraint * w).collect(),
        case.tube_epsilon,
    );
    Solved {
        case,
        x,
        y,
        scaled,
        naive,
        fit,
        tolerance,
    }
}

impl Solved {
    /// Figures of the coefficients; for the linear kernel `Kβ` is `w·x`, as an interior point's `β` is a difference of two
    /// numbers of the size of `C`.
    fn worth(&self) -> Worth {
        let (fit, d) = (&self.fit, self.case.d);
        let products = if self.case.kernel == Kernel::Linear {
            let weights = fit.model.coefficients();
            let product = |row: &[f64]| row.iter().zip(weights).map(|(x, w)| x * w).sum();
            self.scaled.chunks(d).map(product).collect()
        } else {
            self.naive.products(&fit.beta)
        };
        self.naive.worth(&fit.beta, products, fit.model.bias())
    }

    /// Optimal, or for the linear kernel at a gap below the rounding of what errors of the size of the response cost.
    /// Without a tube and with fewer samples than predictors, the objective itself may be less.
    fn is_as_good_as_can_be(&self) -> bool {
        let cost = self.naive.bound.iter().sum::<f64>() * self.case.response_scale;
        let at_the_limit = self.case.kernel == Kernel::Linear
            && self.fit.status == Status::Stalled
            && self.fit.duality_gap() <= 1e-9 * cost;
        self.fit.status == Status::Optimal || at_the_limit
    }

    /// What the loss could change by where every residual is off by as much as the tolerance.
    fn slack(&self) -> f64 {
        let rounding = 1e-12 * self.case.response_scale;
        let tolerance = match self.case.kernel {
            Kernel::Linear => rounding,
            _ => self.tolerance + rounding,
        };
        self.naive.bound.iter().sum::<f64>() * tolerance
    }

    /// What the loss could change by from the rounding of `Kβ`, whose terms are at most `√K_ii √K_jj |β_j|`.
    fn rounding_of_polynomials(&self) -> f64 {
        if !matches!(self.case.kernel, Kernel::Quadratic | Kernel::Cubic) {
            return 0.0;
        }
        let root = |i: usize| self.naive.kernel[i][i].sqrt();
        let loss = self.naive.bound.iter().enumerate();
        let terms = self.fit.beta.iter().enumerate();
        let loss: f64 = loss.map(|(i, bound)| bound * root(i)).sum();
        f64::EPSILON * loss * terms.map(|(j, beta)| beta.abs() * root(j)).sum::<f64>()
    }
}

/// `½ βᵀKβ − yᵀβ + ε‖β‖₁` at its minimum, in `(α*, α)`, with the response brought to scale 1.
fn minimum_by_clarabel(naive: &Naive, scale: f64) -> Option<f64> {
    let n = naive.response.len();
    let sign = |k: usize| if k < n { 1.0 } else { -1.0 };
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for k in 0..2 * n {
        for i in 0..=k {
            rows.push(i);
            values.push(sign(i) * sign(k) * naive.kernel[i % n][k % n]);
        }
        starts.push(rows.len());
    }
    let quadratic = CscMatrix::new(2 * n, 2 * n, starts, rows, values);
    let linear: Vec<f64> = (0..2 * n)
        .map(|k| (naive.tube_epsilon - sign(k) * naive.response[k % n]) / scale)
        .collect();
    // One equality, then α ≥ 0, then α ≤ c.
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for k in 0..2 * n {
        rows.extend([0, 1 + k, 1 + 2 * n + k]);
        values.extend([sign(k), -1.0, 1.0]);
        starts.push(rows.len());
    }
    let constraints = CscMatrix::new(1 + 4 * n, 2 * n, starts, rows, values);
    let mut right = vec![0.0; 1 + 2 * n];
    right.extend((0..2 * n).map(|k| naive.bound[k % n] / scale));
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-11)
        .tol_gap_rel(1e-9)
        .tol_feas(1e-9)
        .max_iter(200)
        .build()
        .expect("settings");
    let cones = [ZeroConeT(1), NonnegativeConeT(4 * n)];
    let mut solver =
        DefaultSolver::new(&quadratic, &linear, &constraints, &right, &cones, settings)
            .expect("a problem");
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved);
    solved.then_some(solver.solution.obj_val * scale * scale)
}

/// Moving pairs alone had not converged after ten million moves.
#[test]
fn a_cubic_kernel_with_a_large_box_constraint_converges() {
    let solved = solve(Case {
        n: 59,
        d: 1,
        kernel: Kernel::Cubic,
        box_constraint: 31.622776601683793,
        tube_epsilon: 0.3016205461525863,
        response_scale: 1.0,
        weighted: false,
        seed: 6_185_031_800_009_909_765,
    });
    assert_eq!(solved.fit.status, Status::Optimal, "{:?}", solved.fit);
    assert!(solved.fit.iterations < 100_000, "{:?}", solved.fit);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn solutions_are_feasible_and_optimal(case in cases(60)) {
        let solved = solve(case);
        let Solved { case, naive, fit, .. } = &solved;
        prop_assert!(solved.is_as_good_as_can_be(), "{:?}", fit);
        prop_assert_eq!(fit.hint().is_none(), fit.status == Status::Optimal);

        for (beta, bound) in fit.beta.iter().zip(&naive.bound) {
            prop_assert!(beta.abs() <= *bound, "{} {}", beta, bound);
        }
        let (sum, size) = (
            fit.beta.iter().sum::<f64>(),
            fit.beta.iter().map(|b| b.abs()).sum::<f64>(),
        );
        prop_assert!(sum.abs() <= 1e-9 * size, "{sum} of {size}");

        let worth = solved.worth();
        let rounding = 1e-9 * worth.primal.abs() + solved.slack();
        prop_assert!((worth.primal - fit.primal_objective).abs() <= rounding,
            "{} {}", worth.primal, fit.primal_objective);
        prop_assert!((worth.dual - fit.dual_objective).abs() <= rounding,
            "{} {}", worth.dual, fit.dual_objective);
        for gap in [worth.primal - worth.dual, fit.duality_gap()] {
            prop_assert!(gap >= -1e-9 * worth.primal - solved.slack(), "gap {gap}");
            prop_assert!(gap <= 1e-6 * worth.primal + solved.slack(), "gap {gap} of {}", worth.primal);
        }

        let share = match case.kernel {
            Kernel::Linear => 1e-6,
            _ => 0.0,
        };
        let violation = naive.violation(&fit.beta, &worth.products, share);
        let rounding = 1e-9 * case.response_scale;
        prop_assert!((violation - fit.kkt_residual).abs() <= rounding, "{violation} {}", fit.kkt_residual);
        match case.kernel {
            // The tolerance is one of the gap, in which a violation of a sample of small weight hardly counts.
            Kernel::Linear => prop_assert!(case.weighted || violation <= 5e-2 * case.response_scale, "{violation}"),
            _ => prop_assert!(violation <= solved.tolerance + rounding, "{violation}"),
        }
    }

    #[test]
    fn predictions_are_the_naive_sum_of_kernels(case in cases(60)) {
        let solved = solve(case);
        let Solved { case, fit, .. } = &solved;
        let (d, scale) = (case.d, fit.model.kernel_scale());
        let mut random = Random(!case.seed);
        let elsewhere: Vec<f64> = solved.x.iter().map(|x| x * (1.0 + 0.3 * random.signed())).collect();
        for x in [&solved.x, &elsewhere] {
            let at = standardised(x, d, &solved.x);
            let naive: Vec<f64> = at.chunks(d).map(|row| {
                let terms = solved.scaled.chunks(d).zip(&fit.beta);
                let sum: f64 = terms.map(|(v, b)| b * naive_kernel(case.kernel, scale, row, v)).sum();
                sum + fit.model.bias()
            }).collect();
            let size: f64 = fit.beta.iter().map(|b| b.abs()).sum();
            // An interior point's β is a difference of two numbers of the size of C.
            let rounded_off = match case.kernel {
                Kernel::Linear => solved.naive.bound.iter().sum::<f64>(),
                _ => 0.0,
            };
            let tolerance = 1e-9 * case.response_scale + 1e-12 * size + 1e-8 * rounded_off;
            let difference = greatest_difference(&naive, &predict(&fit.model, x));
            prop_assert!(difference <= tolerance, "{difference}");
        }
        prop_assert_eq!(solved.y.len(), fit.beta.len());
    }

    #[test]
    fn support_vectors_are_the_samples_that_count(case in cases(60)) {
        if case.kernel == Kernel::Linear {
            return Ok(());
        }
        let Solved { fit, .. } = solve(case);
        let used = fit.beta.iter().filter(|b| **b != 0.0).count();
        prop_assert_eq!(used, fit.model.coefficients().len());
        prop_assert_eq!(used, fit.support_vectors);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(80) })]

    #[test]
    fn clarabel_finds_the_same_minimum(case in cases(40)) {
        let solved = solve(case);
        let minimum = minimum_by_clarabel(&solved.naive, solved.case.response_scale);
        // Where it gives up there is nothing to compare.
        prop_assume!(minimum.is_some());
        let minimum = minimum.expect("a minimum");
        let tolerance = 1e-6 * minimum.abs() + 1e-9 * solved.case.response_scale.powi(2) + solved.slack();
        prop_assert!((minimum + solved.fit.dual_objective).abs() <= tolerance,
            "{minimum} {:?}", solved.fit);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    /// Whatever the number of iterations, the figures are those of the coefficients and enclose the optimum.
    #[test]
    fn a_fit_that_was_stopped_says_how_far_off_it_is(
        case in cases(60),
        harder in 1.0..1e4_f64,
        max_iterations in prop_oneof![0..30_usize, 0..3000_usize],
    ) {
        let case = Case { box_constraint: case.box_constraint * harder, ..case };
        let solved = solve_within(case, max_iterations);
        let Solved { naive, fit, .. } = &solved;
        prop_assert!(fit.status == Status::IterationLimit || solved.is_as_good_as_can_be(), "{:?}", fit);
        prop_assert_eq!(fit.hint().is_none(), fit.status == Status::Optimal);
        prop_assert!(fit.iterations <= max_iterations);
        for (beta, bound) in fit.beta.iter().zip(&naive.bound) {
            prop_assert!(beta.abs() <= *bound, "{} {}", beta, bound);
        }
        let worth = solved.worth();
        let size: f64 = fit.beta.iter().map(|b| b.abs()).sum();
        let rounding = 1e-9 * (worth.primal.abs() + worth.dual.abs() + size * solved.case.response_scale) + solved.slack() + solved.rounding_of_polynomials();
        prop_assert!((worth.dual - fit.dual_objective).abs() <= rounding, "{} {}", worth.dual, fit.dual_objective);
        prop_assert!((worth.primal - fit.primal_objective).abs() <= rounding, "{} {}", worth.primal, fit.primal_objective);
        prop_assert!(fit.duality_gap() >= -rounding, "{}", fit.duality_gap());
    }
}

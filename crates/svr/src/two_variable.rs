//! Decomposition for kernels: the samples that violate optimality most form a working set of some hundred, on which the
//! two-variable method runs in the cache; then the gradient of all samples is brought up to date from whole rows.
//!
//! Only rows of samples that were ever in a working set are computed. The gradient is summed in double precision over
//! rows in single precision, and computed anew in double precision before the fit is called optimal where single
//! precision might hide a violation.

use crate::deadline::Deadline;
use crate::expansion::{add_expansion, kernel_block};
use crate::kernel_rows::KernelRows;
use crate::linear::Target;
use crate::subproblem::{Subproblem, slopes};
use crate::{Error, Kernel, Status};

/// Size of a working set.
const WORKING_SET: usize = 512;

/// A subproblem is solved to this share of the violation at hand.
const SHARE_OF_VIOLATION: f64 = 0.1;

/// The gradient is computed anew in double precision when single precision may have moved it by this share of the violation.
const SHARE_OF_ROUNDING: f64 = 0.1;

/// A solution in kernel form.
pub(crate) struct KernelSolution {
    pub(crate) beta: Vec<f64>,
    pub(crate) bias: f64,
    /// `(Kβ)_i`.
    pub(crate) products: Vec<f64>,
    /// Greatest violation of optimality.
    pub(crate) violation: f64,
    pub(crate) status: Status,
    pub(crate) iterations: usize,
}

/// Predictors and rows that solutions for several responses share.
pub(crate) struct KernelProblem {
    kernel: Kernel,
    predictors: usize,
    scaled: Vec<f64>,
    rows: KernelRows,
}

struct Progress<'a> {
    target: &'a Target<'a>,
    beta: Vec<f64>,
    gradient: Vec<f64>,
}

impl Progress<'_> {
    fn slopes(&self, i: usize) -> (f64, f64) {
        slopes(
            self.beta[i],
            self.gradient[i],
            self.target.bound[i],
            self.target.tube_epsilon,
        )
    }

    /// Greatest gain of moving up and least cost of moving down; optimal where the first is at most the second.
    fn extremes(&self) -> (f64, f64) {
        let slopes = (0..self.beta.len()).map(|i| self.slopes(i));
        slopes.fold(
            (f64::NEG_INFINITY, f64::INFINITY),
            |(most, least), (up, down)| (most.max(up), least.min(down)),
        )
    }
}

impl KernelProblem {
    pub(crate) fn new(
        kernel: Kernel,
        scaled: Vec<f64>,
        predictors: usize,
        capacity: usize,
    ) -> Result<Self, Error> {
        let rows = KernelRows::new(kernel, &scaled, predictors, capacity)?;
        Ok(Self {
            kernel,
            predictors,
            scaled,
            rows,
        })
    }

    /// Rows and coefficients of the samples whose coefficient is not 0.
    pub(crate) fn support(&self, beta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let used = self
            .scaled
            .chunks_exact(self.predictors)
            .zip(beta)
            .filter(|(_, beta)| **beta != 0.0);
        let coefficients = used.clone().map(|(_, beta)| *beta).collect();
        (
            used.flat_map(|(row, _)| row).copied().collect(),
            coefficients,
        )
    }

    /// Minimises `½ βᵀKβ − yᵀβ + ε‖β‖₁` until no pair of samples violates optimality by more than `tolerance`.
    pub(crate) fn solve(
        &mut self,
        target: &Target<'_>,
        tolerance: f64,
        start: Option<&[f64]>,
        deadline: &Deadline,
    ) -> KernelSolution {
        let beta = start.map_or_else(
            || vec![0.0; target.response.len()],
            |start| feasible(start, target.bound),
        );
        let mut progress = Progress {
            target,
            beta,
            gradient: Vec::new(),
        };
        progress.gradient = self.gradient(&progress);
        let mut rounding = 0.0;
        let mut iterations = 0;
        let mut previous = Vec::new();
        let mut least = f64::INFINITY;
        let mut rounds_without = 0;
        let status = loop {
            let (most, low) = progress.extremes();
            let violation = most - low;
            if rounding > SHARE_OF_ROUNDING * violation.max(tolerance) {
                progress.gradient = self.gradient(&progress);
                rounding = 0.0;
                continue;
            }
            if violation <= tolerance {
                break Status::Optimal;
            }
            if let Some(status) = deadline.passed(iterations) {
                break status;
            }
            if violation < 0.999 * least {
                (least, rounds_without) = (violation, 0);
            } else {
                rounds_without += 1;
                if rounds_without > 2000 {
                    break Status::Stalled;
                }
            }
            let members = self.working_set(&progress, most, low, &previous);
            self.rows.ensure(&members);
            let mut subproblem = Subproblem::new(
                &members,
                self.between(&members),
                &progress.beta,
                &progress.gradient,
                target.bound,
                target.tube_epsilon,
            );
            let most_steps = (100 * members.len()).min(deadline.max_iterations() - iterations);
            iterations += subproblem
                .minimise(
                    (SHARE_OF_VIOLATION * violation).max(0.5 * tolerance),
                    most_steps,
                )
                .max(1);
            rounding += self.take_over(&subproblem, &members, &mut progress);
            previous = members;
        };
        if status != Status::Optimal && rounding > 0.0 {
            // So that the figures of a fit that was stopped are those of its coefficients.
            progress.gradient = self.gradient(&progress);
        }
        let (most, low) = progress.extremes();
        let products = progress
            .gradient
            .iter()
            .zip(target.response)
            .map(|(g, y)| g + y)
            .collect();
        KernelSolution {
            bias: middle(most, low),
            violation: (most - low).max(0.0),
            products,
            beta: progress.beta,
            status,
            iterations,
        }
    }

    /// Kernel values between members.
    fn between(&self, members: &[usize]) -> Vec<f64> {
        let d = self.predictors;
        let rows = members
            .iter()
            .flat_map(|i| &self.scaled[i * d..(i + 1) * d]);
        let rows: Vec<f64> = rows.copied().collect();
        let mut values = vec![0.0; members.len() * members.len()];
        kernel_block(self.kernel, d, &rows, &rows, &mut values);
        values
    }

    /// `Kβ − y` in double precision.
    fn gradient(&self, progress: &Progress<'_>) -> Vec<f64> {
        let mut sums: Vec<f64> = progress.target.response.iter().map(|y| -y).collect();
        let (vectors, coefficients) = self.support(&progress.beta);
        add_expansion(
            self.kernel,
            self.predictors,
            &self.scaled,
            &vectors,
            &coefficients,
            &mut sums,
        );
        sums
    }

    /// Brings `β` and the gradient up to date; a bound of the rounding in single precision.
    fn take_over(
        &self,
        subproblem: &Subproblem,
        members: &[usize],
        progress: &mut Progress<'_>,
    ) -> f64 {
        let changes = members.iter().zip(&subproblem.beta);
        let changes = changes.map(|(&i, beta)| (i, beta - progress.beta[i]));
        let changes: Vec<(usize, f64)> = changes.filter(|(_, change)| *change != 0.0).collect();
        for (&i, &beta) in members.iter().zip(&subproblem.beta) {
            progress.beta[i] = beta;
        }
        self.rows.add(&changes, &mut progress.gradient);
        let size: f64 = changes
            .iter()
            .map(|(i, change)| change * change * self.rows.diagonal()[*i].powi(2))
            .sum();
        size.sqrt() * f64::from(f32::EPSILON)
    }

    /// The samples that violate most, as many that want to go up as down, and of the previous set those still free.
    fn working_set(
        &self,
        progress: &Progress<'_>,
        most: f64,
        low: f64,
        previous: &[usize],
    ) -> Vec<usize> {
        let size = WORKING_SET.min(self.rows.capacity());
        let (mut ups, mut downs) = (Vec::new(), Vec::new());
        for i in 0..progress.beta.len() {
            let (up, down) = progress.slopes(i);
            if up > low {
                ups.push((up, i));
            }
            if down < most {
                downs.push((-down, i));
            }
        }
        let new = if previous.is_empty() { size } else { size / 2 };
        let mut chosen = vec![false; progress.beta.len()];
        let mut members = Vec::with_capacity(size);
        for candidates in [&mut ups, &mut downs] {
            take_greatest(candidates, new / 2, &mut chosen, &mut members);
        }
        let free =
            |i: usize| progress.beta[i] != 0.0 && progress.beta[i].abs() < progress.target.bound[i];
        for &i in previous.iter().filter(|&&i| free(i)).chain(previous) {
            if members.len() < size && !std::mem::replace(&mut chosen[i], true) {
                members.push(i);
            }
        }
        members
    }
}

/// Moves the `count` samples of greatest value over to the members.
fn take_greatest(
    candidates: &mut [(f64, usize)],
    count: usize,
    chosen: &mut [bool],
    members: &mut Vec<usize>,
) {
    let count = count.max(1).min(candidates.len());
    if count == 0 {
        return;
    }
    let order = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    candidates.select_nth_unstable_by(count - 1, order);
    for &(_, i) in &candidates[..count] {
        if !std::mem::replace(&mut chosen[i], true) {
            members.push(i);
        }
    }
}

/// The start clipped to the bounds, and its sum brought back to 0.
fn feasible(start: &[f64], bound: &[f64]) -> Vec<f64> {
    let mut beta: Vec<f64> = start
        .iter()
        .zip(bound)
        .map(|(b, c)| if b.is_nan() { 0.0 } else { b.clamp(-c, *c) })
        .collect();
    let excess: f64 = beta.iter().sum();
    let side: f64 = beta.iter().map(|b| (b * excess.signum()).max(0.0)).sum();
    if side > 0.0 {
        let keep = 1.0 - excess.abs() / side;
        for b in &mut beta {
            if *b * excess > 0.0 {
                *b *= keep;
            }
        }
    }
    beta
}

/// Middle of the interval of optimal biases.
fn middle(most: f64, low: f64) -> f64 {
    match (most.is_finite(), low.is_finite()) {
        (true, true) => 0.5 * (most + low),
        (true, false) => most,
        (false, true) => low,
        (false, false) => 0.0,
    }
}

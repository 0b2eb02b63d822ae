use crate::deadline::Deadline;
use crate::linear::Target;
use crate::linear_rows::LinearRows;
use crate::model::Model;
use crate::nystrom::Nystrom;
use crate::scaler::Scaler;
use crate::subproblem::slopes;
use crate::two_variable::KernelProblem;
use crate::{Error, Kernel, Landmarks, Penalty, Response, Samples, Settings, Status, UsedPenalty};

/// A fitted model, and how good the fit is as an optimum. All figures are on the scale of the fitted response.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Fit {
    /// What predicts.
    pub model: Model,
    /// How the solver ended.
    pub status: Status,
    /// Penalties used.
    pub penalty: UsedPenalty,
    /// (4.17) at the solution.
    pub primal_objective: f64,
    /// Negative of (4.21) at the solution; never more than the optimum.
    pub dual_objective: f64,
    /// Greatest violation of the optimality conditions, in units of the response.
    pub kkt_residual: f64,
    /// Samples outside the tube or on its edge.
    pub support_vectors: usize,
    /// Newton steps, or pairs moved.
    pub iterations: usize,
    /// Wall clock.
    pub seconds: f64,
    /// `β = α* − α` of every sample, the start of a next fit.
    pub beta: Vec<f64>,
}

impl Fit {
    /// `primal_objective − dual_objective`, at least 0 but for rounding.
    #[must_use]
    pub fn duality_gap(&self) -> f64 {
        self.primal_objective - self.dual_objective
    }

    /// What to do about a fit that is not optimal.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self.status {
            Status::Optimal => None,
            Status::IterationLimit | Status::Stalled => Some(
                "scale the predictors, or use a greater kernel scale or a smaller box constraint; with predictors as they are, kernels of scale 1 hardly converge in any solver",
            ),
            Status::TimeLimit => Some("raise the time limit, or fit to fewer samples"),
        }
    }
}

/// Scaled predictors, and kernel rows that fits to several responses and penalties share.
pub struct Trainer {
    settings: Settings,
    kernel_scale: f64,
    scaler: Scaler,
    samples: usize,
    method: Method,
}

enum Method {
    Linear(LinearRows),
    Kernel(KernelProblem),
    Landmarks(Nystrom, LinearRows),
}

/// Samples from which on a kernel is approximated.
const MANY_SAMPLES: usize = 100_000;
const DEFAULT_LANDMARKS: usize = 512;

/// Fits one model.
///
/// # Errors
/// As [`Trainer::new`] and [`Trainer::fit`].
pub fn fit(
    samples: &Samples<'_>,
    response: &Response<'_>,
    settings: &Settings,
    penalty: &Penalty,
) -> Result<Fit, Error> {
    Trainer::new(samples, settings)?.fit(response, penalty, None)
}

impl Trainer {
    /// Scales the predictors.
    ///
    /// # Errors
    /// [`Error::Setting`] for settings out of range, [`Error::Memory`] where predictors and landmarks, or two kernel rows, do not fit,
    /// [`Error::NotPositiveDefinite`].
    pub fn new(samples: &Samples<'_>, settings: &Settings) -> Result<Self, Error> {
        settings.check(samples.predictors())?;
        let (n, d) = (samples.len(), samples.predictors());
        let kernel_scale = settings
            .kernel_scale
            .unwrap_or_else(|| settings.kernel.default_scale(d));
        let scaler = Scaler::of(samples, settings);
        let scaled = scaler.scale(samples, kernel_scale);
        let limit_bytes = settings.memory_limit_bytes;
        let within = |needed_bytes: usize| {
            let fits = needed_bytes <= limit_bytes;
            let refused = Error::Memory {
                samples: n,
                needed_bytes,
                limit_bytes,
            };
            if fits { Ok(()) } else { Err(refused) }
        };
        let landmarks = match settings.landmarks {
            Landmarks::Never => None,
            Landmarks::Count(count) => Some(count.min(n)),
            Landmarks::Auto => (n > MANY_SAMPLES).then_some(DEFAULT_LANDMARKS),
        };
        let method = match (settings.kernel, landmarks) {
            (Kernel::Linear, _) => {
                within(8 * n * (2 * d + 1))?;
                Method::Linear(LinearRows::new(&scaled, d))
            }
            (kernel, Some(count)) => {
                within(8 * n * d + Nystrom::bytes(n, d, count))?;
                let nystrom = Nystrom::new(kernel, &scaled, d, count)?;
                let rows = nystrom.features(&scaled);
                Method::Landmarks(nystrom, rows)
            }
            (kernel, None) => {
                // Predictors in double and in single precision, the products of a batch, and per sample the solver's own.
                let fixed_bytes = n * (12 * d + 4 * 64 + 100);
                within(fixed_bytes + 4 * n * n.min(2))?;
                let capacity = (limit_bytes - fixed_bytes) / (4 * n);
                Method::Kernel(KernelProblem::new(kernel, scaled, d, capacity)?)
            }
        };
        Ok(Self {
            settings: settings.clone(),
            kernel_scale,
            scaler,
            samples: n,
            method,
        })
    }

    /// Fits to a response; `start` is a fit to the same samples with other penalties or a similar response.
    ///
    /// # Errors
    /// [`Error::Length`] where response or start have not one value per sample, [`Error::Setting`] for penalties out of
    /// range.
    pub fn fit(
        &mut self,
        response: &Response<'_>,
        penalty: &Penalty,
        start: Option<&Fit>,
    ) -> Result<Fit, Error> {
        for (what, found) in [
            ("responses", response.values().len()),
            (
                "coefficients to start from",
                start.map_or(self.samples, |s| s.beta.len()),
            ),
        ] {
            if found != self.samples {
                return Err(Error::Length {
                    what,
                    found,
                    expected: self.samples,
                });
            }
        }
        let stopping = self.settings.stopping;
        let deadline = Deadline::new(stopping.max_iterations, stopping.time_limit_s);
        let response_scaler = Scaler::learn(
            &Samples::new(response.values(), 1)?,
            self.settings.response_scaling,
        );
        let scaled = response_scaler.scale_values(response.values());
        let used = penalty.resolve(&scaled)?;
        let bound: Vec<f64> = (0..self.samples)
            .map(|i| used.box_constraint * response.weight(i))
            .collect();
        let target = Target {
            response: &scaled,
            bound: &bound,
            tube_epsilon: used.tube_epsilon,
        };
        // Coefficients at a bound mostly stay there, so they grow with it.
        let start: Option<Vec<f64>> = start.map(|fit| {
            let growth = (used.box_constraint / fit.penalty.box_constraint).min(f64::MAX);
            fit.beta.iter().map(|b| b * growth).collect()
        });
        let solved = self.method.solve(
            &target,
            stopping.tolerance(self.settings.kernel),
            start.as_deref(),
            &deadline,
        );
        let figures = target.figures(&solved);
        let model = Model::new(
            self.settings.kernel,
            self.kernel_scale,
            self.scaler.clone(),
            response_scaler,
            solved.coefficients,
            solved.vectors,
            solved.bias,
        );
        Ok(Fit {
            model,
            status: solved.status,
            penalty: used,
            primal_objective: figures.primal,
            dual_objective: figures.dual,
            kkt_residual: solved.violation,
            support_vectors: solved.support_vectors,
            iterations: solved.iterations,
            seconds: deadline.seconds(),
            beta: solved.beta,
        })
    }
}

/// What every method answers.
struct Solved {
    coefficients: Vec<f64>,
    vectors: Vec<f64>,
    bias: f64,
    beta: Vec<f64>,
    /// `f(x_i) − b`.
    products: Vec<f64>,
    violation: f64,
    support_vectors: usize,
    status: Status,
    iterations: usize,
}

impl Method {
    fn solve(
        &mut self,
        target: &Target<'_>,
        tolerance: f64,
        start: Option<&[f64]>,
        deadline: &Deadline,
    ) -> Solved {
        match self {
            Self::Linear(rows) => solve_linear(rows, target, tolerance, deadline),
            Self::Landmarks(nystrom, rows) => {
                let solved = solve_linear(rows, target, tolerance.min(1e-4), deadline);
                Solved {
                    coefficients: nystrom.coefficients(&solved.coefficients),
                    vectors: nystrom.landmarks().to_vec(),
                    ..solved
                }
            }
            Self::Kernel(problem) => {
                let solution = problem.solve(target, tolerance, start, deadline);
                let (vectors, coefficients) = problem.support(&solution.beta);
                Solved {
                    support_vectors: coefficients.len(),
                    coefficients,
                    vectors,
                    bias: solution.bias,
                    beta: solution.beta,
                    products: solution.products,
                    violation: solution.violation,
                    status: solution.status,
                    iterations: solution.iterations,
                }
            }
        }
    }
}

fn solve_linear(
    rows: &LinearRows,
    target: &Target<'_>,
    tolerance: f64,
    deadline: &Deadline,
) -> Solved {
    let mut solution = rows.solve(target, tolerance, deadline);
    let bias = solution.omega.pop().unwrap_or(0.0);
    let mut products = vec![0.0; target.response.len()];
    rows.products(&[solution.omega.as_slice(), &[0.0]].concat(), &mut products);
    let near_zero = target.near_zero(&solution.beta);
    let support_vectors = solution.beta.iter().zip(&near_zero);
    Solved {
        violation: target.violation(&solution.beta, &products, &near_zero),
        support_vectors: support_vectors
            .filter(|(beta, near)| beta.abs() > **near)
            .count(),
        coefficients: solution.omega,
        vectors: Vec::new(),
        bias,
        beta: solution.beta,
        products,
        status: solution.status,
        iterations: solution.iterations,
    }
}

/// Objectives of a solution.
struct FitFigures {
    primal: f64,
    dual: f64,
}

/// Multipliers nearer than this share of the bound to the bound are there, and nearer than this share of the bound or of the
/// greatest multiplier to 0 are 0: an interior point method stays inside.
const AT_A_BOUND: f64 = 1e-6;

impl Target<'_> {
    fn figures(&self, solved: &Solved) -> FitFigures {
        let (mut square, mut loss, mut linear) = (0.0, 0.0, 0.0);
        for (i, &y) in self.response.iter().enumerate() {
            let (beta, product, bound) = (solved.beta[i], solved.products[i], self.bound[i]);
            square += beta * product;
            linear += y * beta - self.tube_epsilon * beta.abs();
            loss += bound * ((y - product - solved.bias).abs() - self.tube_epsilon).max(0.0);
        }
        FitFigures {
            primal: 0.5 * square + loss,
            dual: linear - 0.5 * square,
        }
    }

    /// Up to what size a multiplier of an interior point is 0.
    fn near_zero(&self, beta: &[f64]) -> Vec<f64> {
        let most = beta.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
        let near = |bound: &f64| AT_A_BOUND * bound.min(most);
        self.bound.iter().map(near).collect()
    }

    fn violation(&self, beta: &[f64], products: &[f64], near_zero: &[f64]) -> f64 {
        let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        for (i, &bound) in self.bound.iter().enumerate() {
            let beta = match beta[i].abs() {
                size if size <= near_zero[i] => 0.0,
                size if size >= (1.0 - AT_A_BOUND) * bound => bound.copysign(beta[i]),
                _ => beta[i],
            };
            let (up, down) = slopes(
                beta,
                products[i] - self.response[i],
                bound,
                self.tube_epsilon,
            );
            (most, least) = (most.max(up), least.min(down));
        }
        (most - least).max(0.0)
    }
}

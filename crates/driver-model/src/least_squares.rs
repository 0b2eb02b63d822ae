//! Bounded nonlinear least squares for curves `y = f(x; p)` with two or three parameters.
//!
//! Minimises `½ Σ (f(x_i; p) − y_i)²` subject to `lower ≤ p ≤ upper` (thesis 2.23, 2.24). The bounds are
//! removed by `p = lower + (upper − lower)·(1 + sin q)/2`, and the trust-region method of `argmin`
//! (Steihaug's conjugate gradients inside) works on `q` with the Gauss–Newton Hessian `JᵀJ`.

use argmin::core::{CostFunction, Executor, Gradient, Hessian, State};
use argmin::solver::trustregion::{Steihaug, TrustRegion};

use crate::Error;

/// A curve `f(x; p)` and its gradient in `p`.
pub(crate) struct Curve<const N: usize> {
    /// Name of the model, for errors.
    pub(crate) model: &'static str,
    /// `f(x; p)`.
    pub(crate) value: fn(&[f64; N], f64) -> f64,
    /// `∂f/∂p` at `(x; p)`.
    pub(crate) gradient: fn(&[f64; N], f64) -> [f64; N],
    /// Lower bounds, strictly below `upper`.
    pub(crate) lower: [f64; N],
    /// Upper bounds.
    pub(crate) upper: [f64; N],
    /// Strictly inside the bounds; the best end point of all of them wins.
    pub(crate) starts: &'static [[f64; N]],
}

/// Where the optimiser ended.
#[derive(Debug)]
pub(crate) struct Fit<const N: usize> {
    pub(crate) parameters: [f64; N],
    /// `Σ (f(x_i; p) − y_i)²`.
    pub(crate) residual_sum_of_squares: f64,
}

struct Transformed<'a, const N: usize> {
    curve: &'a Curve<N>,
    points: &'a [(f64, f64)],
}

const MAX_ITERATIONS: u64 = 120;

impl<const N: usize> Curve<N> {
    /// Fits the curve to `(x, y)` points.
    pub(crate) fn fit(&self, points: &[(f64, f64)]) -> Result<Fit<N>, Error> {
        let mut best: Option<Fit<N>> = None;
        for start in self.starts {
            let fit = self.fit_from(start, points)?;
            let better = best
                .as_ref()
                .is_none_or(|b| fit.residual_sum_of_squares < b.residual_sum_of_squares);
            if better && fit.residual_sum_of_squares.is_finite() {
                best = Some(fit);
            }
        }
        best.ok_or_else(|| self.failure("no finite sum of squares from any starting point"))
    }

    /// Refuses parameters outside the bounds, which no fit can produce.
    pub(crate) fn check(
        &self,
        names: [&'static str; N],
        parameters: &[f64; N],
    ) -> Result<(), Error> {
        for (i, name) in names.into_iter().enumerate() {
            let (value, range) = (parameters[i], self.lower[i]..=self.upper[i]);
            if !range.contains(&value) {
                return Err(Error::Parameter {
                    model: self.model,
                    name,
                    value,
                    expected: format!("{} to {}", range.start(), range.end()),
                });
            }
        }
        Ok(())
    }

    fn fit_from(&self, start: &[f64; N], points: &[(f64, f64)]) -> Result<Fit<N>, Error> {
        let problem = Transformed {
            curve: self,
            points,
        };
        let solver = TrustRegion::new(Steihaug::new().with_max_iters(2 * N as u64))
            .with_radius(0.5)
            .and_then(|s| s.with_max_radius(2.0))
            .map_err(|e| self.failure(e))?;
        let outcome = Executor::new(problem, solver)
            .configure(|state| {
                state
                    .param(self.free_from_bounded(start))
                    .max_iters(MAX_ITERATIONS)
                    .target_cost(0.0)
            })
            .run()
            .map_err(|e| self.failure(e))?;
        let free = outcome
            .state()
            .get_best_param()
            .ok_or_else(|| self.failure("the optimiser returned no point"))?;
        let parameters = self.bounded_from_free(free);
        Ok(Fit {
            parameters,
            residual_sum_of_squares: self.sum_of_squares(&parameters, points),
        })
    }

    fn sum_of_squares(&self, p: &[f64; N], points: &[(f64, f64)]) -> f64 {
        points
            .iter()
            .map(|&(x, y)| ((self.value)(p, x) - y).powi(2))
            .sum()
    }

    fn bounded_from_free(&self, q: &[f64]) -> [f64; N] {
        std::array::from_fn(|i| {
            let (lower, upper) = (self.lower[i], self.upper[i]);
            (lower + (upper - lower) * 0.5 * (1.0 + q[i].sin())).clamp(lower, upper)
        })
    }

    fn free_from_bounded(&self, p: &[f64; N]) -> Vec<f64> {
        (0..N)
            .map(|i| {
                let share = (p[i] - self.lower[i]) / (self.upper[i] - self.lower[i]);
                (2.0 * share - 1.0).clamp(-1.0, 1.0).asin()
            })
            .collect()
    }

    fn failure(&self, reason: impl std::fmt::Display) -> Error {
        Error::Fit {
            model: self.model,
            reason: reason.to_string(),
        }
    }
}

impl<const N: usize> Transformed<'_, N> {
    /// Calls `visit` with the residual and its gradient in the free parameters for every point.
    fn for_each_residual(&self, q: &[f64], mut visit: impl FnMut(f64, &[f64; N])) {
        let p = self.curve.bounded_from_free(q);
        let stretch: [f64; N] =
            std::array::from_fn(|i| (self.curve.upper[i] - self.curve.lower[i]) * 0.5 * q[i].cos());
        for &(x, y) in self.points {
            let mut gradient = (self.curve.gradient)(&p, x);
            for (g, s) in gradient.iter_mut().zip(stretch) {
                *g *= s;
            }
            visit((self.curve.value)(&p, x) - y, &gradient);
        }
    }
}

impl<const N: usize> CostFunction for Transformed<'_, N> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, q: &Self::Param) -> Result<f64, argmin::core::Error> {
        let p = self.curve.bounded_from_free(q);
        Ok(0.5 * self.curve.sum_of_squares(&p, self.points))
    }
}

impl<const N: usize> Gradient for Transformed<'_, N> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, q: &Self::Param) -> Result<Vec<f64>, argmin::core::Error> {
        let mut sum = vec![0.0; N];
        self.for_each_residual(q, |residual, gradient| {
            for (s, g) in sum.iter_mut().zip(gradient) {
                *s += residual * g;
            }
        });
        Ok(sum)
    }
}

impl<const N: usize> Hessian for Transformed<'_, N> {
    type Param = Vec<f64>;
    type Hessian = Vec<Vec<f64>>;

    fn hessian(&self, q: &Self::Param) -> Result<Vec<Vec<f64>>, argmin::core::Error> {
        let mut sum = vec![vec![0.0; N]; N];
        self.for_each_residual(q, |_, gradient| {
            for (row, gi) in sum.iter_mut().zip(gradient) {
                for (s, gj) in row.iter_mut().zip(gradient) {
                    *s += gi * gj;
                }
            }
        });
        Ok(sum)
    }
}

//! Nonlinear least squares over simulated stretches, within bounds.
//!
//! Minimises the mean over samples of `((ŝ − s)/S)² + ((v̂ − v)/V)²`, where `S` and `V` are the root mean squares of
//! measured gap and speed of a stretch, at least 1 m and 1 m/s. The gap is off by some tenths and the speed by some
//! hundredths, so that the gap decides. The bounds are removed by `p = lower + (upper − lower)(1 + sin q)/2`, and Levenberg
//! and Marquardt's method works on `q`.

use ev_energy::calibration::Bounds;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use rayon::prelude::*;
use serde::Serialize;

use super::simulation::root_mean_square;
use super::{Family, FollowingModel, FollowingStretch, Parameter};
use crate::least_squares::unconverged;
use crate::{Error, ModelKind};

/// A model of car following fitted to stretches.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowingFit {
    /// The model.
    pub model: FollowingModel,
    /// What was minimised: mean over the samples of the squares of the relative errors of gap and speed.
    pub mean_square: f64,
    /// Stretches it was fitted to.
    pub stretches: usize,
    /// Parameters that ran into a bound: the stretches do not tell them.
    pub at_bound: Vec<&'static str>,
}

/// Samples are compared this far apart, or further where the log has a longer step.
const COMPARE_STEP_S: f64 = 0.5;

/// Step of finite differences, of the width of the bounds.
const DIFFERENCE: f64 = 1e-5;

/// Change of the sum of squares, and of the parameters, below which the fit has converged.
const TOLERANCE: f64 = 1e-5;

/// Evaluations at most, per parameter.
const PATIENCE: usize = 100;

/// A value this near to a bound, as a share of the width, ran into it.
const AT_BOUND: f64 = 0.01;

/// Least `S` in m and `V` in m/s, so that standing still has a scale.
const SMALLEST_SCALE: f64 = 1.0;

impl FollowingModel {
    /// Fits one model to whole stretches, from three starting points of which the best counts.
    ///
    /// # Errors
    /// [`Error::TooFewStretches`] without stretches, or with less samples than parameters; [`Error::Fit`] where the best
    /// end point is not one that the method converged to; [`Error::Subject`] for a model of anything else.
    pub fn fit(kind: ModelKind, stretches: &[&FollowingStretch]) -> Result<FollowingFit, Error> {
        let family = Family::of(kind)?;
        let samples: usize = stretches.iter().map(|s| compared_samples(s)).sum();
        if samples < family.parameters.len() {
            return Err(Error::TooFewStretches {
                found: samples,
                needed: family.parameters.len(),
                unit: "half seconds behind a vehicle (lead_gap_m) to learn from",
            });
        }
        let ends: Vec<End> = family
            .starts
            .par_iter()
            .map(|start| Problem::new(family, start, stretches).solve())
            .collect();
        let failure = |reason: String| Error::Fit {
            model: kind.name(),
            reason,
        };
        let best = ends
            .into_iter()
            .filter(|end| end.half_sum.is_finite())
            .min_by(|a, b| a.half_sum.total_cmp(&b.half_sum))
            .ok_or_else(|| failure("no finite sum of squares from any starting point".into()))?;
        if let Some(reason) = best.unconverged {
            return Err(failure(reason));
        }
        Ok(FollowingFit {
            model: (family.model)(&best.values),
            mean_square: 2.0 * best.half_sum / samples as f64,
            stretches: stretches.len(),
            at_bound: family
                .parameters
                .iter()
                .zip(&best.values)
                .filter(|(parameter, value)| parameter.is_at_bound(**value))
                .map(|(parameter, _)| parameter.name)
                .collect(),
        })
    }
}

impl Parameter {
    fn bounds(&self) -> Bounds {
        Bounds {
            lower: self.lower,
            upper: self.upper,
        }
    }

    fn is_at_bound(&self, value: f64) -> bool {
        (value - self.lower).min(self.upper - value) < AT_BOUND * self.bounds().width()
    }
}

/// Where the method ended from one starting point.
struct End {
    values: Vec<f64>,
    half_sum: f64,
    unconverged: Option<String>,
}

struct Problem<'a> {
    family: &'static Family,
    stretches: &'a [&'a FollowingStretch],
    /// `S` and `V` per stretch.
    scales: Vec<(f64, f64)>,
    free: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(family: &'static Family, start: &[f64], stretches: &'a [&'a FollowingStretch]) -> Self {
        let parameters = family.parameters;
        let starts = parameters.iter().zip(start);
        let free = starts.map(|(parameter, value)| parameter.bounds().free(*value));
        let scale = |values: &[f64]| root_mean_square(values).max(SMALLEST_SCALE);
        Self {
            family,
            stretches,
            scales: stretches
                .iter()
                .map(|s| (scale(s.gap_m()), scale(s.speed_mps())))
                .collect(),
            free: DVector::from_iterator(parameters.len(), free),
        }
    }

    fn solve(self) -> End {
        let solver = LevenbergMarquardt::new()
            .with_ftol(TOLERANCE)
            .with_xtol(TOLERANCE)
            .with_gtol(TOLERANCE)
            .with_patience(PATIENCE);
        let (solved, report) = solver.minimize(self);
        End {
            values: solved.values(),
            half_sum: report.objective_function,
            unconverged: unconverged(&report.termination),
        }
    }

    fn values(&self) -> Vec<f64> {
        self.family
            .parameters
            .iter()
            .zip(self.free.iter())
            .map(|(parameter, free)| parameter.bounds().value(*free))
            .collect()
    }

    /// Relative errors of gap and speed, one after the other.
    fn residuals_at(&self, values: &[f64]) -> Option<Vec<f64>> {
        let model = (self.family.model)(values);
        let mut residuals = Vec::new();
        for (stretch, (gap_scale_m, speed_scale_mps)) in self.stretches.iter().zip(&self.scales) {
            let every = compare_every(stretch);
            let measured = stretch.gap_m().iter().zip(stretch.speed_mps());
            let mut measured = measured.enumerate();
            model.drive(stretch, |speed_mps, gap_m| {
                if let Some((k, (measured_m, measured_mps))) = measured.next()
                    && k % every == 0
                    && k > 0
                {
                    residuals.push((gap_m - measured_m) / gap_scale_m);
                    residuals.push((speed_mps - measured_mps) / speed_scale_mps);
                }
            });
        }
        let finite = residuals.iter().all(|residual| residual.is_finite());
        finite.then_some(residuals)
    }
}

fn compare_every(stretch: &FollowingStretch) -> usize {
    (COMPARE_STEP_S / stretch.step_s()).round().max(1.0) as usize
}

/// The first sample is where the simulation starts and not compared.
fn compared_samples(stretch: &FollowingStretch) -> usize {
    (stretch.speed_mps().len() - 1) / compare_every(stretch)
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, free: &DVector<f64>) {
        self.free.copy_from(free);
    }

    fn params(&self) -> DVector<f64> {
        self.free.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals_at(&self.values()).map(DVector::from_vec)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let values = self.values();
        let here = self.residuals_at(&values)?;
        let mut jacobian = DMatrix::zeros(here.len(), values.len());
        for (k, parameter) in self.family.parameters.iter().enumerate() {
            // Inward from the upper bound.
            let bounds = parameter.bounds();
            let step = DIFFERENCE * bounds.width();
            let inward = values[k] + step > parameter.upper;
            let step = if inward { -step } else { step };
            let mut moved = values.clone();
            moved[k] += step;
            let there = self.residuals_at(&moved)?;
            let slope = bounds.slope(self.free[k]) / step;
            for ((place, here), there) in jacobian.column_mut(k).iter_mut().zip(&here).zip(&there) {
                *place = slope * (there - here);
            }
        }
        Some(jacobian)
    }
}

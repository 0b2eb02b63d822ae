//! Least squares over simulated stretches, within bounds.
//!
//! Laws are clamped and drivers stop, so that the objective has edges and several minima. It is looked up on a fixed design
//! of parameters beside the starting points of the model; Levenberg and Marquardt's method goes down from the best of them,
//! and simplices of Nelder and Mead, which need no derivatives, from where it ends. Positive parameters are sought by their logarithms.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use rayon::prelude::*;
use serde::Serialize;

use super::objective::FollowingObjective;
use super::polish::polish;
use super::{Family, FollowingModel, FollowingStretch};
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

/// Places at which the objective is looked up, per parameter.
const DESIGN: usize = 24;

/// How many of them the methods start from, beside the starting points of the model.
const DESCENTS: usize = 5;

/// Ends that are polished.
const POLISHED: usize = 4;

/// Ends whose sums differ by less, relative, are the same.
const SAME: f64 = 1e-3;

/// Step of finite differences in free parameters: over edges of the objective rather than along one.
const DIFFERENCE: f64 = 1e-4;

/// Change of the sum of squares, and of the parameters, below which Levenberg and Marquardt's method stops.
const TOLERANCE: f64 = 1e-4;

/// Its evaluations at most, per parameter.
const PATIENCE: usize = 30;

/// A value this near to a bound, as a share of the width, ran into it.
const AT_BOUND: f64 = 0.01;

impl FollowingModel {
    /// Fits one model to whole stretches.
    ///
    /// # Errors
    /// [`Error::TooFewStretches`] without stretches, or with less samples than parameters; [`Error::Fit`] where the model drives
    /// nowhere with finite errors; [`Error::Subject`] for a model of anything else.
    pub fn fit(kind: ModelKind, stretches: &[&FollowingStretch]) -> Result<FollowingFit, Error> {
        let family = Family::of(kind)?;
        let objective = FollowingObjective::new(stretches);
        Search::new(family, &objective)?.widely()
    }
}

impl Family {
    pub(super) fn at_bound(&self, values: &[f64]) -> Vec<&'static str> {
        let named = self.parameters.iter().zip(values);
        let at_bound = named.filter(|(parameter, value)| {
            let (bounds, place) = (parameter.bounds(), parameter.place(**value));
            (place - bounds.lower).min(bounds.upper - place) < AT_BOUND * bounds.width()
        });
        at_bound.map(|(parameter, _)| parameter.name).collect()
    }
}

/// Free parameters with their sum: the objective, and what the prior adds.
#[derive(Debug, Clone)]
pub(super) struct End {
    pub(super) free: Vec<f64>,
    pub(super) sum: f64,
}

/// What is known of parameters besides the stretches: each adds `weight (place − mean)²` to the objective.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    pub(super) mean: Vec<f64>,
    pub(super) weight: Vec<f64>,
}

/// Looks for the parameters of a model with the least objective.
pub(super) struct Search<'a> {
    pub(super) family: &'static Family,
    pub(super) objective: &'a FollowingObjective<'a>,
    pub(super) prior: Option<&'a Prior>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        family: &'static Family,
        objective: &'a FollowingObjective<'a>,
    ) -> Result<Self, Error> {
        let (found, needed) = (objective.samples(), family.parameters.len());
        if found < needed {
            return Err(Error::TooFewStretches {
                found,
                needed,
                unit: "half seconds behind a vehicle (lead_gap_m) to learn from",
            });
        }
        Ok(Self {
            family,
            objective,
            prior: None,
        })
    }

    /// The fit from everywhere.
    fn widely(&self) -> Result<FollowingFit, Error> {
        self.from(&self.starts())
    }

    /// The fit from some places.
    pub(super) fn from(&self, starts: &[Vec<f64>]) -> Result<FollowingFit, Error> {
        let values = self.best(starts)?;
        let model = (self.family.model)(&values);
        Ok(FollowingFit {
            model,
            mean_square: self.objective.mean_square(&model),
            stretches: self.objective.stretches(),
            at_bound: self.family.at_bound(&values),
        })
    }

    /// The starting points of the model and the best of the design.
    fn starts(&self) -> Vec<Vec<f64>> {
        let dimensions = self.family.parameters.len();
        let mut design: Vec<End> = (0..DESIGN * dimensions)
            .into_par_iter()
            .map(|k| self.at(design_point(k, dimensions)))
            .collect();
        design.sort_by(|a, b| a.sum.total_cmp(&b.sum));
        let own = self
            .family
            .starts
            .iter()
            .map(|start| self.family.free(start));
        let best = design.into_iter().take(DESCENTS).map(|end| end.free);
        own.chain(best).collect()
    }

    /// Values of the least sum that is found from so many places.
    fn best(&self, starts: &[Vec<f64>]) -> Result<Vec<f64>, Error> {
        let mut ends: Vec<End> = starts.par_iter().map(|start| self.descend(start)).collect();
        ends.sort_by(|a, b| a.sum.total_cmp(&b.sum));
        ends.dedup_by(|next, kept| next.sum - kept.sum < SAME * kept.sum);
        ends.truncate(POLISHED);
        let polished: Vec<End> = ends
            .into_par_iter()
            .map(|end| polish(end, |free| self.sum(free)))
            .collect();
        let best = polished.into_iter().min_by(|a, b| a.sum.total_cmp(&b.sum));
        match best {
            Some(end) if end.sum.is_finite() => Ok(self.family.values(&end.free)),
            _ => Err(Error::Fit {
                model: (self.family.model)(self.family.starts[0]).kind().name(),
                reason: "no finite sum of squares from any starting point".into(),
            }),
        }
    }

    fn at(&self, free: Vec<f64>) -> End {
        let sum = self.sum(&free);
        End { free, sum }
    }

    fn sum(&self, free: &[f64]) -> f64 {
        let model = (self.family.model)(&self.family.values(free));
        let of_prior = self
            .prior_residuals(free)
            .map(|residual| residual * residual);
        self.objective.mean_square(&model) + of_prior.sum::<f64>()
    }

    fn prior_residuals(&self, free: &[f64]) -> impl Iterator<Item = f64> {
        let prior = self
            .prior
            .into_iter()
            .flat_map(|prior| prior.mean.iter().zip(&prior.weight));
        let places = self.family.places(free).into_iter();
        prior
            .zip(places)
            .map(|((mean, weight), place)| weight.sqrt() * (place - mean))
    }

    /// Where Levenberg and Marquardt's method ends.
    pub(super) fn descend(&self, start: &[f64]) -> End {
        let solver = LevenbergMarquardt::new()
            .with_ftol(TOLERANCE)
            .with_xtol(TOLERANCE)
            .with_gtol(TOLERANCE)
            .with_patience(PATIENCE);
        let (solved, _) = solver.minimize(Descent {
            search: self,
            free: DVector::from_column_slice(start),
        });
        self.at(solved.free.as_slice().to_vec())
    }
}

/// Point `k` of a low-discrepancy design in free parameters: multiples of the powers of the root of `x^(d+1) = x + 1`, by their
/// fractions.
fn design_point(k: usize, dimensions: usize) -> Vec<f64> {
    let mut root: f64 = 1.5;
    for _ in 0..40 {
        root = (1.0 + root).powf(1.0 / (dimensions as f64 + 1.0));
    }
    (1..=dimensions)
        .map(|j| {
            let share = (0.5 + (k + 1) as f64 / root.powi(j as i32)).fract();
            (2.0 * share - 1.0).asin()
        })
        .collect()
}

struct Descent<'a> {
    search: &'a Search<'a>,
    free: DVector<f64>,
}

impl Descent<'_> {
    fn residuals_at(&self, free: &[f64]) -> Option<Vec<f64>> {
        let family = self.search.family;
        let model = (family.model)(&family.values(free));
        let objective = self.search.objective;
        let mut residuals = objective.residuals(&model)?;
        let root = (objective.samples() as f64).sqrt();
        residuals.extend(
            self.search
                .prior_residuals(free)
                .map(|residual| root * residual),
        );
        Some(residuals)
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Descent<'_> {
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
        self.residuals_at(self.free.as_slice())
            .map(DVector::from_vec)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let here = self.residuals_at(self.free.as_slice())?;
        let mut jacobian = DMatrix::zeros(here.len(), self.free.len());
        for k in 0..self.free.len() {
            let mut moved = self.free.as_slice().to_vec();
            moved[k] += DIFFERENCE;
            let there = self.residuals_at(&moved)?;
            for ((place, here), there) in jacobian.column_mut(k).iter_mut().zip(&here).zip(&there) {
                *place = (there - here) / DIFFERENCE;
            }
        }
        Some(jacobian)
    }
}

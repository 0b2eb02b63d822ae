//! Parameters of every driver, with what is typical of all of them as a prior (empirical Bayes).
//!
//! The places `x` of a driver's parameters, logarithms where they are positive, are spread around a mean `μ` with a
//! deviation `τ` each, and the driver's own minimise `n/σ² · objective + Σ((x − μ)/τ)²`, with `n` independent samples and the
//! mean square `σ²` that own parameters leave. Mean and deviations follow from the drivers (expectation and maximisation, with
//! the curvature of the objective for how much a driver's stretches tell).

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use rayon::prelude::*;
use serde::Serialize;

use super::fit::{End, FollowingFit, Prior, Search};
use super::objective::FollowingObjective;
use super::{Family, FollowingStretch};
use crate::Error;

/// Drivers and how they differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowingPopulation {
    /// Standard deviations over drivers: of the logarithms of parameters, and in m of a gap that may be negative.
    pub spread: BTreeMap<&'static str, f64>,
    /// Every driver's own, in the order they were given.
    pub drivers: Vec<FollowingFit>,
}

/// Errors of a simulation this far apart are independent.
const INDEPENDENT_S: f64 = 10.0;

/// Rounds of expectation and maximisation; deviations change by some per cent in the last.
const ROUNDS: usize = 5;

/// Deviations before anything is known, as a share of the width of bounds, and for how many drivers they count.
const WIDE: f64 = 1.0 / 6.0;
const WIDE_DRIVERS: f64 = 1.0;

/// Step of the differences that curvatures come from, as a share of the width of bounds.
const DIFFERENCE: f64 = 1e-3;

impl FollowingPopulation {
    /// Fits a model to every driver, given by the stretches of each, from what was fitted to all of them together.
    ///
    /// # Errors
    /// [`Error::TooFewStretches`] for a driver with less samples than parameters, and those of [`super::FollowingModel::fit`].
    pub fn fit(pooled: &FollowingFit, drivers: &[Vec<&FollowingStretch>]) -> Result<Self, Error> {
        let all: Vec<&FollowingStretch> = drivers.iter().flatten().copied().collect();
        let objective = FollowingObjective::new(&all);
        let own: Vec<_> = drivers.iter().map(|own| objective.of_some(own)).collect();
        let mut population = Population::around(pooled)?;
        let searches = own.iter().map(|own| Search::new(population.family, own));
        let searches: Vec<Search<'_>> = searches.collect::<Result<_, _>>()?;
        let mut ends = vec![population.free_mean(); searches.len()];
        for _ in 0..ROUNDS {
            population.learn(&searches, &mut ends);
        }
        population.settled(&searches, &ends)
    }
}

struct Population {
    family: &'static Family,
    mean: Vec<f64>,
    deviation: Vec<f64>,
    /// `σ²`.
    noise: f64,
}

/// What a driver's stretches say.
struct Told {
    free: Vec<f64>,
    mean_square: f64,
    /// Of the places, given the stretches and the prior.
    variance: Vec<f64>,
}

impl Population {
    fn around(pooled: &FollowingFit) -> Result<Self, Error> {
        let family = Family::of(pooled.model.kind())?;
        Ok(Self {
            family,
            mean: family.places(&family.free(&pooled.model.values())),
            deviation: family.widths().map(|width| WIDE * width).collect(),
            noise: pooled.mean_square,
        })
    }

    fn free_mean(&self) -> Vec<f64> {
        let named = self.family.parameters.iter().zip(&self.mean);
        named.map(|(p, place)| p.bounds().free(*place)).collect()
    }

    /// The prior of a driver: the fewer the samples, the more it weighs.
    fn prior(&self, objective: &FollowingObjective<'_>) -> Prior {
        let one = self.noise / (objective.duration_s() / INDEPENDENT_S);
        Prior {
            mean: self.mean.clone(),
            weight: self
                .deviation
                .iter()
                .map(|deviation| one / deviation.powi(2))
                .collect(),
        }
    }

    /// One round: every driver by the population, the population by the drivers.
    fn learn(&mut self, searches: &[Search<'_>], ends: &mut [Vec<f64>]) {
        let of_driver = |(search, start): (&Search<'_>, &Vec<f64>)| self.told(search, start);
        let told: Vec<Told> = searches.par_iter().zip(&*ends).map(of_driver).collect();
        let drivers = told.len() as f64;
        let places: Vec<Vec<f64>> = told.iter().map(|t| self.family.places(&t.free)).collect();
        for (k, width) in self.family.widths().enumerate() {
            let middle = places.iter().map(|places| places[k]).sum::<f64>() / drivers;
            let squares = places.iter().zip(&told);
            let squares = squares.map(|(p, t)| (p[k] - middle).powi(2) + t.variance[k]);
            let wide = WIDE_DRIVERS * (WIDE * width).powi(2);
            let variance = (wide + squares.sum::<f64>()) / (WIDE_DRIVERS + drivers);
            (self.mean[k], self.deviation[k]) = (middle, variance.sqrt());
        }
        let weighted = searches.iter().zip(&told);
        let samples = |search: &Search<'_>| search.objective.samples() as f64;
        let sum: f64 = weighted.map(|(s, t)| samples(s) * t.mean_square).sum();
        self.noise = sum / searches.iter().map(samples).sum::<f64>();
        for (end, told) in ends.iter_mut().zip(told) {
            *end = told.free;
        }
    }

    fn told(&self, search: &Search<'_>, start: &[f64]) -> Told {
        let prior = self.prior(search.objective);
        let search = Search {
            prior: Some(&prior),
            ..*search
        };
        let ends = [start.to_vec(), self.free_mean()].map(|start| search.descend(&start));
        let [a, b] = ends;
        let End { free, .. } = if a.sum <= b.sum { a } else { b };
        let model = (self.family.model)(&self.family.values(&free));
        Told {
            mean_square: search.objective.mean_square(&model),
            variance: self.variance(&search, &free),
            free,
        }
    }

    /// Diagonal of the inverse of curvature and prior; that of the prior where it has none.
    fn variance(&self, search: &Search<'_>, free: &[f64]) -> Vec<f64> {
        let precision = search.objective.duration_s() / INDEPENDENT_S / self.noise;
        let prior = || self.deviation.iter().map(|deviation| deviation.powi(2));
        let curvature = self.curvature(search.objective, &self.family.places(free));
        let inverse = curvature.and_then(|curvature| {
            let prior = DMatrix::from_iterator(prior().count(), 1, prior().map(f64::recip));
            (precision * curvature + DMatrix::from_diagonal(&prior.column(0).into_owned()))
                .try_inverse()
        });
        match inverse {
            Some(inverse) => inverse
                .diagonal()
                .iter()
                .zip(prior())
                .map(|(v, p)| v.clamp(0.0, p))
                .collect(),
            None => prior().collect(),
        }
    }

    /// Products of the derivatives of the relative errors by the places, mean over samples.
    fn curvature(
        &self,
        objective: &FollowingObjective<'_>,
        places: &[f64],
    ) -> Option<DMatrix<f64>> {
        let residuals = |places: &[f64]| {
            let named = self.family.parameters.iter().zip(places);
            let values: Vec<f64> = named.map(|(p, place)| p.value(*place)).collect();
            objective.residuals(&(self.family.model)(&values))
        };
        let here = residuals(places)?;
        let mut columns = DMatrix::zeros(here.len(), places.len());
        for (k, parameter) in self.family.parameters.iter().enumerate() {
            let bounds = parameter.bounds();
            let step = DIFFERENCE * bounds.width();
            let inward = if places[k] + step > bounds.upper {
                -step
            } else {
                step
            };
            let mut moved = places.to_vec();
            moved[k] += inward;
            let there = residuals(&moved)?;
            for ((place, here), there) in columns.column_mut(k).iter_mut().zip(&here).zip(&there) {
                *place = (there - here) / inward;
            }
        }
        Some(columns.tr_mul(&columns) / objective.samples() as f64)
    }

    fn settled(
        &self,
        searches: &[Search<'_>],
        ends: &[Vec<f64>],
    ) -> Result<FollowingPopulation, Error> {
        let fit = |(search, end): (&Search<'_>, &Vec<f64>)| {
            let prior = self.prior(search.objective);
            let search = Search {
                prior: Some(&prior),
                ..*search
            };
            search.from(&[end.clone(), self.free_mean()])
        };
        let drivers = searches.par_iter().zip(ends).map(fit);
        let names = self
            .family
            .parameters
            .iter()
            .map(|parameter| parameter.name);
        Ok(FollowingPopulation {
            spread: names.zip(self.deviation.iter().copied()).collect(),
            drivers: drivers.collect::<Result<_, _>>()?,
        })
    }
}

impl Family {
    fn widths(&self) -> impl Iterator<Item = f64> {
        self.parameters
            .iter()
            .map(|parameter| parameter.bounds().width())
    }
}

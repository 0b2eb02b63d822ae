//! Which parameters trips tell.
//!
//! A parameter is told if it has an effect, correlates with no other one that is told beyond 0.9, did not run into a bound, and has
//! an interval that is neither empty nor half as wide as what is allowed. The one that is told least keeps the value of the vehicle
//! that the fit starts from, the others are fitted again, and so on until all that are left are told.

use std::fmt;

use nalgebra::{DMatrix, SymmetricEigen};

use super::parameter::Bounded;
use super::trip::CalibrationTrip;
use crate::error::Error;
use crate::vehicle::Vehicle;

/// A value this near to a bound, as a share of the width of the bounds, ran into it.
const AT_BOUND: f64 = 0.025;

/// An interval of this share of the bounds tells nothing.
const UNTOLD: f64 = 0.5;

/// An interval of this share of the bounds is none: trips that differ leave more.
const NO_WIDTH: f64 = 1e-6;

/// Two parameters that correlate more than this cannot be told apart.
const ALIKE: f64 = 0.9;

/// A parameter with this share of the largest effect, over the width of its bounds, has none.
const NO_EFFECT: f64 = 1e-4;

/// Curvatures below this share of the largest are rounding.
const SINGULAR: f64 = 1e-12;

/// Speeds in motion that deviate by less than this share of their mean are one.
const ONE_SPEED: f64 = 0.05;

/// Trips that an interval needs.
const FEWEST_TRIPS: usize = 3;

/// Slower is standing, m/s.
const STANDING_MPS: f64 = 0.5;

/// Why trips do not tell a parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Untold {
    /// All trips are driven at one speed, m/s.
    OneSpeed(f64),
    NoEffect,
    /// Correlates with another one.
    Alike {
        key: &'static str,
        correlation: f64,
    },
    AtBound(&'static str),
    /// So many different trips are too few for an interval.
    FewTrips(usize),
    NoWidth,
    /// The interval is wide.
    Wide,
}

impl fmt::Display for Untold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneSpeed(speed_mps) => write!(
                f,
                "all trips are driven at one speed, {:.0} km/h, which tells no parameter from another",
                3.6 * speed_mps
            ),
            Self::NoEffect => f.write_str("without effect on these trips"),
            Self::Alike { key, correlation } => {
                write!(
                    f,
                    "cannot be told apart from {key} (correlation {correlation:.2})"
                )
            }
            Self::AtBound(bound) => write!(f, "ran into its {bound} bound"),
            Self::FewTrips(different) => {
                write!(
                    f,
                    "an interval needs {FEWEST_TRIPS} different trips, different ones are {different}"
                )
            }
            Self::NoWidth => f.write_str("an interval of width 0: the trips are all alike"),
            Self::Wide => f.write_str("the interval covers half of what is allowed"),
        }
    }
}

/// A parameter that keeps its value.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) key: &'static str,
    /// What the fit made of it.
    pub(super) tried: f64,
    pub(super) why: Untold,
}

/// What a fit says of its parameters, by the derivatives of its residuals in units of the width of the bounds.
pub(super) struct Curvature {
    effects: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl Curvature {
    /// `(JᵀJ)⁻¹`, without the scale of the residuals. Parameters next to without effect correlate with nothing.
    pub(super) fn of(derivatives: &DMatrix<f64>) -> Self {
        let effects: Vec<f64> = derivatives.column_iter().map(|c| c.norm()).collect();
        let mut scaled = derivatives.clone();
        for (k, mut column) in scaled.column_iter_mut().enumerate() {
            if has_effect(&effects, k) {
                column /= effects[k];
            } else {
                column.fill(0.0);
            }
        }
        let curvature = SymmetricEigen::new(scaled.tr_mul(&scaled));
        // Directions that the residuals do not see are open, not closed.
        let least = SINGULAR * curvature.eigenvalues.max().max(f64::MIN_POSITIVE);
        let inverse = curvature.eigenvalues.map(|value| 1.0 / value.max(least));
        let vectors = &curvature.eigenvectors;
        let scaled = vectors * DMatrix::from_diagonal(&inverse) * vectors.transpose();
        let entry = |i: usize, j: usize| match (has_effect(&effects, i), has_effect(&effects, j)) {
            (true, true) => scaled[(i, j)] / (effects[i] * effects[j]),
            _ if i == j => f64::INFINITY,
            _ => 0.0,
        };
        Self {
            covariance: DMatrix::from_fn(effects.len(), effects.len(), entry),
            effects,
        }
    }

    /// Correlation of two estimates.
    fn correlation(&self, i: usize, j: usize) -> f64 {
        let scale = (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt();
        if i == j {
            1.0
        } else if scale > 0.0 && scale.is_finite() {
            (self.covariance[(i, j)] / scale).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }

    /// A row per parameter.
    pub(super) fn correlations(&self) -> Vec<Vec<f64>> {
        let n = self.effects.len();
        let row = |i| (0..n).map(|j| self.correlation(i, j)).collect();
        (0..n).map(row).collect()
    }

    /// The parameter that is told least, `None` where all are: first those without effect, then the vaguer of the two that correlate
    /// most, then the vaguest at a bound.
    pub(super) fn least_told(
        &self,
        bounded: &[Bounded],
        values: &[f64],
    ) -> Option<(usize, Untold)> {
        let n = self.effects.len();
        let without_effect = (0..n).find(|&k| !has_effect(&self.effects, k));
        without_effect
            .map(|k| (k, Untold::NoEffect))
            .or_else(|| self.most_alike(bounded))
            .or_else(|| {
                let at_bound = (0..n).filter_map(|k| Some((k, bound(&bounded[k], values[k])?)));
                let vaguest =
                    at_bound.max_by(|a, b| self.variance(a.0).total_cmp(&self.variance(b.0)));
                vaguest.map(|(k, bound)| (k, Untold::AtBound(bound)))
            })
    }

    fn most_alike(&self, bounded: &[Bounded]) -> Option<(usize, Untold)> {
        let n = self.effects.len();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j, self.correlation(i, j))));
        let alike = pairs.filter(|(_, _, correlation)| correlation.abs() > ALIKE);
        let (i, j, correlation) = alike.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
        let (vague, other) = if self.variance(i) > self.variance(j) {
            (i, j)
        } else {
            (j, i)
        };
        let key = bounded[other].key();
        Some((vague, Untold::Alike { key, correlation }))
    }

    /// In units of the width of the bounds, squared.
    fn variance(&self, k: usize) -> f64 {
        self.covariance[(k, k)]
    }
}

fn has_effect(effects: &[f64], k: usize) -> bool {
    effects[k] > NO_EFFECT * effects.iter().copied().fold(0.0, f64::max)
}

/// The bound that a value ran into.
fn bound(parameter: &Bounded, value: f64) -> Option<&'static str> {
    let margin = AT_BOUND * parameter.width();
    if value - parameter.lower < margin {
        Some("lower")
    } else if parameter.upper - value < margin {
        Some("upper")
    } else {
        None
    }
}

/// What a 95 % interval of so many different trips does not tell about a parameter, and how wide it is as a share of what is allowed.
pub(super) fn untold_by(
    ci95: Option<[f64; 2]>,
    different: usize,
    [lower, upper]: [f64; 2],
) -> Option<(Untold, f64)> {
    let Some([low, high]) = ci95.filter(|_| different >= FEWEST_TRIPS) else {
        return Some((Untold::FewTrips(different), f64::INFINITY));
    };
    let share = (high - low) / (upper - lower);
    if share < NO_WIDTH {
        Some((Untold::NoWidth, f64::INFINITY))
    } else if share > UNTOLD {
        Some((Untold::Wide, share))
    } else {
        None
    }
}

/// The speed of trips that are all driven at one.
pub(super) fn one_speed(
    vehicle: &Vehicle,
    trips: &[&CalibrationTrip],
) -> Result<Option<f64>, Error> {
    let (mut time_s, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for trip in trips {
        trip.for_each_mean(vehicle, |mean, _| {
            if mean.speed_mps > STANDING_MPS {
                time_s += mean.duration_s;
                sum += mean.speed_mps * mean.duration_s;
                squares += mean.speed_mps.powi(2) * mean.duration_s;
            }
        })?;
    }
    let mean_mps = sum / time_s;
    let deviation_mps = (squares / time_s - mean_mps * mean_mps).max(0.0).sqrt();
    Ok((deviation_mps < ONE_SPEED * mean_mps).then_some(mean_mps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn like_columns_correlate() {
        let derivatives = DMatrix::from_row_slice(
            4,
            3,
            &[1.0, 1.0, 0.0, 1.0, 1.01, 0.0, 0.0, 0.0, 1.0, 1.0, 0.99, 1.0],
        );
        let rho = Curvature::of(&derivatives).correlations();
        assert!(rho[0][1] < -0.99 && rho[0][2].abs() < 0.9);
        assert!((0..3).all(|i| (rho[i][i] - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_sum_of_two_others_correlates_with_both() {
        let derivatives =
            DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let rho = Curvature::of(&derivatives).correlations();
        assert!(rho[0][2].abs() > 0.99 && rho[1][2].abs() > 0.99, "{rho:?}");
    }

    #[test]
    fn intervals_tell_if_they_are_neither_empty_nor_wide() {
        let of = |ci95, different| untold_by(ci95, different, [0.0, 1.0]).map(|(why, _)| why);
        let told = |low: f64, high: f64| of(Some([low, high]), 3);
        assert_eq!(told(0.3, 0.6), None);
        assert_eq!(told(0.3, 0.3), Some(Untold::NoWidth));
        assert_eq!(told(0.2, 0.8), Some(Untold::Wide));
        assert_eq!(of(None, 2), Some(Untold::FewTrips(2)));
        assert_eq!(of(Some([0.3, 0.6]), 1), Some(Untold::FewTrips(1)));
    }
}

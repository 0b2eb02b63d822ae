//! How far the speed may be from a prediction, moment by moment.
//!
//! Trees learn from errors on drives that were held back how far the speed is above the prediction on average, and how far below, in
//! widths of the interval that is the same at every moment; what they say is stretched until the wanted share of errors lies inside (scaled
//! residuals in a split conformal prediction; J. Lei, M. G'Sell, A. Rinaldo, R. J. Tibshirani, L. Wasserman, Journal of the American
//! Statistical Association 113, 2018).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::boosted_trees::BoostedTrees;
use crate::Error;

/// Trees of a scale: what is left after them is noise.
const TREES: usize = 100;

/// Moments and horizons that a scale learns from, at most.
const MOST_PAIRS: usize = 30_000;

/// No moment is more certain than this share of an average one.
const LEAST_SHARE: f64 = 0.02;

/// How much of what trees say is believed: few drives teach little, and that is found out on those held back.
const TRUSTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Where the speed never was on this side of a prediction, in widths: none, but for a division.
const LEAST_REACH: f64 = 1e-6;

/// Narrower intervals are none.
const LEAST_WIDTH_MPS: f64 = 1e-3;

/// Predictions on drives that they were not learnt from.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldErrors {
    /// Predictors of each moment.
    pub(super) rows: Vec<f64>,
    /// Predicted change of the speed, per moment and horizon.
    pub(super) changes_mps: Vec<Vec<f64>>,
    /// Measured less predicted speed, per moment and horizon.
    pub(super) errors_mps: Vec<Vec<f64>>,
}

/// Bounds around predictions, one entry per horizon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Intervals {
    /// Half width of the interval that is the same at every moment.
    pub(super) one_width_mps: Vec<f64>,
    below: Side,
    above: Side,
}

/// How far the speed may be on one side, in widths: `factor · max((1 − trust) · mean + trust · scale, least)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Side {
    scale: BoostedTrees,
    mean: f64,
    trust: f64,
    least: f64,
    factors: Vec<f64>,
}

impl Intervals {
    /// Learns from errors on several parts of the drives: each part is judged by what the others say. `None` where there are too few errors, or
    /// less than two parts.
    pub(super) fn fit(
        parts: &[HeldErrors],
        predictors: usize,
        coverage: f64,
    ) -> Result<Option<Self>, Error> {
        let parts: Vec<&HeldErrors> = parts
            .iter()
            .filter(|part| !part.errors_mps.is_empty())
            .collect();
        let [first, _, ..] = &parts[..] else {
            return Ok(None);
        };
        let horizons = first.errors_mps[0].len();
        let width = |k: usize| {
            let moments = parts.iter().flat_map(|part| &part.errors_mps);
            conformal_quantile(moments.map(|errors| errors[k].abs()).collect(), coverage)
        };
        let widths: Option<Vec<f64>> = (0..horizons).map(width).collect();
        let Some(widths) = widths else {
            return Ok(None);
        };
        let task = Task {
            parts,
            predictors,
            one_width_mps: widths.iter().map(|w| w.max(LEAST_WIDTH_MPS)).collect(),
            coverage: 0.5 * (1.0 + coverage),
        };
        let sides: Result<Vec<Option<Side>>, Error> = [-1.0, 1.0]
            .into_par_iter()
            .map(|sign| task.side(sign))
            .collect();
        let mut sides = sides?.into_iter().flatten();
        let both = sides.next().zip(sides.next());
        Ok(both.map(|(below, above)| Self {
            one_width_mps: task.one_width_mps,
            below,
            above,
        }))
    }

    /// Lower and upper bound of the error at a horizon, for rows of `predictors` values and the changes predicted.
    pub(super) fn bounds_mps(
        &self,
        k: usize,
        rows: &[f64],
        changes_mps: &[f64],
    ) -> Vec<(f64, f64)> {
        let d = rows.len() / changes_mps.len().max(1);
        let width_mps = self.one_width_mps[k];
        let mut row = vec![0.0; d + 2];
        let moments = rows.chunks_exact(d).zip(changes_mps);
        moments
            .map(|(predictors, change_mps)| {
                fill(&mut row, predictors, change_mps / width_mps, k);
                let reach = |side: &Side| width_mps * side.factors[k] * side.reach(&row);
                (-reach(&self.below), reach(&self.above))
            })
            .collect()
    }

    pub(super) fn is_sound(&self, horizons: usize, predictors: usize) -> bool {
        let positive = |x: &f64| x.is_finite() && *x >= 0.0;
        let sound = |values: &[f64]| values.len() == horizons && values.iter().all(positive);
        let side = |side: &Side| {
            side.scale.predictors() == predictors + 2
                && [side.mean, side.trust, side.least].iter().all(positive)
                && side.trust <= 1.0
                && sound(&side.factors)
        };
        sound(&self.one_width_mps)
            && self.one_width_mps.iter().all(|width| *width > 0.0)
            && side(&self.below)
            && side(&self.above)
    }
}

/// Predictors of a moment, then the predicted change in widths, then which horizon.
fn fill(row: &mut [f64], predictors: &[f64], change: f64, k: usize) {
    let d = predictors.len();
    row[..d].copy_from_slice(predictors);
    (row[d], row[d + 1]) = (change, k as f64);
}

impl Side {
    fn reach(&self, row: &[f64]) -> f64 {
        self.trusted(self.trust, self.scale.answer(row))
    }

    fn trusted(&self, trust: f64, scale: f64) -> f64 {
        ((1.0 - trust) * self.mean + trust * scale).max(self.least)
    }
}

/// An error in widths, and how far one may be for each of [`TRUSTS`].
#[derive(Debug, Clone, Copy)]
struct Judged {
    error: f64,
    reach: [f64; TRUSTS.len()],
}

/// What one of [`TRUSTS`] comes to: the sum of the parts of interval scores on this side.
struct Outcome {
    trust: f64,
    factors: Vec<f64>,
    score: f64,
}

/// What both sides learn from.
struct Task<'a> {
    parts: Vec<&'a HeldErrors>,
    predictors: usize,
    one_width_mps: Vec<f64>,
    coverage: f64,
}

impl Task<'_> {
    fn side(&self, sign: f64) -> Result<Option<Side>, Error> {
        let side = self.scale(None, sign)?;
        let judged = self.judged(&side, sign)?;
        let outcomes = (0..TRUSTS.len()).filter_map(|place| self.outcome(place, &judged));
        let best = outcomes.min_by(|a, b| a.score.total_cmp(&b.score));
        Ok(best.map(|Outcome { trust, factors, .. }| Side {
            trust,
            factors,
            ..side
        }))
    }

    /// Per horizon every error in widths, beside what the trees of the other parts say for each trust.
    fn judged(&self, whole: &Side, sign: f64) -> Result<Vec<Vec<Judged>>, Error> {
        let mut judged = vec![Vec::new(); self.one_width_mps.len()];
        for (number, part) in self.parts.iter().enumerate() {
            let judge = Side {
                mean: whole.mean,
                least: whole.least,
                ..self.scale(Some(number), sign)?
            };
            let mut row = vec![0.0; self.predictors + 2];
            for (moment, predictors) in part.rows.chunks_exact(self.predictors).enumerate() {
                for (k, (judged, width)) in judged.iter_mut().zip(&self.one_width_mps).enumerate() {
                    let (change, error) = (part.changes_mps[moment][k], part.errors_mps[moment][k]);
                    fill(&mut row, predictors, change / width, k);
                    let scale = judge.scale.answer(&row);
                    judged.push(Judged {
                        error: sign * error / width,
                        reach: TRUSTS.map(|trust| judge.trusted(trust, scale)),
                    });
                }
            }
        }
        Ok(judged)
    }

    /// What trust number `place` comes to; `None` where there are too few errors.
    fn outcome(&self, place: usize, judged: &[Vec<Judged>]) -> Option<Outcome> {
        let mut outcome = Outcome {
            trust: TRUSTS[place],
            factors: Vec::new(),
            score: 0.0,
        };
        for judged in judged {
            let ratio = |judged: &Judged| judged.error / judged.reach[place];
            let factor = conformal_quantile(judged.iter().map(ratio).collect(), self.coverage)?;
            let factor = factor.max(0.0);
            let score = |judged: &Judged| {
                let reach = factor * judged.reach[place];
                reach + (judged.error - reach).max(0.0) / (1.0 - self.coverage)
            };
            outcome.score += judged.iter().map(score).sum::<f64>();
            outcome.factors.push(factor);
        }
        Some(outcome)
    }

    /// What all parts say but one. Of a moment every horizon in turn is taken, as long as there are not too many.
    fn scale(&self, without: Option<usize>, sign: f64) -> Result<Side, Error> {
        let horizons = self.one_width_mps.len();
        let parts = self.parts.iter().enumerate();
        let parts = parts.filter(|(number, _)| Some(*number) != without);
        let total: usize = parts
            .clone()
            .map(|(_, part)| part.errors_mps.len() * horizons)
            .sum();
        let every = total.div_ceil(MOST_PAIRS).max(1);
        let (mut rows, mut reach) = (Vec::new(), Vec::new());
        let mut row = vec![0.0; self.predictors + 2];
        let mut pair = 0;
        for (_, part) in parts {
            for (moment, predictors) in part.rows.chunks_exact(self.predictors).enumerate() {
                for (k, width) in self.one_width_mps.iter().enumerate() {
                    pair += 1;
                    // Skewed, so that all horizons come in turn whatever their number.
                    if (pair + moment) % every != 0 {
                        continue;
                    }
                    fill(&mut row, predictors, part.changes_mps[moment][k] / width, k);
                    rows.extend_from_slice(&row);
                    reach.push((sign * part.errors_mps[moment][k] / width).max(0.0));
                }
            }
        }
        let mean = reach.iter().sum::<f64>() / reach.len().max(1) as f64;
        Ok(Side {
            scale: BoostedTrees::fit(&rows, self.predictors + 2, &reach, TREES)?,
            mean,
            trust: 1.0,
            least: (LEAST_SHARE * mean).max(LEAST_REACH),
            factors: Vec::new(),
        })
    }
}

/// The value that a new one of the same kind is below with this probability; `None` where there are too few.
fn conformal_quantile(mut values: Vec<f64>, coverage: f64) -> Option<f64> {
    let rank = (coverage * (values.len() + 1) as f64).ceil() as usize;
    if rank > values.len() {
        return None;
    }
    let (_, quantile, _) = values.select_nth_unstable_by(rank - 1, f64::total_cmp);
    Some(*quantile)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// One predictor and one horizon.
    fn part(errors_mps: &[f64]) -> HeldErrors {
        HeldErrors {
            rows: (0..errors_mps.len()).map(|i| i as f64).collect(),
            changes_mps: vec![vec![0.0]; errors_mps.len()],
            errors_mps: errors_mps.iter().map(|error| vec![*error]).collect(),
        }
    }

    fn fitted(parts: &[HeldErrors]) -> Option<Intervals> {
        Intervals::fit(parts, 1, 0.8).unwrap()
    }

    #[test]
    fn one_part_or_few_errors_make_no_interval() {
        let many = part(&[0.5; 60]);
        assert_eq!(fitted(&[]), None);
        assert_eq!(fitted(&[many.clone(), HeldErrors::default()]), None);
        assert_eq!(fitted(&[part(&[1.0]), part(&[1.0])]), None);
        assert!(fitted(&[many, part(&[1.0])]).is_some());
    }

    #[test]
    fn errors_of_one_sign_or_none_have_finite_bounds() {
        for parts in [
            [part(&[0.0; 60]), part(&[0.0; 60])],
            [part(&[0.0; 60]), part(&[2.0; 60])],
            [part(&[-3.0; 60]), part(&[-3.0; 60])],
        ] {
            let intervals = fitted(&parts).unwrap();
            assert!(intervals.is_sound(1, 1), "{intervals:?}");
            let bounds = intervals.bounds_mps(0, &[5.0, 50.0], &[0.0, 0.0]);
            assert!(
                bounds
                    .iter()
                    .all(|(low, high)| low.is_finite() && high.is_finite() && low <= high)
            );
        }
    }
}

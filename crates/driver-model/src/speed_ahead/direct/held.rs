//! Predictions on drives that they were not learnt from: how much each part of a model counts, and how far it is off.

use super::knowledge::Knowledge;
use super::origins;
use crate::speed_ahead::interval::HeldErrors;
use crate::speed_ahead::predictors::rows;
use crate::{Error, Motion};

/// Shares of the parts of a blend are whole multiples of one over this.
const STEPS: usize = 20;

/// Predictions of some drives by what others taught.
#[derive(Debug, Default)]
pub(super) struct Held {
    rows: Vec<f64>,
    here_mps: Vec<f64>,
    horizons: Vec<HeldHorizon>,
}

/// At one horizon, per moment.
#[derive(Debug, Clone, Default)]
struct HeldHorizon {
    /// By part of the model.
    changes_mps: Vec<Vec<f64>>,
    measured_mps: Vec<f64>,
}

impl Held {
    /// Predicts every second of the drives.
    pub(super) fn of(
        knowledge: &Knowledge,
        motions: &[&Motion],
        step_s: f64,
    ) -> Result<Self, Error> {
        let horizons_s: Vec<f64> = knowledge.horizons.iter().map(|h| h.horizon_s).collect();
        let longest_s = horizons_s.iter().copied().fold(0.0, f64::max);
        let mut held = Self {
            horizons: vec![HeldHorizon::default(); horizons_s.len()],
            ..Self::default()
        };
        for motion in motions {
            let origins = origins(motion, longest_s, step_s.max(1.0));
            let speed_mps = motion.speed_mps();
            let rows = rows(motion, &knowledge.predictors, &origins);
            for (held, horizon) in held.horizons.iter_mut().zip(&knowledge.horizons) {
                let ahead = motion.samples_in(horizon.horizon_s);
                let change = |&i: &usize| speed_mps[i + ahead] - speed_mps[i];
                held.measured_mps.extend(origins.iter().map(change));
                let parts = horizon.parts(&rows, knowledge.predictors.len())?;
                held.changes_mps.resize(parts.len(), Vec::new());
                for (all, part) in held.changes_mps.iter_mut().zip(parts) {
                    all.extend(part);
                }
            }
            held.rows.extend(rows);
            held.here_mps.extend(origins.iter().map(|&i| speed_mps[i]));
        }
        Ok(held)
    }

    /// Errors of what the parts say in these shares, by horizon.
    pub(super) fn errors(self, shares: &[Vec<f64>]) -> HeldErrors {
        let mut errors = HeldErrors {
            rows: self.rows,
            changes_mps: vec![Vec::new(); self.here_mps.len()],
            errors_mps: vec![Vec::new(); self.here_mps.len()],
        };
        for (horizon, shares) in self.horizons.iter().zip(shares) {
            for (i, here_mps) in self.here_mps.iter().enumerate() {
                let parts = horizon.changes_mps.iter().zip(shares);
                let change_mps: f64 = parts.map(|(part, share)| share * part[i]).sum();
                let change_mps = change_mps.max(-here_mps);
                errors.changes_mps[i].push(change_mps);
                errors.errors_mps[i].push(horizon.measured_mps[i] - change_mps);
            }
        }
        errors
    }
}

/// The shares of `parts` parts with the least sum of squared errors at horizon `k` (stacking; L. Breiman, Machine Learning 24, 1996), or `None`
/// where nothing was held back.
pub(super) fn shares(held: &[Held], k: usize, parts: usize) -> Option<Vec<f64>> {
    let mut products = vec![0.0; parts * parts];
    for horizon in held.iter().filter_map(|held| held.horizons.get(k)) {
        for (i, measured) in horizon.measured_mps.iter().enumerate() {
            let off = |part: usize| horizon.changes_mps[part][i] - measured;
            for a in 0..parts {
                for b in 0..parts {
                    products[a * parts + b] += off(a) * off(b);
                }
            }
        }
    }
    let squares = |shares: &Vec<f64>| -> f64 {
        let term = |(ab, product): (usize, &f64)| shares[ab / parts] * shares[ab % parts] * product;
        products.iter().enumerate().map(term).sum()
    };
    let is_judged = products.iter().any(|product| *product > 0.0);
    let best = mixtures(parts)
        .into_iter()
        .min_by(|a, b| squares(a).total_cmp(&squares(b)));
    best.filter(|_| is_judged)
}

/// All ways to share one between `parts` in steps.
fn mixtures(parts: usize) -> Vec<Vec<f64>> {
    fn extend(open: usize, left: usize, shares: &mut Vec<f64>, all: &mut Vec<Vec<f64>>) {
        if open == 1 {
            shares.push(left as f64 / STEPS as f64);
            all.push(shares.clone());
            shares.pop();
            return;
        }
        for taken in 0..=left {
            shares.push(taken as f64 / STEPS as f64);
            extend(open - 1, left - taken, shares, all);
            shares.pop();
        }
    }
    let mut all = Vec::new();
    if parts > 0 {
        extend(parts, STEPS, &mut Vec::new(), &mut all);
    }
    all
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn mixtures_share_one() {
        let all = mixtures(3);
        assert_eq!(all.len(), (STEPS + 1) * (STEPS + 2) / 2);
        assert!(
            all.iter()
                .all(|shares| (shares.iter().sum::<f64>() - 1.0).abs() < 1e-12)
        );
    }

    #[test]
    fn the_part_that_is_right_gets_all_and_opposite_errors_share() {
        let horizon = |changes_mps: Vec<Vec<f64>>| Held {
            horizons: vec![HeldHorizon {
                changes_mps,
                measured_mps: vec![1.0, -1.0, 2.0],
            }],
            ..Held::default()
        };
        let one_right = [horizon(vec![vec![0.0; 3], vec![1.0, -1.0, 2.0]])];
        assert_eq!(shares(&one_right, 0, 2).unwrap(), [0.0, 1.0]);
        let opposite = [horizon(vec![vec![2.0, 0.0, 3.0], vec![0.0, -2.0, 1.0]])];
        assert_eq!(shares(&opposite, 0, 2).unwrap(), [0.5, 0.5]);
        assert_eq!(shares(&[], 0, 2), None);
    }
}

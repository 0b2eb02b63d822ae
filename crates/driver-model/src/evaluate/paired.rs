use std::collections::BTreeMap;

use serde::Serialize;

use super::EvaluatedPhase;
use crate::ModelKind;

/// Two models on the same held-out phases: which is better, and is that more than chance.
///
/// The difference is that of the mean RMSE over phases. Phases of one unit are alike, so the interval is over units: with `n_u`
/// phases and the sum `s_u` of differences in unit `u`, `D = Σs_u/Σn_u` has the variance
/// `k/(k−1) Σ(s_u − n_u D)²/(Σn_u)²` (ratio estimator, Cochran 1977), and Student's t with `k − 1` degrees of freedom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairedComparison {
    /// First model.
    pub model: ModelKind,
    /// Second model.
    pub against: ModelKind,
    /// Units with phases.
    pub units: usize,
    /// Phases.
    pub phases: usize,
    /// Mean RMSE of the first less that of the second; negative where the first is better.
    pub difference_rmse_mps: f64,
    /// Lower end of the 95 % interval.
    pub low_mps: f64,
    /// Upper end of the 95 % interval.
    pub high_mps: f64,
    /// Units in which the first is better.
    pub better_units: usize,
    /// Units in which it is worse.
    pub worse_units: usize,
    /// What the interval says.
    pub verdict: Verdict,
}

impl PairedComparison {
    /// The same with this model as the first; `None` where it is neither.
    #[must_use]
    pub fn seen_from(&self, model: ModelKind) -> Option<Self> {
        if self.model == model {
            return Some(self.clone());
        }
        (self.against == model).then(|| Self {
            model: self.against,
            against: self.model,
            difference_rmse_mps: -self.difference_rmse_mps,
            low_mps: -self.high_mps,
            high_mps: -self.low_mps,
            better_units: self.worse_units,
            worse_units: self.better_units,
            verdict: self.verdict.opposite(),
            ..*self
        })
    }
}

/// Whether a difference is more than chance, at 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// The first model is better.
    #[serde(rename = "better")]
    Better,
    /// The first model is worse.
    #[serde(rename = "worse")]
    Worse,
    /// The interval holds 0.
    #[serde(rename = "no clear difference")]
    Unclear,
}

impl Verdict {
    fn opposite(self) -> Self {
        match self {
            Self::Better => Self::Worse,
            Self::Worse => Self::Better,
            Self::Unclear => Self::Unclear,
        }
    }

    /// As in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Better => "better",
            Self::Worse => "worse",
            Self::Unclear => "no clear difference",
        }
    }
}

/// Every pair, in the order of `models`; none below two units with phases.
pub(super) fn all_pairs(models: &[ModelKind], phases: &[EvaluatedPhase]) -> Vec<PairedComparison> {
    let pairs = (0..models.len()).flat_map(|a| (a + 1..models.len()).map(move |b| (a, b)));
    pairs
        .filter_map(|(a, b)| {
            let difference = |phase: &EvaluatedPhase| {
                phase.predictions[a].rmse_mps - phase.predictions[b].rmse_mps
            };
            compare(
                models[a],
                models[b],
                phases.iter().map(|p| (p.unit, difference(p))),
            )
        })
        .collect()
}

fn compare(
    model: ModelKind,
    against: ModelKind,
    differences: impl Iterator<Item = (usize, f64)>,
) -> Option<PairedComparison> {
    let mut units = BTreeMap::<usize, (f64, f64)>::new();
    for (unit, difference) in differences {
        let sums = units.entry(unit).or_default();
        *sums = (sums.0 + difference, sums.1 + 1.0);
    }
    let k = units.len();
    if k < 2 {
        return None;
    }
    let phases: f64 = units.values().map(|u| u.1).sum();
    let mean = units.values().map(|u| u.0).sum::<f64>() / phases;
    let squares: f64 = units.values().map(|(s, n)| (s - n * mean).powi(2)).sum();
    let deviation = (k as f64 / (k - 1) as f64 * squares).sqrt() / phases;
    let reach = t_quantile_975(k - 1) * deviation;
    let (low_mps, high_mps) = (mean - reach, mean + reach);
    Some(PairedComparison {
        model,
        against,
        units: k,
        phases: phases as usize,
        difference_rmse_mps: mean,
        low_mps,
        high_mps,
        better_units: units.values().filter(|u| u.0 < 0.0).count(),
        worse_units: units.values().filter(|u| u.0 > 0.0).count(),
        verdict: match () {
            () if high_mps < 0.0 => Verdict::Better,
            () if low_mps > 0.0 => Verdict::Worse,
            () => Verdict::Unclear,
        },
    })
}

/// The 97.5 % quantile of Student's t: exact for 1 and 2 degrees of freedom, else by the expansion in `1/ν` (Abramowitz and
/// Stegun 26.7.5), within 0.2 % from 3 on.
fn t_quantile_975(degrees: usize) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    match degrees {
        0 => f64::INFINITY,
        1 => 12.706_204_736_174_7,
        2 => 4.302_652_729_749_46,
        _ => {
            let nu = degrees as f64;
            let (z3, z5, z7, z9) = (z.powi(3), z.powi(5), z.powi(7), z.powi(9));
            z + (z3 + z) / (4.0 * nu)
                + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * nu.powi(2))
                + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * nu.powi(3))
                + (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z)
                    / (92_160.0 * nu.powi(4))
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, quantile) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (10, 2.228),
            (30, 2.042),
        ] {
            let found = t_quantile_975(degrees);
            assert!((found / quantile - 1.0).abs() < 2e-3, "{degrees}: {found}");
        }
    }

    #[test]
    fn seen_from_the_other_model_everything_turns_round() {
        let differences = [(0, -1.0), (1, -2.0), (2, 0.5), (3, 0.0)];
        let pair = compare(
            ModelKind::Profile,
            ModelKind::Straight,
            differences.into_iter(),
        )
        .unwrap();
        let other = pair.seen_from(ModelKind::Straight).unwrap();
        assert_eq!((other.better_units, other.worse_units), (1, 2));
        assert!((other.low_mps + pair.high_mps).abs() < 1e-12);
        assert_eq!(other.seen_from(ModelKind::Profile).as_ref(), Some(&pair));
        assert_eq!(pair.seen_from(ModelKind::Inverse), None);
    }

    #[test]
    fn the_interval_is_over_units_not_phases() {
        let pair = |differences: &[(usize, f64)]| {
            compare(
                ModelKind::Profile,
                ModelKind::Straight,
                differences.iter().copied(),
            )
        };
        let few_units: Vec<_> = (0..100)
            .map(|i| (i % 2, if i % 2 == 0 { -1.0 } else { -0.1 }))
            .collect();
        let found = pair(&few_units).unwrap();
        assert_eq!((found.units, found.phases, found.better_units), (2, 100, 2));
        assert!((found.difference_rmse_mps + 0.55).abs() < 1e-12);
        assert_eq!(found.verdict, Verdict::Unclear);
        let many_units: Vec<_> = (0..100).map(|i| (i, few_units[i].1)).collect();
        assert_eq!(pair(&many_units).unwrap().verdict, Verdict::Better);
        assert_eq!(pair(&few_units[..1]), None);
    }
}

use std::collections::BTreeMap;

use driver_model::ModelKind;
use serde::Serialize;

use super::fold::EvaluatedPhase;
use crate::ratio_interval::RatioInterval;

/// Two models on the same held-out phases: which is better, and is that more than chance.
///
/// The difference is that of the mean RMSE over phases. Phases of one unit are alike, so the interval is over units (ratio
/// estimator, Cochran 1977).
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
    /// On an interval of a difference of errors.
    pub(crate) fn of(interval: &RatioInterval) -> Self {
        match interval {
            RatioInterval { high, .. } if *high < 0.0 => Self::Better,
            RatioInterval { low, .. } if *low > 0.0 => Self::Worse,
            _ => Self::Unclear,
        }
    }

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
    let interval = RatioInterval::of(units.values().copied())?;
    Some(PairedComparison {
        model,
        against,
        units: units.len(),
        phases: units.values().map(|u| u.1).sum::<f64>() as usize,
        difference_rmse_mps: interval.ratio,
        low_mps: interval.low,
        high_mps: interval.high,
        better_units: units.values().filter(|u| u.0 < 0.0).count(),
        worse_units: units.values().filter(|u| u.0 > 0.0).count(),
        verdict: Verdict::of(&interval),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

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

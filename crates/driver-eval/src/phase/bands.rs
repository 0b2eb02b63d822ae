use std::collections::BTreeMap;

use driver_model::ModelKind;
use serde::Serialize;

use super::fold::EvaluatedPhase;

/// What a predictive band holds of held-out phases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BandCoverage {
    /// Share of samples that the band promises to hold.
    pub level_pct: f64,
    /// Share that it holds: mean over phases. First and last sample do not count, their speeds being known.
    pub inside_pct: f64,
    /// Mean over phases of the mean full width.
    pub mean_width_mps: f64,
    /// `inside_pct` by speed group.
    pub groups: BTreeMap<String, f64>,
}

/// Coverage by level, for the models that have bands.
pub(super) fn coverage(
    models: &[ModelKind],
    phases: &[EvaluatedPhase],
) -> Vec<(ModelKind, Vec<BandCoverage>)> {
    let of_model = |(m, &kind): (usize, &ModelKind)| {
        let levels = phases.first()?.predictions[m].bands.len();
        let coverage = (0..levels).filter_map(|level| at_level(m, level, phases));
        (levels > 0).then(|| (kind, coverage.collect()))
    };
    models.iter().enumerate().filter_map(of_model).collect()
}

fn at_level(model: usize, level: usize, phases: &[EvaluatedPhase]) -> Option<BandCoverage> {
    let mut groups = BTreeMap::<_, (f64, f64)>::new();
    let (mut inside_pct, mut width_mps, mut count) = (0.0, 0.0, 0.0);
    for phase in phases {
        let prediction = &phase.predictions[model];
        let half_width_mps = &prediction.bands[level].half_width_mps;
        let measured = phase.curve.speed_mps();
        let inner = 1..measured.len() - 1;
        if inner.is_empty() {
            continue;
        }
        let n = inner.len() as f64;
        let holds =
            |&k: &usize| (prediction.speed_mps[k] - measured[k]).abs() <= half_width_mps[k] + 1e-12;
        let share_pct = 100.0 * inner.clone().filter(holds).count() as f64 / n;
        let group = groups.entry(phase.curve.outline().group()).or_default();
        *group = (group.0 + share_pct, group.1 + 1.0);
        inside_pct += share_pct;
        width_mps += inner.map(|k| 2.0 * half_width_mps[k]).sum::<f64>() / n;
        count += 1.0;
    }
    (count > 0.0).then(|| BandCoverage {
        level_pct: phases[0].predictions[model].bands[level].level_pct,
        inside_pct: inside_pct / count,
        mean_width_mps: width_mps / count,
        groups: groups
            .into_iter()
            .map(|(group, (sum, n))| (group.name(), sum / n))
            .collect(),
    })
}

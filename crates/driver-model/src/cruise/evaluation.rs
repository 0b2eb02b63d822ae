use serde::Serialize;

use super::{CruiseModel, CruiseStretch};
use crate::Error;
use crate::statistics::mean;

/// Stretches that are held out together, such as those of one trip.
#[derive(Debug, Clone, PartialEq)]
pub struct CruiseGroup {
    /// Name of the group.
    pub name: String,
    /// Its stretches; may be none.
    pub stretches: Vec<CruiseStretch>,
}

/// Figures of one way to predict, means over held-out stretches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CruiseSummary {
    /// Stretches.
    pub stretches: usize,
    /// Mean root mean square error.
    pub rmse_mps: f64,
    /// Mean share of samples in the 90 % band, the first one left out; `None` for baselines.
    pub coverage_90_pct: Option<f64>,
}

/// One group held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CruiseFold {
    /// Name of the group that was held out.
    pub held_out: String,
    /// Its stretches.
    pub stretches: usize,
    /// The model as fitted on the others.
    pub model: CruiseModel,
    /// Mean root mean square error over its stretches.
    pub rmse_mps: f64,
}

/// The outcome of [`evaluate_cruise`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CruiseEvaluation {
    /// The cruise model.
    pub cruise: CruiseSummary,
    /// Baseline: the speed stays what it was.
    pub hold: CruiseSummary,
    /// Baseline: the limit is driven, on stretches that have one. `None` where none has.
    pub limit: Option<CruiseSummary>,
    /// The cruise model on the stretches that have a limit.
    pub cruise_with_limit: Option<CruiseSummary>,
    /// Fitted to all groups.
    pub parameters: CruiseModel,
    /// One per group with stretches.
    pub folds: Vec<CruiseFold>,
}

/// Holds each group out once, fits on the others and predicts the held-out stretches from their first sample and limit.
///
/// # Errors
/// [`Error::TooFewStretches`] with less than two groups that have stretches.
pub fn evaluate_cruise(groups: &[CruiseGroup]) -> Result<CruiseEvaluation, Error> {
    let groups: Vec<&CruiseGroup> = groups.iter().filter(|g| !g.stretches.is_empty()).collect();
    if groups.len() < 2 {
        return Err(Error::TooFewStretches {
            found: groups.len(),
            needed: 2,
            unit: "units with a stretch of cruising",
        });
    }
    let others = |held_out: usize| -> Vec<&CruiseStretch> {
        let kept = groups.iter().enumerate().filter(|(g, _)| *g != held_out);
        kept.flat_map(|(_, group)| &group.stretches).collect()
    };
    let mut scores = Vec::new();
    let mut folds = Vec::new();
    for (held_out, group) in groups.iter().enumerate() {
        let model = CruiseModel::fit(&others(held_out))?;
        let own: Vec<CruiseErrors> = group.stretches.iter().map(|s| model.errors(s)).collect();
        folds.push(CruiseFold {
            held_out: group.name.clone(),
            stretches: own.len(),
            rmse_mps: mean(own.iter().map(|s| s.cruise_mps)).unwrap_or(f64::NAN),
            model,
        });
        scores.extend(own);
    }
    let with_limit: Vec<CruiseErrors> = scores
        .iter()
        .copied()
        .filter(|s| s.limit_mps.is_some())
        .collect();
    let limited = |of: fn(&CruiseErrors) -> f64, coverage| {
        (!with_limit.is_empty()).then(|| summary(&with_limit, of, coverage))
    };
    Ok(CruiseEvaluation {
        cruise: summary(&scores, |s| s.cruise_mps, true),
        hold: summary(&scores, |s| s.hold_mps, false),
        limit: limited(|s| s.limit_mps.unwrap_or(f64::NAN), false),
        cruise_with_limit: limited(|s| s.cruise_mps, true),
        parameters: CruiseModel::fit(&others(usize::MAX))?,
        folds,
    })
}

/// Root mean square errors on one stretch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CruiseErrors {
    /// Of the cruise model.
    pub cruise_mps: f64,
    /// Of holding the first speed.
    pub hold_mps: f64,
    /// Of driving the limit; `None` without one.
    pub limit_mps: Option<f64>,
    /// Share of samples in the 90 % band, the first one left out.
    pub inside_pct: f64,
}

impl CruiseErrors {
    pub(super) fn of(model: &CruiseModel, stretch: &CruiseStretch) -> Self {
        let (measured, limit) = (stretch.speed_mps(), stretch.limit_mps());
        let start = measured[0];
        let rmse = |predicted: &dyn Fn(f64) -> f64| {
            let times = (0..measured.len()).map(|k| k as f64 * stretch.step_s());
            let squares = times.zip(measured).map(|(t, v)| (predicted(t) - v).powi(2));
            (squares.sum::<f64>() / measured.len() as f64).sqrt()
        };
        let holds = |&k: &usize| {
            let t = k as f64 * stretch.step_s();
            let error = model.speed_mps(start, limit, t) - measured[k];
            error.abs() <= model.half_width_90_mps(limit, t)
        };
        let inside = (1..measured.len()).filter(holds).count();
        Self {
            cruise_mps: rmse(&|t| model.speed_mps(start, limit, t)),
            hold_mps: rmse(&|_| start),
            limit_mps: limit.map(|limit| rmse(&|_| limit)),
            inside_pct: 100.0 * inside as f64 / (measured.len() - 1) as f64,
        }
    }
}

fn summary(scores: &[CruiseErrors], of: fn(&CruiseErrors) -> f64, coverage: bool) -> CruiseSummary {
    CruiseSummary {
        stretches: scores.len(),
        rmse_mps: mean(scores.iter().map(of)).unwrap_or(f64::NAN),
        coverage_90_pct: if coverage {
            mean(scores.iter().map(|s| s.inside_pct))
        } else {
            None
        },
    }
}

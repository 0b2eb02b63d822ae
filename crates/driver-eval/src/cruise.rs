//! Cruising held out: the cruise model beside holding the speed and driving the limit.

use driver_model::cruise::{CruiseErrors, CruiseModel, CruiseStretch};
use driver_model::statistics::mean;
use serde::Serialize;

use crate::{Error, HoldOut};

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

/// One unit held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CruiseFold {
    /// Name of the unit that was held out.
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
    /// Fitted to all stretches.
    pub parameters: CruiseModel,
    /// One per unit.
    pub folds: Vec<CruiseFold>,
}

/// Holds each unit out once, fits on the others and predicts the held-out stretches from their first sample and limit.
///
/// # Errors
/// [`Error::Model`] with less than two units.
pub fn evaluate_cruise(
    stretches: &[CruiseStretch],
    hold_out: &HoldOut,
) -> Result<CruiseEvaluation, Error> {
    let found = hold_out.units().len();
    if found < 2 {
        return Err(crate::error::too_few_stretches(
            found,
            "units with a stretch of cruising",
        ));
    }
    let outcomes = hold_out.run(&|| {}, |split| {
        let others: Vec<&CruiseStretch> = split.rest().map(|item| &stretches[item]).collect();
        let model = CruiseModel::fit(&others)?;
        let own = split.held_out().map(|item| model.errors(&stretches[item]));
        let own: Vec<CruiseErrors> = own.collect();
        Ok((model, own))
    })?;
    let mut scores = Vec::new();
    let mut folds = Vec::new();
    for ((model, own), unit) in outcomes.into_iter().zip(hold_out.units()) {
        folds.push(CruiseFold {
            held_out: unit.clone(),
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
        parameters: CruiseModel::fit(&stretches.iter().collect::<Vec<_>>())?,
        folds,
    })
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

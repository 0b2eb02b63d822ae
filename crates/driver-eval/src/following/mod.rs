//! Car following held out: the intelligent driver model beside the constant-time-gap law, with parameters for all drivers and
//! for each.

mod drivers;
mod rows;

use std::time::Instant;

use driver_model::ModelKind;
use driver_model::following::{FollowingErrors, FollowingFit, FollowingModel, FollowingStretch};
use driver_model::statistics::mean;
use serde::Serialize;

pub use drivers::{DriverComparison, HeldOutPart, PairedDrivers, ParametersOf};
pub use rows::{FollowingRow, FollowingRows};

use crate::{Error, HoldOut};

/// The same for either model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PerFollowingModel<T> {
    /// Of the intelligent driver model.
    pub idm: T,
    /// Of the constant-time-gap law.
    pub constant_time_gap: T,
}

/// One unit held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowingFold {
    /// Name of the unit that was held out.
    pub group: String,
    /// Its stretches.
    pub stretches: usize,
    /// The models as fitted on all other units.
    pub fits: PerFollowingModel<FollowingFit>,
    /// Seconds of fitting.
    pub fit_seconds: PerFollowingModel<f64>,
}

/// How the models do on one stretch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScoredStretch {
    /// Name of the unit.
    pub group: String,
    /// Name of the log.
    pub log: String,
    /// Time of the first sample in the drive.
    pub start_s: f64,
    /// From first to last sample.
    pub duration_s: f64,
    /// Fitted on the other units.
    pub held_out: PerFollowingModel<FollowingErrors>,
    /// Fitted on all units, this one included.
    pub in_sample: PerFollowingModel<FollowingErrors>,
}

/// Figures over stretches, every stretch with the same weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FollowingSummary {
    /// Mean root mean square error of the gap.
    pub gap_rmse_m: f64,
    /// Mean root mean square error of the speed.
    pub speed_rmse_mps: f64,
    /// Mean of the root mean square error of the gap over the root mean square of the measured gap.
    pub gap_rmse_relative: f64,
    /// Collisions, over all stretches.
    pub collisions: usize,
}

/// Errors of the intelligent driver model minus those of the constant-time-gap law on the same stretches; negative where
/// the former is better.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairedDifference {
    /// Mean difference of the root mean square errors of the gap.
    pub gap_rmse_m: f64,
    /// Standard error of that mean over stretches; `None` for one stretch. Stretches of one drive are alike, so that it is
    /// rather too small.
    pub gap_rmse_std_error_m: Option<f64>,
    /// Mean difference of the root mean square errors of the speed.
    pub speed_rmse_mps: f64,
    /// Stretches on which the gap of the intelligent driver model is the better one.
    pub idm_better: usize,
}

/// The outcome of [`evaluate_following`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowingEvaluation {
    /// One per unit, in the order of units.
    pub folds: Vec<FollowingFold>,
    /// Models fitted on all stretches.
    pub all: PerFollowingModel<FollowingFit>,
    /// Every stretch with the models fitted on the other units.
    pub held_out: PerFollowingModel<FollowingSummary>,
    /// Every stretch with the models fitted on all of them.
    pub in_sample: PerFollowingModel<FollowingSummary>,
    /// Held-out errors of the two models, stretch by stretch.
    pub held_out_difference: PairedDifference,
    /// By unit.
    pub stretches: Vec<ScoredStretch>,
    /// Parameters of every driver beside those for all, for drivers that are known from other stretches.
    pub drivers: Vec<DriverComparison>,
}

/// Holds each unit out once, fits both models on the others, and simulates the held-out stretches.
///
/// # Errors
/// [`Error::Model`] with less than two units, and what fits refuse.
pub fn evaluate_following(
    stretches: &[FollowingStretch],
    hold_out: &HoldOut,
) -> Result<FollowingEvaluation, Error> {
    let found = hold_out.units().len();
    if found < 2 {
        let unit = "units with a stretch behind a vehicle";
        return Err(crate::error::too_few_stretches(found, unit));
    }
    let all = Fitted::to(&stretches.iter().collect::<Vec<_>>())?;
    let folds = hold_out.run(&|| {}, |split| {
        let items: Vec<usize> = split.held_out().collect();
        let rest: Vec<_> = split.rest().map(|item| &stretches[item]).collect();
        let own: Vec<_> = items.iter().map(|&item| &stretches[item]).collect();
        let fitted = Fitted::to(&rest)?;
        let by_driver = PerFollowingModel {
            idm: drivers::scored(&fitted.fits.idm, &rest, &own)?,
            constant_time_gap: drivers::scored(&fitted.fits.constant_time_gap, &rest, &own)?,
        };
        Ok((fitted, items, by_driver))
    })?;
    let mut scored = Vec::with_capacity(stretches.len());
    let mut of_folds = Vec::with_capacity(folds.len());
    let mut by_unit = PerFollowingModel {
        idm: Vec::new(),
        constant_time_gap: Vec::new(),
    };
    for ((fitted, items, by_driver), unit) in folds.into_iter().zip(hold_out.units()) {
        by_unit.idm.extend(by_driver.idm);
        by_unit
            .constant_time_gap
            .extend(by_driver.constant_time_gap);
        let own = items.iter().map(|&item| &stretches[item]);
        scored.extend(own.map(|stretch| score(unit, stretch, &fitted, &all)));
        of_folds.push(FollowingFold {
            group: unit.clone(),
            stretches: items.len(),
            fits: fitted.fits,
            fit_seconds: fitted.fit_seconds,
        });
    }
    let held_out = |s: &ScoredStretch| s.held_out;
    Ok(FollowingEvaluation {
        held_out: summaries(&scored, held_out),
        in_sample: summaries(&scored, |s| s.in_sample),
        held_out_difference: difference(scored.iter().map(held_out)),
        folds: of_folds,
        all: all.fits,
        stretches: scored,
        drivers: drivers::compared(stretches, &by_unit)?,
    })
}

struct Fitted {
    fits: PerFollowingModel<FollowingFit>,
    fit_seconds: PerFollowingModel<f64>,
}

impl Fitted {
    fn to(stretches: &[&FollowingStretch]) -> Result<Self, Error> {
        let fit = |kind| {
            let clock = Instant::now();
            let fit = FollowingModel::fit(kind, stretches)?;
            Ok::<_, Error>((fit, clock.elapsed().as_secs_f64()))
        };
        let (idm, idm_seconds) = fit(ModelKind::Idm)?;
        let (constant_time_gap, law_seconds) = fit(ModelKind::ConstantTimeGap)?;
        Ok(Self {
            fits: PerFollowingModel {
                idm,
                constant_time_gap,
            },
            fit_seconds: PerFollowingModel {
                idm: idm_seconds,
                constant_time_gap: law_seconds,
            },
        })
    }

    fn errors(&self, stretch: &FollowingStretch) -> PerFollowingModel<FollowingErrors> {
        PerFollowingModel {
            idm: self.fits.idm.model.errors(stretch),
            constant_time_gap: self.fits.constant_time_gap.model.errors(stretch),
        }
    }
}

fn score(unit: &str, stretch: &FollowingStretch, fold: &Fitted, all: &Fitted) -> ScoredStretch {
    ScoredStretch {
        group: unit.to_owned(),
        log: stretch.log().to_owned(),
        start_s: stretch.start_s(),
        duration_s: stretch.duration_s(),
        held_out: fold.errors(stretch),
        in_sample: all.errors(stretch),
    }
}

fn summaries(
    stretches: &[ScoredStretch],
    of: fn(&ScoredStretch) -> PerFollowingModel<FollowingErrors>,
) -> PerFollowingModel<FollowingSummary> {
    let summary = |model: fn(PerFollowingModel<FollowingErrors>) -> FollowingErrors| {
        FollowingSummary::of(stretches.iter().map(|stretch| model(of(stretch))))
    };
    PerFollowingModel {
        idm: summary(|errors| errors.idm),
        constant_time_gap: summary(|errors| errors.constant_time_gap),
    }
}

impl FollowingSummary {
    fn of(errors: impl Iterator<Item = FollowingErrors> + Clone) -> Self {
        let of_all = |figure: fn(FollowingErrors) -> f64| {
            mean(errors.clone().map(figure)).unwrap_or(f64::NAN)
        };
        Self {
            gap_rmse_m: of_all(|e| e.gap_rmse_m),
            speed_rmse_mps: of_all(|e| e.speed_rmse_mps),
            gap_rmse_relative: of_all(|e| e.gap_rmse_relative),
            collisions: errors.map(|e| e.collisions).sum(),
        }
    }
}

fn difference(
    errors: impl Iterator<Item = PerFollowingModel<FollowingErrors>>,
) -> PairedDifference {
    let (gap_m, speed_mps): (Vec<f64>, Vec<f64>) = errors
        .map(|e| (e.idm, e.constant_time_gap))
        .map(|(idm, law)| {
            (
                idm.gap_rmse_m - law.gap_rmse_m,
                idm.speed_rmse_mps - law.speed_rmse_mps,
            )
        })
        .unzip();
    let n = gap_m.len() as f64;
    let mean_m = mean(gap_m.iter().copied()).unwrap_or(f64::NAN);
    let squares: f64 = gap_m.iter().map(|d| (d - mean_m).powi(2)).sum();
    PairedDifference {
        gap_rmse_m: mean_m,
        gap_rmse_std_error_m: (gap_m.len() > 1).then(|| (squares / (n * (n - 1.0))).sqrt()),
        speed_rmse_mps: mean(speed_mps).unwrap_or(f64::NAN),
        idm_better: gap_m.iter().filter(|d| **d < 0.0).count(),
    }
}

//! Parameters of every driver beside one set for all of them.

use driver_model::ModelKind;
use driver_model::following::{
    FollowingErrors, FollowingFit, FollowingModel, FollowingPopulation, FollowingStretch,
};
use rayon::prelude::*;
use serde::Serialize;

use super::{FollowingSummary, PerFollowingModel};
use crate::ratio_interval::RatioInterval;
use crate::{Error, HoldOut};

/// Pieces of stretches that are held out have about this length.
const PIECE_S: f64 = 60.0;

/// What is held out, and of whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOutPart {
    /// Every other minute of every stretch; the driver is known from the minutes between.
    Minutes,
    /// One unit, and of it the drivers that other units know.
    KnownDrivers,
    /// One unit, with whoever drives.
    AnyDriver,
}

/// Where parameters come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ParametersOf {
    /// One set fitted to all drivers together.
    All,
    /// The mean of the drivers' own, as for a driver of whom nothing is known.
    Typical,
    /// The driver alone.
    Own,
    /// The driver, with the other drivers as a prior.
    OwnWithPrior,
}

/// A model with parameters from one place, on the stretches of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriverComparison {
    /// What is held out.
    pub held_out: HeldOutPart,
    /// Which model.
    pub model: ModelKind,
    /// Where its parameters come from.
    pub parameters_of: ParametersOf,
    /// Drivers that are predicted.
    pub drivers: usize,
    /// Their stretches, or pieces of them.
    pub stretches: usize,
    /// Errors on them.
    pub errors: FollowingSummary,
    /// Against the parameters for all; `None` for those themselves, and for one driver.
    pub against_all: Option<PairedDrivers>,
}

/// Difference of the mean root mean square errors of the gap on the same stretches; negative where it is better.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairedDrivers {
    /// The difference.
    pub gap_rmse_m: f64,
    /// Lower end of the 95 % interval over drivers.
    pub low_m: f64,
    /// Upper end of the 95 % interval.
    pub high_m: f64,
    /// Drivers for whom it is better.
    pub better_drivers: usize,
}

/// Errors on one held-out stretch.
pub(super) struct Scored<'a> {
    driver: &'a str,
    all: FollowingErrors,
    typical: FollowingErrors,
    /// Own parameters without and with the prior.
    own: Option<[FollowingErrors; 2]>,
}

/// `by_unit` are held-out stretches by model.
pub(super) fn compared(
    stretches: &[FollowingStretch],
    by_unit: &PerFollowingModel<Vec<Scored<'_>>>,
) -> Result<Vec<DriverComparison>, Error> {
    let cut = stretches.iter().map(|stretch| stretch.pieces(PIECE_S));
    let cut = cut.enumerate().flat_map(|(k, pieces)| {
        let numbered = pieces.into_iter().enumerate();
        numbered.map(move |(i, piece)| (["even", "odd"][(k + i) % 2], piece))
    });
    let (minutes, pieces): (Vec<&str>, Vec<FollowingStretch>) = cut.unzip();
    let by_minute = |model| -> Result<Vec<Scored<'_>>, Error> {
        let folds = HoldOut::by_unit(&minutes).run(&|| {}, |split| {
            let held_out: Vec<_> = split.held_out().map(|item| &pieces[item]).collect();
            let rest: Vec<_> = split.rest().map(|item| &pieces[item]).collect();
            scored(&FollowingModel::fit(model, &rest)?, &rest, &held_out)
        })?;
        Ok(folds.into_iter().flatten().collect())
    };
    let by_minute = PerFollowingModel {
        idm: by_minute(ModelKind::Idm)?,
        constant_time_gap: by_minute(ModelKind::ConstantTimeGap)?,
    };
    let of = |part, scored: &PerFollowingModel<Vec<Scored<'_>>>| {
        let mut found = rows(part, ModelKind::Idm, &scored.idm);
        found.extend(rows(
            part,
            ModelKind::ConstantTimeGap,
            &scored.constant_time_gap,
        ));
        found
    };
    Ok([
        of(HeldOutPart::Minutes, &by_minute),
        of(HeldOutPart::KnownDrivers, by_unit),
        of(HeldOutPart::AnyDriver, by_unit),
    ]
    .concat())
}

/// Held-out stretches by parameters for all of the rest, and for its drivers; nothing where it knows less than two of them.
pub(super) fn scored<'a>(
    all: &FollowingFit,
    rest: &[&FollowingStretch],
    held_out: &[&'a FollowingStretch],
) -> Result<Vec<Scored<'a>>, Error> {
    let names = drivers_of(rest.iter().copied());
    if names.len() < 2 {
        return Ok(Vec::new());
    }
    let of_driver = |name: &&str| {
        let own = rest.iter().copied().filter(|s| s.driver() == *name);
        own.collect::<Vec<_>>()
    };
    let drivers: Vec<Vec<&FollowingStretch>> = names.iter().map(of_driver).collect();
    let population = FollowingPopulation::fit(all, &drivers)?;
    let own = drivers.par_iter().zip(&names).map(|(own, name)| {
        let is_asked = held_out.iter().any(|stretch| stretch.driver() == *name);
        let fit = is_asked.then(|| FollowingModel::fit(all.model.kind(), own));
        Ok(fit.transpose()?.map(|fit| fit.model))
    });
    let own = own.collect::<Result<Vec<_>, Error>>()?;
    let score = |stretch: &&'a FollowingStretch| {
        let known = names.binary_search(&stretch.driver()).ok();
        let models = known.and_then(|k| Some([own[k]?, population.drivers[k].model]));
        Scored {
            driver: stretch.driver(),
            all: all.model.errors(stretch),
            typical: population.typical.errors(stretch),
            own: models.map(|models| models.map(|model| model.errors(stretch))),
        }
    };
    Ok(held_out.iter().map(score).collect())
}

/// Names in order, each once.
fn drivers_of<'a>(stretches: impl Iterator<Item = &'a FollowingStretch>) -> Vec<&'a str> {
    let mut names: Vec<&str> = stretches.map(FollowingStretch::driver).collect();
    names.sort_unstable();
    names.dedup();
    names
}

impl Scored<'_> {
    fn errors(&self, of: ParametersOf) -> Option<FollowingErrors> {
        match of {
            ParametersOf::All => Some(self.all),
            ParametersOf::Typical => Some(self.typical),
            ParametersOf::Own => self.own.map(|own| own[0]),
            ParametersOf::OwnWithPrior => self.own.map(|own| own[1]),
        }
    }
}

/// A row for each place that has parameters for all of the stretches; none for less than two drivers.
fn rows(held_out: HeldOutPart, model: ModelKind, scored: &[Scored<'_>]) -> Vec<DriverComparison> {
    let counts = |s: &&Scored<'_>| held_out != HeldOutPart::KnownDrivers || s.own.is_some();
    let scored: Vec<&Scored<'_>> = scored.iter().filter(counts).collect();
    let mut names: Vec<&str> = scored.iter().map(|s| s.driver).collect();
    names.sort_unstable();
    names.dedup();
    if names.len() < 2 {
        return Vec::new();
    }
    let row = |parameters_of: ParametersOf| {
        let errors = scored.iter().map(|s| s.errors(parameters_of));
        let errors: Vec<FollowingErrors> = errors.collect::<Option<_>>()?;
        let against_all =
            (parameters_of != ParametersOf::All).then(|| paired(&names, &scored, &errors));
        Some(DriverComparison {
            held_out,
            model,
            parameters_of,
            drivers: names.len(),
            stretches: errors.len(),
            errors: FollowingSummary::of(errors.iter().copied()),
            against_all: against_all.flatten(),
        })
    };
    let known = [ParametersOf::Own, ParametersOf::OwnWithPrior];
    let known = known
        .into_iter()
        .filter(|_| held_out != HeldOutPart::AnyDriver);
    let any = [ParametersOf::All, ParametersOf::Typical].into_iter();
    any.chain(known).filter_map(row).collect()
}

fn paired(
    names: &[&str],
    scored: &[&Scored<'_>],
    errors: &[FollowingErrors],
) -> Option<PairedDrivers> {
    let of_driver = |name: &&str| {
        let own = scored.iter().zip(errors).filter(|(s, _)| s.driver == *name);
        let differences = own.map(|(s, errors)| errors.gap_rmse_m - s.all.gap_rmse_m);
        differences.fold((0.0, 0.0), |(sum, n), difference| {
            (sum + difference, n + 1.0)
        })
    };
    let sums: Vec<(f64, f64)> = names.iter().map(of_driver).collect();
    let interval = RatioInterval::of(sums.iter().copied())?;
    Some(PairedDrivers {
        gap_rmse_m: interval.ratio,
        low_m: interval.low,
        high_m: interval.high,
        better_drivers: sums.iter().filter(|(sum, _)| *sum < 0.0).count(),
    })
}

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
}

/// Where parameters come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ParametersOf {
    /// One set fitted to all drivers together.
    All,
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
    /// Parameters for all, own ones, and own ones with the prior.
    errors: [FollowingErrors; 3],
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
    ]
    .concat())
}

/// Held-out stretches of drivers that the rest knows; none where it knows less than two drivers.
pub(super) fn scored<'a>(
    all: &FollowingFit,
    rest: &[&FollowingStretch],
    held_out: &[&'a FollowingStretch],
) -> Result<Vec<Scored<'a>>, Error> {
    let names = drivers_of(rest.iter().copied());
    let known: Vec<(&&'a FollowingStretch, usize)> = held_out
        .iter()
        .filter_map(|stretch| Some((stretch, names.binary_search(&stretch.driver()).ok()?)))
        .collect();
    if known.is_empty() || names.len() < 2 {
        return Ok(Vec::new());
    }
    let of_driver = |name: &&str| {
        let own = rest.iter().copied().filter(|s| s.driver() == *name);
        own.collect::<Vec<_>>()
    };
    let drivers: Vec<Vec<&FollowingStretch>> = names.iter().map(of_driver).collect();
    let population = FollowingPopulation::fit(all, &drivers)?;
    let own = drivers.par_iter().map(|own| {
        let fit = FollowingModel::fit(all.model.kind(), own)?;
        Ok(fit.model)
    });
    let own = own.collect::<Result<Vec<_>, Error>>()?;
    let score = |(stretch, k): (&&'a FollowingStretch, usize)| Scored {
        driver: stretch.driver(),
        errors: [all.model, own[k], population.drivers[k].model].map(|model| model.errors(stretch)),
    };
    Ok(known.into_iter().map(score).collect())
}

/// Names in order, each once.
fn drivers_of<'a>(stretches: impl Iterator<Item = &'a FollowingStretch>) -> Vec<&'a str> {
    let mut names: Vec<&str> = stretches.map(FollowingStretch::driver).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// A row for each place that parameters come from; none for less than two drivers.
fn rows(held_out: HeldOutPart, model: ModelKind, scored: &[Scored<'_>]) -> Vec<DriverComparison> {
    let mut names: Vec<&str> = scored.iter().map(|s| s.driver).collect();
    names.sort_unstable();
    names.dedup();
    if names.len() < 2 {
        return Vec::new();
    }
    let places = [
        ParametersOf::All,
        ParametersOf::Own,
        ParametersOf::OwnWithPrior,
    ];
    let row = |(place, parameters_of)| DriverComparison {
        held_out,
        model,
        parameters_of,
        drivers: names.len(),
        stretches: scored.len(),
        errors: FollowingSummary::of(scored.iter().map(|s| s.errors[place])),
        against_all: (place > 0).then(|| paired(&names, scored, place)).flatten(),
    };
    places.into_iter().enumerate().map(row).collect()
}

fn paired(names: &[&str], scored: &[Scored<'_>], place: usize) -> Option<PairedDrivers> {
    let of_driver = |name: &&str| {
        let own = scored.iter().filter(|s| s.driver == *name);
        let differences = own.map(|s| s.errors[place].gap_rmse_m - s.errors[0].gap_rmse_m);
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

//! Parameters of every driver beside one set for all of them.

use driver_model::ModelKind;
use driver_model::following::{
    FollowingErrors, FollowingModel, FollowingPopulation, FollowingStretch,
};
use rayon::prelude::*;
use serde::Serialize;

use super::FollowingSummary;
use crate::ratio_interval::RatioInterval;
use crate::{Error, HoldOut};

/// What is predicted from what else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOutPart {
    /// One half of every stretch, from all other halves.
    Half,
    /// One unit, from the others.
    Unit,
}

/// Parameters for all, of the drivers alone, and of the drivers with what is typical of all as a prior.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriverComparison {
    /// What is held out.
    pub held_out: HeldOutPart,
    /// Which model.
    pub model: ModelKind,
    /// Drivers that what is left says something of; others do not count.
    pub drivers: usize,
    /// Their stretches, or halves of stretches.
    pub stretches: usize,
    /// Parameters fitted to all drivers together.
    pub pooled: DriverRow,
    /// The mean over drivers.
    pub typical: DriverRow,
    /// Fitted to the driver alone.
    pub own: DriverRow,
    /// Fitted to the driver with the other drivers as a prior.
    pub own_with_prior: DriverRow,
}

/// One way to get parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriverRow {
    /// Its errors.
    pub errors: FollowingSummary,
    /// Against the pooled parameters; `None` for those themselves, and for one driver.
    pub against_pooled: Option<PairedDrivers>,
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

/// Errors on one stretch, by the way to get parameters, in the order of [`DriverComparison`].
struct Scored {
    driver: String,
    errors: [FollowingErrors; 4],
}

pub(super) fn compared(
    stretches: &[FollowingStretch],
    units: &HoldOut,
) -> Result<Vec<DriverComparison>, Error> {
    let halves: Vec<FollowingStretch> = stretches
        .iter()
        .filter_map(FollowingStretch::halves)
        .flatten()
        .collect();
    let which = (0..halves.len()).map(|k| ["first", "second"][k % 2]);
    let by_half = HoldOut::by_unit(&which.collect::<Vec<_>>());
    let mut found = Vec::new();
    for (part, stretches, hold_out) in [
        (HeldOutPart::Half, halves.as_slice(), &by_half),
        (HeldOutPart::Unit, stretches, units),
    ] {
        for model in [ModelKind::Idm, ModelKind::ConstantTimeGap] {
            let folds = hold_out.run(&|| {}, |split| {
                let held_out: Vec<_> = split.held_out().map(|item| &stretches[item]).collect();
                let rest: Vec<_> = split.rest().map(|item| &stretches[item]).collect();
                scored(model, &rest, &held_out)
            })?;
            let scored: Vec<Scored> = folds.into_iter().flatten().collect();
            found.extend(comparison(part, model, &scored));
        }
    }
    Ok(found)
}

/// Held-out stretches of drivers that the rest knows.
fn scored(
    kind: ModelKind,
    rest: &[&FollowingStretch],
    held_out: &[&FollowingStretch],
) -> Result<Vec<Scored>, Error> {
    let mut names: Vec<&str> = rest.iter().map(|stretch| stretch.driver()).collect();
    names.sort_unstable();
    names.dedup();
    let known: Vec<_> = held_out
        .iter()
        .filter_map(|stretch| Some((stretch, names.binary_search(&stretch.driver()).ok()?)))
        .collect();
    if known.is_empty() || names.len() < 2 {
        return Ok(Vec::new());
    }
    let drivers: Vec<Vec<&FollowingStretch>> = names
        .iter()
        .map(|name| {
            rest.iter()
                .copied()
                .filter(|s| s.driver() == *name)
                .collect()
        })
        .collect();
    let pooled = FollowingModel::fit(kind, rest)?.model;
    let population = FollowingPopulation::fit(kind, &drivers)?;
    let own = drivers
        .par_iter()
        .map(|own| Ok(FollowingModel::fit(kind, own)?.model))
        .collect::<Result<Vec<_>, Error>>()?;
    let score = |(stretch, driver): (&&FollowingStretch, usize)| Scored {
        driver: stretch.driver().to_owned(),
        errors: [
            pooled,
            population.typical,
            own[driver],
            population.drivers[driver].model,
        ]
        .map(|model| model.errors(stretch)),
    };
    Ok(known.into_iter().map(score).collect())
}

fn comparison(
    held_out: HeldOutPart,
    model: ModelKind,
    scored: &[Scored],
) -> Option<DriverComparison> {
    let mut names: Vec<&str> = scored.iter().map(|s| s.driver.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let row = |way: usize| DriverRow {
        errors: FollowingSummary::of(scored.iter().map(|s| s.errors[way])),
        against_pooled: (way > 0).then(|| paired(&names, scored, way)).flatten(),
    };
    (names.len() > 1).then(|| DriverComparison {
        held_out,
        model,
        drivers: names.len(),
        stretches: scored.len(),
        pooled: row(0),
        typical: row(1),
        own: row(2),
        own_with_prior: row(3),
    })
}

fn paired(names: &[&str], scored: &[Scored], way: usize) -> Option<PairedDrivers> {
    let of_driver = |name: &&str| {
        let own = scored.iter().filter(|s| s.driver == *name);
        let differences = own.map(|s| s.errors[way].gap_rmse_m - s.errors[0].gap_rmse_m);
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

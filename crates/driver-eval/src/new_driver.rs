//! How soon the model of a driver who is new is good, with and without other drivers.

use std::collections::BTreeMap;

use driver_model::statistics::mean;
use driver_model::{
    DriveBehaviour, Error as ModelError, FitSettings, ModelKind, PhaseCurve, PhaseMemory,
    PhaseModel,
};
use rayon::prelude::*;
use serde::Serialize;

use crate::Error;
use crate::ratio_interval::RatioInterval;

/// Errors for later trips of a driver of whom so many trips were learnt, one after the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NewDriverPoint {
    /// Trips learnt.
    pub own_trips: usize,
    /// Orders of trips after which the own trips alone were enough to fit the model, and all orders.
    pub fitted_orders: (usize, usize),
    /// Mean root mean square error over the phases of the trips kept back, over the orders that were enough: from the own trips alone.
    pub own_rmse_mps: Option<f64>,
    /// The same of the model of other drivers that went on learning.
    pub updated_rmse_mps: Option<f64>,
    /// The same over all orders.
    pub updated_rmse_all_mps: f64,
    /// The second less the first, with its 95 % interval over the trips kept back.
    pub difference_mps: Option<(f64, f64, f64)>,
}

/// Errors of the phases of the trips kept back after one order: of the own trips alone, where they are enough, and updated.
type OfOrder = Vec<(usize, Option<f64>, f64)>;

/// Learns own trips in each of the orders, which are permutations of their numbers. The last third of an order is kept back for judgement.
///
/// # Errors
/// [`Error::Model`] for settings that a memory cannot hold, and what fitting refuses but for too few phases; points without an order of enough are left
/// out.
pub fn new_driver_curve(
    own: &[DriveBehaviour],
    others: &[DriveBehaviour],
    model: ModelKind,
    fit: &FitSettings,
    prior_weight: f64,
    counts: &[usize],
    orders: &[Vec<usize>],
) -> Result<Vec<NewDriverPoint>, Error> {
    let kind = fit.manoeuvre.into();
    let nothing = PhaseMemory::new(fit).ok_or(ModelError::NoMemory { model })?;
    let of_others = nothing.clone().with_prior(others, prior_weight);
    let after = |own_trips: usize, order: &[usize]| -> Result<Option<OfOrder>, Error> {
        let kept_back = &order[order.len() - order.len() / 3..];
        let learnt = || {
            order
                .iter()
                .take(own_trips)
                .filter_map(|&trip| own.get(trip))
        };
        let alone = fitted(model, &nothing.clone().with_own(learnt()))?;
        let Some(updated) = fitted(model, &of_others.clone().with_own(learnt()))? else {
            return Ok(None);
        };
        let trips = kept_back
            .iter()
            .filter_map(|&trip| Some((trip, own.get(trip)?)));
        let phases = trips.flat_map(|(trip, of)| of.phases_of(kind).map(move |p| (trip, p)));
        let errors = phases.map(|(trip, phase)| {
            let alone = alone.as_ref().map(|model| rmse_mps(model, phase));
            (trip, alone, rmse_mps(&updated, phase))
        });
        Ok(Some(errors.collect()))
    };
    let most = orders.iter().map(|order| order.len() - order.len() / 3);
    let most = most.min().unwrap_or(0);
    let counts = counts.par_iter().filter(|count| **count <= most);
    let points = counts.map(|&own_trips| {
        let each = orders.iter().map(|order| after(own_trips, order));
        let each = each.collect::<Result<Option<Vec<OfOrder>>, Error>>()?;
        Ok(each.map(|each| NewDriverPoint::of(own_trips, &each)))
    });
    let points: Vec<Option<NewDriverPoint>> = points.collect::<Result<_, Error>>()?;
    Ok(points.into_iter().flatten().collect())
}

/// `None` where there is too little to learn from.
fn fitted(model: ModelKind, memory: &PhaseMemory) -> Result<Option<PhaseModel>, Error> {
    match PhaseModel::fit(model, &memory.training()) {
        Err(ModelError::TooFewPhases { .. } | ModelError::Fit { .. }) => Ok(None),
        fitted => Ok(Some(fitted?)),
    }
}

impl NewDriverPoint {
    fn of(own_trips: usize, orders: &[OfOrder]) -> Self {
        let is_fitted = |order: &&OfOrder| order.iter().all(|(_, alone, _)| alone.is_some());
        let fitted: Vec<&OfOrder> = orders.iter().filter(is_fitted).collect();
        let pairs = || {
            let phases = fitted.iter().copied().flatten();
            phases.filter_map(|&(trip, alone, updated)| Some((trip, alone?, updated)))
        };
        let mut trips = BTreeMap::<usize, (f64, f64)>::new();
        for (trip, alone, updated) in pairs() {
            let sums = trips.entry(trip).or_default();
            *sums = (sums.0 + updated - alone, sums.1 + 1.0);
        }
        let interval = RatioInterval::of(trips.values().copied());
        let all = orders.iter().flatten().map(|(_, _, updated)| *updated);
        Self {
            own_trips,
            fitted_orders: (fitted.len(), orders.len()),
            own_rmse_mps: mean(pairs().map(|(_, alone, _)| alone)),
            updated_rmse_mps: mean(pairs().map(|(_, _, updated)| updated)),
            updated_rmse_all_mps: mean(all).unwrap_or(f64::NAN),
            difference_mps: interval.map(|i| (i.ratio, i.low, i.high)),
        }
    }
}

fn rmse_mps(model: &PhaseModel, phase: &PhaseCurve) -> f64 {
    let predicted = model.predict(&phase.outline());
    let squares = predicted.iter().zip(phase.speed_mps());
    let squares = mean(squares.map(|(p, v)| (p - v) * (p - v)));
    squares.unwrap_or(f64::NAN).sqrt()
}

//! A fitted vehicle on the standard cycles, warm and at 20 °C.

use driver_model::Error as ModelError;
use ev_energy::{ConsumptionCheck, Vehicle};
use serde::Serialize;

use crate::Error;

/// A cycle with published consumption.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibratedCycle {
    /// Name of the cycle.
    pub cycle: &'static str,
    /// Published, at the wall, kWh per 100 km.
    pub published_kwh_per_100km: f64,
    /// By the fitted vehicle, at the wall, kWh per 100 km.
    pub fitted_kwh_per_100km: f64,
    /// That less the published, %.
    pub fitted_error_pct: f64,
    /// The same with mass and road load of the vehicle before the fit, as the published figure was measured.
    pub load_before_kwh_per_100km: f64,
    /// That less the published, %.
    pub load_before_error_pct: f64,
}

/// The cycles of a vehicle file, by the fitted vehicle and by the same with mass and road load of the one before.
pub(super) fn cycles(before: &Vehicle, fitted: &Vehicle) -> Result<Vec<CalibratedCycle>, Error> {
    let checked = |vehicle: &Vehicle| -> Result<Vec<ConsumptionCheck>, Error> {
        let check = vehicle.check().map_err(ModelError::from)?;
        Ok(check.consumption)
    };
    let lent = fitted.with_load_of(before).map_err(ModelError::from)?;
    let pairs = checked(fitted)?.into_iter().zip(checked(&lent)?);
    let cycles = pairs.map(|(fitted, lent)| CalibratedCycle {
        cycle: fitted.cycle.name(),
        published_kwh_per_100km: fitted.published_kwh_per_100km,
        fitted_kwh_per_100km: fitted.model_kwh_per_100km,
        fitted_error_pct: fitted.error_pct,
        load_before_kwh_per_100km: lent.model_kwh_per_100km,
        load_before_error_pct: lent.error_pct,
    });
    Ok(cycles.collect())
}

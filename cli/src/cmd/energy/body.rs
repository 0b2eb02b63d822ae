//! What `energy` says of drives.

use std::collections::BTreeMap;

use driver_model::energy::{DriveEnergy, EnergyTotals, PowerCurve};
use ev_energy::CalibrationRecord;
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Body<'a> {
    pub(super) totals: Vec<Totals<'a>>,
    pub(super) logs: Vec<Entry<'a>>,
}

/// All logs with one vehicle.
#[derive(Serialize)]
pub(super) struct Totals<'a> {
    pub(super) vehicle: &'a str,
    /// How far to trust it.
    pub(super) calibration: Option<CalibrationRecord>,
    #[serde(flatten)]
    pub(super) totals: EnergyTotals,
}

/// One log with one vehicle.
#[derive(Serialize)]
pub(super) struct Entry<'a> {
    pub(super) name: &'a str,
    pub(super) origin: &'a BTreeMap<String, String>,
    pub(super) vehicle: &'a str,
    #[serde(flatten)]
    pub(super) energy: DriveEnergy,
    /// On the report page only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) curve: Option<PowerCurve>,
}

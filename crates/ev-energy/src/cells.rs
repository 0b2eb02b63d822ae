use serde::{Deserialize, Serialize};

use crate::check::{Checker, argument};
use crate::error::Error;

/// Cells to which the power refers: their temperature, °C, and their charge, %.
const REFERENCE_DEGC: f64 = 5.0;
const REFERENCE_PCT: f64 = 70.0;

/// What cells take: cold ones and full ones less.
///
/// ```text
/// max(0, power + per K · (T − 5 °C) − per % · (charge − 70 %))
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellIntakeSpec {
    /// Largest shaft power of braking at cells of 5 °C with 70 % of charge, W.
    pub power_w: f64,
    /// More of it per degree, W/K.
    pub power_w_per_k: f64,
    /// Less of it per per cent of charge, W.
    pub power_w_per_soc_pct: f64,
}

impl Default for CellIntakeSpec {
    /// More than any car brakes with.
    fn default() -> Self {
        Self {
            power_w: 1e8,
            power_w_per_k: 0.0,
            power_w_per_soc_pct: 0.0,
        }
    }
}

impl CellIntakeSpec {
    pub(crate) fn check(&self, check: &Checker) -> Result<(), Error> {
        check.range("regeneration.cells.power_w", self.power_w, 0.0, 1e8)?;
        let (per_k, per_pct) = (self.power_w_per_k, self.power_w_per_soc_pct);
        check.range("regeneration.cells.power_w_per_k", per_k, 0.0, 1e6)?;
        check.range("regeneration.cells.power_w_per_soc_pct", per_pct, 0.0, 1e6)?;
        Ok(())
    }

    /// Largest power that these cells take, W.
    #[must_use]
    pub fn limit_w(&self, state: CellState) -> f64 {
        let warmer_k = state.temperature_degc - REFERENCE_DEGC;
        let fuller_pct = state.soc_pct.map_or(0.0, |soc| soc - REFERENCE_PCT);
        let rise_w = self.power_w_per_k * warmer_k - self.power_w_per_soc_pct * fuller_pct;
        (self.power_w + rise_w).max(0.0)
    }
}

/// Cells of a battery on a trip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CellState {
    /// Mean temperature, −60 to 120 °C.
    pub temperature_degc: f64,
    /// State of charge at the start, 0 to 100 %; 70 % where it is not known.
    pub soc_pct: Option<f64>,
}

impl CellState {
    pub(crate) fn check(&self) -> Result<(), Error> {
        let soc_pct = self.soc_pct.unwrap_or(REFERENCE_PCT);
        argument(
            "cells.temperature_degc",
            self.temperature_degc,
            -60.0,
            120.0,
        )?;
        argument("cells.soc_pct", soc_pct, 0.0, 100.0)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn cold_and_full_cells_take_less_and_never_less_than_nothing() {
        let spec = CellIntakeSpec {
            power_w: 40e3,
            power_w_per_k: 4e3,
            power_w_per_soc_pct: 500.0,
        };
        let limit_w = |temperature_degc, soc_pct| {
            spec.limit_w(CellState {
                temperature_degc,
                soc_pct,
            })
        };
        assert_eq!(limit_w(5.0, None), 40e3);
        assert_eq!(limit_w(0.0, Some(70.0)), 20e3);
        assert_eq!(limit_w(0.0, Some(100.0)), 5e3);
        assert_eq!(limit_w(-10.0, Some(100.0)), 0.0);
        assert_eq!(limit_w(5.0, Some(40.0)), 55e3);
        assert!(
            CellIntakeSpec::default().limit_w(CellState {
                temperature_degc: -60.0,
                soc_pct: Some(100.0)
            }) >= 1e8
        );
    }
}

use ev_energy::comparison::Comparison;
use serde::Serialize;

use crate::statistics::median;

/// How well a vehicle meets trips.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct EnergyScore {
    /// Mean over the trips of the magnitude of the error of their energy, %.
    pub mean_abs_error_pct: Option<f64>,
    /// Error of the energy of all trips together, %.
    pub total_error_pct: Option<f64>,
    /// Median over the trips of the root mean square of the power's error, W.
    pub median_power_rmse_w: Option<f64>,
}

impl EnergyScore {
    /// Of one comparison per trip.
    #[must_use]
    pub fn of(comparisons: &[Comparison]) -> Self {
        let errors: Vec<f64> = comparisons
            .iter()
            .filter_map(Comparison::error_pct)
            .collect();
        let rmse_w = comparisons.iter().filter_map(Comparison::power_rmse_w);
        let sum = |energy: fn(&Comparison) -> f64| comparisons.iter().map(energy).sum::<f64>();
        let (modelled_j, measured_j) = (sum(|c| c.modelled_j), sum(|c| c.measured_j));
        Self {
            mean_abs_error_pct: (!errors.is_empty())
                .then(|| errors.iter().map(|e| e.abs()).sum::<f64>() / errors.len() as f64),
            total_error_pct: (measured_j != 0.0)
                .then(|| 100.0 * (modelled_j - measured_j) / measured_j.abs()),
            median_power_rmse_w: median(rmse_w.collect()),
        }
    }
}

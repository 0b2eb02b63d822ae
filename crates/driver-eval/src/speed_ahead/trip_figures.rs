use driver_model::Error;
use driver_model::Motion;
use driver_model::energy::driving_energy_j;
use driver_model::statistics::mean;
use ev_energy::Vehicle;

/// How well a whole trip was predicted: the columns of Table 4.1, and two that say more.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TripFigures {
    /// Battery energy of the measured speed.
    pub measured_energy_j: f64,
    /// Battery energy of the predicted speed; `None` where it is no speed that a vehicle could have.
    pub energy_j: Option<f64>,
    /// `√SSE/n` of the speed, the thesis's "SSE per sample".
    pub sqrt_sse_speed_mps: f64,
    /// The same of the acceleration.
    pub sqrt_sse_accel_mps2: f64,
    /// Share of samples within half the width of the band.
    pub in_band_pct: f64,
    /// Root mean square error of the speed.
    pub rmse_mps: f64,
    /// How much longer the predicted trip is than the measured one, in the same time; `None` below 100 m measured.
    pub distance_error_pct: Option<f64>,
}

/// Faster than this is no prediction of a road vehicle.
const FASTEST_MPS: f64 = 100.0;

/// A shorter drive has no distance error worth a name.
const LEAST_DISTANCE_M: f64 = 100.0;

impl TripFigures {
    /// Compares a prediction with the measured trip; `band_mps` is the full width of the band.
    ///
    /// # Errors
    /// What the vehicle model refuses.
    pub fn compare(
        motion: &Motion,
        predicted_mps: &[f64],
        vehicle: &Vehicle,
        band_mps: f64,
    ) -> Result<Self, Error> {
        let measured = motion.speed_mps();
        let n = measured.len() as f64;
        let errors = || measured.iter().zip(predicted_mps).map(|(v, p)| p - v);
        let square_sum: f64 = errors().map(|e| e * e).sum();
        let accel = |speeds: &[f64]| -> Vec<f64> {
            speeds
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) / motion.step_s())
                .collect()
        };
        let accel_square_sum: f64 = accel(measured)
            .iter()
            .zip(accel(predicted_mps))
            .map(|(a, p)| (p - a) * (p - a))
            .sum();
        let inside = errors().filter(|e| e.abs() <= 0.5 * band_mps).count();
        let possible = predicted_mps.iter().all(|v| v.abs() <= FASTEST_MPS);
        let distance_m = |speeds: &[f64]| speeds.iter().sum::<f64>() * motion.step_s();
        let moved = distance_m(measured) >= LEAST_DISTANCE_M;
        // Predicted over the slope that was measured at the same time.
        let slope_rad = motion.slope_rad();
        let energy_j =
            |speeds: &[f64]| driving_energy_j(vehicle, motion.step_s(), speeds, slope_rad);
        Ok(Self {
            measured_energy_j: energy_j(measured)?,
            energy_j: possible.then(|| energy_j(predicted_mps)).transpose()?,
            sqrt_sse_speed_mps: square_sum.sqrt() / n,
            sqrt_sse_accel_mps2: accel_square_sum.sqrt() / n,
            in_band_pct: 100.0 * inside as f64 / n,
            rmse_mps: (square_sum / n).sqrt(),
            distance_error_pct: moved
                .then(|| 100.0 * (distance_m(predicted_mps) / distance_m(measured) - 1.0)),
        })
    }
}

/// Figures of several trips together: energies are summed, the rest are means over trips.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TripSummary {
    /// Trips.
    pub trips: usize,
    /// Battery energy of the measured speeds.
    pub measured_energy_j: f64,
    /// Battery energy of the predicted speeds; `None` where a prediction is no speed that a vehicle could have.
    pub energy_j: Option<f64>,
    /// Measured less predicted: positive where the prediction uses less.
    pub energy_difference_j: Option<f64>,
    /// `√SSE/n` of the speed.
    pub sqrt_sse_speed_mps: f64,
    /// The same of the acceleration.
    pub sqrt_sse_accel_mps2: f64,
    /// Share of samples within half the width of the band.
    pub in_band_pct: f64,
    /// Root mean square error of the speed.
    pub rmse_mps: f64,
    /// Mean magnitude of the error of the distance.
    pub abs_distance_error_pct: Option<f64>,
}

impl TripSummary {
    /// Of the figures of trips; `None` without any.
    pub(super) fn of(figures: &[&TripFigures]) -> Option<Self> {
        let mean_of = |of: fn(&TripFigures) -> f64| mean(figures.iter().map(|figures| of(figures)));
        let measured_energy_j = figures.iter().map(|f| f.measured_energy_j).sum();
        let energy_j: Option<f64> = figures.iter().map(|f| f.energy_j).sum();
        Some(Self {
            trips: figures.len(),
            measured_energy_j,
            energy_j,
            energy_difference_j: energy_j.map(|energy_j| measured_energy_j - energy_j),
            sqrt_sse_speed_mps: mean_of(|f| f.sqrt_sse_speed_mps)?,
            sqrt_sse_accel_mps2: mean_of(|f| f.sqrt_sse_accel_mps2)?,
            in_band_pct: mean_of(|f| f.in_band_pct)?,
            rmse_mps: mean_of(|f| f.rmse_mps)?,
            abs_distance_error_pct: mean(
                figures
                    .iter()
                    .filter_map(|f| f.distance_error_pct)
                    .map(f64::abs),
            ),
        })
    }
}

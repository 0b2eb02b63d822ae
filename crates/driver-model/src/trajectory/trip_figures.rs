use ev_energy::Vehicle;

use super::Course;
use crate::Error;

/// How well a whole trip was predicted: the columns of Table 4.1, and two that say more.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// How much longer the predicted trip is than the measured one, in the same time.
    pub distance_error_pct: f64,
}

/// Faster than this is no prediction of a road vehicle.
const FASTEST_MPS: f64 = 100.0;

impl TripFigures {
    /// Compares a prediction with the measured trip; `band_mps` is the full width of the band.
    ///
    /// # Errors
    /// What the vehicle model refuses.
    pub fn compare(course: &Course, predicted_mps: &[f64], vehicle: &Vehicle, band_mps: f64) -> Result<Self, Error> {
        let measured = &course.speed_mps;
        let n = measured.len() as f64;
        let errors = || measured.iter().zip(predicted_mps).map(|(v, p)| p - v);
        let square_sum: f64 = errors().map(|e| e * e).sum();
        let accel = |speeds: &[f64]| -> Vec<f64> {
            speeds.windows(2).map(|pair| (pair[1] - pair[0]) / course.step_s).collect()
        };
        let accel_square_sum: f64 = accel(measured)
            .iter()
            .zip(accel(predicted_mps))
            .map(|(a, p)| (p - a) * (p - a))
            .sum();
        let inside = errors().filter(|e| e.abs() <= 0.5 * band_mps).count();
        let possible = predicted_mps.iter().all(|v| v.abs() <= FASTEST_MPS);
        let sum = |speeds: &[f64]| speeds.iter().sum::<f64>();
        Ok(Self {
            measured_energy_j: energy_j(course, measured, vehicle)?,
            energy_j: possible.then(|| energy_j(course, predicted_mps, vehicle)).transpose()?,
            sqrt_sse_speed_mps: square_sum.sqrt() / n,
            sqrt_sse_accel_mps2: accel_square_sum.sqrt() / n,
            in_band_pct: 100.0 * inside as f64 / n,
            rmse_mps: (square_sum / n).sqrt(),
            distance_error_pct: 100.0 * (sum(predicted_mps) / sum(measured) - 1.0),
        })
    }
}

/// Battery energy of driving at these speeds over the slope that was measured at the same time. Backward counts as standing.
fn energy_j(course: &Course, speed_mps: &[f64], vehicle: &Vehicle) -> Result<f64, Error> {
    let forward: Vec<f64> = speed_mps.iter().map(|v| v.max(0.0)).collect();
    let energy = vehicle.trip_energy(&ev_energy::Trip {
        speed_mps: &forward,
        slope_rad: course.slope_rad.as_deref(),
        step_s: course.step_s,
        ..ev_energy::Trip::default()
    })?;
    Ok(energy.battery_energy_j)
}

//! Robust least squares within bounds.
//!
//! Minimises `Σ_trips [ mean over a trip of ρ(ΔP/σ) + mean of ρ(ΔP_T/σ_T) + (ΔE/(s E))² + (ΔP_0/σ_0)² ]` with
//! `ρ(x) = 2 (√(1 + x²) − 1)`, where `ΔP` is the difference of a mean of modelled and measured power, `ΔP_T` the same by measured
//! torque in place of motion, `ΔE/E` that of the trip's energy, `E` at least 2 kW times its duration, and `ΔP_0` that of the mean
//! power at standstill. Every trip weighs the same however long. The bounds are removed by
//! `p = lower + (upper − lower)(1 + sin q)/2`, and Levenberg and Marquardt's method works on `q`.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::parameter::{Bounded, with_values};
use super::trip::CalibrationTrip;
use crate::error::Error;
use crate::vehicle::{Vehicle, VehicleSpec};

/// `σ`, W: what a good model still gets wrong in half a second. Larger differences count less than their square.
const POWER_SCALE_W: f64 = 3000.0;

/// `σ_T`, W: the same where the torque is measured, which knows of no wind.
const TORQUE_SCALE_W: f64 = 2000.0;

/// `σ_0`, W, for a stand that is long against the second figure, s: what a standing car takes are its auxiliaries. Below the
/// speed, m/s, it stands.
const STANDING_SCALE_W: f64 = 400.0;
const STANDING_S: f64 = 10.0;
const STANDING_MPS: f64 = 0.02;

/// `s`: an error of this share of a trip's energy weighs as much as an error of `σ` all along.
const ENERGY_SHARE: f64 = 0.2;

/// Power of a trip that takes next to nothing, W.
const LEAST_POWER_W: f64 = 2000.0;

/// Relative step of finite differences, of the width of the bounds.
const DIFFERENCE: f64 = 1e-5;

/// Change of the sum of squares, and of the parameters, below which the fit has converged.
const TOLERANCE: f64 = 1e-5;

/// Evaluations at most, per parameter: measurements that a vehicle can have made take a fifth of it, and what it cannot have made
/// is fitted as well as it goes.
const PATIENCE: usize = 15;

/// Free variables this far from a bound at the start, as a share of the width: at a bound the sine has no slope.
const START_MARGIN: f64 = 0.02;

pub(super) struct Problem<'a> {
    spec: VehicleSpec,
    parameters: &'a [Bounded],
    trips: &'a [&'a CalibrationTrip],
    free: DVector<f64>,
}

impl<'a> Problem<'a> {
    /// A problem that starts at some values of the parameters; the others are those of `spec`.
    pub(super) fn new(
        spec: &VehicleSpec,
        starts: &[f64],
        parameters: &'a [Bounded],
        trips: &'a [&'a CalibrationTrip],
    ) -> Self {
        let free = parameters.iter().zip(starts).map(|(parameter, start)| {
            let share = (start - parameter.lower) / parameter.width();
            let inside = share.clamp(START_MARGIN, 1.0 - START_MARGIN);
            parameter.bounds().free_of_share(inside)
        });
        let free = DVector::from_iterator(parameters.len(), free);
        Self {
            spec: spec.clone(),
            parameters,
            trips,
            free,
        }
    }

    /// Solves it; the best values of the parameters.
    pub(super) fn solve(self) -> Result<Vec<f64>, Error> {
        let solver = LevenbergMarquardt::new()
            .with_ftol(TOLERANCE)
            .with_xtol(TOLERANCE)
            .with_gtol(TOLERANCE)
            .with_patience(PATIENCE);
        let (solved, report) = solver.minimize(self);
        if !report.termination.was_successful()
            && report.termination != TerminationReason::LostPatience
        {
            return Err(Error::Calibration {
                problem: format!("the fit did not converge: {:?}", report.termination),
            });
        }
        Ok(solved.values())
    }

    fn values(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .zip(self.free.iter())
            .map(|(parameter, q)| parameter.bounds().value(*q))
            .collect()
    }

    /// The residuals whose squares are summed: per trip those of power and the one of energy.
    fn residuals_at(&self, values: &[f64]) -> Option<Vec<f64>> {
        let vehicle = Vehicle::new(with_values(&self.spec, self.parameters, values)).ok()?;
        let mut residuals = Vec::with_capacity(self.len());
        for trip in self.trips {
            add_power(trip, &vehicle, &mut residuals)?;
            add_torque(trip, &vehicle, &mut residuals);
        }
        Some(residuals)
    }

    fn len(&self) -> usize {
        let of_trip = |trip: &&CalibrationTrip| trip.means() + trip.torque_means() + 2;
        self.trips.iter().map(of_trip).sum()
    }

    /// Derivatives of the residuals by the parameters themselves, in units of their bounds' width.
    pub(super) fn derivatives_at(&self, values: &[f64]) -> Option<DMatrix<f64>> {
        let here = self.residuals_at(values)?;
        let mut derivatives = DMatrix::zeros(here.len(), values.len());
        for (k, parameter) in self.parameters.iter().enumerate() {
            // Inward from the upper bound.
            let sign = if values[k] + DIFFERENCE * parameter.width() > parameter.upper {
                -1.0
            } else {
                1.0
            };
            let mut moved = values.to_vec();
            moved[k] += sign * DIFFERENCE * parameter.width();
            let there = self.residuals_at(&moved)?;
            for ((place, here), there) in
                derivatives.column_mut(k).iter_mut().zip(&here).zip(&there)
            {
                *place = sign * (there - here) / DIFFERENCE;
            }
        }
        Some(derivatives)
    }
}

/// The residuals of power, of energy, and of the power at standstill.
fn add_power(trip: &CalibrationTrip, vehicle: &Vehicle, residuals: &mut Vec<f64>) -> Option<()> {
    let weight = 1.0 / (trip.means() as f64).sqrt();
    let (mut modelled_j, mut measured_j, mut duration_s) = (0.0, 0.0, 0.0);
    let (mut standing_off_j, mut standing_s) = (0.0, 0.0);
    trip.for_each_mean(vehicle, |mean, _| {
        let measured_w = mean.measured_w.unwrap_or_default();
        let off_w = mean.modelled_w - measured_w;
        residuals.push(weight * robust(off_w / POWER_SCALE_W));
        modelled_j += mean.modelled_w * mean.duration_s;
        measured_j += measured_w * mean.duration_s;
        duration_s += mean.duration_s;
        if mean.speed_mps.abs() < STANDING_MPS {
            standing_off_j += off_w * mean.duration_s;
            standing_s += mean.duration_s;
        }
    })
    .ok()?;
    // A trip downhill may have taken next to nothing.
    let scale_j = f64::abs(measured_j).max(LEAST_POWER_W * duration_s);
    residuals.push((modelled_j - measured_j) / (ENERGY_SHARE * scale_j));
    let standing_off_w = standing_off_j / f64::max(standing_s, f64::MIN_POSITIVE);
    let long = standing_s / (standing_s + STANDING_S);
    residuals.push(long.sqrt() * standing_off_w / STANDING_SCALE_W);
    Some(())
}

/// The residuals of the power that measured torque makes.
fn add_torque(trip: &CalibrationTrip, vehicle: &Vehicle, residuals: &mut Vec<f64>) {
    let weight = 1.0 / (trip.torque_means() as f64).sqrt();
    trip.for_each_torque_mean(vehicle, |mean| {
        let off_w = mean.modelled_w - mean.measured_w.unwrap_or_default();
        residuals.push(weight * robust(off_w / TORQUE_SCALE_W));
    });
}

/// `√ρ` with the sign of its argument.
fn robust(x: f64) -> f64 {
    // √(1 + x²) − 1 without cancellation
    let root = x * x / (1.0 + (1.0 + x * x).sqrt());
    (2.0 * root).sqrt().copysign(x)
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, free: &DVector<f64>) {
        self.free.copy_from(free);
    }

    fn params(&self) -> DVector<f64> {
        self.free.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals_at(&self.values()).map(DVector::from_vec)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut jacobian = self.derivatives_at(&self.values())?;
        for (mut column, q) in jacobian.column_iter_mut().zip(self.free.iter()) {
            column *= 0.5 * q.cos();
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_differences_count_square_and_large_ones_linear() {
        assert!((robust(1e-3) - 1e-3).abs() < 1e-9);
        assert!((robust(-1e3).powi(2) / (2.0 * 1e3) - 1.0).abs() < 2e-3);
        assert!(robust(-2.0) < 0.0);
    }
}

use driver_model::error::at_least;
use driver_model::trip_driver::{FreeRun, RecordedTrip, interpolated, restless};
use ev_energy::{Trip, Vehicle};
use serde::Serialize;

use crate::Error;

/// Errors relative to less than this mean nothing, m.
const LEAST_M: f64 = 100.0;

/// Distances are compared this much before the end of the shorter motion: at the end itself the car may stand, m.
const BEFORE_END_M: f64 = 1.0;

/// How far a free run is off a measured trip; predicted minus measured, relative to measured.
///
/// Energies are those at the battery terminals of the vehicle model, for both motions on a grid of 1 s: finer ones would
/// charge the noise of the recorded speed with the losses of motor and battery. The predicted one includes the driver's unrest, and
/// recorded readings that are held are joined by straight lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FreeRunScore {
    /// Time up to which both are compared: as asked for, or the end of the log or of the run.
    pub duration_s: f64,
    /// Measured distance at that time.
    pub distance_m: f64,
    /// Energy of the measured speed until then.
    pub energy_j: f64,
    /// Distance at equal time.
    pub distance_error_pct: f64,
    /// Energy at equal time. It contains the kinetic energy of that moment. `None` where the measured energy is not positive.
    pub energy_error_pct: Option<f64>,
    /// Time at equal distance.
    pub time_at_distance_error_pct: f64,
    /// Energy at equal distance; `None` as above.
    pub energy_at_distance_error_pct: Option<f64>,
}

impl FreeRunScore {
    /// Compares over the first `duration_s`. `slope_rad` is that of the log, a value per sample; `None` is a level road.
    ///
    /// # Errors
    /// [`Error::Model`] where less than 100 m were driven or predicted, and from the vehicle model.
    pub fn of(
        run: &FreeRun,
        trip: &RecordedTrip,
        slope_rad: Option<&[f64]>,
        vehicle: &Vehicle,
        duration_s: f64,
    ) -> Result<Self, Error> {
        let measured = Sampled {
            step_s: trip.step_s(),
            speed_mps: trip.speed_mps(),
            position_m: trip.distance_m(),
            slope_rad,
            unrest_mps2: 0.0,
        };
        let predicted = Sampled {
            step_s: run.step_s,
            speed_mps: &run.speed_mps,
            position_m: &run.position_m,
            slope_rad: run.slope_rad.as_deref(),
            unrest_mps2: run.unrest_mps2,
        };
        let end_s = duration_s.min(measured.end_s()).min(predicted.end_s());
        let (distance_m, predicted_m) = (measured.position_m(end_s), predicted.position_m(end_s));
        let equal_m = measured.position_m(duration_s).min(predicted.last_m()) - BEFORE_END_M;
        let shortest_m = distance_m.min(predicted_m).min(equal_m);
        at_least("distance_m", shortest_m, LEAST_M, "at least 100 m driven")?;
        let (measured_s, predicted_s) = (measured.time_s(equal_m), predicted.time_s(equal_m));
        let energy_j = measured.energy_j(end_s, vehicle)?;
        Ok(Self {
            duration_s: end_s,
            distance_m,
            energy_j,
            distance_error_pct: 100.0 * (predicted_m / distance_m - 1.0),
            energy_error_pct: error_pct(predicted.energy_j(end_s, vehicle)?, energy_j),
            time_at_distance_error_pct: 100.0 * (predicted_s / measured_s - 1.0),
            energy_at_distance_error_pct: error_pct(
                predicted.energy_j(predicted_s, vehicle)?,
                measured.energy_j(measured_s, vehicle)?,
            ),
        })
    }
}

fn error_pct(predicted_j: f64, measured_j: f64) -> Option<f64> {
    (measured_j > 0.0).then(|| 100.0 * (predicted_j / measured_j - 1.0))
}

#[derive(Clone, Copy)]
struct Sampled<'a> {
    step_s: f64,
    speed_mps: &'a [f64],
    position_m: &'a [f64],
    slope_rad: Option<&'a [f64]>,
    unrest_mps2: f64,
}

impl Sampled<'_> {
    fn end_s(&self) -> f64 {
        (self.speed_mps.len() - 1) as f64 * self.step_s
    }

    fn last_m(&self) -> f64 {
        self.position_m[self.position_m.len() - 1]
    }

    fn position_m(&self, t_s: f64) -> f64 {
        interpolated(self.position_m, t_s / self.step_s)
    }

    /// When a position is reached first.
    fn time_s(&self, position_m: f64) -> f64 {
        let next = self.position_m.partition_point(|s| *s < position_m);
        let next = next.clamp(1, self.position_m.len() - 1);
        let (from_m, to_m) = (self.position_m[next - 1], self.position_m[next]);
        let share = (position_m - from_m) / (to_m - from_m);
        ((next - 1) as f64 + share) * self.step_s
    }

    /// Up to a time, in equal steps as near to 1 s as fit.
    fn energy_j(&self, end_s: f64, vehicle: &Vehicle) -> Result<f64, Error> {
        let steps = end_s.round().max(1.0);
        let step_s = end_s / steps;
        let sampled = |values: &[f64]| -> Vec<f64> {
            (0..=steps as usize)
                .map(|k| interpolated(values, k as f64 * step_s / self.step_s))
                .collect()
        };
        let speed_mps = restless(&sampled(self.speed_mps), step_s, self.unrest_mps2);
        let slope_rad = self.slope_rad.map(sampled);
        let trip = Trip {
            step_s,
            speed_mps: &speed_mps,
            slope_rad: slope_rad.as_deref(),
            ..Trip::default()
        };
        let energy = vehicle
            .trip_energy(&trip)
            .map_err(driver_model::Error::from)?;
        Ok(energy.terminal_energy_j)
    }
}

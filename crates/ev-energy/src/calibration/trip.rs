use crate::comparison::{Comparison, PowerAverager, PowerMean};
use crate::error::Error;
use crate::trip::Trip;
use crate::vehicle::Vehicle;
use crate::weather::Weather;

/// A trip with measured battery power, in one or several pieces.
#[derive(Debug, Clone, Default)]
pub struct CalibrationTrip {
    pieces: Vec<Piece>,
    means: usize,
    measured_s: f64,
}

/// Speeds that differ by less than this in the root mean square are of one trip, m/s.
const SAME_MPS: f64 = 0.1;

/// How many of these trips are no copies of one before them.
pub(super) fn different(trips: &[&CalibrationTrip]) -> usize {
    let is_new = |k: &usize| {
        !trips[..*k]
            .iter()
            .any(|before| before.moves_like(trips[*k]))
    };
    (0..trips.len()).filter(is_new).count()
}

/// A motion of its own.
#[derive(Debug, Clone)]
struct Piece {
    step_s: f64,
    speed_mps: Vec<f64>,
    slope_rad: Option<Vec<f64>>,
    extra_aux_power_w: Option<Vec<f64>>,
    weather: Option<Weather>,
    /// Measured at the terminals, per step.
    power_w: Vec<f64>,
}

impl CalibrationTrip {
    /// Adds a piece: its motion, and the measured terminal power of every step in W, NaN where there is none. The state of charge
    /// is left out: it does not matter at the terminals.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`], and [`Error::Length`] for the power.
    pub fn add(&mut self, vehicle: &Vehicle, trip: &Trip, power_w: &[f64]) -> Result<(), Error> {
        let steps = vehicle.trip_points(trip)?.len();
        if power_w.len() != steps {
            return Err(Error::Length {
                channel: "power_w",
                found: power_w.len(),
                expected: steps,
            });
        }
        self.pieces.push(Piece {
            step_s: trip.step_s,
            speed_mps: trip.speed_mps.to_vec(),
            slope_rad: trip.slope_rad.map(<[f64]>::to_vec),
            extra_aux_power_w: trip.extra_aux_power_w.map(<[f64]>::to_vec),
            weather: trip.weather,
            power_w: power_w.to_vec(),
        });
        let (mut means, mut measured_s) = (0, 0.0);
        self.for_each_mean(vehicle, |mean, _| {
            means += 1;
            measured_s += mean.duration_s;
        })?;
        (self.means, self.measured_s) = (means, measured_s);
        Ok(())
    }

    /// Number of means of measured power.
    #[must_use]
    pub fn means(&self) -> usize {
        self.means
    }

    /// Time with measured power, s.
    #[must_use]
    pub fn measured_s(&self) -> f64 {
        self.measured_s
    }

    /// Whether any piece was driven in colder air.
    pub(crate) fn is_colder_than(&self, temperature_degc: f64) -> bool {
        let colder = |weather: Weather| weather.temperature_degc < temperature_degc;
        self.pieces.iter().any(|p| p.weather.is_some_and(colder))
    }

    /// Whether the car moved as on another trip, but for noise.
    fn moves_like(&self, other: &Self) -> bool {
        let speeds = |trip: &Self| -> Vec<f64> {
            let pieces = trip.pieces.iter();
            pieces.flat_map(|piece| &piece.speed_mps).copied().collect()
        };
        let (own, others) = (speeds(self), speeds(other));
        let squares: f64 = own.iter().zip(&others).map(|(a, b)| (a - b).powi(2)).sum();
        own.len() == others.len() && squares <= SAME_MPS.powi(2) * own.len() as f64
    }

    /// Compares a vehicle's power with the measured.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`].
    pub fn compare(&self, vehicle: &Vehicle) -> Result<Comparison, Error> {
        let mut comparison = Comparison::default();
        self.for_each_mean(vehicle, |mean, _| comparison.add(mean))?;
        Ok(comparison)
    }

    /// Shows every mean of modelled and measured power, with the weather; means without a measurement are left out.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`].
    pub fn for_each_mean(
        &self,
        vehicle: &Vehicle,
        mut visit: impl FnMut(&PowerMean, Option<Weather>),
    ) -> Result<(), Error> {
        for piece in &self.pieces {
            let trip = Trip {
                step_s: piece.step_s,
                speed_mps: &piece.speed_mps,
                slope_rad: piece.slope_rad.as_deref(),
                extra_aux_power_w: piece.extra_aux_power_w.as_deref(),
                weather: piece.weather,
                soc_start_pct: None,
            };
            let mut measured = |mean: &PowerMean| {
                if mean.measured_w.is_some() {
                    visit(mean, piece.weather);
                }
            };
            let mut averager = PowerAverager::new(piece.step_s);
            for (point, &power_w) in vehicle.trip_points(&trip)?.zip(&piece.power_w) {
                averager.add(&point, power_w, &mut measured);
            }
            averager.finish(&mut measured);
        }
        Ok(())
    }
}

use crate::cells::CellState;
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
    torque_means: usize,
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
    since_cold_start_s: Option<f64>,
    cells: Option<CellState>,
    /// Measured at the terminals, per step.
    power_w: Vec<f64>,
    /// Measured at the motor shaft, per step.
    torque_nm: Vec<f64>,
}

impl CalibrationTrip {
    /// Adds a piece: its motion, and the measured terminal power in W and motor torque in N m of every step, NaN where there is
    /// none. The state of charge at the start is left out: it does not matter at the terminals, but for what cells take.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`], and [`Error::Length`] for the power.
    pub fn add(
        &mut self,
        vehicle: &Vehicle,
        trip: &Trip,
        power_w: &[f64],
        torque_nm: &[f64],
    ) -> Result<(), Error> {
        let expected = vehicle.trip_points(trip)?.len();
        for (channel, values) in [("power_w", power_w), ("torque_nm", torque_nm)] {
            if values.len() != expected {
                return Err(Error::Length {
                    channel,
                    found: values.len(),
                    expected,
                });
            }
        }
        self.pieces.push(Piece {
            step_s: trip.step_s,
            speed_mps: trip.speed_mps.to_vec(),
            slope_rad: trip.slope_rad.map(<[f64]>::to_vec),
            extra_aux_power_w: trip.extra_aux_power_w.map(<[f64]>::to_vec),
            weather: trip.weather,
            since_cold_start_s: trip.since_cold_start_s,
            cells: trip.cells,
            power_w: power_w.to_vec(),
            torque_nm: torque_nm.to_vec(),
        });
        let (mut means, mut measured_s) = (0, 0.0);
        self.for_each_mean(vehicle, |mean, _| {
            means += 1;
            measured_s += mean.duration_s;
        })?;
        (self.means, self.measured_s) = (means, measured_s);
        let mut torque_means = 0;
        self.for_each_torque_mean(vehicle, |_| torque_means += 1);
        self.torque_means = torque_means;
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

    /// Number of means of measured power with a measured torque.
    pub(crate) fn torque_means(&self) -> usize {
        self.torque_means
    }

    /// Whether any piece is known to follow a cold start.
    pub(crate) fn has_cold_start(&self) -> bool {
        self.pieces.iter().any(|p| p.since_cold_start_s.is_some())
    }

    /// Whether the cells of any piece are known.
    pub(crate) fn has_cells(&self) -> bool {
        self.pieces.iter().any(|p| p.cells.is_some())
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
                since_cold_start_s: piece.since_cold_start_s,
                cells: piece.cells,
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

    /// Shows every mean of measured power and of what measured torque, losses and auxiliaries of a vehicle make; means without
    /// either measurement are left out.
    pub(crate) fn for_each_torque_mean(
        &self,
        vehicle: &Vehicle,
        mut visit: impl FnMut(&PowerMean),
    ) {
        for piece in &self.pieces {
            let mut measured = |mean: &PowerMean| {
                if mean.measured_w.is_some() {
                    visit(mean);
                }
            };
            let mut averager = PowerAverager::new(piece.step_s);
            for (k, (&torque_nm, &power_w)) in
                piece.torque_nm.iter().zip(&piece.power_w).enumerate()
            {
                let speed_mps = 0.5 * (piece.speed_mps[k] + piece.speed_mps[k + 1]);
                let both = torque_nm.is_finite() && power_w.is_finite();
                let (torque_nm, power_w) = if both {
                    (torque_nm, power_w)
                } else {
                    (0.0, f64::NAN)
                };
                let extra = piece.extra_aux_power_w.as_ref();
                let extra_w = extra.map_or(0.0, |aux| 0.5 * (aux[k] + aux[k + 1]));
                let modelled_w = vehicle.power_of_torque_w(speed_mps, torque_nm) + extra_w;
                averager.add_step(speed_mps, modelled_w, power_w, &mut measured);
            }
            averager.finish(&mut measured);
        }
    }
}

use std::f64::consts::FRAC_PI_2;

use crate::battery::VoltagePiece;
use crate::cells::CellState;
use crate::check::argument;
use crate::error::Error;
use crate::operating_point::{Motion, OperatingPoint};
use crate::road_load::RoadLoad;
use crate::scalar::{larger, sin_cos};
use crate::trip_energy::{Budget, LimitedTotals, TripEnergy, WheelEnergy};
use crate::vehicle::Vehicle;
use crate::weather::Weather;

/// A motion on a uniform time grid. All channels have one value per sample.
#[derive(Debug, Clone, Copy)]
pub struct Trip<'a> {
    /// Time between two samples, s; 10⁻³ to 10⁶.
    pub step_s: f64,
    /// Speed, m/s; within ±1000.
    pub speed_mps: &'a [f64],
    /// Slope angle, positive uphill, rad; within ±π/2. `None` is a level road.
    pub slope_rad: Option<&'a [f64]>,
    /// Power of what the log knows of auxiliaries, such as heating, on top of the constant of the vehicle, W; within ±10⁶.
    pub extra_aux_power_w: Option<&'a [f64]>,
    /// Weather; `None` is that of the vehicle's road load.
    pub weather: Option<Weather>,
    /// State of charge at the start, 0 to 100 %; `None` leaves the battery at its nominal voltage.
    pub soc_start_pct: Option<f64>,
    /// Time from a cold start to the first sample, s, up to 10⁹; `None` is a warm car.
    pub since_cold_start_s: Option<f64>,
    /// Cells; `None` takes what the limits of regeneration allow.
    pub cells: Option<CellState>,
}

/// No samples, 0.1 s apart.
impl Default for Trip<'_> {
    fn default() -> Self {
        Self {
            step_s: 0.1,
            speed_mps: &[],
            slope_rad: None,
            extra_aux_power_w: None,
            weather: None,
            soc_start_pct: None,
            since_cold_start_s: None,
            cells: None,
        }
    }
}

impl Vehicle {
    /// Energy of a trip: the sum of [`Vehicle::trip_points`] times the step. Less than two samples
    /// are no motion.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`].
    pub fn trip_energy(&self, trip: &Trip) -> Result<TripEnergy, Error> {
        self.trip_energy_with(trip, |_| {})
    }

    /// As [`Vehicle::trip_energy`], and shows every operating point on the way.
    ///
    /// # Errors
    /// As [`Vehicle::trip_points`].
    #[inline]
    pub fn trip_energy_with(
        &self,
        trip: &Trip,
        mut visit: impl FnMut(&OperatingPoint),
    ) -> Result<TripEnergy, Error> {
        let mut points = self.trip_points(trip)?;
        let mut sum = PowerSum::default();
        for point in points.by_ref() {
            sum.add(&point, 1.0);
            visit(&point);
        }
        let duration_s = trip.speed_mps.len().saturating_sub(1) as f64 * trip.step_s;
        let mut energy = sum.energy(self, trip.step_s, duration_s);
        energy.soc_end_pct = points.soc_pct;
        Ok(energy)
    }

    /// Operating points of a trip, one per step, `n − 1` for `n` samples.
    ///
    /// Step `k` lies between samples `k` and `k + 1`: the speed is the mean of the two, the
    /// acceleration constant between them, slope and auxiliary power are the means of the two
    /// samples.
    ///
    /// # Errors
    /// [`Error::Argument`] for the step, the weather and the state of charge, [`Error::Length`] for
    /// channels of different length and [`Error::Sample`] for a value that is not finite or out of
    /// range; see [`Trip`] for the ranges.
    pub fn trip_points<'a>(&'a self, trip: &Trip<'a>) -> Result<TripPoints<'a>, Error> {
        argument("step_s", trip.step_s, 1e-3, 1e6)?;
        if let Some(soc_pct) = trip.soc_start_pct {
            argument("soc_start_pct", soc_pct, 0.0, 100.0)?;
        }
        if let Some(since_s) = trip.since_cold_start_s {
            argument("since_cold_start_s", since_s, 0.0, 1e9)?;
        }
        if let Some(cells) = trip.cells {
            cells.check()?;
        }
        let samples = trip.speed_mps.len();
        check_channel("speed_mps", trip.speed_mps, samples, 1e3)?;
        if let Some(slope_rad) = trip.slope_rad {
            check_channel("slope_rad", slope_rad, samples, FRAC_PI_2)?;
        }
        if let Some(power_w) = trip.extra_aux_power_w {
            check_channel("extra_aux_power_w", power_w, samples, 1e6)?;
        }
        let road_load = match &trip.weather {
            None => self.road_load.clone(),
            Some(weather) => {
                weather.check()?;
                self.road_load.under(weather, &self.spec().weather)
            }
        };
        Ok(TripPoints {
            vehicle: self,
            trip: *trip,
            rate_hz: 1.0 / trip.step_s,
            road_load,
            soc_pct: trip
                .soc_start_pct
                .and_then(|soc_pct| self.battery.discharged_pct(soc_pct, 0.0)),
            piece: trip.soc_start_pct.and_then(|soc| self.battery.piece(soc)),
            end: 1,
            warm_up_n: trip.since_cold_start_s.map_or(0.0, |since_s| {
                let degc = trip
                    .weather
                    .map_or(20.0, |weather| weather.temperature_degc);
                let middle_s = since_s + 0.5 * trip.step_s;
                self.spec().warm_up.force_at_n(middle_s, degc)
            }),
            warm_up_left: (-trip.step_s / self.spec().warm_up.decay_s).exp(),
            cells_w: trip
                .cells
                .zip(self.spec().regeneration.cells.as_ref())
                .map_or(f64::INFINITY, |(state, intake)| intake.limit_w(state)),
        })
    }
}

/// The operating points of a trip, from [`Vehicle::trip_points`].
#[derive(Debug, Clone)]
pub struct TripPoints<'a> {
    vehicle: &'a Vehicle,
    trip: Trip<'a>,
    rate_hz: f64,
    road_load: RoadLoad,
    soc_pct: Option<f64>,
    /// Piece of the voltage curve, where the vehicle has one and the state of charge is known.
    piece: Option<VoltagePiece>,
    /// Sample at the end of the next step.
    end: usize,
    /// Resistance of the cold car in the next step, N, and what is left of it a step later, 1.
    warm_up_n: f64,
    warm_up_left: f64,
    /// Largest shaft power of braking that the cells take, W.
    cells_w: f64,
}

impl TripPoints<'_> {
    /// State of charge after the last point given, %.
    #[must_use]
    pub fn soc_pct(&self) -> Option<f64> {
        self.soc_pct
    }

    #[inline(always)]
    fn motion(&self, end: usize) -> Motion {
        let mean = |channel: &[f64]| 0.5 * (channel[end - 1] + channel[end]);
        let Trip {
            speed_mps,
            slope_rad,
            extra_aux_power_w,
            ..
        } = self.trip;
        let (sin_slope, cos_slope) = slope_rad.map_or((0.0, 1.0), |slope| sin_cos(mean(slope)));
        Motion {
            speed_mps: mean(speed_mps),
            accel_mps2: (speed_mps[end] - speed_mps[end - 1]) * self.rate_hz,
            sin_slope,
            cos_slope,
            auxiliary_power_w: self.vehicle.spec().auxiliary_power_w
                + extra_aux_power_w.map_or(0.0, mean),
            warm_up_n: self.warm_up_n,
            cells_w: self.cells_w,
        }
    }
}

impl Iterator for TripPoints<'_> {
    type Item = OperatingPoint;

    #[inline(always)]
    fn next(&mut self) -> Option<OperatingPoint> {
        if self.end >= self.trip.speed_mps.len() {
            return None;
        }
        let motion = self.motion(self.end);
        self.end += 1;
        self.warm_up_n *= self.warm_up_left;
        let battery = &self.vehicle.battery;
        let Some(soc_pct) = self.soc_pct else {
            return Some(
                self.vehicle
                    .evaluate(&self.road_load, &battery.nominal(), &motion),
            );
        };
        if self.piece.is_some_and(|piece| !piece.covers(soc_pct)) {
            self.piece = battery.piece(soc_pct);
        }
        let cells = self
            .piece
            .map_or(battery.nominal(), |piece| piece.cells(soc_pct));
        let point = self.vehicle.evaluate(&self.road_load, &cells, &motion);
        self.soc_pct = battery.discharged_pct(soc_pct, point.battery_current_a * self.trip.step_s);
        Some(point)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.trip.speed_mps.len().saturating_sub(self.end);
        (left, Some(left))
    }
}

impl ExactSizeIterator for TripPoints<'_> {}

fn check_channel(
    channel: &'static str,
    values: &[f64],
    expected: usize,
    limit: f64,
) -> Result<(), Error> {
    if values.len() != expected {
        return Err(Error::Length {
            channel,
            found: values.len(),
            expected,
        });
    }
    match values
        .iter()
        .position(|value| !(-limit..=limit).contains(value))
    {
        None => Ok(()),
        Some(index) => Err(Error::Sample {
            channel,
            index,
            value: values[index],
            min: -limit,
            max: limit,
        }),
    }
}

/// Sums of powers over steps, each with a weight.
#[derive(Default)]
pub(crate) struct PowerSum {
    speed_mps: f64,
    battery_w: f64,
    terminal_w: f64,
    inertia_w: f64,
    rolling_w: f64,
    aero_w: f64,
    grade_w: f64,
    gear_loss_w: f64,
    motor_loss_w: f64,
    auxiliary_w: f64,
    battery_loss_w: f64,
    friction_brake_w: f64,
    regenerated_w: f64,
    undelivered_w: f64,
    propelled_w: f64,
    braked_w: f64,
    /// Steps.
    torque_limited: f64,
    battery_limited: f64,
}

impl PowerSum {
    #[inline(always)]
    pub(crate) fn add(&mut self, point: &OperatingPoint, weight: f64) {
        let v = point.speed_mps;
        self.speed_mps += weight * v.abs();
        self.battery_w += weight * point.battery_power_w;
        self.terminal_w += weight * point.terminal_power_w;
        self.inertia_w += weight * (point.inertia_n * v);
        self.rolling_w += weight * (point.rolling_n * v);
        self.aero_w += weight * (point.aero_n * v);
        self.grade_w += weight * (point.grade_n * v);
        self.gear_loss_w += weight * point.gear_loss_w;
        self.motor_loss_w += weight * point.motor_loss_w;
        self.auxiliary_w += weight * point.auxiliary_power_w;
        self.battery_loss_w += weight * point.battery_loss_w;
        self.friction_brake_w += weight * point.friction_brake_w;
        self.regenerated_w += weight * larger(-point.terminal_power_w, 0.0);
        self.undelivered_w += weight * point.undelivered_w;
        let wheel_w = point.wheel_force_n * v;
        self.propelled_w += weight * larger(wheel_w, 0.0);
        self.braked_w += weight * larger(-wheel_w, 0.0);
        self.torque_limited += weight * f64::from(u8::from(point.limited.torque));
        self.battery_limited += weight * f64::from(u8::from(point.limited.battery));
    }

    /// The energy of steps of a time in s each for a weight of 1; without a state of charge.
    pub(crate) fn energy(&self, vehicle: &Vehicle, step_s: f64, duration_s: f64) -> TripEnergy {
        let battery_energy_j = self.battery_w * step_s;
        TripEnergy {
            distance_m: self.speed_mps * step_s,
            duration_s,
            battery_energy_j,
            terminal_energy_j: self.terminal_w * step_s,
            wall_energy_j: battery_energy_j / vehicle.spec().battery.charging_efficiency,
            budget: Budget {
                inertia_j: self.inertia_w * step_s,
                rolling_j: self.rolling_w * step_s,
                aero_j: self.aero_w * step_s,
                grade_j: self.grade_w * step_s,
                gear_loss_j: self.gear_loss_w * step_s,
                motor_loss_j: self.motor_loss_w * step_s,
                auxiliary_j: self.auxiliary_w * step_s,
                battery_loss_j: self.battery_loss_w * step_s,
                friction_brake_j: self.friction_brake_w * step_s,
                regenerated_j: self.regenerated_w * step_s,
            },
            wheel: WheelEnergy {
                propelled_j: self.propelled_w * step_s,
                braked_j: self.braked_w * step_s,
            },
            limited: LimitedTotals {
                torque_s: self.torque_limited * step_s,
                battery_s: self.battery_limited * step_s,
                undelivered_j: self.undelivered_w * step_s,
            },
            soc_end_pct: None,
        }
    }
}

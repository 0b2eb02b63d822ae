use std::f64::consts::FRAC_PI_2;
use std::ops::AddAssign;

use serde::Serialize;

use crate::battery::Cells;
use crate::error::Error;
use crate::operating_point::{Motion, OperatingPoint};
use crate::road_load::RoadLoad;
use crate::scalar::{larger, sin_cos};
use crate::vehicle::Vehicle;
use crate::weather::Weather;

/// Joules in a kilowatt hour.
pub const JOULES_PER_KWH: f64 = 3.6e6;

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
        }
    }
}

/// Energy of a trip, from [`Vehicle::trip_energy`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[must_use]
pub struct TripEnergy {
    /// Distance driven, forwards or in reverse, m.
    pub distance_m: f64,
    /// Time between the first and the last sample, s.
    pub duration_s: f64,
    /// Energy taken from the cells, `∫ I U0 dt` (thesis 2.14), J.
    pub battery_energy_j: f64,
    /// Energy that left the battery at its terminals, as a logger's volts times amps gives it, J.
    pub terminal_energy_j: f64,
    /// Energy from the wall that recharges the cells, `battery_energy_j` over the charging
    /// efficiency, J.
    pub wall_energy_j: f64,
    /// Where the energy went.
    pub budget: Budget,
    /// What passed the wheels.
    pub wheel: WheelEnergy,
    /// Where the car could not follow.
    pub limited: LimitedTotals,
    /// State of charge at the end, %; `None` where it was not known at the start, or the vehicle has no capacity.
    pub soc_end_pct: Option<f64>,
}

/// Energy through the wheels by direction; the first minus the second is what the motion and its resistances took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct WheelEnergy {
    /// From the car to the road, J.
    pub propelled_j: f64,
    /// From the road back, to motor and friction brakes, J.
    pub braked_j: f64,
}

/// Where the energy of a trip went. All terms but the last sum to the energy from the cells:
///
/// ```text
/// battery_energy_j = inertia_j + rolling_j + aero_j + grade_j + gear_loss_j + motor_loss_j
///                  + auxiliary_j + battery_loss_j + friction_brake_j − limited.undelivered_j
/// ```
///
/// The model charges for the motion as recorded even where the car could not follow; what motor or
/// battery could not give is `undelivered_j`. Losses and brake heat are positive.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Budget {
    /// Change of kinetic energy, `½ m_eff (v_end² − v_start²)` (thesis 2.9; corrected: a power, and
    /// with `m_eff`), J.
    pub inertia_j: f64,
    /// Rolling resistance, J.
    pub rolling_j: f64,
    /// Air drag, J.
    pub aero_j: f64,
    /// Change of potential energy, J.
    pub grade_j: f64,
    /// Loss in the gear, J.
    pub gear_loss_j: f64,
    /// Loss in motor and inverter, J.
    pub motor_loss_j: f64,
    /// Auxiliaries, J.
    pub auxiliary_j: f64,
    /// Ohmic loss in the battery, J.
    pub battery_loss_j: f64,
    /// Heat in the friction brakes, J.
    pub friction_brake_j: f64,
    /// Energy that entered the battery at its terminals, J; for information, it is no term of the
    /// sum.
    pub regenerated_j: f64,
}

/// How long and by how much a trip asked for more than the car can give.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LimitedTotals {
    /// Time at the torque limit of the motor, s.
    pub torque_s: f64,
    /// Time at the power limit of the battery, s.
    pub battery_s: f64,
    /// Energy that was needed and not given, at the wheels and at the battery terminals, J.
    pub undelivered_j: f64,
}

impl Budget {
    /// Sum of all terms but `regenerated_j`, in J: the energy from the cells plus the undelivered
    /// energy.
    #[must_use]
    pub fn total_j(&self) -> f64 {
        self.inertia_j
            + self.rolling_j
            + self.aero_j
            + self.grade_j
            + self.gear_loss_j
            + self.motor_loss_j
            + self.auxiliary_j
            + self.battery_loss_j
            + self.friction_brake_j
    }
}

/// Trips add up; the state of charge is that of the last.
impl AddAssign for TripEnergy {
    fn add_assign(&mut self, other: Self) {
        self.distance_m += other.distance_m;
        self.duration_s += other.duration_s;
        self.battery_energy_j += other.battery_energy_j;
        self.terminal_energy_j += other.terminal_energy_j;
        self.wall_energy_j += other.wall_energy_j;
        let (budget, more) = (&mut self.budget, other.budget);
        budget.inertia_j += more.inertia_j;
        budget.rolling_j += more.rolling_j;
        budget.aero_j += more.aero_j;
        budget.grade_j += more.grade_j;
        budget.gear_loss_j += more.gear_loss_j;
        budget.motor_loss_j += more.motor_loss_j;
        budget.auxiliary_j += more.auxiliary_j;
        budget.battery_loss_j += more.battery_loss_j;
        budget.friction_brake_j += more.friction_brake_j;
        budget.regenerated_j += more.regenerated_j;
        self.wheel.propelled_j += other.wheel.propelled_j;
        self.wheel.braked_j += other.wheel.braked_j;
        self.soc_end_pct = other.soc_end_pct;
        self.limited.torque_s += other.limited.torque_s;
        self.limited.battery_s += other.limited.battery_s;
        self.limited.undelivered_j += other.limited.undelivered_j;
    }
}

impl TripEnergy {
    /// Consumption at the battery terminals in kWh per 100 km; `None` without distance.
    #[must_use]
    pub fn consumption_kwh_per_100km(&self) -> Option<f64> {
        (self.distance_m > 0.0)
            .then(|| self.terminal_energy_j / JOULES_PER_KWH / (self.distance_m / 1e5))
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
            sum.add(&point);
            visit(&point);
        }
        let step_s = trip.step_s;
        let battery_energy_j = sum.battery_w * step_s;
        Ok(TripEnergy {
            distance_m: sum.speed_mps * step_s,
            duration_s: trip.speed_mps.len().saturating_sub(1) as f64 * step_s,
            battery_energy_j,
            terminal_energy_j: sum.terminal_w * step_s,
            wall_energy_j: battery_energy_j / self.spec().battery.charging_efficiency,
            budget: Budget {
                inertia_j: sum.inertia_w * step_s,
                rolling_j: sum.rolling_w * step_s,
                aero_j: sum.aero_w * step_s,
                grade_j: sum.grade_w * step_s,
                gear_loss_j: sum.gear_loss_w * step_s,
                motor_loss_j: sum.motor_loss_w * step_s,
                auxiliary_j: sum.auxiliary_w * step_s,
                battery_loss_j: sum.battery_loss_w * step_s,
                friction_brake_j: sum.friction_brake_w * step_s,
                regenerated_j: sum.regenerated_w * step_s,
            },
            wheel: WheelEnergy {
                propelled_j: sum.propelled_w * step_s,
                braked_j: sum.braked_w * step_s,
            },
            limited: LimitedTotals {
                torque_s: sum.torque_limited * step_s,
                battery_s: sum.battery_limited * step_s,
                undelivered_j: sum.undelivered_w * step_s,
            },
            soc_end_pct: points.soc_pct,
        })
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
        let argument = |name, value: f64, min: f64, max: f64| {
            if (min..=max).contains(&value) {
                return Ok(());
            }
            Err(Error::Argument {
                name,
                value,
                min,
                max,
            })
        };
        argument("step_s", trip.step_s, 1e-3, 1e6)?;
        if let Some(soc_pct) = trip.soc_start_pct {
            argument("soc_start_pct", soc_pct, 0.0, 100.0)?;
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
            cells: self.battery.cells(trip.soc_start_pct),
            soc_pct: trip
                .soc_start_pct
                .and_then(|soc_pct| self.battery.discharged_pct(soc_pct, 0.0)),
            end: 1,
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
    cells: Cells,
    soc_pct: Option<f64>,
    /// Sample at the end of the next step.
    end: usize,
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
        let point = self.vehicle.evaluate(&self.road_load, &self.cells, &motion);
        self.end += 1;
        if let Some(soc_pct) = self.soc_pct {
            let battery = &self.vehicle.battery;
            self.soc_pct =
                battery.discharged_pct(soc_pct, point.battery_current_a * self.trip.step_s);
            if battery.has_curve() {
                self.cells = battery.cells(self.soc_pct);
            }
        }
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

/// Sums of powers over the steps of a trip.
#[derive(Default)]
struct PowerSum {
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
    fn add(&mut self, point: &OperatingPoint) {
        let v = point.speed_mps;
        self.speed_mps += v.abs();
        self.battery_w += point.battery_power_w;
        self.terminal_w += point.terminal_power_w;
        self.inertia_w += point.inertia_n * v;
        self.rolling_w += point.rolling_n * v;
        self.aero_w += point.aero_n * v;
        self.grade_w += point.grade_n * v;
        self.gear_loss_w += point.gear_loss_w;
        self.motor_loss_w += point.motor_loss_w;
        self.auxiliary_w += point.auxiliary_power_w;
        self.battery_loss_w += point.battery_loss_w;
        self.friction_brake_w += point.friction_brake_w;
        self.regenerated_w += larger(-point.terminal_power_w, 0.0);
        self.undelivered_w += point.undelivered_w;
        let wheel_w = point.wheel_force_n * v;
        self.propelled_w += larger(wheel_w, 0.0);
        self.braked_w += larger(-wheel_w, 0.0);
        self.torque_limited += f64::from(u8::from(point.limited.torque));
        self.battery_limited += f64::from(u8::from(point.limited.battery));
    }
}

use crate::battery::Cells;
use crate::check::argument;
use crate::error::Error;
use crate::formula::StepFormula;
use crate::operating_point::{Motion, OperatingPoint};
use crate::road_load::RoadLoad;
use crate::scalar::sin_cos;
use crate::trip::PowerSum;
use crate::trip_energy::TripEnergy;
use crate::vehicle::Vehicle;
use crate::weather::Weather;

/// A step of a road: its length and its mean slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadStep {
    length_m: f64,
    sin_slope: f64,
    cos_slope: f64,
}

impl RoadStep {
    /// A step of a length in m at a slope angle in rad, positive uphill.
    #[must_use]
    pub fn new(length_m: f64, slope_rad: f64) -> Self {
        let (sin_slope, cos_slope) = sin_cos(slope_rad);
        Self {
            length_m,
            sin_slope,
            cos_slope,
        }
    }

    /// Length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Sine of the slope angle.
    #[must_use]
    pub fn sin_slope(&self) -> f64 {
        self.sin_slope
    }

    /// Cosine of the slope angle.
    #[must_use]
    pub fn cos_slope(&self) -> f64 {
        self.cos_slope
    }
}

/// A vehicle over the steps of a road: the speeds at both ends of a step are given, the acceleration between them is constant.
///
/// ```text
/// v̄ = (v₀ + v₁)/2        Δt = Δs/v̄        a = (v₁² − v₀²)/2Δs        E = P_bat(v̄, a, θ) Δt
/// ```
///
/// It is the step of [`Vehicle::trip_points`], over a distance in place of a time. The battery is at nominal voltage and the car
/// warm.
#[derive(Debug, Clone)]
pub struct StepModel<'a> {
    vehicle: &'a Vehicle,
    road_load: RoadLoad,
    cells: Cells,
    auxiliary_power_w: f64,
    weather: Option<Weather>,
}

impl<'a> StepModel<'a> {
    /// A vehicle with its own auxiliary power, in the weather of its road load.
    #[must_use]
    pub fn new(vehicle: &'a Vehicle) -> Self {
        Self {
            vehicle,
            road_load: vehicle.road_load.clone(),
            cells: vehicle.battery.nominal(),
            auxiliary_power_w: vehicle.spec().auxiliary_power_w,
            weather: None,
        }
    }

    /// The same in other weather.
    ///
    /// # Errors
    /// [`Error::Argument`] for weather out of range.
    pub fn in_weather(mut self, weather: &Weather) -> Result<Self, Error> {
        weather.check()?;
        self.road_load = self
            .vehicle
            .road_load
            .under(weather, &self.vehicle.spec().weather);
        self.weather = Some(*weather);
        Ok(self)
    }

    /// The same with another auxiliary power in W, 0 to 10⁶.
    ///
    /// # Errors
    /// [`Error::Argument`] out of that range.
    pub fn with_auxiliary_power(mut self, power_w: f64) -> Result<Self, Error> {
        argument("auxiliary_power_w", power_w, 0.0, 1e6)?;
        self.auxiliary_power_w = power_w;
        Ok(self)
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &'a Vehicle {
        self.vehicle
    }

    /// The weather; `None` is that of the road load.
    #[must_use]
    pub fn weather(&self) -> Option<Weather> {
        self.weather
    }

    /// Power of the auxiliaries, W.
    #[must_use]
    pub fn auxiliary_power_w(&self) -> f64 {
        self.auxiliary_power_w
    }

    /// The operating point of a step between two speeds in m/s, of which one at least is above 0.
    #[must_use]
    #[inline(always)]
    pub fn operating_point(&self, step: &RoadStep, from_mps: f64, to_mps: f64) -> OperatingPoint {
        self.at(
            step,
            0.5 * (from_mps + to_mps),
            (to_mps * to_mps - from_mps * from_mps) / (2.0 * step.length_m),
        )
    }

    /// The operating point in a step at a mean speed in m/s and an acceleration in m/s².
    #[must_use]
    #[inline(always)]
    pub fn at(&self, step: &RoadStep, speed_mps: f64, accel_mps2: f64) -> OperatingPoint {
        let motion = Motion {
            speed_mps,
            accel_mps2,
            sin_slope: step.sin_slope,
            cos_slope: step.cos_slope,
            auxiliary_power_w: self.auxiliary_power_w,
            warm_up_n: 0.0,
            cells_w: f64::INFINITY,
        };
        self.vehicle.evaluate(&self.road_load, &self.cells, &motion)
    }

    /// Energy from the cells in J for a step; infinite where motor or battery cannot give it.
    #[must_use]
    #[inline(always)]
    pub fn energy_j(&self, step: &RoadStep, from_mps: f64, to_mps: f64) -> f64 {
        let point = self.operating_point(step, from_mps, to_mps);
        let time_s = step.length_m / point.speed_mps;
        if point.limited.torque || point.limited.battery {
            f64::INFINITY
        } else {
            point.battery_power_w * time_s
        }
    }

    /// [`Self::energy_j`] from one speed to each of several; vectorised. As many energies as speeds, or the fewer of both.
    pub fn energies_j(&self, step: &RoadStep, from_mps: f64, to_mps: &[f64], energy_j: &mut [f64]) {
        for (energy_j, &to_mps) in energy_j.iter_mut().zip(to_mps) {
            *energy_j = self.energy_j(step, from_mps, to_mps);
        }
    }

    /// Power in W from the cells of a car that stands on a slope angle in rad: the motor holds it uphill, the brakes downhill.
    #[must_use]
    pub fn standing_power_w(&self, slope_rad: f64) -> f64 {
        self.at(&RoadStep::new(1.0, slope_rad), 0.0, 0.0)
            .battery_power_w
    }

    /// Largest force in N that motor and battery put on the road at a speed in m/s.
    #[must_use]
    pub fn propulsion_limit_n(&self, speed_mps: f64) -> f64 {
        let vehicle = self.vehicle;
        let motor_speed_rad_s = speed_mps * vehicle.motor_speed_per_mps;
        let motor_nm = vehicle.motor.torque_limit_nm(motor_speed_rad_s);
        let demand_w = |torque_nm: f64| {
            torque_nm * motor_speed_rad_s
                + vehicle.motor.loss_w(torque_nm, motor_speed_rad_s)
                + self.auxiliary_power_w
        };
        let given_w = vehicle.battery.max_power_w();
        if demand_w(motor_nm) <= given_w {
            return motor_nm * vehicle.propelling_n_per_nm;
        }
        let (mut within_nm, mut beyond_nm) = (0.0, motor_nm);
        // Halving beyond the last bit changes nothing more.
        for _ in 0..60 {
            let middle_nm = 0.5 * (within_nm + beyond_nm);
            if demand_w(middle_nm) <= given_w {
                within_nm = middle_nm;
            } else {
                beyond_nm = middle_nm;
            }
        }
        within_nm * vehicle.propelling_n_per_nm
    }

    /// Force in N that a step takes at a steady speed in m/s above 0: road load and grade.
    #[must_use]
    pub fn resistance_n(&self, step: &RoadStep, speed_mps: f64) -> f64 {
        let vehicle = self.vehicle;
        self.road_load.rolling_n(speed_mps, step.cos_slope)
            + self.road_load.aero_n(speed_mps)
            + vehicle.spec().mass_kg * crate::GRAVITY_MPS2 * step.sin_slope
    }

    /// Energy and budget of a drive over steps between speeds in m/s, one more than steps, with stands given as slope angle in rad and
    /// time in s.
    pub fn drive_energy(
        &self,
        steps: &[RoadStep],
        speed_mps: &[f64],
        stands: impl IntoIterator<Item = (f64, f64)>,
    ) -> TripEnergy {
        let mut sum = PowerSum::default();
        let mut duration_s = 0.0;
        for (step, ends) in steps.iter().zip(speed_mps.windows(2)) {
            let point = self.operating_point(step, ends[0], ends[1]);
            let time_s = step.length_m / point.speed_mps;
            sum.add(&point, time_s);
            duration_s += time_s;
        }
        for (slope_rad, time_s) in stands {
            sum.add(&self.at(&RoadStep::new(1.0, slope_rad), 0.0, 0.0), time_s);
            duration_s += time_s;
        }
        sum.energy(self.vehicle, 1.0, duration_s)
    }

    /// The formulas that give the energy, with derivatives; `None` where losses are a table.
    #[must_use]
    pub fn formula(&self) -> Option<StepFormula> {
        StepFormula::new(
            self.vehicle,
            &self.road_load,
            &self.cells,
            self.auxiliary_power_w,
        )
    }
}

use std::ops::AddAssign;

use serde::Serialize;

/// Joules in a kilowatt hour.
pub const JOULES_PER_KWH: f64 = 3.6e6;

/// Energy of a trip, from [`Vehicle::trip_energy`](crate::Vehicle::trip_energy).
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
        self.per_100km(self.terminal_energy_j)
    }

    /// Consumption at the wall in kWh per 100 km; `None` without distance.
    #[must_use]
    pub fn wall_kwh_per_100km(&self) -> Option<f64> {
        self.per_100km(self.wall_energy_j)
    }

    fn per_100km(&self, energy_j: f64) -> Option<f64> {
        (self.distance_m > 0.0).then(|| energy_j / JOULES_PER_KWH / (self.distance_m / 1e5))
    }
}

//! What a recorded trip could have cost.

mod recorded;
mod road;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tests;

use driver_model::statistics::quantile;
use ev_energy::{StepModel, Trip};
use speed_plan::{Answer, Demand, Envelope, Obstacle, Problem, Settings, plan};

use crate::document::Bound;
use recorded::Legs;
pub use recorded::RecordedMotion;

/// No road is shorter, m.
const SHORTEST_M: f64 = 1.0;

/// How much freedom a plan has beside the recorded motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PotentialSettings {
    /// Nowhere faster than the fastest recorded within this distance to either side, m.
    pub window_m: f64,
    /// Lows that are this much below the highs beside them are passed no faster than recorded, m/s.
    pub prominence_mps: f64,
    /// Strongest braking, m/s²; below 0.
    pub min_mps2: f64,
    /// The strongest acceleration is this quantile of the recorded ones in motion, 0 to 1.
    pub accel_quantile: f64,
    /// Slowest speed where the car does not stand, m/s.
    pub slowest_mps: f64,
}

impl Default for PotentialSettings {
    fn default() -> Self {
        Self {
            window_m: 100.0,
            prominence_mps: 2.0,
            min_mps2: -2.5,
            accel_quantile: 0.995,
            slowest_mps: 0.5,
        }
    }
}

/// The recorded motion of a trip and its cheapest plan, by the same model of the car; of no trip by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Potential {
    /// Distance, m.
    pub distance_m: f64,
    /// Time, that standing at both ends included, s.
    pub time_s: f64,
    /// Energy from the cells of the recorded motion, J.
    pub own_energy_j: f64,
    /// The same of the plan, J.
    pub plan_energy_j: f64,
    /// No plan takes less, J.
    pub lower_bound_j: f64,
    /// Whether the bound was proven.
    pub bound: Bound,
    /// Energy of the recorded motion that flows in either direction, J.
    pub turned_over_j: f64,
    /// How long the driver was faster than the limit, s; 0 where no limit is known.
    pub faster_than_limit_s: f64,
    /// How long the recorded motion asks for more than motor or battery of the model give, s.
    pub limited_s: f64,
}

impl Potential {
    /// Energy that the plan saves, % of the larger of |energy| and a tenth of the energy turned over, both of the recorded motion.
    #[must_use]
    pub fn saving_pct(&self) -> f64 {
        self.pct(self.own_energy_j - self.plan_energy_j)
    }

    /// What any other plan could save beyond that at most, % of the same.
    #[must_use]
    pub fn gap_pct(&self) -> f64 {
        self.pct(self.plan_energy_j - self.lower_bound_j)
    }

    fn pct(&self, energy_j: f64) -> f64 {
        100.0 * energy_j
            / self
                .own_energy_j
                .abs()
                .max(0.1 * self.turned_over_j)
                .max(f64::MIN_POSITIVE)
    }
}

/// Trips or pieces of a trip together.
impl std::ops::AddAssign for Potential {
    fn add_assign(&mut self, other: Self) {
        self.distance_m += other.distance_m;
        self.time_s += other.time_s;
        self.own_energy_j += other.own_energy_j;
        self.plan_energy_j += other.plan_energy_j;
        self.lower_bound_j += other.lower_bound_j;
        self.turned_over_j += other.turned_over_j;
        self.faster_than_limit_s += other.faster_than_limit_s;
        self.limited_s += other.limited_s;
        self.bound = self.bound.max(other.bound);
    }
}

/// Why there is no plan for a recorded trip.
#[derive(Debug, thiserror::Error)]
pub enum NotPlanned {
    /// The car does not move.
    #[error("the car does not move as far as a metre")]
    Standing,
    /// It cannot be driven within the accelerations that are allowed.
    #[error("{0}")]
    Obstacle(Obstacle),
    /// It is no road, or the car cannot have driven it.
    #[error(transparent)]
    Problem(#[from] speed_plan::Error),
}

/// A drive in pieces, see [`potential()`]. What a piece took in which the car does not move as far as a metre is what its plan takes, too.
///
/// # Errors
/// [`NotPlanned`] of the first piece that cannot be planned, and where the car moves in none.
pub fn potential_of_pieces<'a>(
    pieces: impl IntoIterator<Item = RecordedMotion<'a>>,
    model: &StepModel,
    settings: &PotentialSettings,
    search: &Settings,
) -> Result<Potential, NotPlanned> {
    let mut sum = Potential::default();
    let mut moves = false;
    for piece in pieces {
        let found = match potential(&piece, model, settings, search) {
            Err(NotPlanned::Standing) => as_recorded(&piece, model)?,
            found => {
                moves = true;
                found?
            }
        };
        sum += found;
    }
    if moves {
        Ok(sum)
    } else {
        Err(NotPlanned::Standing)
    }
}

fn as_recorded(motion: &RecordedMotion, model: &StepModel) -> Result<Potential, NotPlanned> {
    let own = own_energy(motion, model).map_err(speed_plan::Error::from)?;
    let legs = Legs::of(motion);
    Ok(Potential {
        distance_m: legs.length_m(),
        time_s: legs.duration_s(),
        own_energy_j: own.energy_j,
        plan_energy_j: own.energy_j,
        lower_bound_j: own.energy_j,
        turned_over_j: own.turned_over_j,
        ..Potential::default()
    })
}

/// The cheapest plan with the stops, dwells and arrival of a recorded motion: slow points are passed no faster than recorded, other
/// places no faster than the fastest recorded near by, and than the limit, or the driver there where he was faster.
///
/// Standing counts on both sides, at both ends too. The car is warm and its battery at nominal voltage, as in every plan.
///
/// # Errors
/// [`NotPlanned`] says why there is none.
pub fn potential(
    motion: &RecordedMotion,
    model: &StepModel,
    settings: &PotentialSettings,
    search: &Settings,
) -> Result<Potential, NotPlanned> {
    let own = own_energy(motion, model).map_err(speed_plan::Error::from)?;
    let (expected, limits) = (motion.speed_mps.len(), motion.limit_mps);
    if let Some(found) = limits.map(<[f64]>::len).filter(|found| *found != expected) {
        let channel = "limit_mps";
        return Err(speed_plan::Error::Length {
            channel,
            found,
            expected,
        }
        .into());
    }
    let legs = Legs::of(motion);
    if legs.length_m() < SHORTEST_M {
        return Err(NotPlanned::Standing);
    }
    let columns = road::columns(&legs, settings)?;
    let mut accels_mps2 = legs.accels_mps2();
    accels_mps2.sort_by(f64::total_cmp);
    let max_mps2 = quantile(&accels_mps2, settings.accel_quantile).unwrap_or(0.0);
    let envelope = Envelope::constant(settings.min_mps2, max_mps2)?;
    let problem = Problem::new(model.clone(), envelope, columns)?;
    let plan = match plan(&problem, Demand::Arrival(legs.arrival_s()), search)? {
        Answer::Plan(plan) => plan,
        Answer::Obstacle(obstacle) => return Err(NotPlanned::Obstacle(obstacle)),
    };
    let standing_j = legs.end_dwell_s() * model.standing_power_w(legs.end_slope_rad());
    Ok(Potential {
        distance_m: legs.length_m(),
        time_s: legs.duration_s(),
        own_energy_j: own.energy_j,
        plan_energy_j: plan.run.energy_j + standing_j,
        lower_bound_j: plan.lower_bound_j + standing_j,
        bound: plan.proof.into(),
        turned_over_j: own.turned_over_j,
        faster_than_limit_s: legs.faster_than_limit_s(),
        limited_s: own.limited_s,
    })
}

struct OwnEnergy {
    energy_j: f64,
    turned_over_j: f64,
    limited_s: f64,
}

fn own_energy(motion: &RecordedMotion, model: &StepModel) -> Result<OwnEnergy, ev_energy::Error> {
    let vehicle = model.vehicle();
    let forward_mps = motion.forward_mps();
    let extra_w = model.auxiliary_power_w() - vehicle.spec().auxiliary_power_w;
    let extra_w = vec![extra_w; forward_mps.len()];
    let trip = Trip {
        step_s: motion.step_s,
        speed_mps: &forward_mps,
        slope_rad: motion.slope_rad,
        extra_aux_power_w: Some(&extra_w),
        weather: model.weather(),
        ..Trip::default()
    };
    let mut turned_over_j = 0.0;
    let energy = vehicle.trip_energy_with(&trip, |point| {
        turned_over_j += point.battery_power_w.abs() * motion.step_s;
    })?;
    Ok(OwnEnergy {
        energy_j: energy.battery_energy_j,
        turned_over_j,
        limited_s: energy.limited.torque_s + energy.limited.battery_s,
    })
}

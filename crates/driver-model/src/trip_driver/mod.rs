//! A whole trip from the road and the driver alone, without any measured speed.
//!
//! The speed is planned over the distance `s` and a clock turns it into one over time, so that nothing drifts. With the limit
//! `L` of the road and the driver's habit `β(L)`, the wanted speed is `w = max(L + β(L), 2 m/s)`. Then
//!
//! ```text
//! ceiling    v²(s) ≤ min(w(s), cap(s))²        cap: 0 at stops, the speed at slow points
//! braking    v²(s) ≤ u² + 2 d (s_e − s)        before every event at s_e with speed u; Δ = w(s_e) − u before it
//!            d = min(c max(Δ, 1)^γ, b_max)
//! forward    dv/dt ≤ min(a_max, A √(1 − v/w))
//! clock      t_{i+1} = t_i + dwell_i + 2 Δs/(v_i + v_{i+1})
//! ```
//!
//! Between nodes, [`crate::road::NODE_SPACING_M`] apart, the acceleration is constant. `v ≥ 0`, standstill at stops and the limits of
//! acceleration and braking hold at every node by construction.
//!
//! A driver also slows down where neither limit nor stop says so: turns, traffic. [`Slowdowns`] are how often and to what
//! speed; where the road does not know its slow points they are put in evenly. Without them a trip is some percent too long
//! and too cheap. What the recorded trips still cost more, the driver's unrest makes up for, see [`restless`].

mod clock;
mod fit;
mod habit;
mod law;
mod law_fit;
mod manoeuvres;
mod plan;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod property_tests;
mod recording;
mod slowdowns;
mod style;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests;
mod unrest;
mod zigzag;

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::Error;

use crate::road::limit::{LIMIT_MPS, LIMITS_PER_MPS};
pub use clock::FreeRun;
pub use habit::{HabitLine, LimitHabit, WantedSpeed};
pub use law::{AccelerationLaw, BrakingLaw};
pub use recording::{RecordedTrip, interpolated};
pub use slowdowns::{LimitSlowdowns, Slowdowns};
pub use style::{AccelAtSpeed, HalfWidth, Spread, Style};
use unrest::UNREST_MPS2;
pub use unrest::restless;
pub use zigzag::{Extremum, zigzag};

/// What a driver's trips have in common, learnt from recorded ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct TripDriver {
    wanted: WantedSpeed,
    acceleration: AccelerationLaw,
    braking: BrakingLaw,
    slowdowns: Slowdowns,
    unrest_mps2: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    style: Option<Style>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    wanted: WantedSpeed,
    acceleration: AccelerationLaw,
    braking: BrakingLaw,
    slowdowns: Slowdowns,
    #[serde(default)]
    unrest_mps2: f64,
    #[serde(default)]
    style: Option<Style>,
}

impl TryFrom<Unchecked> for TripDriver {
    type Error = Error;

    fn try_from(parts: Unchecked) -> Result<Self, Error> {
        within("unrest_mps2", parts.unrest_mps2, &UNREST_MPS2)?;
        let driver = Self::new(
            parts.wanted,
            parts.acceleration,
            parts.braking,
            parts.slowdowns,
        )?;
        if let Some(style) = &parts.style {
            style.check()?;
        }
        Ok(Self {
            unrest_mps2: parts.unrest_mps2,
            style: parts.style,
            ..driver
        })
    }
}

impl TripDriver {
    /// A driver of known habits, who drives without unrest.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value that no fit can produce.
    pub fn new(
        wanted: WantedSpeed,
        acceleration: AccelerationLaw,
        braking: BrakingLaw,
        slowdowns: Slowdowns,
    ) -> Result<Self, Error> {
        wanted.check()?;
        acceleration.check()?;
        braking.check()?;
        slowdowns.check()?;
        Ok(Self {
            wanted,
            acceleration,
            braking,
            slowdowns,
            unrest_mps2: 0.0,
            style: None,
        })
    }

    /// The speed wanted under a limit.
    #[must_use]
    pub fn wanted(&self) -> &WantedSpeed {
        &self.wanted
    }

    /// How the driver speeds up.
    #[must_use]
    pub fn acceleration(&self) -> &AccelerationLaw {
        &self.acceleration
    }

    /// How the driver brakes.
    #[must_use]
    pub fn braking(&self) -> &BrakingLaw {
        &self.braking
    }

    /// Slowdowns that neither limits nor stops explain.
    #[must_use]
    pub fn slowdowns(&self) -> &Slowdowns {
        &self.slowdowns
    }

    /// Acceleration by which the speed rises and falls around the plan all the time, see [`restless`]: what trips cost more than evenly
    /// driven ones.
    #[must_use]
    pub fn unrest_mps2(&self) -> f64 {
        self.unrest_mps2
    }
}

fn within(name: &'static str, value: f64, range: &RangeInclusive<f64>) -> Result<(), Error> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::Parameter {
        model: "trip driver",
        name,
        value,
        expected: format!("{} to {}", range.start(), range.end()),
    })
}

/// The row of a limit in a table that is sorted by it.
fn row_of<T>(table: &[T], limit_of: fn(&T) -> f64, limit_mps: f64) -> Option<&T> {
    let half = 0.5 / LIMITS_PER_MPS;
    let row = table.get(table.partition_point(|row| limit_of(row) < limit_mps - half))?;
    (limit_of(row) < limit_mps + half).then_some(row)
}

fn check_table<T>(table: &[T], limit_of: fn(&T) -> f64) -> Result<(), Error> {
    for row in table {
        within("limit_mps", limit_of(row), &LIMIT_MPS)?;
    }
    let unsorted = |pair: &&[T]| limit_of(&pair[1]) < limit_of(&pair[0]) + 0.5 / LIMITS_PER_MPS;
    match table.windows(2).find(unsorted) {
        None => Ok(()),
        Some(pair) => Err(Error::Parameter {
            model: "trip driver",
            name: "limit_mps",
            value: limit_of(&pair[1]),
            expected: "limits in ascending order, each once".to_owned(),
        }),
    }
}

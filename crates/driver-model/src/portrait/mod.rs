//! What kind of driver this is: figures over everything recorded of one.

mod cruise;
mod distribution;
mod dynamics;
mod economy;
mod headway;
mod pace;

use ev_energy::Vehicle;
use rayon::prelude::*;
use serde::Serialize;

pub use cruise::LimitKeeping;
pub use distribution::Distribution;
pub use dynamics::Dynamics;
pub use economy::{Economy, SMOOTH_WINDOW_S};
pub use headway::{Headway, HeadwayBin};
pub use pace::{AccelBin, AccelOverSpeed};

use crate::{DriveBehaviour, Error, Motion, PhaseKind, PhaseSettings, motion};

/// A driver in figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Portrait {
    /// Drives.
    pub drives: usize,
    /// Over all drives.
    pub distance_m: f64,
    /// Over all drives, standstill included.
    pub duration_s: f64,
    /// Acceleration over speed, without a leader.
    pub acceleration: AccelOverSpeed,
    /// Deceleration over speed, without a leader.
    pub braking: AccelOverSpeed,
    /// Speed against each limit while cruising; empty where no log has limits.
    pub limits: Vec<LimitKeeping>,
    /// Time behind the vehicle ahead; `None` where no log has a gap.
    pub headway: Option<Headway>,
    /// How smoothly.
    pub dynamics: Dynamics,
    /// What it costs, and what the same drives would cost without the restlessness.
    pub economy: Economy,
}

impl Portrait {
    /// Draws a portrait from all drives of one driver.
    ///
    /// # Errors
    /// Whatever segmentation and the vehicle model refuse.
    pub fn of(
        motions: &[Motion],
        vehicle: &Vehicle,
        settings: &PhaseSettings,
    ) -> Result<Self, Error> {
        let drives: Vec<&[Motion]> = motion::drives(motions).collect();
        let trips = drives
            .par_iter()
            .map(|drive| DriveBehaviour::of_drive(drive, settings))
            .collect::<Result<Vec<_>, _>>()?;
        let logs: Vec<_> = motions.iter().map(Motion::log).collect();
        Ok(Self {
            drives: drives.len(),
            distance_m: motions
                .iter()
                .filter_map(|motion| motion.distance_m().last())
                .sum(),
            duration_s: motions.iter().map(Motion::duration_s).sum(),
            acceleration: AccelOverSpeed::of(PhaseKind::Acceleration, &trips),
            braking: AccelOverSpeed::of(PhaseKind::Braking, &trips),
            limits: cruise::limit_keeping(&trips),
            headway: Headway::of(&logs),
            dynamics: Dynamics::of(&logs),
            economy: Economy::of(motions, vehicle)?,
        })
    }
}

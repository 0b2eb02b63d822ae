//! What kind of driver this is: figures over everything recorded of one.

mod cruise;
mod distribution;
mod dynamics;
mod economy;
mod headway;
mod pace;

use drive_log::Drive;
use ev_energy::Vehicle;
use rayon::prelude::*;
use serde::Serialize;

pub use cruise::LimitKeeping;
pub use distribution::Distribution;
pub use dynamics::Dynamics;
pub use economy::{Economy, SMOOTH_WINDOW_S};
pub use headway::{Headway, HeadwayBin};
pub use pace::{AccelBin, AccelOverSpeed};

use crate::{Error, PhaseKind, PhaseSettings, Trip};

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
        drives: &[&Drive],
        vehicle: &Vehicle,
        settings: &PhaseSettings,
    ) -> Result<Self, Error> {
        let trips = drives
            .par_iter()
            .map(|drive| Trip::from_drive(drive, settings))
            .collect::<Result<Vec<_>, _>>()?;
        let logs = || drives.iter().flat_map(|drive| &drive.pieces);
        let all: Vec<_> = logs().collect();
        Ok(Self {
            drives: drives.len(),
            distance_m: logs()
                .filter_map(|log| log.distance_m().last().copied())
                .sum(),
            duration_s: logs()
                .map(|log| (log.len() - 1) as f64 * log.step_s())
                .sum(),
            acceleration: AccelOverSpeed::of(PhaseKind::Acceleration, &trips),
            braking: AccelOverSpeed::of(PhaseKind::Braking, &trips),
            limits: cruise::limit_keeping(&trips),
            headway: Headway::of(&all),
            dynamics: Dynamics::of(&all),
            economy: Economy::of(&all, vehicle, settings.slope_bandwidth_m)?,
        })
    }
}

use drive_log::{DriveLog, hann};
use ev_energy::{JOULES_PER_KWH, Vehicle};
use serde::Serialize;

use crate::{Error, Motion};

/// Energy of the recorded driving, and of the same drives with the speed averaged over [`SMOOTH_WINDOW_S`].
///
/// The smooth drive covers the same distance in the same time and stays so near to the recorded one that it is feasible in the
/// same traffic; what it saves is what restless speed costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Economy {
    /// As recorded; `None` without distance.
    pub consumption_kwh_per_100km: Option<f64>,
    /// Smooth.
    pub smooth_consumption_kwh_per_100km: Option<f64>,
    /// Share of the recorded energy that smoothness saves.
    pub restless_pct: Option<f64>,
    /// The farthest that the smooth drive is ever from the recorded one.
    pub largest_deviation_m: f64,
    /// As recorded, lost in the friction brakes.
    pub friction_brake_kwh_per_100km: Option<f64>,
}

/// Length of the Hann window that smooths a drive.
pub const SMOOTH_WINDOW_S: f64 = 10.0;

impl Economy {
    pub(super) fn of(motions: &[Motion], vehicle: &Vehicle) -> Result<Self, Error> {
        let (mut recorded_j, mut smooth_j, mut brake_j) = (0.0, 0.0, 0.0);
        let (mut distance_m, mut largest_deviation_m) = (0.0, 0.0_f64);
        for motion in motions {
            let log = motion.log();
            let energy = |speed_mps: &[f64]| {
                let trip = ev_energy::Trip {
                    step_s: log.step_s(),
                    speed_mps,
                    slope_rad: motion.slope_rad(),
                    ..ev_energy::Trip::default()
                };
                let energy = vehicle.trip_energy(&trip);
                energy.map_err(|error| Error::from(error).in_log(log.name()))
            };
            let smooth_mps = hann(log.speed_mps(), window(log.step_s()));
            let recorded = energy(log.speed_mps())?;
            recorded_j += recorded.terminal_energy_j;
            brake_j += recorded.budget.friction_brake_j;
            smooth_j += energy(&smooth_mps)?.terminal_energy_j;
            distance_m += recorded.distance_m;
            largest_deviation_m = largest_deviation_m.max(deviation_m(log, &smooth_mps));
        }
        let per_100km =
            |joules: f64| (distance_m > 0.0).then(|| joules / JOULES_PER_KWH / (distance_m / 1e5));
        Ok(Self {
            consumption_kwh_per_100km: per_100km(recorded_j),
            smooth_consumption_kwh_per_100km: per_100km(smooth_j),
            restless_pct: (recorded_j > 0.0).then(|| 100.0 * (1.0 - smooth_j / recorded_j)),
            largest_deviation_m,
            friction_brake_kwh_per_100km: per_100km(brake_j),
        })
    }
}

/// An odd number of samples.
fn window(step_s: f64) -> usize {
    2 * (0.5 * SMOOTH_WINDOW_S / step_s) as usize + 1
}

fn deviation_m(log: &DriveLog, smooth_mps: &[f64]) -> f64 {
    let mut ahead_m = 0.0;
    let mut largest = 0.0_f64;
    for (recorded, smooth) in log.speed_mps().iter().zip(smooth_mps) {
        ahead_m += (smooth - recorded) * log.step_s();
        largest = largest.max(f64::abs(ahead_m));
    }
    largest
}
